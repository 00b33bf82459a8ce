"""Check a document against a parameter model; every mistake with its file, line and key."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from dataclasses import replace
from typing import Any, Literal, TypeVar, get_args, get_origin

from pydantic import BaseModel, ValidationError

from edl6dof.config.base import stated
from edl6dof.config.document.document import Document
from edl6dof.config.errors import ConfigError, Inconsistent, Problem, did_you_mean
from edl6dof.config.model_paths import Slot, is_tag_of, literal_names, root_slot
from edl6dof.config.refused import partial_model, steps
from edl6dof.config.wording import expected, got, in_bounds, in_length, unknown_key

Model = TypeVar("Model", bound=BaseModel)

_RANGE = {"greater_than", "greater_than_equal", "less_than", "less_than_equal"}
_LENGTH = {"too_short", "too_long", "string_too_short", "string_too_long"}
_NAME = {"literal_error", "union_tag_invalid"}
_OWN_WORDS = {"value_error", "assertion_error"}


def validate(model: type[Model], document: Document) -> Model:
    """Make a ``model`` instance from a document.

    Raises:
        ConfigError: every problem of every value.
    """
    made, problems = judged(model, document)
    if problems:
        raise ConfigError(problems)
    return made


def judged(model: type[Model], document: Document) -> tuple[Model, list[Problem]]:
    """Make a ``model`` instance from a document, and list the problems of its values.

    If there are problems, the instance is only for further checks (:mod:`edl6dof.config.refused`).
    """
    found: dict[tuple, Problem] = {}
    wrong: set[tuple] = set()
    try:
        # JSON mode is pydantic's strict mode for text formats: a list for a tuple, never text for a number
        made = model.model_validate_json(json.dumps(document.data, allow_nan=False))
        if not document.refused:
            return made, []
    except ValidationError as error:
        found, wrong = _problems(model, document, error.errors(include_url=False))
    made, more = partial_model(model, document.data, {*wrong, *document.refused})
    found = {path: document.problem(path, message) for path, message in more.items()} | found
    unread = document.refused.values()
    return made, [
        *(problem for problems in unread for problem in problems),
        *(problem for path, problem in found.items() if not _within(path, document.refused)),
    ]


def _within(path: tuple, others: Iterable[tuple]) -> bool:
    return any(path[: len(other)] == other for other in others)


def _problems(
    model: type[BaseModel], document: Document, errors: list[Any]
) -> tuple[dict[tuple, Problem], set[tuple]]:
    """Problems by path, and the paths of the values that are refused."""
    lacking: dict[tuple, list[str]] = {}  # keys that a new item of a list lacks
    problems: dict[tuple, Problem] = {}
    wrong: set[tuple] = set()
    refused: set[tuple] = set()  # values that one alternative of a union refused as a whole
    for error in errors:
        path, slot, parent = _follow(model, document.data, error["loc"], error["type"])
        if error["type"] == "missing" and isinstance(error["loc"][-1], int):
            # A fixed-length list that is too short: one problem of the list, not one for each element.
            path, slot, parent = path[:-1], stated(parent), None
        value = _value_at(document.data, path)
        if error["type"] == "union_tag_invalid" and _holds(value, tag := _tag_key(error["ctx"])):
            path, value = (*path, tag), value[tag]
        if error["loc"] and error["type"] != "missing" and (not path or path[-1] != error["loc"][-1]):
            refused.add(path)
        wrong.add(path)
        if isinstance(cause := error.get("ctx", {}).get("error"), Inconsistent):
            for below, message in cause.problems.items():
                inner = (*path, *steps(below))
                problems.setdefault(inner, document.problem(inner, message))
            continue
        if error["type"] == "missing" and path[:-1] in document.similar:
            lacking.setdefault(path[:-1], []).append(str(path[-1]))
            continue
        # Each alternative of a union reports on its own; the first report already names all alternatives.
        problems.setdefault(path, document.problem(path, _message(error, path, slot, parent, value)))
    for path, keys in lacking.items():
        words = f"{new_entry(document.similar[path])} (a new one also needs {', '.join(keys)})"
        problems[*path, "name"] = document.problem((*path, "name"), words)
    # Where another alternative got further inside, only what it found there is of use.
    outer = {
        path for path in refused if any(path == other[: len(path)] and path != other for other in problems)
    }
    return {path: problem for path, problem in problems.items() if path not in outer}, wrong


def new_entry(near: str) -> str:
    """Question whether an item that was added to a list was meant to change the one named ``near``."""
    return f"is a new entry; did you mean {near!r}?"


def _follow(model: type[BaseModel], data: Any, loc: tuple, kind: str) -> tuple[tuple, Slot, Slot | None]:
    """Path of a pydantic location (which also names union alternatives), its place and its parent's."""
    path: list[str | int] = []
    slot, tagged = root_slot(model), False
    parent: Slot | None = None
    for position, key in enumerate(loc):
        if len(slot.options) > 1 and not tagged:
            # Pydantic names the alternative before it goes on; narrow only models, so that messages list all
            # simple types.
            chosen = tuple(option for option in slot.models if is_tag_of(option, key))
            slot = replace(slot, options=chosen or slot.options)
            tagged = True
            continue
        tagged = False
        is_new = position == len(loc) - 1 and kind in ("missing", "extra_forbidden")
        if not is_new and not _holds(data, key):
            continue
        path.append(key)
        data = data[key] if _holds(data, key) else None
        slot, parent = slot.child(key) or Slot(str(key), ()), slot
    return tuple(path), slot, parent


def _holds(data: Any, key: Any) -> bool:
    if isinstance(data, dict):
        return key in data
    return isinstance(data, list) and isinstance(key, int) and key < len(data)


def _value_at(data: Any, path: tuple) -> Any:
    for key in path:
        if not _holds(data, key):
            return None
        data = data[key]
    return data


def _message(error: Any, path: tuple, slot: Slot, parent: Slot | None, value: Any) -> str:
    kind, context = error["type"], error.get("ctx", {})
    if kind == "extra_forbidden":
        return unknown_key(str(path[-1]), parent)
    if kind == "missing" and not isinstance(error["loc"][-1], int):
        return _required(slot)
    if kind in _OWN_WORDS:
        return " ".join(str(context.get("error", error["msg"])).split())
    if kind == "union_tag_not_found":
        key = _tag_key(context)
        return f"needs the key {key!r}, which says which kind it is (allowed {', '.join(_tags(slot, key))})"
    if kind in _NAME and (slot.models or len(slot.options) == 1):
        return _wrong_name(slot, context, value)
    if kind in _RANGE and (words := in_bounds(slot, context)):
        return f"must be {words} (got {got(value)})"
    if kind in _LENGTH and (words := in_length(slot, context)) and not _fixed(slot):
        unit = "characters" if isinstance(value, str) else "entries"
        return f"must have {words} {unit} (got {len(value)})"
    if kind.endswith(("_type", "_parsing", "_error", "_float", "_number")) or kind in {
        "missing",
        "too_short",
        "too_long",
    }:
        return f"must be {expected(slot)} (got {got(value)}{_count(value, slot)}){_hint(slot, value)}"
    words = error["msg"].replace("Input should", "must").replace("String should", "must")
    return f"{words} (got {got(value)})"


def _required(slot: Slot) -> str:
    meaning = slot.info.description if slot.info is not None and slot.info.description else ""
    unit = f"in {slot.unit.label}" if slot.unit.label else ""
    words = ", ".join(part for part in (meaning.rstrip("."), unit) if part)
    return f"required key is missing: {words}" if words else "required key is missing"


def _wrong_name(slot: Slot, context: dict[str, Any], value: Any) -> str:
    if "discriminator" in context:
        names = _tags(slot, _tag_key(context))
    else:
        names = [str(name) for name in literal_names(slot)]
    hint = did_you_mean(value, names) if isinstance(value, str) else ""
    return f"unknown name{hint} (got {got(value)}; allowed {', '.join(names)})"


def _tag_key(context: dict[str, Any]) -> str:
    """The key that chooses among the models of a union; pydantic gives it in quotes."""
    return str(context["discriminator"]).strip("'")


def _tags(slot: Slot, key: str) -> list[str]:
    """Allowed values of the key that chooses among the models of a union."""
    kinds = (model.model_fields[key].annotation for model in slot.models if key in model.model_fields)
    return list(
        dict.fromkeys(str(value) for kind in kinds if get_origin(kind) is Literal for value in get_args(kind))
    )


def _fixed(slot: Slot) -> bool:
    return any(get_origin(option) is tuple for option in slot.options)


def _count(value: Any, slot: Slot) -> str:
    return f", {len(value)} entries" if isinstance(value, list) and _fixed(slot) and len(value) <= 20 else ""


def _hint(slot: Slot, value: Any) -> str:
    """End of a message on a text given for a mapping or number: its probable meaning, or empty."""
    if isinstance(value, str) and slot.models and re.match(r"\w+:\S", value):
        return "; a blank is missing behind the colon"
    if not isinstance(value, str) or not {float, int} & set(slot.options):
        return ""
    try:
        float(value)
    except ValueError:
        return ""
    return "; write the number without quotes or underscores"
