"""Dotted paths in a validated model: the values there, and models that differ from it in a few of them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

from pydantic import BaseModel

#: Names of fields and indices of list items, from a model inwards.
Keys = tuple[str | int, ...]

Model = TypeVar("Model", bound=BaseModel)


def value_at(model: Any, path: str) -> Any:
    """Value of a validated model at a dotted path; list items by index or by name."""
    return walk(model, path)[1]


def walk(value: Any, path: str) -> tuple[Keys, Any]:
    """Names of fields and indices of list items that a dotted path means, and the value there.

    Raises:
        AttributeError, LookupError, ValueError: there is no such path.
    """
    keys: list[str | int] = []
    for part in path.split("."):
        if isinstance(value, list | tuple):
            keys.append(index := _index(value, part))
            value = value[index]
        else:
            keys.append(part)
            value = value[part] if isinstance(value, dict) else getattr(value, part)
    return tuple(keys), value


def overridden(model: Model, values: Mapping[Keys, Any]) -> Model:
    """``model`` with values put at keys.  Every model on the way to one is validated again;
    the others are shared with the original, as the same objects.

    Raises:
        ValidationError: a value, or what it makes of its model, is not allowed.
        LookupError: there is nothing to put a value into.
    """
    changes: dict[str | int, Any] = {}
    for keys, value in values.items():
        inner = changes
        for key in keys[:-1]:
            inner = inner.setdefault(key, {})
            if not isinstance(inner, dict):
                raise LookupError(key)
        inner[keys[-1]] = value
    return type(model).model_validate(_changed(model, changes))


def _changed(inside: Any, changes: Any) -> Any:
    """A copy with nested changes made; the models on the way to them become plain mappings."""
    if not isinstance(changes, dict):
        return tuple(changes) if isinstance(inside, tuple) else changes
    if isinstance(inside, list | tuple):
        items = list(inside)
        for index, inner in changes.items():
            items[index] = _changed(items[index], inner)
        return type(inside)(items)
    if not isinstance(inside, dict | BaseModel):
        raise LookupError(next(iter(changes)))
    fields = dict(inside if isinstance(inside, dict) else vars(inside))
    for name, inner in changes.items():
        fields[name] = _changed(fields.get(name), inner)
    return fields


def _index(items: list[Any] | tuple[Any, ...], part: str) -> int:
    names = [getattr(item, "name", None) for item in items]
    if part not in names and not part.isdecimal():
        raise LookupError(f"no entry {part!r}")
    return names.index(part) if part in names else int(part)
