"""The values that a case really flies with, read back from the records that compiled code gets.

A dispersion that is silently not applied is the classic failure of Monte Carlo tools; here a value that did
not arrive stops the case.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from math import isclose
from typing import Any, NamedTuple, get_args

import numpy as np
from pydantic import BaseModel

from edl6dof.campaign.design.variants import Variant
from edl6dof.config.dtype import in_record
from edl6dof.config.model_paths import Keys, walk
from edl6dof.config.units import split_unit
from edl6dof.records import offset
from edl6dof.scenario.case import CASE
from edl6dof.scenario.schema import Scenario


class NotApplied(Exception):
    """A change of a case did not reach what is flown."""


def applied(
    variant: Variant, case_truth: Mapping[str, Any], told: Mapping[str, Any], places: dict[str, Place]
) -> dict[str, Any]:
    """Column name to value for every change of a case, ``truth.`` and ``belief.`` in front.

    ``places``, filled here, tells for the next cases of one scenario where the record holds a path: a number
    that is found there needs no walk through the models.

    Raises:
        NotApplied: the record, or the validated scenario where the record has no such field, holds another
            value.
    """
    true, believed = variant.loaded.truth, variant.loaded.scenario
    words: dict[type, np.ndarray] = {kind: variant.parts.case.view(kind) for kind in (np.float64, np.int64)}
    row: dict[str, Any] = {}
    for path, wanted in case_truth.items():
        place = places.get(path)
        if place is not None and type(wanted) is float and _holds(words, place, wanted):
            row[f"truth.{path}"] = wanted
            continue
        keys, value = _confirmed(path, wanted, true)
        row[f"truth.{path}"] = value
        if (place := _place(keys)) is not None and isinstance(value, bool | int | float):
            if not _holds(words, place, value):
                raise NotApplied(
                    f"{path} should be {value!r} and its record holds {_held(words, place) / place.to_si!r}"
                )
            places[path] = place
    for path, wanted in told.items():
        row["profile" if path == "profile" else f"belief.{path}"] = _confirmed(path, wanted, believed)[1]
    return row


def _confirmed(path: str, wanted: Any, model: BaseModel) -> tuple[Keys, Any]:
    keys, value = walk(model, path)
    if not _same(value, wanted):
        raise NotApplied(f"{path} should be {wanted!r} and is {value!r}")
    return keys, value


def _same(value: Any, wanted: Any) -> bool:
    if isinstance(wanted, list | tuple):
        return len(value) == len(wanted) and all(map(_same, value, wanted))
    if isinstance(wanted, float) or isinstance(value, float):
        # a model may bring a value to its normal form, such as a direction to length one
        return isclose(value, wanted, rel_tol=1e-3, abs_tol=1e-12)
    return not isinstance(wanted, bool | int | str) or value == wanted


class Place(NamedTuple):
    """Where the case record holds a parameter: as which kind of number of eight bytes, how many of them in
    front, its unit in SI.
    """

    kind: type
    word: int
    to_si: float


def _held(words: Mapping[type, np.ndarray], place: Place) -> float:
    return float(words[place.kind][place.word])


def _holds(words: Mapping[type, np.ndarray], place: Place, value: float) -> bool:
    return isclose(_held(words, place), value * place.to_si, rel_tol=1e-12)


@cache
def _place(keys: Keys) -> Place | None:
    """Place of a parameter in the case record; ``None`` where its value stays in Python."""
    dtype, start, to_si = CASE, 0, 1.0
    model: Any = Scenario
    for depth, key in enumerate(keys):
        if isinstance(key, int):
            if not dtype.shape:
                return None
            dtype, model = dtype.base, (get_args(model) or (None,))[0]
            start += key * dtype.itemsize
            continue
        target, unit = split_unit(key)
        info = (
            model.model_fields.get(key) if isinstance(model, type) and issubclass(model, BaseModel) else None
        )
        if info is None or (depth and not in_record(info)) or target not in (dtype.names or ()):
            return None
        start += offset(dtype, target)
        dtype, model, to_si = dtype[target], info.annotation, unit.to_si
    if dtype.names is not None or dtype.shape:
        return None
    return Place(np.float64 if dtype.kind == "f" else np.int64, start // dtype.itemsize, to_si)
