"""Record layout (numpy structured dtype) of a parameter model, and the copy of a validated model into a
record.

Rules: a float becomes ``f8`` in SI units under its name without the unit suffix; an int or bool ``i8``; a
``Literal`` the index of its value as ``i8``; a tuple a sub-array; a sub-model a nested record; a ``list``
with a :class:`Capacity` a fixed array plus ``n_<name>``; text and fields declared ``record=False`` stay in
Python.
"""

from __future__ import annotations

import types
from functools import cache
from typing import Any, Literal, NamedTuple, Union, get_args, get_origin

import numpy as np
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from edl6dof.config.base import Capacity, extra_of
from edl6dof.config.units import split_unit


def in_record(info: FieldInfo) -> bool:
    """Return whether a field belongs to the compiled record."""
    return extra_of(info).get("record") is not False


def capacity_of(info: FieldInfo) -> int | None:
    """Slots of a list field, ``None`` for another field."""
    if get_origin(_bare(info.annotation)) is not list:
        return None
    return next((item.max_length for item in info.metadata if isinstance(item, Capacity)), None)


def literal_values(annotation: Any) -> tuple[str, ...] | None:
    """Values of a ``Literal`` of names, in declaration order: the index is what the record stores."""
    return get_args(annotation) if get_origin(annotation) is Literal else None


@cache
def dtype_of(model: type[BaseModel]) -> np.dtype:
    """The aligned structured dtype that carries ``model`` into compiled code, which has no empty records."""
    fields = [field for place in _places(model) for field in place.fields]
    return np.dtype(fields or [("unused", "f8")], align=True)


def fill(record: np.ndarray | np.void, model: BaseModel) -> None:
    """Copy a validated model into a zeroed record of its dtype, converting to SI units."""
    for place in _places(type(model)):
        value = getattr(model, place.name)
        if type(value) is float:  # most are, and every case of a campaign is filled
            record[place.target] = value * place.to_si
        else:
            _put(record, place, value)


def in_si(model: BaseModel) -> np.void:
    """A validated model as a record of its dtype, in SI units."""
    record: np.void = np.zeros(1, dtype_of(type(model)))[0]
    fill(record, model)
    return record


def duplicate(records: np.ndarray) -> np.ndarray:
    """Copy a record array by its bytes: a copy field by field would take fifty times as long."""
    return np.ndarray(records.shape, records.dtype, records.view(np.uint8).copy())


def _put(record: np.ndarray | np.void, place: _Place, value: Any) -> None:
    if value is None:
        return
    if isinstance(value, BaseModel):
        fill(record[place.target], value)
    elif place.slots is not None:
        _put_list(record, place, place.slots, value)
    elif isinstance(value, str):
        if place.names is not None:
            record[place.target] = place.names.index(value)
    else:
        record[place.target] = value if place.to_si == 1.0 else np.multiply(value, place.to_si)


def _put_list(record: np.ndarray | np.void, place: _Place, most: int, items: list[Any]) -> None:
    if len(items) > most:
        raise ValueError(f"{place.name}: {len(items)} entries, at most {most} are allowed")
    record[f"n_{place.target}"] = len(items)
    slots = record[place.target][: len(items)]
    if place.names is not None:
        slots[:] = [place.names.index(item) for item in items]
    elif items and isinstance(items[0], BaseModel):
        for slot, item in zip(slots, items, strict=True):
            fill(slot, item)
    elif items:
        slots[:] = np.multiply(items, place.to_si)


class _Place(NamedTuple):
    """Place of a field of a model in its record, read once from the declaration."""

    name: str  # of the field in the model
    target: str  # its name in the record
    fields: tuple[tuple, ...]  # of the dtype; none for text
    to_si: float  # factor to SI
    slots: int | None  # of a list
    names: tuple[str, ...] | None  # of a ``Literal``, or of the items of a list of them


@cache
def _places(model: type[BaseModel]) -> tuple[_Place, ...]:
    return tuple(_place(name, info) for name, info in model.model_fields.items() if in_record(info))


def _place(name: str, info: FieldInfo) -> _Place:
    target, unit = split_unit(name)
    one, slots = _bare(info.annotation), capacity_of(info)
    if one is str:
        return _Place(name, target, (), 1.0, None, None)
    if slots is not None:
        (one,) = get_args(one)
    kind, shape = _layout(one)
    fields: tuple[tuple, ...] = ((target, kind, shape) if shape else (target, kind),)
    if slots is not None:
        fields = (target, kind, (slots, *shape)), (f"n_{target}", "i8")
    return _Place(name, target, fields, unit.to_si if kind == "f8" else 1.0, slots, literal_values(one))


def _layout(annotation: Any) -> tuple[str | np.dtype, tuple[int, ...]]:
    """Type of a value in a record, and shape of its array."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return dtype_of(annotation), ()
    if annotation is float:
        return "f8", ()
    if annotation in (int, bool) or literal_values(annotation) is not None:
        return "i8", ()
    if get_origin(annotation) is tuple:
        items = get_args(annotation)
        kind, shape = _layout(items[0])
        return kind, (len(items), *shape)
    raise TypeError(f"no record type for {annotation!r}")


def _bare(annotation: Any) -> Any:
    """Strip ``Optional``."""
    if get_origin(annotation) in (Union, types.UnionType):
        items = [item for item in get_args(annotation) if item is not type(None)]
        if len(items) == 1:
            return items[0]
    return annotation


def extended(model: type[BaseModel], **fields: Any) -> np.dtype:
    """The aligned dtype of ``model`` with ``fields`` (name = dtype) added, or put in place of fields of the
    same name.
    """
    base = dtype_of(model)
    layout = {name: base[name] for name in base.names or ()}
    layout.update({name: np.dtype(kind) for name, kind in fields.items()})
    return np.dtype(list(layout.items()), align=True)
