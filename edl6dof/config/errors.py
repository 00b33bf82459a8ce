"""What is wrong with a configuration, said in one line per mistake and for all mistakes at once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Problem:
    """One mistake and where it stands; ``line`` and ``column`` count from 1, 0 means that the place has no
    lines.
    """

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
    """A configuration that cannot be used; ``problems`` holds every mistake found, in the order of the files
    and lines.
    """

    def __init__(self, problems: Iterable[Problem]):
        found = tuple(dict.fromkeys(problems))
        files = list(dict.fromkeys(problem.file for problem in found))
        self.problems = tuple(sorted(found, key=lambda p: (files.index(p.file), p.line, p.column)))
        super().__init__(self.problems)

    def __str__(self) -> str:
        return "\n".join(str(problem) for problem in self.problems)


def refusal(place: object, message: str) -> ConfigError:
    """The error of a file, a folder or an option that cannot be used: one line, of at most 300 characters."""
    return ConfigError([Problem(str(place), 0, 0, "", " ".join(message.split())[:300])])


class Inconsistent(ValueError):
    """Raised by a model validator for values that do not fit together: each problem at its own key instead of
    at the section's.

    >>> raise Inconsistent({"simulation.step_s": "must divide the base cycle"})
    """

    def __init__(self, problems: Mapping[str, str]):
        """``problems``: dotted path below the validated section (empty for the section itself) to message."""
        self.problems = dict(problems)
        super().__init__(
            "; ".join(": ".join(part for part in pair if part) for pair in self.problems.items())
        )
