"""A report as a PDF: pages of words and tables, then every figure as a vector page."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from edl6dof.report.document import Cell, Report, Table
from edl6dof.report.figure import BAD, GOOD, GREY, INK, WARN
from edl6dof.report.matplotlib_figure import STYLE, matplotlib_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

A4 = (8.27, 11.69)
ROWS_PER_PAGE = 58
_MOODS = {"good": GOOD, "warn": WARN, "bad": BAD, "plain": INK}


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

    for lines in _pages(report):
        canvas = Canvas(figsize=A4)
        for row, cells in enumerate(lines):
            for x, align, words, style in cells:
                canvas.text(
                    0.08 + 0.84 * x, 0.95 - 0.9 * row / ROWS_PER_PAGE, words, ha=align, va="top", **style
                )
        yield canvas


#: Words at places of a line: place 0..1, alignment, text, style.
Line = list[tuple[float, str, str, dict[str, Any]]]

_SMALL = {"fontsize": 7.5}
#: Lines at the head of a table: its caption and the names of its columns.
_HEAD = 2


def _pages(report: Report) -> Iterator[list[Line]]:
    """Lines of each page; a table stays on one page if it fits there, else its head stands on every page."""
    page = list(_summary(report))
    for section in report.sections:
        for table in (block for block in section.blocks if isinstance(block, Table)):
            lines = list(_table_lines(table, table.caption or section.title))
            if len(page) + len(lines) > ROWS_PER_PAGE >= len(lines):
                yield page
                page = []
            page += lines
            while len(page) > ROWS_PER_PAGE:
                yield page[:ROWS_PER_PAGE]
                page = [*lines[:_HEAD], *page[ROWS_PER_PAGE:]]
            page.append([])
    yield page + [
        [(0.0, "left", line, {**_SMALL, "color": GREY})] for line in textwrap.wrap(report.footer, 130)
    ]


def _summary(report: Report) -> Iterator[Line]:
    """What stands above the tables: title, headline and facts."""
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
        yield [(k / 4, "left", fact.label, {**_SMALL, "color": GREY}) for k, fact in facts]
        yield []


def _table_lines(table: Table, caption: str) -> Iterator[Line]:
    """Caption, names and rows; columns are as wide as their longest text."""
    yield [(0.0, "left", caption, {"fontsize": 9, "fontweight": "bold"})]
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
    yield [
        (*place, head.rstrip(">"), {**_SMALL, "color": GREY})
        for place, head in zip(places, table.columns, strict=True)
    ]
    for row in rows:
        yield [
            (*place, cell.text, {**_SMALL, "color": _MOODS[cell.mood]})
            for place, cell in zip(places, row, strict=True)
        ]
