"""The content of a report: a headline, key figures, and sections of text, tables and figures, independent of
HTML and matplotlib.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal

from edl6dof.report.figure import Figure

Mood = Literal["good", "warn", "bad", "plain"]


@dataclass(frozen=True)
class Fact:
    """A key figure: its label, its value with the unit, and its mood."""

    label: str
    value: str
    mood: Mood = "plain"


@dataclass(frozen=True)
class Cell:
    """A table cell with a mood, and with a bar for a share 0..1 (cut off beyond)."""

    text: str
    mood: Mood = "plain"
    bar: float | None = None


Row = Sequence[str | Cell]


def as_cell(item: str | Cell) -> Cell:
    """Return an item of a row as a cell."""
    return item if isinstance(item, Cell) else Cell(item)


@dataclass(frozen=True)
class Table:
    """Rows under headings; a heading that ends in ``>`` marks a column of right-aligned numbers."""

    columns: Sequence[str]
    rows: Sequence[Row]
    caption: str = ""


@dataclass(frozen=True)
class Text:
    """A paragraph."""

    words: str


@dataclass(frozen=True)
class Listing:
    """Lines of a file, folded under a title; status marks such as ``# [P]`` are coloured."""

    title: str
    text: str
    note: str = ""


Block = Figure | Table | Text | Listing


@dataclass(frozen=True)
class Section:
    """A part of the report with an entry in the contents; keys are unique letters, digits and ``_``."""

    key: str
    title: str
    blocks: Sequence[Block]


@dataclass(frozen=True)
class Report:
    """A whole report."""

    title: str
    headline: str
    mood: Mood
    subtitle: str = ""
    facts: Sequence[Fact] = ()
    sections: Sequence[Section] = field(default_factory=tuple)
    footer: str = ""

    def figures(self) -> Iterator[Figure]:
        """Return all figures in order."""
        for section in self.sections:
            yield from (block for block in section.blocks if isinstance(block, Figure))
