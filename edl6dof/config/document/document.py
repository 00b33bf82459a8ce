"""The data of a scenario, with the file, line and claim of every value."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from edl6dof.config.document import yamltree
from edl6dof.config.document.yamltree import Mark, dotted
from edl6dof.config.errors import Problem


@dataclass
class Document:
    """Plain data of a scenario, and for error messages and provenance: where each value stands and what kind
    of claim it is.

    Attributes:
        data: nested dicts and lists of str, int, float, bool and None.
        marks: place of every key and list item; ``()`` is the document itself.
        status: dotted path to status name, where a mark such as ``# [P] S1 section 7`` stands.
        sources: dotted path to the text behind that mark.
        files: every file read, the scenario first.
        replacing: lists tagged ``!replace``, until the document is laid over its base.
    """

    data: dict[str, Any]
    marks: dict[yamltree.Path, Mark] = field(default_factory=dict)
    status: dict[str, str] = field(default_factory=dict)
    sources: dict[str, str] = field(default_factory=dict)
    files: tuple[Path, ...] = ()
    replacing: set[yamltree.Path] = field(default_factory=set)

    def copy(self) -> Document:
        """One that may be changed without changing this."""
        places = dict(self.marks), dict(self.status), dict(self.sources)
        return Document(_copied(self.data), *places, self.files, set(self.replacing))

    def mark(self, path: yamltree.Path) -> Mark:
        """Place of a value, or of the nearest parent that has one."""
        for length in range(len(path), -1, -1):
            if path[:length] in self.marks:
                return self.marks[path[:length]]
        return Mark("(configuration)")

    def problem(self, path: yamltree.Path, message: str, at: yamltree.Path | None = None) -> Problem:
        """A problem of the value at ``path``, shown at the place of ``at`` (by default the same)."""
        return Problem(*self.mark(path if at is None else at), dotted(path), message)

    def forget(self, path: yamltree.Path) -> None:
        """Drop places and provenance of a value that is being replaced, and of everything inside it."""
        self.marks = {known: mark for known, mark in self.marks.items() if known[: len(path)] != path}
        inside = dotted(path) + "."
        for claims in (self.status, self.sources):
            for known in [known for known in claims if f"{known}.".startswith(inside)]:
                del claims[known]


def _copied(data: Any) -> Any:
    """Plain data with dicts and lists of its own, at a third of the cost of ``deepcopy``."""
    if isinstance(data, dict):
        return {key: _copied(value) for key, value in data.items()}
    return [_copied(value) for value in data] if isinstance(data, list) else data
