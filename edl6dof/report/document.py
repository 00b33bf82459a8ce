"""What a report says: a headline, figures at a glance, and sections of text, tables and figures.  It knows no
HTML and no matplotlib.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal

from edl6dof.report.figure import Figure

Mood = Literal["good", "warn", "bad", "plain"]


@dataclass(frozen=True)
class Fact:
    """A figure at a glance: what it is, its value with the unit, and how it is to be taken."""

    label: str
    value: str
    mood: Mood = "plain"


@dataclass(frozen=True)
class Cell:
    """A table cell that says more than its text: by its mood, and by a bar of a share 0..1 (more is cut)."""

    text: str
    mood: Mood = "plain"
    bar: float | None = None


Row = Sequence[str | Cell]


@dataclass(frozen=True)
class Table:
    """Rows under headings; a heading that ends in ``>`` is that of right-aligned numbers."""

    columns: Sequence[str]
    rows: Sequence[Row]
    caption: str = ""


@dataclass(frozen=True)
class Text:
    """A paragraph."""

    words: str


@dataclass(frozen=True)
class Listing:
    """Lines of a file, folded away under a title; a status mark such as ``# [P]`` in them is coloured."""

    title: str
    text: str
    note: str = ""


Block = Figure | Table | Text | Listing


@dataclass(frozen=True)
class Section:
    """A part of the report with an entry in its contents; keys are letters, digits and ``_``, each once in a
    report.
    """

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
        """All figures in their order."""
        for section in self.sections:
            yield from (block for block in section.blocks if isinstance(block, Figure))
