"""The table of all parameters of a model: one row per value that a file may contain."""

from __future__ import annotations

from typing import Any, NamedTuple, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined, to_jsonable_python

from edl6dof.config.document.scalars import write_flow
from edl6dof.config.introspect import Slot, field_slot, is_model, type_slot
from edl6dof.config.usual import usual_range
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
    extra = info.json_schema_extra if isinstance(info.json_schema_extra, dict) else {}
    words = [word.removeprefix("a ") for word in kinds(slot)]
    limits = in_bounds(slot).removesuffix(slot.unit.label).strip()
    length, given = in_length(slot), usual_range(info)
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
        usual=""
        if given is None or given.of_magnitude
        else f"{given.low:g} to {given.high:g}: {given.reason}",
    )


def _default(info: FieldInfo) -> str:
    default = info.get_default(call_default_factory=True)
    if default is PydanticUndefined:
        return "required"
    plain = to_jsonable_python(default)
    text = write_flow(plain)
    return text if len(text) <= 60 or not isinstance(plain, list | dict) else f"{len(plain)} entries"
