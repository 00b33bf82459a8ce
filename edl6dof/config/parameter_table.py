"""Tables of parameters: of a model, one row per value that a file may contain; of a scenario, one row per
value.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined, to_jsonable_python

from edl6dof.config.base import extra_of
from edl6dof.config.document.document import Document
from edl6dof.config.document.yamltree import dotted, write_flow
from edl6dof.config.dump import declared
from edl6dof.config.errors import nearest
from edl6dof.config.model_paths import Slot, field_slot, is_model, leaves, type_slot, usual_range
from edl6dof.config.units import split_unit
from edl6dof.config.wording import in_bounds, in_length, kinds


class Row(NamedTuple):
    """One parameter; ``path`` writes a list item as ``thrusters[]`` and a free key as ``phases.<key>``."""

    path: str
    type: str
    unit: str
    bounds: str
    default: str
    meaning: str
    status: str
    source: str
    printed: str
    usual: str


def rows(model: type[BaseModel], prefix: str = "") -> list[Row]:
    """All parameters of a model in declaration order, sub-models after their parent's earlier fields.

    Args:
        model: any parameter model.
        prefix: dotted path of the model itself, without the last dot.
    """
    table: list[Row] = []
    for name, info in model.model_fields.items():
        slot = field_slot(name, info)
        path = f"{prefix}.{name}" if prefix else name
        inner = [(path + suffix, sub) for option in slot.options for suffix, sub in _inside(option)]
        if not slot.models or slot.optional:
            table.append(_row(path + ("[]" if any(p == path + "[]" for p, _ in inner) else ""), slot, info))
        for sub_path, sub_model in inner:
            table += rows(sub_model, sub_path)
    return list(dict.fromkeys(table))


def nearest_path(path: str, known: Iterable[str]) -> str | None:
    """The known dotted path that was probably meant: one that is similar, or that has a similar end."""
    length = path.count(".") + 1
    ends: dict[str, str] = {}
    for one in known:
        ends.setdefault(".".join(one.split(".")[-length:]), one)
    near = nearest(path, ends)
    return ends[near] if near is not None else nearest(path, ends.values())


class Value(NamedTuple):
    """A value of a scenario."""

    row: Row  # its parameter, with the claim of this value
    value: str  # as it stands in YAML
    place: str  # its path with the indices of lists; that of ``row`` has the names of their items
    origin: str  # ``file:line`` where it is given, or ``default``


def values(model: BaseModel, document: Document) -> Iterator[Value]:
    """Every value of a validated model, in declaration order.

    Args:
        model: validated.
        document: the files that it was read from.
    """
    for path, keys, info, value in leaves(model):
        place, key = dotted(keys), str(keys[-1])
        row = _row(path, field_slot(key, info), info)
        status, source = declared(value, info)
        if place in document.status:
            status, source = document.status[place], document.sources.get(place, "")
        mark = document.marks.get(keys)
        origin = "default" if mark is None else f"{mark.file}:{mark.line}" if mark.line else mark.file
        row = row._replace(unit=split_unit(key)[1].label, status=status, source=source, printed="")
        yield Value(row, write_flow(to_jsonable_python(value)), place, origin)


def _inside(option: Any) -> list[tuple[str, type[BaseModel]]]:
    """Models inside one alternative of a type, with what they add to the path."""
    if is_model(option):
        return [("", option)]
    origin, args = get_origin(option), get_args(option)
    if origin not in (list, dict):
        return []
    item = type_slot("", args[-1])
    suffix = "[]" if origin is list else ".<key>"
    return [(suffix + deeper, model) for inner in item.options for deeper, model in _inside(inner)]


def _row(path: str, slot: Slot, info: FieldInfo) -> Row:
    extra = extra_of(info)
    words = [word.removeprefix("a ") for word in kinds(slot)]
    limits = in_bounds(slot).removesuffix(slot.unit.label).strip()
    length, usual = in_length(slot), usual_range(info)
    return Row(
        path=path,
        type=" or ".join(words),
        unit=slot.unit.label if any("number" in word for word in words) else "",
        bounds=limits or (f"{length} entries" if length and "list" in words[0] else length),
        default=_default(info),
        meaning=info.description or "",
        status=str(extra.get("status", "")),
        source=str(extra.get("source", "")),
        printed=write_flow(extra["printed"]) if "printed" in extra else "",
        usual=f"{usual.low:g} to {usual.high:g}: {usual.reason}" if usual and not usual.of_magnitude else "",
    )


def _default(info: FieldInfo) -> str:
    default = info.get_default(call_default_factory=True)
    if default is PydanticUndefined:
        return "required"
    plain = to_jsonable_python(default)
    text = write_flow(plain)
    return text if len(text) <= 60 or not isinstance(plain, list | dict) else f"{len(plain)} entries"
