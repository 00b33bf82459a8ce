"""Places of a parameter model by dotted path, for validation messages, ``--set`` and the reference."""

from __future__ import annotations

import types
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import annotated_types
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from edl6dof.config.base import Within
from edl6dof.config.units import Unit, split_unit


@dataclass(frozen=True)
class Slot:
    """A place for a value: the alternatives its type allows, and the bounds on it."""

    name: str  # nearest field name, which carries the unit
    options: tuple[Any, ...]  # alternatives of the type, ``None`` left out
    optional: bool = False  # true if ``None`` is allowed
    limits: tuple[Any, ...] = ()  # pydantic metadata (bounds)
    info: FieldInfo | None = None  # declaration, when the place is a field

    @property
    def unit(self) -> Unit:
        """Unit of the value, from the suffix of the name."""
        return split_unit(self.name)[1]

    @property
    def models(self) -> tuple[type[BaseModel], ...]:
        """The parameter models among the alternatives."""
        return tuple(option for option in self.options if is_model(option))

    @property
    def keys(self) -> list[str]:
        """Keys allowed inside, over all alternatives."""
        return list(dict.fromkeys(key for model in self.models for key in model.model_fields))

    def child(self, key: str | int) -> Slot | None:
        """The place of a key, list item or tuple element, or ``None`` when there is none."""
        found = [slot for option in self.options if (slot := _child(self.name, option, key)) is not None]
        if not found:
            return None
        options = tuple(dict.fromkeys(option for slot in found for option in slot.options))
        inherited = (
            tuple(limit for limit in self.limits if isinstance(limit, Within)) if isinstance(key, int) else ()
        )
        limits = (*(limit for slot in found for limit in slot.limits), *inherited)
        return Slot(found[0].name, options, any(slot.optional for slot in found), limits, found[0].info)


def root_slot(model: type[BaseModel]) -> Slot:
    """The place of the whole document."""
    return Slot("", (model,))


def field_slot(name: str, info: FieldInfo) -> Slot:
    """The place of one declared field."""
    options, optional, limits = _alternatives(info.annotation)
    return Slot(name, options, optional, (*_flat(info.metadata), *limits), info)


def is_model(option: Any) -> bool:
    """Return whether a type is a parameter model."""
    return isinstance(option, type) and issubclass(option, BaseModel)


def is_tag_of(option: Any, tag: Any) -> bool:
    """True if pydantic calls this alternative of a union ``tag``: its class name, or a ``Literal`` value."""
    if not is_model(option):
        return getattr(option, "__name__", None) == tag
    literals = (
        get_args(info.annotation)
        for info in option.model_fields.values()
        if get_origin(info.annotation) is Literal
    )
    return option.__name__ == tag or any(tag in values for values in literals)


def literal_names(slot: Slot) -> list[Any]:
    """Values of all ``Literal`` alternatives."""
    return [value for option in slot.options if get_origin(option) is Literal for value in get_args(option)]


def bounds(slot: Slot) -> dict[str, Any]:
    """Bounds by pydantic name (``gt``, ``ge``, ..., ``max_length``), those of the unit included."""
    found = own_bounds(slot)
    if number := {float, int}.intersection(slot.options):
        for limit in (limit for limit in slot.limits if isinstance(limit, Within)):
            found.update(limit.bounds(float not in number, found))
    return found


def own_bounds(slot: Slot) -> dict[str, Any]:
    """As :func:`bounds`, those only that the parameter itself declares."""
    names = ("gt", "ge", "lt", "le", "min_length", "max_length")
    found: dict[str, Any] = {}
    for limit in slot.limits:
        found.update({name: getattr(limit, name) for name in names if getattr(limit, name, None) is not None})
        if isinstance(slots := getattr(limit, "slots", None), int):
            found["max_length"] = slots
    return found


def _child(name: str, option: Any, key: str | int) -> Slot | None:
    if is_model(option):
        info = option.model_fields.get(key)
        return None if info is None else field_slot(str(key), info)
    if option is Any:
        return Slot(name, (Any,), True)
    origin, args = get_origin(option), get_args(option)
    if not isinstance(key, int):
        return type_slot(key, args[1]) if origin is dict else None
    if origin is list:
        return type_slot(name, args[0])
    if origin is tuple:
        if len(args) == 2 and args[1] is Ellipsis:
            return type_slot(name, args[0])
        return type_slot(name, args[key]) if 0 <= key < len(args) else None
    return None


def type_slot(name: str, annotation: Any) -> Slot:
    """The place of a list item, tuple element or mapping value."""
    options, optional, limits = _alternatives(annotation)
    return Slot(name, options, optional, limits)


def _alternatives(annotation: Any) -> tuple[tuple[Any, ...], bool, tuple[Any, ...]]:
    """Split ``Annotated[A, x] | B | None`` into ``(A, B)``, ``True``, ``(x,)``."""
    origin = get_origin(annotation)
    if origin is Annotated:
        inner, *metadata = get_args(annotation)
        options, optional, limits = _alternatives(inner)
        return options, optional, (*_flat(metadata), *limits)
    if origin in (Union, types.UnionType):
        parts = [_alternatives(item) for item in get_args(annotation)]
        options = tuple(option for part in parts for option in part[0])
        return options, any(part[1] for part in parts), tuple(limit for part in parts for limit in part[2])
    if annotation is type(None):
        return (), True, ()
    return (annotation,), False, ()


def _flat(metadata: Iterable[Any]) -> tuple[Any, ...]:
    """Metadata with pydantic's ``Field(...)`` and grouped bounds opened."""
    flat: list[Any] = []
    for item in metadata:
        if isinstance(item, FieldInfo):
            flat += _flat(item.metadata)
        elif isinstance(item, annotated_types.GroupedMetadata):
            flat += _flat(item)
        else:
            flat.append(item)
    return tuple(flat)
