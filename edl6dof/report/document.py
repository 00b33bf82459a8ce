"""The content of a report: a headline, key figures, and sections of text, tables and figures, independent of
HTML and matplotlib; and the format of its numbers.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import floor, inf, log10
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
    """A part of the report with an entry in the contents; ``key``: unique, of letters, digits and ``_``."""

    key: str
    title: str
    blocks: Sequence[Block]


@dataclass(frozen=True)
class Report:
    """A whole report; ``picture``: figure at its head."""

    title: str
    headline: str
    mood: Mood
    subtitle: str = ""
    facts: Sequence[Fact] = ()
    sections: Sequence[Section] = ()
    footer: str = ""
    picture: Figure | None = None

    def figures(self) -> Iterator[Figure]:
        """Return all figures in order."""
        yield from [self.picture] if self.picture is not None else []
        for section in self.sections:
            yield from (block for block in section.blocks if isinstance(block, Figure))


def significant(value: float, digits: int = 4) -> str:
    """Format a number to ``digits`` significant digits; a larger one is written whole, not as 1.235e+04."""
    text = f"{value:.{digits}g}"
    return f"{value:.0f}" if "e+" in text else text


def aligned(*values: float) -> list[str]:
    """Format numbers with the same number of decimals: two digits of the span between them, but no decimals
    beyond the fourth digit of the largest.

    >>> aligned(86.12345, 86.0, 86.9)
    ['86.12', '86.00', '86.90']
    >>> aligned(12345.6, 12000.0, 13000.0)
    ['12346', '12000', '13000']
    """
    largest = max(map(abs, values)) or 1.0
    span = max(values) - min(values) or largest
    places = min(decimals(span, 2), decimals(largest, 4))
    return [f"{value:.{places}f}" for value in values]


def decimals(size: float, digits: int) -> int:
    """Return the number of decimals with which a number of this size has so many digits.

    >>> decimals(2.5, 3), decimals(0.04, 3), decimals(12345.0, 3)
    (2, 4, 0)
    """
    return max(digits - 1 - floor(log10(size)), 0) if 0.0 < size < inf else 0


def in_percent(share: float, decimals: int = 0) -> str:
    """Format a share as a percentage.

    >>> in_percent(0.963, 2), in_percent(0.5)
    ('96.30 %', '50 %')
    """
    return f"{100.0 * share:.{decimals}f} %"


def printed(unit: str) -> str:
    """Format a unit for print, with raised powers."""
    return unit.translate(str.maketrans("234", "²³⁴"))
