"""Unusual values of a scenario: allowed, and far from those known of such a parameter.

A declaration gives the usual range and its reason (``param(..., usual=(low, high, reason))``).  Without one,
values up to ten times larger or smaller than the default are usual.  Parameters without either (directions,
places, angles, times of a plan) have no usual range; :mod:`edl6dof.scenario.loaded` relates some of them
to the size of the vehicle.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from edl6dof.config.units import split_unit

#: Factor on the default, either way, within which a value is usual.
FACTOR = 10.0


class Usual(NamedTuple):
    """Range of usual values in the unit of the parameter, or of their magnitude; and the reason."""

    low: float
    high: float
    reason: str
    of_magnitude: bool = False


def usual_range(info: FieldInfo) -> Usual | None:
    """Usual range of a declared parameter; ``None`` where it has none."""
    extra = info.json_schema_extra
    if isinstance(extra, dict) and isinstance(given := extra.get("usual"), list):
        low, high, reason = given
        return Usual(float(str(low)), float(str(high)), str(reason))
    default = [] if info.is_required() else numbers(info.get_default(call_default_factory=True))
    largest = max(map(abs, default), default=0.0)
    if largest == 0.0:
        return None
    return Usual(largest / FACTOR, largest * FACTOR, "a factor of ten about the default", of_magnitude=True)


def numbers(value: Any) -> list[float]:
    """The numbers in a value; truth values are none."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return [float(value)]
    return [number for item in value for number in numbers(item)] if isinstance(value, list | tuple) else []


def unusual(model: BaseModel, prefix: str = "") -> dict[str, str]:
    """Dotted path of every unusual value of a validated model, to what is usual instead."""
    found: dict[str, str] = {}
    for name, info in type(model).model_fields.items():
        path, value = f"{prefix}{name}", getattr(model, name)
        inner = dict(_models(path, value))
        for place, part in inner.items():
            found |= unusual(part, f"{place}.")
        if not inner and (words := _why_unusual(name, info, numbers(value))):
            found[path] = words
    return found


def _models(path: str, value: Any) -> Iterator[tuple[str, BaseModel]]:
    if isinstance(value, BaseModel):
        yield path, value
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from _models(f"{path}.{index}", item)
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from _models(f"{path}.{key}", item)


def _why_unusual(name: str, info: FieldInfo, values: list[float]) -> str:
    usual = usual_range(info) if values else None
    if usual is None:
        return ""
    if usual.of_magnitude:
        values = [largest] if (largest := max(map(abs, values))) else []
    odd = [value for value in values if not usual.low <= value <= usual.high]
    if not odd:
        return ""
    unit = f" {label}" if (label := split_unit(name)[1].label) else ""
    return f"{odd[0]:g}{unit} is unusual: {usual.low:g} to {usual.high:g}{unit} ({usual.reason})"
