"""A report as a PDF: pages of words and tables, then every figure as a vector page."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from edl6dof.report.document import Cell, Report, Table
from edl6dof.report.figure import BAD, GOOD, GREY, WARN
from edl6dof.report.matplotlib_figure import STYLE, matplotlib_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

A4 = (8.27, 11.69)
ROWS_PER_PAGE = 58
_MOODS = {"good": GOOD, "warn": WARN, "bad": BAD, "plain": "#1f2933"}


def write_pdf(report: Report, path: Path) -> None:
    """Headline and tables on A4 pages, then every figure on a page of its own size."""
    import matplotlib

    with matplotlib.rc_context(STYLE):
        from matplotlib.backends.backend_pdf import PdfPages

        with PdfPages(
            path, metadata={"Title": report.title, "Subject": report.headline, "CreationDate": None}
        ) as pages:
            for canvas in _word_pages(report):
                pages.savefig(canvas)
            for figure in report.figures():
                pages.savefig(matplotlib_figure(figure))


def _word_pages(report: Report) -> Iterator[Canvas]:
    """A4 pages with title, headline, facts and all tables."""
    from matplotlib.figure import Figure as Canvas

    lines = list(_lines(report))
    for start in range(0, len(lines), ROWS_PER_PAGE):
        canvas = Canvas(figsize=A4)
        for row, cells in enumerate(lines[start : start + ROWS_PER_PAGE]):
            for x, align, words, style in cells:
                canvas.text(
                    0.08 + 0.84 * x, 0.95 - 0.9 * row / ROWS_PER_PAGE, words, ha=align, va="top", **style
                )
        yield canvas


Words = tuple[float, str, str, dict[str, Any]]


def _lines(report: Report) -> Iterator[list[Words]]:
    """Lines of the word pages: each a list of (place 0..1, alignment, text, style)."""
    small = {"fontsize": 7.5}
    yield [(0.0, "left", report.title, {"fontsize": 17, "fontweight": "bold"})]
    yield []
    yield [(0.0, "left", report.subtitle, {"fontsize": 9, "color": GREY})]
    yield [
        (0.0, "left", report.headline, {"fontsize": 11, "fontweight": "bold", "color": _MOODS[report.mood]})
    ]
    yield []
    for first in range(0, len(report.facts), 4):
        facts = list(enumerate(report.facts[first : first + 4]))
        yield [
            (k / 4, "left", fact.value, {"fontsize": 11, "fontweight": "bold", "color": _MOODS[fact.mood]})
            for k, fact in facts
        ]
        yield [(k / 4, "left", fact.label, {**small, "color": GREY}) for k, fact in facts]
        yield []
    for section in report.sections:
        for table in (block for block in section.blocks if isinstance(block, Table)):
            yield [(0.0, "left", table.caption or section.title, {"fontsize": 9, "fontweight": "bold"})]
            yield from _table_lines(table)
            yield []
    for line in textwrap.wrap(report.footer, 130):
        yield [(0.0, "left", line, {**small, "color": GREY})]


def _table_lines(table: Table) -> Iterator[list[Words]]:
    """Columns as wide as their longest text."""
    rows = [[item if isinstance(item, Cell) else Cell(item) for item in row] for row in table.rows]
    widths = [
        max([len(head.rstrip(">")), *(len(row[k].text) for row in rows)]) + 3
        for k, head in enumerate(table.columns)
    ]
    total = max(sum(widths), 110)
    starts = np.concatenate([[0], np.cumsum(widths)]) / total
    right = [column.endswith(">") for column in table.columns]
    places = [
        (starts[k + 1] - 2 / total if right[k] else starts[k], "right" if right[k] else "left")
        for k in range(len(widths))
    ]
    style = {"fontsize": 7.5}
    yield [
        (*place, head.rstrip(">"), {**style, "color": GREY})
        for place, head in zip(places, table.columns, strict=True)
    ]
    for row in rows:
        yield [
            (*place, cell.text, {**style, "color": _MOODS[cell.mood]})
            for place, cell in zip(places, row, strict=True)
        ]
