"""Places of parameter models by dotted path, for validation messages, ``--set`` and the reference; values at
paths of a validated model, models that differ from it in a few of them, and the usual range of a parameter.
"""

from __future__ import annotations

import types
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, NamedTuple, TypeVar, Union, get_args, get_origin

import annotated_types
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from edl6dof.config.base import Within, extra_of
from edl6dof.config.units import Unit, split_unit

#: Names of fields and indices of list items, from a model inwards.
Keys = tuple[str | int, ...]

Model = TypeVar("Model", bound=BaseModel)


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
    """Return the bounds of a parameter by pydantic name (``gt``, ``ge``, ..., ``max_length``), including
    those that follow from its unit.
    """
    found = own_bounds(slot)
    if number := {float, int}.intersection(slot.options):
        for limit in (limit for limit in slot.limits if isinstance(limit, Within)):
            found.update(limit.bounds(float not in number, found))
    return found


def own_bounds(slot: Slot) -> dict[str, Any]:
    """Bounds that the parameter itself declares."""
    names = ("gt", "ge", "lt", "le", "min_length", "max_length")
    found: dict[str, Any] = {}
    for limit in slot.limits:
        found.update({name: getattr(limit, name) for name in names if getattr(limit, name, None) is not None})
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
    """``model`` with values put at keys.  Every model that contains such a value is validated again; the
    others are shared with the original, as the same objects.

    Raises:
        ValidationError: a value, or the model with that value, is not allowed.
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


def leaves(model: BaseModel, path: str = "", keys: Keys = ()) -> Iterator[tuple[str, Keys, FieldInfo, Any]]:
    """Yield every value of a validated model that is not itself a model, in the order of declaration.

    Each item consists of the path with the names of list items, the keys with the indices of list items, the
    declaration, and the value.
    """
    for name, info in type(model).model_fields.items():
        yield from _below(getattr(model, name), info, f"{path}.{name}".lstrip("."), (*keys, name))


def _below(value: Any, info: FieldInfo, path: str, keys: Keys) -> Iterator[tuple[str, Keys, FieldInfo, Any]]:
    if isinstance(value, BaseModel):
        yield from leaves(value, path, keys)
    elif isinstance(value, dict) and value:
        for key, item in value.items():
            yield from _below(item, info, f"{path}.{key}", (*keys, key))
    elif isinstance(value, list | tuple) and any(isinstance(item, BaseModel) for item in value):
        for index, item in enumerate(value):
            yield from _below(item, info, f"{path}.{getattr(item, 'name', index)}", (*keys, index))
    else:
        yield path, keys, info, value


#: Largest usual ratio of a value to the default, or of the default to the value.
FACTOR = 10.0


class Usual(NamedTuple):
    """Range of usual values in the unit of the parameter, or of their magnitude; and the reason."""

    low: float
    high: float
    reason: str
    of_magnitude: bool = False


def usual_range(info: FieldInfo) -> Usual | None:
    """Usual range of a declared parameter, ``None`` if it has none.

    The range is declared with its reason (``param(..., usual=(low, high, reason))``), or extends from a tenth
    to ten times the default.  Parameters without either (directions, places, angles, times of a plan) have
    none.
    """
    if isinstance(given := extra_of(info).get("usual"), list):
        low, high, reason = given
        return Usual(float(str(low)), float(str(high)), str(reason))
    default = [] if info.is_required() else numbers(info.get_default(call_default_factory=True))
    largest = max(map(abs, default), default=0.0)
    if largest == 0.0:
        return None
    return Usual(largest / FACTOR, largest * FACTOR, "a factor of ten about the default", of_magnitude=True)


def numbers(value: Any) -> list[float]:
    """All numbers in a value, booleans left out."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return [float(value)]
    return [number for item in value for number in numbers(item)] if isinstance(value, list | tuple) else []
