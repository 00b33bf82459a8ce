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

from edl6dof.config.base import Capacity, stated
from edl6dof.config.units import split_unit


def in_record(info: FieldInfo) -> bool:
    """Return whether a field belongs to the compiled record."""
    extra = info.json_schema_extra
    return not (isinstance(extra, dict) and extra.get("record") is False)


def capacity_of(info: FieldInfo) -> int | None:
    """Slots of a list field, or ``None`` when it is not a capacity-bound list."""
    for item in info.metadata:
        if isinstance(item, Capacity):
            return item.slots
    return None


def literal_values(annotation: Any) -> tuple[str, ...] | None:
    """Values of a ``Literal`` of names, in declaration order: the index is what the record stores."""
    return get_args(annotation) if get_origin(annotation) is Literal else None


@cache
def dtype_of(model: type[BaseModel]) -> np.dtype:
    """The aligned structured dtype that carries ``model`` into compiled code, which knows no empty record."""
    fields: list[tuple] = []
    for name, info in model.model_fields.items():
        if in_record(info):
            fields += _fields_of(name, info)
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
    """A copy of a record array, made of its bytes: field by field it would take fifty times as long."""
    return np.ndarray(records.shape, records.dtype, records.view(np.uint8).copy())


def _put(record: np.ndarray | np.void, place: _Place, value: Any) -> None:
    if value is None:
        return
    if isinstance(value, BaseModel):
        fill(record[place.target], value)
    elif place.slots is not None:
        _fill_list(record, place, place.slots, value)
    elif isinstance(value, str):
        if place.names is not None:
            record[place.target] = place.names.index(value)
    elif place.to_si == 1.0:
        record[place.target] = value
    else:
        record[place.target] = np.asarray(value, dtype=np.float64) * place.to_si


class _Place(NamedTuple):
    """Place of a field of a model in its record, read once from the declaration."""

    name: str
    target: str
    to_si: float
    slots: int | None
    names: tuple[str, ...] | None
    item_names: tuple[str, ...] | None


@cache
def _places(model: type[BaseModel]) -> tuple[_Place, ...]:
    places = []
    for name, info in model.model_fields.items():
        if in_record(info):
            target, unit = split_unit(name)
            annotation, slots = _bare(info.annotation), capacity_of(info)
            names = literal_values(annotation)
            item_names = literal_values(get_args(annotation)[0]) if slots is not None else None
            to_si = unit.to_si if slots is not None or _is_float(annotation) else 1.0
            places.append(_Place(name, target, to_si, slots, names, item_names))
    return tuple(places)


def _fill_list(record: np.ndarray | np.void, place: _Place, most: int, items: list[Any]) -> None:
    if len(items) > most:
        raise ValueError(f"{place.name}: {len(items)} entries, at most {most} are allowed")
    record[f"n_{place.target}"] = len(items)
    slots = record[place.target][: len(items)]
    if not items:
        return
    if isinstance(items[0], BaseModel):
        for slot, item in zip(slots, items, strict=True):
            fill(slot, item)
    elif isinstance(items[0], str):
        slots[:] = [stated(place.item_names).index(item) for item in items]
    else:
        slots[:] = np.asarray(items, dtype=np.float64) * place.to_si


def _fields_of(name: str, info: FieldInfo) -> list[tuple]:
    target, _ = split_unit(name)
    annotation = _bare(info.annotation)
    slots = capacity_of(info)
    if slots is not None:
        (item,) = get_args(annotation)
        if isinstance(item, type) and issubclass(item, BaseModel):
            return [(target, dtype_of(item), (slots,)), (f"n_{target}", "i8")]
        scalar, shape = _scalar(item)
        return [(target, scalar, (slots, *shape)), (f"n_{target}", "i8")]
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [(target, dtype_of(annotation))]
    if annotation is str:
        return []
    scalar, shape = _scalar(annotation)
    return [(target, scalar, shape)] if shape else [(target, scalar)]


def _scalar(annotation: Any) -> tuple[str, tuple[int, ...]]:
    if annotation in (float,):
        return "f8", ()
    if annotation in (int, bool) or literal_values(annotation) is not None:
        return "i8", ()
    if get_origin(annotation) is tuple:
        items = get_args(annotation)
        scalar, shape = _scalar(items[0])
        return scalar, (len(items), *shape)
    raise TypeError(f"no record type for {annotation!r}")


def _bare(annotation: Any) -> Any:
    """Strip ``Optional``."""
    if get_origin(annotation) in (Union, types.UnionType):
        items = [item for item in get_args(annotation) if item is not type(None)]
        if len(items) == 1:
            return items[0]
    return annotation


def _is_float(annotation: Any) -> bool:
    """Return whether a field holds a float, or several."""
    bare = _bare(annotation)
    return bare is float or (get_origin(bare) is tuple and all(map(_is_float, get_args(bare))))


def extended(model: type[BaseModel], **fields: Any) -> np.dtype:
    """The aligned dtype of ``model`` with ``fields`` (name = dtype) added, or put in place of fields of the
    same name.
    """
    base = dtype_of(model)
    layout = {name: base[name] for name in base.names or ()}
    layout.update({name: np.dtype(kind) for name, kind in fields.items()})
    return np.dtype(list(layout.items()), align=True)
