"""YAML text to plain data plus the place and the provenance mark of every key.

The parser's events are walked here instead of loading a dict, because only events have lines, duplicate keys,
aliases and tags.  Plain scalars are those of the YAML 1.2 core schema: PyYAML follows YAML 1.1, where ``1e5``
is text, ``on`` a boolean and ``1_000`` a number.
"""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import yaml

from edl6dof.config.base import STATUS_MARKS
from edl6dof.config.errors import ConfigError, Problem

Keys = tuple[str | int, ...]

LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
DEEPEST = 40
#: Tag of a list that replaces the one in the base of its file.
REPLACE = "!replace"

_UNPRINTABLE = re.compile("[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_SURROGATE = re.compile("[\ud800-\udfff]")
_CLAIM = re.compile(r"[^#]*?\s#\s*\[([A-Z])\]\s*(.*?)\s*")

Scalar = str | int | float | bool | None

_NULL = {"", "~", "null", "Null", "NULL"}
_BOOL = {"true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False}
_INT = re.compile(r"[-+]?[0-9]+")
_BASED = re.compile(r"0o[0-7]+|0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")
_PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_./+-]*( [A-Za-z0-9_(][A-Za-z0-9_./+()-]*)*")
_LONGEST_NUMBER = 300
#: Words that YAML 1.1, and many programs, take for true and false.
BOOLEAN_WORDS = {
    **dict.fromkeys(("y", "yes", "on"), True),
    **dict.fromkeys(("n", "no", "off"), False),
}


class Mark(NamedTuple):
    """A place in a file, counted from 1; line 0 where there are no lines, as in a command line option."""

    file: str
    line: int = 0
    column: int = 0


@dataclass
class Tree:
    """Plain data of a text, place of every key, ``!replace`` lists, and marks ``# [P] source`` of values."""

    data: Any = None
    marks: dict[Keys, Mark] = field(default_factory=dict)
    replacing: set[Keys] = field(default_factory=set)
    status: dict[str, str] = field(default_factory=dict)
    sources: dict[str, str] = field(default_factory=dict)


def dotted(path: Keys) -> str:
    """``("thrusters", 2, "thrust_n")`` as ``thrusters.2.thrust_n``."""
    return ".".join(str(part) for part in path)


def parse_yaml(text: str, file: str) -> Tree:
    """Read one YAML document; an empty one gives ``None``.

    Raises:
        ConfigError: the text is not YAML, or has unsupported parts (aliases, tags other than ``!replace``,
            several documents, NaN, ...).
    """
    if bad := _UNPRINTABLE.search(text):
        line = text.count("\n", 0, bad.start()) + 1
        column = bad.start() - text.rfind("\n", 0, bad.start())
        message = f"character {bad.group()!r} is not allowed in YAML"
        raise ConfigError([Problem(file, line, column, "", message)])
    builder = _Builder(text, file)
    try:
        builder.run()
    except yaml.MarkedYAMLError as error:
        builder.problems.append(_syntax_problem(error, text, file))
    except _TooDeep:
        pass
    if builder.problems:
        raise ConfigError(builder.problems)
    return builder.tree


def _syntax_problem(error: yaml.MarkedYAMLError, text: str, file: str) -> Problem:
    mark = error.problem_mark or error.context_mark
    line, column = (mark.line, mark.column) if mark else (0, 0)
    lines = text.splitlines()
    content = lines[line] if line < len(lines) else ""
    if "\t" in content[: len(content) - len(content.lstrip())]:
        message = "a tab cannot indent a line; use spaces"
    elif "nesting depth" in (error.problem or ""):  # newer parsers have a limit of their own, beyond ours
        message = f"nested more than {DEEPEST} levels deep"
    else:
        message = "not valid YAML: " + ", ".join(part for part in (error.problem, error.context) if part)
    return Problem(file, line + 1, column + 1, "", message)


class _TooDeep(Exception):
    """Nesting beyond any configuration; ends the walk before the stack overflows."""


class _Builder:
    """Walks the events of one text into a :class:`Tree`."""

    def __init__(self, text: str, file: str):
        self.file = file
        self.lines = text.splitlines()
        self.events = yaml.parse(text, Loader=LOADER)
        # line -> column behind its last token, where alone a comment can follow; the last one taken
        self.ends: dict[int, int] = {}
        self.line = 0
        self.claim_lines: dict[Keys, tuple[int, ...]] = {}
        self.plain: dict[Keys, bool] = {}  # whether a value holds no mapping: only such values carry a status
        self.problems: list[Problem] = []
        self.tree = Tree(marks={(): Mark(file, 1, 1)})

    def run(self) -> None:
        """Read the one document."""
        while not isinstance(event := self._take(), yaml.StreamEndEvent):
            if isinstance(event, yaml.DocumentStartEvent):
                if self.plain:
                    self._problem(event, (), "only one YAML document per file is allowed")
                self.tree.data = self._value((), self._take(), ())
        self._collect_claims()

    def _take(self) -> yaml.Event:
        event = next(self.events)
        end = event.end_mark
        if end.index != event.start_mark.index:
            self.ends[end.line] = max(end.column, self.ends.get(end.line, 0))
        self.line = end.line
        return event

    def _problem(self, event: yaml.Event, path: Keys, message: str) -> None:
        mark = event.start_mark
        self.problems.append(Problem(self.file, mark.line + 1, mark.column + 1, dotted(path), message))

    def _value(self, path: Keys, event: yaml.Event, key_lines: tuple[int, ...]) -> Any:
        """Value that begins with ``event``; ``key_lines`` has the line of its key, which may have a mark."""
        if len(path) > DEEPEST:
            self._problem(event, path[:4], f"nested more than {DEEPEST} levels deep")
            raise _TooDeep
        self.plain[path] = True
        if isinstance(event, yaml.AliasEvent):
            self._problem(event, path, "aliases (*name) are not supported; write the value out")
            return None
        if event.tag:
            self._tag(path, event)
        self.claim_lines[path] = key_lines
        if isinstance(event, yaml.MappingStartEvent):
            value: Any = self._mapping(path)
        elif isinstance(event, yaml.SequenceStartEvent):
            value = self._sequence(path)
        else:
            value = self._scalar(path, event)
        if isinstance(event, yaml.ScalarEvent) or event.flow_style:
            self.claim_lines[path] = (self.line, *key_lines)
        return value

    def _tag(self, path: Keys, event: yaml.Event) -> None:
        if event.tag != REPLACE:
            self._problem(
                event, path, f"tags ({event.tag}) are not supported, except {REPLACE} before a list"
            )
        elif not isinstance(event, yaml.SequenceStartEvent):
            self._problem(event, path, f"{REPLACE} stands before a list only")
        else:
            self.tree.replacing.add(path)

    def _scalar(self, path: Keys, event: yaml.ScalarEvent) -> Any:
        if _SURROGATE.search(event.value):
            self._problem(event, path, "half of a surrogate pair is not text")
        if not event.implicit[0]:
            return event.value
        try:
            return read_scalar(event.value)
        except ValueError as error:
            shown = event.value if len(event.value) <= 40 else event.value[:37] + "..."
            self._problem(event, path, f"{error} (got {shown})")
            return None

    def _sequence(self, path: Keys) -> list[Any]:
        items: list[Any] = []
        while not isinstance(event := self._take(), yaml.SequenceEndEvent):
            item_path, start = (*path, len(items)), event.start_mark
            self.tree.marks[item_path] = Mark(self.file, start.line + 1, start.column + 1)
            items.append(self._value(item_path, event, ()))
            self.plain[path] &= self.plain[item_path]
        return items

    def _mapping(self, path: Keys) -> dict[str, Any]:
        self.plain[path] = False
        items: dict[str, Any] = {}
        while not isinstance(event := self._take(), yaml.MappingEndEvent):
            if not isinstance(event, yaml.ScalarEvent) or not event.value:
                self._problem(event, path, "a key must be a name")
                if not isinstance(event, yaml.AliasEvent):
                    self._value((*path, "?"), event, ())
                self._value((*path, "?"), self._take(), ())
                continue
            key, line = event.value, event.start_mark.line
            if key in items:
                first = self.tree.marks[(*path, key)].line
                self._problem(event, (*path, key), f"key is given twice (first on line {first})")
            self.tree.marks[(*path, key)] = Mark(self.file, line + 1, event.start_mark.column + 1)
            items[key] = self._value((*path, key), self._take(), (line,))
        return items

    def _collect_claims(self) -> None:
        """Give every value the mark of its own line, of its key's, or of the nearest parent with one."""
        found: dict[Keys, tuple[str, str] | None] = {}
        for path, lines in self.claim_lines.items():
            own = next((claim for line in lines if (claim := self._claim(line))), None)
            found[path] = claim = own or found.get(path[:-1])
            inside_plain = bool(path) and self.plain[path[:-1]]
            if claim and self.plain[path] and not (inside_plain and claim == found[path[:-1]]):
                self.tree.status[dotted(path)], self.tree.sources[dotted(path)] = claim

    def _claim(self, line: int) -> tuple[str, str] | None:
        """Status and source in the comment at the end of a line."""
        text = self.lines[line] if line < len(self.lines) else ""
        match = _CLAIM.fullmatch(text, self.ends.get(line, 0))
        if match is None or match[1] not in STATUS_MARKS:
            return None
        return STATUS_MARKS[match[1]], match[2]


def read_scalar(text: str) -> Scalar:
    """Value of a plain (unquoted) scalar.

    Raises:
        ValueError: the number is infinite, not a number or absurdly long.
    """
    if text in _NULL:
        return None
    if text in _BOOL:
        return _BOOL[text]
    if _NOT_FINITE.fullmatch(text):
        raise ValueError("must be a finite number")
    is_number = _FLOAT.fullmatch(text) or _BASED.fullmatch(text)
    if is_number and len(text) > _LONGEST_NUMBER:
        raise ValueError(f"number with more than {_LONGEST_NUMBER} characters")
    if _INT.fullmatch(text):
        return int(text)
    if _BASED.fullmatch(text):
        return int(text, 0)
    if _FLOAT.fullmatch(text):
        value = float(text)
        if not math.isfinite(value):
            raise ValueError("must be a finite number; this one is too large")
        return value
    return text


def write_scalar(value: Scalar) -> str:
    """Text that reads back as exactly ``value``, in YAML 1.1 too: ``'off'`` in quotes, ``1.0e-05``."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        text = repr(value)
        return text.replace("e", ".0e") if "e" in text and "." not in text else text
    if _PLAIN.fullmatch(value) and read_scalar(value) == value and value.lower() not in BOOLEAN_WORDS:
        return value
    return "".join(ch if ch.isprintable() else _escape(ch) for ch in json.dumps(value, ensure_ascii=False))


def write_flow(value: Any) -> str:
    """A scalar, or nested lists and mappings of scalars, on one line."""
    if isinstance(value, list | tuple):
        return "[" + ", ".join(write_flow(item) for item in value) + "]"
    if isinstance(value, dict):
        pairs = (f"{write_scalar(str(key))}: {write_flow(item)}" for key, item in value.items())
        return "{" + ", ".join(pairs) + "}"
    return write_scalar(value)


def _escape(ch: str) -> str:
    code = ord(ch)
    return f"\\u{code:04x}" if code <= 0xFFFF else f"\\U{code:08x}"
