"""Errors of a configuration, all mistakes at once and one line for each, and of unknown names."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeVar

Value = TypeVar("Value")


@dataclass(frozen=True)
class Problem:
    """One mistake and its place; ``line`` and ``column`` count from 1; 0 if the place has none."""

    file: str
    line: int
    column: int
    path: str
    message: str

    def __str__(self) -> str:
        """``file:line:column: dotted.key: message``, without the parts that do not apply."""
        place = f"{self.file}:{self.line}:{self.column}" if self.line else self.file
        line = ": ".join(part for part in (place, self.path, self.message) if part)
        return "".join(ch if ch.isprintable() else "?" for ch in line)


class ConfigError(Exception):
    """A configuration that cannot be used; ``problems`` has every mistake in order of files and lines."""

    def __init__(self, problems: Iterable[Problem]):
        found = tuple(dict.fromkeys(problems))
        files = list(dict.fromkeys(problem.file for problem in found))
        self.problems = tuple(sorted(found, key=lambda p: (files.index(p.file), p.line, p.column)))
        super().__init__(self.problems)

    def __str__(self) -> str:
        return "\n".join(str(problem) for problem in self.problems)


def refusal(place: object, message: str) -> ConfigError:
    """The error of an unusable file, folder or option: one line, of at most 300 characters."""
    return ConfigError([Problem(str(place), 0, 0, "", " ".join(message.split())[:300])])


class Inconsistent(ValueError):
    """Raised by a model validator for values that do not fit together, each problem at its own key.

    >>> raise Inconsistent({"simulation.step_s": "must divide the base cycle"})
    """

    def __init__(self, problems: Mapping[str, str]):
        """``problems``: dotted path below the validated section (empty for the section itself) to message."""
        self.problems = dict(problems)
        super().__init__(
            "; ".join(": ".join(part for part in pair if part) for pair in self.problems.items())
        )


def nearest(name: str, allowed: Iterable[str]) -> str | None:
    """The allowed name that ``name`` was probably meant to be."""
    by_fold = {str(item).casefold(): str(item) for item in allowed}
    found = difflib.get_close_matches(str(name).casefold(), list(by_fold), n=1, cutoff=0.6)
    return by_fold[found[0]] if found else None


def did_you_mean(name: str, known: Iterable[str], otherwise: str = "") -> str:
    """Text ``; did you mean 'entry'?`` if a known name is similar to ``name``, else ``otherwise``."""
    near = nearest(name, known)
    return f"; did you mean {near!r}?" if near else otherwise


class UnknownName(KeyError):
    """An unknown ``name`` of a ``kind`` such as ``channel``; the message suggests a similar name."""

    def __init__(self, kind: str, name: object, known: Iterable[str]):
        super().__init__(name)
        self.kind, self.name, self._known = kind, name, known

    def __str__(self) -> str:
        return f"no {self.kind} {self.name!r}{did_you_mean(str(self.name), self._known)}"


class Named(dict[str, Value]):
    """Values by name.

    Raises:
        UnknownName: on access by a name that is not known.
    """

    def __init__(self, kind: str, values: Mapping[str, Value]):
        """``kind``: word for the names in messages, such as ``figure``."""
        super().__init__(values)
        self._kind = kind

    def __missing__(self, name: str) -> Value:
        raise UnknownName(self._kind, name, self)
