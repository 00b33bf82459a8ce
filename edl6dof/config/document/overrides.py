"""``--set vehicle.mass.entry_kg=1300``: change single values of a document before it is checked."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from copy import deepcopy
from typing import Any, get_args, get_origin

from pydantic import BaseModel
from pydantic_core import PydanticUndefined, to_jsonable_python

from edl6dof.config.base import Params
from edl6dof.config.document.document import Document, unknown_entry
from edl6dof.config.document.source import INCLUDES, Mark, include
from edl6dof.config.document.yamltree import REPLACE, Keys, dotted, parse_yaml
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.config.model_paths import Slot, root_slot
from edl6dof.config.parameter_table import nearest_path, rows
from edl6dof.config.wording import got, meant_key, unknown_key

_FORM = "must have the form path.to.key=value"


class _Refused(ValueError):
    """An override cannot be applied, for the reason in its text."""


class _NoKey(_Refused):
    """A path has a key that does not exist and is not similar to one that does."""


def apply_overrides(document: Document, overrides: Iterable[str], model: type[BaseModel]) -> Document:
    """A copy of ``document`` with every ``dotted.path=value`` applied, in the order given.

    Args:
        document: the files as read.
        overrides: texts ``path=value``; a list item is chosen by its index (from 0) or by its ``name``; the
            value is YAML.
        model: root parameter model, which defines the paths; so defaults that the file omits can be set.

    Raises:
        ConfigError: every override that is malformed or names a path that does not exist.
    """
    parts = ((text, *text.partition("=")) for text in overrides)
    changes = [
        (path, value if equals else None, Mark(f"--set {text}")) for text, path, equals, value in parts
    ]
    return _with(document, changes, model, _parse)


def with_values(
    document: Document,
    values: Mapping[str, Any],
    model: type[BaseModel],
    mark: Callable[[str], Mark] = lambda path: Mark(""),
) -> Document:
    """A copy of ``document`` with plain data put at dotted paths, as by :func:`apply_overrides`.

    Args:
        document: the files as read.
        values: dotted path to value, in the order in which they are put.
        model: root parameter model.
        mark: the place where a value is given, by its path.

    Raises:
        ConfigError: every path that does not exist.
    """
    return _with(document, [(path, value, mark(path)) for path, value in values.items()], model, deepcopy)


def _with(
    document: Document,
    changes: Iterable[tuple[str, Any, Mark]],
    model: type[BaseModel],
    read: Callable[[Any], Any],
) -> Document:
    """A copy with changes: path, value for ``read`` to convert, and the place where the value was given."""
    result, problems = document.copy(), list[Problem]()
    for path, given, mark in changes:
        if any(path.strip().startswith(f"{dotted(unread)}.") for unread in result.refused):
            continue  # its place is not known
        try:
            _set(result, path.strip().split("."), read(given), mark, model)
        except _NoKey as error:
            near = nearest_path(path.strip(), (row.path for row in rows(model) if _is_plain(row.path)))
            words = f"{error}; did you mean {near!r}?" if near else str(error)
            problems.append(Problem(*mark, path.strip(), words))
        except _Refused as error:
            problems.append(Problem(*mark, path.strip(), str(error)))
        except ConfigError as error:
            problems += error.problems
    if problems:
        raise ConfigError(problems)
    return result


def _is_plain(path: str) -> bool:
    """Return whether a path of the table of parameters can be set as it stands: without names to put in."""
    return "[]" not in path and "<" not in path


def _parse(text: str | None) -> Any:
    """Value of an override as YAML; ``None`` stands for an override without ``=``."""
    if text is None:
        raise _Refused(_FORM)
    if not text.strip():
        raise _Refused("no value after '='; write null for none")
    try:
        tree = parse_yaml(text, "")
    except ConfigError as error:
        raise _Refused("; ".join(problem.message for problem in error.problems)) from None
    if tree.replacing:
        raise _Refused(f"a list that is set always replaces the whole list; leave out {REPLACE}")
    return tree.data


def _set(document: Document, parts: list[str], value: Any, mark: Mark, model: type[BaseModel]) -> None:
    node, parent, path = _reach(document, parts, mark, model)
    key = path[-1]
    _forget(document, path)
    document.marks[path] = mark
    if isinstance(node, dict):
        _drop_foreign(node, parent, parts[-1], value)
        deciding = (one for one in parent.models if issubclass(one, Params))
        for name in {name for one in deciding for name in one.decided_by(parts[-1])}.intersection(node):
            del node[name]
            _forget(document, (*path[:-1], name))
    node[key] = value
    if len(parts) == 1 and parts[0] in INCLUDES and isinstance(value, str):
        include(document, parts[0], value, INCLUDES[parts[0]])


def _reach(
    document: Document, parts: list[str], mark: Mark, model: type[BaseModel]
) -> tuple[Any, Slot, Keys]:
    """Container of the value at a path, its place in the model, and the path as keys and indices.

    Containers that the file omits are filled with their defaults.
    """
    if not all(parts):
        raise _Refused(_FORM)
    node: Any = document.data
    slot = root_slot(model)
    path: Keys = ()
    for part in parts[:-1]:
        key, slot = _step(node, slot, part)
        path = (*path, key)
        if isinstance(node, dict) and node.get(key) is None:
            node[key] = _default(slot)
            document.marks[path] = mark
        node = node[key]
    key, _ = _step(node, slot, parts[-1])
    return node, slot, (*path, key)


def ensure_path(document: Document, dotted_path: str, model: type[BaseModel]) -> Keys:
    """Write the containers of a dotted path that ``document`` omits; return its keys and indices.

    Raises:
        ValueError: no such path; the text gives the reason without a place.
    """
    return _reach(document, dotted_path.split("."), Mark("(default)"), model)[2]


def _step(node: Any, slot: Slot, part: str) -> tuple[str | int, Slot]:
    """Key or index meant by one part of a path, and its place in the model."""
    if isinstance(node, list):
        key: str | int = _index(node, part)
    elif isinstance(node, dict):
        key = part
    elif slot.keys:
        raise _Refused(f"cannot set {part!r} inside {got(node)}")
    else:
        raise _NoKey(f"{slot.name} is a single value: it has no {part!r} inside")
    child = slot.child(key)
    if child is None:
        kind = _NoKey if meant_key(part, slot.keys) is None else _Refused
        raise kind(unknown_key(part, slot) + (f" (in {slot.name})" if slot.name else ""))
    return key, child


def _index(items: list[Any], part: str) -> int:
    names = [item.get("name") if isinstance(item, dict) else None for item in items]
    if part in names:
        return names.index(part)
    if part.isdecimal():
        if int(part) < len(items):
            return int(part)
        raise _Refused(f"no entry {part}: the list has {len(items)}, counted from 0")
    known = [str(name) for name in names if name is not None]
    otherwise = f"; names: {', '.join(known)}" if known else "; use its index, from 0"
    raise _Refused(unknown_entry(part, known, otherwise))


def _default(slot: Slot) -> Any:
    """Plain data of the default of a place."""
    default = slot.info.get_default(call_default_factory=True) if slot.info is not None else None
    if default is None or default is PydanticUndefined:
        if not slot.models and not any(
            option is Any or get_origin(option) is dict for option in slot.options
        ):
            raise _Refused(f"{slot.name} is not in the file: set all of it, not a part")
        return {}
    return to_jsonable_python(default)


def _drop_foreign(node: dict[str, Any], slot: Slot, key: str, value: Any) -> None:
    """Drop parameters of the former alternative when ``key`` chooses another (``guidance.law=...``)."""
    kinds = [model for model in slot.models if key in model.model_fields]
    chosen = [model for model in kinds if value in get_args(model.model_fields[key].annotation)]
    if len(kinds) > 1 and len(chosen) == 1:
        for name in [name for name in node if name not in chosen[0].model_fields]:
            del node[name]


def _forget(document: Document, path: Keys) -> None:
    """Drop the provenance of a value, and of a list of numbers that contains it."""
    document.forget(path)
    for length in range(1, len(path)):
        document.status.pop(dotted(path[:length]), None)
        document.sources.pop(dotted(path[:length]), None)
