"""The values that a case really flies with, read back from the records that compiled code gets.

A dispersion that is silently not applied is the classic failure of Monte Carlo tools; here a value that did not arrive stops the case.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from math import isclose
from typing import Any, NamedTuple, get_args

import numpy as np
from pydantic import BaseModel

from edl6dof.campaign.variants import Variant
from edl6dof.config.dtype import in_record
from edl6dof.config.units import split_unit
from edl6dof.sim.records import CASE
from edl6dof.sim.scenario import Scenario

#: Names of fields and indices of list items, from a model inwards.
Keys = tuple[str | int, ...]


#: Where a list item of that name was found last: looked at first, as every case asks for the same.
_LAST_INDEX: dict[str, int] = {}


class NotApplied(Exception):
    """A change of a case did not reach what is flown."""


def applied(variant: Variant, case_truth: Mapping[str, Any], told: Mapping[str, Any]) -> dict[str, Any]:
    """Column name to value for every change of a case, ``truth.`` and ``belief.`` in front.

    Raises:
        NotApplied: the record, or the validated scenario where the record has no such field, holds another value.
    """
    true, believed = variant.loaded.truth, variant.loaded.scenario
    words = {kind: variant.parts.case.view(kind) for kind in (np.float64, np.int64)}
    row: dict[str, Any] = {}
    for path, wanted in case_truth.items():
        keys, row[f"truth.{path}"] = _confirmed(path, wanted, true)
        _compare_record(words, path, keys, row[f"truth.{path}"])
    for path, wanted in told.items():
        row["profile" if path == "profile" else f"belief.{path}"] = _confirmed(path, wanted, believed)[1]
    return row


def _confirmed(path: str, wanted: Any, model: BaseModel) -> tuple[Keys, Any]:
    keys, value = _walk(model, path)
    if not _same(value, wanted):
        raise NotApplied(f"{path} should be {wanted!r} and is {value!r}")
    return keys, value


def value_at(model: Any, path: str) -> Any:
    """Value of a validated model at a dotted path; list items by index or by name."""
    return _walk(model, path)[1]


def _walk(value: Any, path: str) -> tuple[Keys, Any]:
    """Names of fields and indices of list items that a dotted path means, and the value there."""
    keys: list[str | int] = []
    for part in path.split("."):
        if isinstance(value, list | tuple):
            keys.append(index := _index(value, part))
            value = value[index]
        else:
            keys.append(part)
            value = value[part] if isinstance(value, dict) else getattr(value, part)
    return tuple(keys), value


def _index(items: list[Any] | tuple[Any, ...], part: str) -> int:
    guess = _LAST_INDEX.get(part, 0)
    if guess < len(items) and getattr(items[guess], "name", None) == part:
        return guess
    names = [getattr(item, "name", None) for item in items]
    if part not in names:
        return int(part)
    _LAST_INDEX[part] = names.index(part)
    return _LAST_INDEX[part]


def _same(value: Any, wanted: Any) -> bool:
    if isinstance(wanted, list | tuple):
        return len(value) == len(wanted) and all(map(_same, value, wanted))
    if isinstance(wanted, float) or isinstance(value, float):
        # a model may bring a value to its normal form, such as a direction to length one
        return isclose(value, wanted, rel_tol=1e-3, abs_tol=1e-12)
    return not isinstance(wanted, bool | int | str) or value == wanted


class _Place(NamedTuple):
    """Where the case record holds a parameter: as which kind of number of eight bytes, how many of them in front, its unit in SI."""

    kind: type
    index: int
    to_si: float


def _compare_record(words: Mapping[type, np.ndarray], path: str, keys: Keys, value: Any) -> None:
    place = _place(keys)
    if place is None or not isinstance(value, bool | int | float):
        return
    held = float(words[place.kind][place.index])
    if not isclose(held, float(value) * place.to_si, rel_tol=1e-12):
        raise NotApplied(f"{path} should be {value!r} and its record holds {held / place.to_si!r}")


@cache
def _place(keys: Keys) -> _Place | None:
    """Place of a parameter in the case record; ``None`` where its value stays in Python."""
    dtype, model, offset, to_si = CASE, Scenario, 0, 1.0
    for depth, key in enumerate(keys):
        if isinstance(key, int):
            if not dtype.shape:
                return None
            dtype, model = dtype.base, (get_args(model) or (None,))[0]
            offset += key * dtype.itemsize
            continue
        target, unit = split_unit(key)
        info = model.model_fields.get(key) if isinstance(model, type) and issubclass(model, BaseModel) else None
        if info is None or (depth and not in_record(info)) or target not in (dtype.names or ()):
            return None
        dtype, model, offset, to_si = dtype[target], info.annotation, offset + dtype.fields[target][1], unit.to_si
    if dtype.names is not None or dtype.shape:
        return None
    return _Place(np.float64 if dtype.kind == "f" else np.int64, offset // dtype.itemsize, to_si)
