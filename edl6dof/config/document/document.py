"""The data of a scenario with the file, line and claim of every value, and the merging of extending files."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from edl6dof.config.document.yamltree import REPLACE, Keys, Mark, dotted
from edl6dof.config.errors import ConfigError, Problem, did_you_mean, nearest


@dataclass
class Document:
    """Plain data of a scenario, with the place in the files and the status (origin) of each value."""

    #: Nested dicts and lists of str, int, float, bool and None.
    data: dict[str, Any]
    #: Place of every key and list item; ``()`` is the document itself.
    marks: dict[Keys, Mark] = field(default_factory=dict)
    #: By dotted path the status and the source in a comment such as ``# [P] S1 section 7``.
    status: dict[str, str] = field(default_factory=dict)
    sources: dict[str, str] = field(default_factory=dict)
    #: Every file read, the scenario first.
    files: tuple[Path, ...] = ()
    #: Lists tagged ``!replace``, until the document is laid over its base.
    replacing: set[Keys] = field(default_factory=set)
    #: Values that could not be read, and the reasons.
    refused: dict[Keys, tuple[Problem, ...]] = field(default_factory=dict)
    #: Items that an extending file adds to a list with fewer keys than an item of a similar name: that name.
    similar: dict[Keys, str] = field(default_factory=dict)

    def copy(self) -> Document:
        """An independent copy."""
        places = dict(self.marks), dict(self.status), dict(self.sources)
        notes = set(self.replacing), dict(self.refused), dict(self.similar)
        return Document(_copied(self.data), *places, self.files, *notes)

    def mark(self, path: Keys) -> Mark:
        """Place of a value, or of the nearest parent that has one."""
        for length in range(len(path), -1, -1):
            if path[:length] in self.marks:
                return self.marks[path[:length]]
        return Mark("(configuration)")

    def problem(self, path: Keys, message: str) -> Problem:
        """A problem of the value at ``path``."""
        return Problem(*self.mark(path), dotted(path), message)

    def error(self, path: Keys, message: str) -> ConfigError:
        """The error of the value at ``path``."""
        return ConfigError([self.problem(path, message)])

    def forget(self, path: Keys) -> None:
        """Drop places and provenance of a value that is replaced, and of everything inside it."""
        self.marks = {known: mark for known, mark in self.marks.items() if known[: len(path)] != path}
        self.similar = {known: name for known, name in self.similar.items() if known[: len(path)] != path}
        inside = dotted(path) + "."
        for claims in (self.status, self.sources):
            for known in [known for known in claims if f"{known}.".startswith(inside)]:
                del claims[known]


def _copied(data: Any) -> Any:
    """Copy plain data with new dicts and lists, at a third of the cost of ``deepcopy``."""
    if isinstance(data, dict):
        return {key: _copied(value) for key, value in data.items()}
    return [_copied(value) for value in data] if isinstance(data, list) else data


EXTENDS = "extends"


def lay_over(base: Document, top: Document) -> None:
    """Put the content of ``top`` into ``base``: merge mappings and lists of named items, replace other lists
    and single values.

    A list over a list, both of items with names, changes the items of the same names and appends the
    others: ``parachutes: [{name: main, drag_coefficient: 0.7}]``.  A mapping of mappings changes the items
    that it names: ``parachutes: {main: {drag_coefficient: 0.7}}``.  An empty list, or one tagged
    ``!replace``, replaces the whole list.

    Raises:
        ConfigError: a name is given twice in a list that is merged, or a ``!replace`` has no list to replace.
    """
    unused = set(top.replacing)
    _merge(base, top, (), (), unused)
    refuse_replacing(top, unused)
    base.marks[()] = top.mark(())
    base.refused |= top.refused
    base.files = (*top.files, *base.files)


def refuse_replacing(document: Document, paths: Iterable[Keys]) -> None:
    """Refuse the tags ``!replace`` at ``paths``, which have no list below them.

    Raises:
        ConfigError: there is such a tag.
    """
    message = f"{REPLACE} needs a list to replace, and what this file extends has none here; leave it out"
    if problems := [document.problem(path, message) for path in sorted(paths, key=dotted)]:
        raise ConfigError(problems)


def _merge(base: Document, top: Document, path: Keys, above_path: Keys, unused: set[Keys]) -> None:
    """Merge ``top`` at ``above_path`` into ``base`` at ``path``; applied ``!replace`` leave ``unused``."""
    below, above = _value_at(base.data, path), _value_at(top.data, above_path)
    if isinstance(above, list):
        _require_single_names(top, above_path, above)
    for key, value in enumerate(above) if isinstance(above, list) else above.items():
        where = value["name"] if isinstance(above, list) else key
        if isinstance(below, list):
            known = _named(below)
            if isinstance(key, str) and key not in known:
                base.refused[*path, key] = (top.problem((*above_path, key), unknown_entry(key, known)),)
                continue
            where = known.get(where, len(below))
            present = below[where] if where < len(below) else None
        else:
            present = below.get(where)
        place, source = (*path, where), (*above_path, key)
        if source not in top.replacing and _takes(present, value):
            _merge(base, top, place, source, unused)
            continue
        if isinstance(present, list):
            unused.discard(source)
        base.forget(place)
        if isinstance(below, list):
            near = nearest(value["name"], known) if present is None else None
            if near is not None and not below[known[near]].keys() <= value.keys():
                base.similar[place] = near
            below[where : where + 1] = [value]
        else:
            below[where] = value
        _copy_claims(base, top, place, source)


def _require_single_names(top: Document, path: Keys, items: list[Any]) -> None:
    first: dict[str, int] = {}
    problems = []
    for k, item in enumerate(items):
        if (earlier := first.setdefault(item["name"], k)) != k:
            line = top.mark((*path, earlier)).line
            message = f"name is given twice (first on line {line}; got {item['name']!r})"
            problems.append(top.problem((*path, k, "name"), message))
    if problems:
        raise ConfigError(problems)


def _takes(below: Any, above: Any) -> bool:
    """Return whether the mapping or list ``above`` changes ``below`` rather than replaces it."""
    if isinstance(above, list):
        return _all_named(above) and _all_named(below)
    if not isinstance(above, dict):
        return False
    changes_items = bool(above) and all(isinstance(value, dict) for value in above.values())
    return isinstance(below, dict) or (_all_named(below) and changes_items)


def _all_named(items: Any) -> bool:
    """Return whether a value is a list of items that all have a name."""
    return isinstance(items, list) and bool(items) and all(map(_has_name, items))


def _has_name(item: Any) -> bool:
    return isinstance(item, dict) and isinstance(item.get("name"), str)


def unknown_entry(name: str, known: Iterable[str], otherwise: str = "") -> str:
    """Message for a name that no item of a list has, with the one that was probably meant."""
    return f"no entry named {name!r}{did_you_mean(name, known, otherwise)}"


def _named(items: list[Any]) -> dict[Any, int]:
    """Index of each item of a list by its name."""
    return {item["name"]: k for k, item in enumerate(items) if _has_name(item)}


def _copy_claims(base: Document, top: Document, path: Keys, above_path: Keys) -> None:
    """Copy places and provenance of a value that ``base`` takes from ``top``."""
    depth, inside = len(above_path), dotted(above_path) + "."
    inner = {known: mark for known, mark in top.marks.items() if known[:depth] == above_path}
    base.marks |= {(*path, *known[depth:]): mark for known, mark in inner.items()}
    for mine, theirs in ((base.status, top.status), (base.sources, top.sources)):
        for known, claim in theirs.items():
            if f"{known}.".startswith(inside):
                mine[f"{dotted(path)}.{known[len(inside) :]}".rstrip(".")] = claim


def _value_at(data: Any, path: Keys) -> Any:
    for key in path:
        data = data[key]
    return data
