"""The values that a case really flies with, read back from the records that compiled code gets.

A dispersion that is silently not applied is the classic failure of Monte Carlo tools; here a value that did not arrive stops the case.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from math import isclose
from typing import Any, get_args

import numpy as np
from pydantic import BaseModel

from edl6dof.campaign.variants import Variant
from edl6dof.config.dtype import in_record
from edl6dof.config.units import split_unit
from edl6dof.sim.records import CASE
from edl6dof.sim.scenario import Scenario


class NotApplied(Exception):
    """A change of a case did not reach what is flown."""


def applied(variant: Variant, case_truth: Mapping[str, Any], told: Mapping[str, Any]) -> dict[str, Any]:
    """Column name to value for every change of a case, ``truth.`` and ``belief.`` in front.

    Raises:
        NotApplied: the record, or the validated scenario where the record has no such field, holds another value.
    """
    true, believed = variant.loaded.truth, variant.loaded.scenario
    row: dict[str, Any] = {}
    for path, wanted in case_truth.items():
        row[f"truth.{path}"] = _confirmed(path, wanted, true)
        _compare_record(variant.parts.case[0], path, true, row[f"truth.{path}"])
    for path, wanted in told.items():
        row["profile" if path == "profile" else f"belief.{path}"] = _confirmed(path, wanted, believed)
    return row


def _confirmed(path: str, wanted: Any, model: BaseModel) -> Any:
    value = value_at(model, path)
    if not _same(value, wanted):
        raise NotApplied(f"{path} should be {wanted!r} and is {value!r}")
    return value


def value_at(model: Any, path: str) -> Any:
    """Value of a validated model at a dotted path; list items by index or by name."""
    for part in path.split("."):
        if isinstance(model, BaseModel):
            model = getattr(model, part)
        elif isinstance(model, Mapping):
            model = model[part]
        else:
            model = model[_index(model, part)]
    return model


def _index(items: Any, part: str) -> int:
    names = [getattr(item, "name", None) for item in items]
    return names.index(part) if part in names else int(part)


def _same(value: Any, wanted: Any) -> bool:
    if isinstance(wanted, list | tuple):
        return len(value) == len(wanted) and all(map(_same, value, wanted))
    if isinstance(wanted, float) or isinstance(value, float):
        # a model may bring a value to its normal form, such as a direction to length one
        return isclose(value, wanted, rel_tol=1e-3, abs_tol=1e-12)
    return not isinstance(wanted, bool | int | str) or value == wanted


def _compare_record(record: np.void, path: str, model: BaseModel, value: Any) -> None:
    field = _record_field(path, _names(path, model))
    if field is None or not isinstance(value, bool | int | float):
        return
    keys, to_si = field
    for key in keys:
        record = record[key]
    if not isclose(float(record), float(value) * to_si, rel_tol=1e-12):
        raise NotApplied(f"{path} should be {value!r} and its record holds {float(record) / to_si!r}")


def _names(path: str, model: BaseModel) -> tuple[int | None, ...]:
    """Index that each part of a path means where it stands in a list."""
    found: list[int | None] = []
    value: Any = model
    for part in path.split("."):
        found.append(None if isinstance(value, BaseModel | Mapping) else _index(value, part))
        value = value_at(value, part)
    return tuple(found)


@cache
def _record_field(path: str, indices: tuple[int | None, ...]) -> tuple[tuple[str | int, ...], float] | None:
    """Keys of the case record's field that holds a path, and the factor to SI; ``None`` where the value stays in Python."""
    dtype, model, to_si = CASE, Scenario, 1.0
    keys: list[str | int] = []
    for part, index in zip(path.split("."), indices, strict=True):
        if index is not None:
            if not dtype.shape:
                return None
            keys.append(index)
            dtype, model = dtype.base, (get_args(model) or (None,))[0]
            continue
        target, unit = split_unit(part)
        info = model.model_fields.get(part) if isinstance(model, type) and issubclass(model, BaseModel) else None
        if info is None or (keys and not in_record(info)) or target not in (dtype.names or ()):
            return None
        keys.append(target)
        dtype, model, to_si = dtype[target], info.annotation, unit.to_si
    return (tuple(keys), to_si) if dtype.names is None and not dtype.shape else None
