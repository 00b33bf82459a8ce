"""A report as a PDF: pages of text and tables, then every figure, drawn by lines, two columns to a page."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator, Sequence
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from edl6dof.report.document import Report, Section, Table, Text, as_cell
from edl6dof.report.figure import Figure
from edl6dof.report.matplotlib_figure import draw, height, own_style
from edl6dof.report.palette import BAD, GOOD, GREY, INK, WARN

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

A4 = (8.27, 11.69)
ROWS_PER_PAGE = 70
#: Size of the panels on a page of figures, relative to those of a figure drawn alone.
SHRINK = 0.78
#: Margin of a page, as a share of it; inches from top to foot of its text, and between figures.
MARGIN = 0.05
ROOM, GAP = A4[1] * (1.0 - 2.0 * MARGIN), 0.12
#: Number of letters in the width of a column, and sizes of type and markers on a page of figures.
COLUMN = 76
LETTERS: Any = {"font.size": 6.0, "lines.markersize": 3.0}
#: Lines at the head of a table: its caption and the names of its columns.
_HEAD = 2
#: Letters in a line of text, and in a line of a cell of a table.
_LETTERS, _LONGEST_CELL = 130, 60
_MOODS = {"good": GOOD, "warn": WARN, "bad": BAD, "plain": INK}


def write_pdf(report: Report, path: Path) -> None:
    """Write headline and tables, then the figures, on A4 pages."""
    import matplotlib

    with own_style():
        from matplotlib.backends.backend_pdf import PdfPages

        about = {"Title": report.title, "Subject": report.headline, "CreationDate": None}
        with PdfPages(path, metadata=about) as pages:
            for lines in _pages(report):
                pages.savefig(_word_page(lines))
            with matplotlib.rc_context(LETTERS):
                for placed in figure_pages(report.figures()):
                    pages.savefig(_figure_page(placed))


class Placed(NamedTuple):
    """A figure on a page: inches from the top of the text to its top and foot, and the columns it covers."""

    figure: Figure
    top: float
    foot: float
    columns: Sequence[int]


def figure_pages(figures: Iterable[Figure]) -> Iterator[list[Placed]]:
    """Yield the figures of each page in order: wide ones across both columns, others in the shorter one."""
    page: list[Placed] = []
    feet = [0.0, 0.0]
    for figure in figures:
        columns = _columns(figure, feet)
        size = min(height(figure, SHRINK, COLUMN * len(columns)), ROOM)
        top = max(feet[column] for column in columns)
        if top + size > ROOM:
            yield page
            page, feet, top = [], [0.0, 0.0], 0.0
            columns = _columns(figure, feet)
        page.append(Placed(figure, top, top + size, columns))
        for column in columns:
            feet[column] = top + size + GAP
    if page:
        yield page


def _columns(figure: Figure, feet: Sequence[float]) -> Sequence[int]:
    return (0, 1) if figure.columns > 1 else (int(np.argmin(feet)),)


def _figure_page(placed: Sequence[Placed]) -> Canvas:
    """A page of figures."""
    from matplotlib.figure import Figure as Canvas

    canvas = Canvas(figsize=A4, layout="constrained")
    around = (MARGIN, 1.0 - 2.0 * MARGIN, MARGIN)
    text = np.asarray(canvas.subfigures(3, 3, width_ratios=around, height_ratios=around))[1, 1]
    edges = sorted({0.0, ROOM, *(edge for one in placed for edge in (one.top, one.foot))})
    ratios: Any = {"width_ratios": (1.0, GAP, 1.0), "height_ratios": np.diff(edges).tolist()}
    grid = text.add_gridspec(len(edges) - 1, 3, **ratios)
    for figure, top, foot, columns in placed:
        across = slice(2 * columns[0], 2 * columns[-1] + 1)
        part = text.add_subfigure(grid[edges.index(top) : edges.index(foot), across])
        draw(part, figure, COLUMN * len(columns))
    return canvas


class Words(NamedTuple):
    """A piece of text in a line; ``x``: place (0..1 of the width) of the side that ``align`` names."""

    x: float
    text: str
    size: float = 7.0
    colour: str = "black"
    bold: bool = False
    align: str = "left"


Line = list[Words]


def _word_page(lines: Sequence[Line]) -> Canvas:
    """A page of lines."""
    from matplotlib.figure import Figure as Canvas

    canvas = Canvas(figsize=A4)
    for row, line in enumerate(lines):
        for x, text, size, colour, bold, align in line:
            style: Any = {"fontsize": size, "color": colour, "fontweight": "bold" if bold else "normal"}
            place = 0.08 + 0.84 * x, 0.95 - 0.9 * row / ROWS_PER_PAGE
            canvas.text(*place, text, ha=align, va="top", **style)
    return canvas


def _pages(report: Report) -> Iterator[list[Line]]:
    """Lines of each page; a table that fits on one page is not split, else its head is repeated."""
    page = list(_summary(report))
    for section in report.sections:
        for lines in _blocks(section):
            begun = len(lines) if len(lines) <= ROWS_PER_PAGE else _HEAD + 1
            if len(page) + begun > ROWS_PER_PAGE:
                yield page[:ROWS_PER_PAGE]
                page = []
            page += lines
            while len(page) > ROWS_PER_PAGE:
                yield page[:ROWS_PER_PAGE]
                page = [*lines[:_HEAD], *page[ROWS_PER_PAGE:]]
            page.append([])
    yield page + [[Words(0.0, line, colour=GREY)] for line in textwrap.wrap(report.footer, _LETTERS)]


def _blocks(section: Section) -> Iterator[list[Line]]:
    """Lines of each table and paragraph; the title of the section is the caption of the first."""
    title = section.title
    for block in section.blocks:
        if isinstance(block, Table):
            yield list(_table_lines(block, block.caption or title))
        elif isinstance(block, Text):
            head = [[Words(0.0, title, 9.0, bold=True)]] if title else []
            yield head + [[Words(0.0, line)] for line in textwrap.wrap(block.words, _LETTERS)]
        else:
            continue
        title = ""


def _summary(report: Report) -> Iterator[Line]:
    """Title, headline and facts above the tables."""
    yield [Words(0.0, report.title, 17.0, bold=True)]
    yield []
    yield [Words(0.0, report.subtitle, 8.0, GREY)]
    yield [Words(0.0, report.headline, 10.0, _MOODS[report.mood], bold=True)]
    yield []
    for first in range(0, len(report.facts), 4):
        facts = list(enumerate(report.facts[first : first + 4]))
        yield [Words(k / 4, fact.value, 9.5, _MOODS[fact.mood], bold=True) for k, fact in facts]
        yield [Words(k / 4, fact.label, colour=GREY) for k, fact in facts]
        yield []


def _table_lines(table: Table, caption: str) -> Iterator[Line]:
    """Caption, names and rows; columns are as wide as their longest text, which is wrapped if it is long."""
    yield [Words(0.0, caption, 9.0, bold=True)]
    rows = [[as_cell(item) for item in row] for row in table.rows]
    texts = [[textwrap.wrap(cell.text, _LONGEST_CELL) or [""] for cell in row] for row in rows]
    heads = [head.rstrip(">") for head in table.columns]
    widths = [
        max(len(head), *(len(part) for row in texts for part in row[k]), 0) + 3
        for k, head in enumerate(heads)
    ]
    total = max(sum(widths), 110)
    starts = np.concatenate([[0], np.cumsum(widths)]) / total

    def line(texts: Iterable[str], colours: Iterable[str]) -> Line:
        return [
            Words(starts[k + 1] - 2 / total, text, colour=colour, align="right")
            if table.columns[k].endswith(">")
            else Words(starts[k], text, colour=colour)
            for k, (text, colour) in enumerate(zip(texts, colours, strict=True))
        ]

    yield line(heads, [GREY] * len(heads))
    for row, parts in zip(rows, texts, strict=True):
        for part in zip_longest(*parts, fillvalue=""):
            yield line(part, (_MOODS[cell.mood] for cell in row))
