"""Plain words for the allowed values of a parameter, for a given value, and for similar names."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Literal, get_args, get_origin

from edl6dof.config.errors import did_you_mean, nearest
from edl6dof.config.model_paths import Slot, bounds, is_model, own_bounds
from edl6dof.config.units import split_unit

_SIGNS = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}
_ONE = {float: "a number", int: "a whole number", bool: "true or false", str: "text", Any: "a value"}
_MANY = {float: "numbers", int: "whole numbers", bool: "true or false values", str: "texts"}


def unknown(kind: str, name: object, known: Iterable[str]) -> str:
    """Message for a name that does not exist: with the one probably meant, or all known names."""
    return f"no {kind} {name!r}" + did_you_mean(str(name), known, f" (there are: {', '.join(known)})")


def counted(number: int, word: str) -> str:
    """Number and noun, such as ``1 flight`` or ``2 flights``."""
    return f"{number:,} {word}{'' if number == 1 else 's'}"


def unknown_key(key: str, inside: Slot | None) -> str:
    """Message for a key that does not exist ``inside`` a place, with the key that was probably meant."""
    allowed = inside.keys if inside is not None else []
    meant = meant_key(key, allowed)
    if meant is None:
        return f"unknown key; allowed: {', '.join(allowed) or 'none'}"
    differs = " (only the unit suffix differs)" if _quantity(meant) == _quantity(key) else ""
    return f"unknown key; did you mean {meant!r}?{differs}"


def meant_key(key: str, allowed: Iterable[str]) -> str | None:
    """The allowed key that an unknown key was probably meant to be: with another unit, or similar."""
    same = (item for item in allowed if item != key and _quantity(item) == _quantity(key))
    return next(same, None) or nearest(key, allowed)


def _quantity(key: str) -> str:
    return split_unit(key)[0]


def got(value: Any) -> str:
    """A value as in YAML, shortened."""
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "a mapping of keys"
    text = repr(list(value) if isinstance(value, tuple) else value)
    if len(text) <= 60:
        return text
    return f"a list of {len(value)}" if isinstance(value, list | tuple) else text[:57] + "..."


def expected(slot: Slot) -> str:
    """Words for the values that a place allows: ``a number in kg``, ``one of apollo, numeric``."""
    unit = f" in {slot.unit.label}" if slot.unit.label else ""
    return " or ".join(word + unit if "number" in word else word for word in kinds(slot))


def kinds(slot: Slot) -> list[str]:
    """The alternatives of a place in words, without unit."""
    return list(dict.fromkeys(_one(option) for option in slot.options)) + (["null"] if slot.optional else [])


def in_bounds(slot: Slot, context: dict[str, Any] | None = None) -> str:
    """Bounds such as ``> 0 and <= 2.5``, or empty; not the unit's if ``context`` names one of the place."""
    own = own_bounds(slot)
    limits = own if context and context.keys() & own.keys() else {**(context or {}), **bounds(slot)}
    text = " and ".join(f"{sign} {_number(limits[name])}" for name, sign in _SIGNS.items() if name in limits)
    return f"{text} {slot.unit.label}".strip() if text else ""


def _number(value: float) -> str:
    return str(value) if isinstance(value, int) else f"{value:g}"


def in_length(slot: Slot, context: dict[str, Any] | None = None) -> str:
    """Declared length of a list or text, such as ``at least 2 and at most 32``, or empty."""
    limits = {**(context or {}), **bounds(slot)}
    low, high = limits.get("min_length"), limits.get("max_length")
    if low is not None and low == high:
        return f"exactly {low}"
    parts = [f"at least {low}"] if low is not None else []
    return " and ".join(parts + ([f"at most {high}"] if high is not None else []))


def _one(option: Any) -> str:
    if is_model(option):
        return "a mapping of keys"
    origin, args = get_origin(option), get_args(option)
    if origin is Literal:
        return "one of " + ", ".join(map(str, args)) if len(args) > 1 else repr(args[0])
    if origin is tuple and not (len(args) == 2 and args[1] is Ellipsis):
        return f"a list of {len(args)} {_many(args[0])}"
    if origin in (list, tuple):
        return f"a list of {_many(args[0])}"
    if origin is dict or option is dict:
        return "a mapping of keys"
    return _ONE.get(option, "a value")


def _many(option: Any) -> str:
    if is_model(option):
        return "mappings"
    origin, args = get_origin(option), get_args(option)
    if origin is tuple and args[-1] is not Ellipsis:
        return f"lists of {len(args)} {_many(args[0])}"
    if origin in (list, tuple):
        return f"lists of {_many(args[0])}"
    return _MANY.get(option, "values")
