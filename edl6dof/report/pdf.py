"""A report as a PDF: pages of text and tables, then every figure, drawn by lines, two columns to a page."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, zip_longest
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
#: Lines of a page, and those that the picture on the first page takes.
ROWS_PER_PAGE, PICTURE_ROWS = 82, 23
#: Sizes of panels on a page of figures, relative to those of a figure drawn alone, the preferred one first.
SHRINK = (0.78, 0.74, 0.70, 0.66)
#: Largest factor by which the figures of a page are stretched to fill it.
STRETCH = 1.3
#: Largest number of figures that a later one may overtake to fill a page.
AHEAD = 6
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
            for number, lines in enumerate(_pages(report)):
                pages.savefig(_word_page(lines, None if number else report.picture))
            with matplotlib.rc_context(LETTERS):
                for placed in figure_pages(one for one in report.figures() if one is not report.picture):
                    pages.savefig(_figure_page(placed))


class Placed(NamedTuple):
    """A figure on a page: inches from the top of the text to its top and foot, and the columns it covers."""

    figure: Figure
    top: float
    foot: float
    columns: Sequence[int]


def figure_pages(figures: Iterable[Figure]) -> list[list[Placed]]:
    """Return the figures of each page, on the fewest pages that one of the sizes needs."""
    every = list(figures)
    return min((_laid_out(every, shrink) for shrink in SHRINK), key=len)


def _laid_out(figures: Sequence[Figure], shrink: float) -> list[list[Placed]]:
    """Figures of each page: wide ones across both columns, others in the shorter one.

    Figures that do not fit on a page wait for the next one; up to ``AHEAD`` may be overtaken.
    """
    waiting, pages = list(figures), list[list[Placed]]()
    while waiting:
        page, feet, left = list[Placed](), [0.0, 0.0], list[Figure]()
        for figure in waiting:
            columns = (0, 1) if figure.columns > 1 else (int(np.argmin(feet)),)
            size = min(height(figure, shrink, COLUMN * len(columns)), ROOM)
            top = max(feet[column] for column in columns)
            if len(left) >= AHEAD or top + size > ROOM:
                left.append(figure)
                continue
            page.append(Placed(figure, top, top + size, columns))
            for column in columns:
                feet[column] = top + size + GAP
        factor = min(ROOM / max(one.foot for one in page), STRETCH)
        pages.append([one._replace(top=factor * one.top, foot=factor * one.foot) for one in page])
        waiting = left
    return pages


def _figure_page(placed: Sequence[Placed]) -> Canvas:
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


def _word_page(lines: Sequence[Line], picture: Figure | None) -> Canvas:
    """A page of lines, and a picture in the room that is left for it below the summary."""
    from matplotlib.figure import Figure as Canvas

    canvas = Canvas(figsize=A4, layout="constrained")
    if picture is not None:
        top = next(k for k in range(len(lines)) if lines[k : k + PICTURE_ROWS] == [[]] * PICTURE_ROWS)
        rows = np.array([top, PICTURE_ROWS, ROWS_PER_PAGE - top - PICTURE_ROWS])
        share = [0.05 + 0.9 * rows[0] / ROWS_PER_PAGE, *(0.9 * rows[1:] / ROWS_PER_PAGE + [0.0, 0.05])]
        grid = canvas.add_gridspec(3, 3, height_ratios=share, width_ratios=(0.08, 0.84, 0.08))
        draw(canvas.add_subfigure(grid[1, 1]), picture)
    for row, line in enumerate(lines):
        for x, text, size, colour, bold, align in line:
            style: Any = {"fontsize": size, "color": colour, "fontweight": "bold" if bold else "normal"}
            place = 0.08 + 0.84 * x, 0.95 - 0.9 * row / ROWS_PER_PAGE
            canvas.text(*place, text, ha=align, va="top", **style)
    return canvas


def _pages(report: Report) -> Iterator[list[Line]]:
    """Lines of each page, which takes the next tables that fit; a longer one is split, its head repeated."""
    page = list(_summary(report))
    waiting = [lines for section in report.sections for lines in _blocks(section)]
    while waiting:
        left = list[list[Line]]()
        for lines in waiting:
            begun = len(lines) if len(lines) <= ROWS_PER_PAGE else _HEAD + 1
            if len(page) + begun > ROWS_PER_PAGE:
                left.append(lines)
                continue
            page += lines
            while len(page) > ROWS_PER_PAGE:
                yield page[:ROWS_PER_PAGE]
                page = [*lines[:_HEAD], *page[ROWS_PER_PAGE:]]
            page.append([])
        if left:
            yield page[:ROWS_PER_PAGE]
            page = []
        waiting = left
    yield page + [[Words(0.0, line, colour=GREY)] for line in textwrap.wrap(report.footer, _LETTERS)]


def _blocks(section: Section) -> list[list[Line]]:
    """Lines of each table with the paragraphs below it; the section's title is the caption of the first."""
    found = list[list[Line]]()
    for block in section.blocks:
        title = "" if found else section.title
        if isinstance(block, Table):
            found.append(list(_table_lines(block, block.caption or title)))
        elif isinstance(block, Text):
            words: list[Line] = [[Words(0.0, line)] for line in textwrap.wrap(block.words, _LETTERS)]
            if found:
                found[-1] += [[], *words]
            else:
                found.append([[Words(0.0, title, 9.0, bold=True)], *words])
    return found


def _summary(report: Report) -> Iterator[Line]:
    """Title, headline and facts above the tables."""
    yield [Words(0.0, report.title, 17.0, bold=True)]
    yield []
    yield [Words(0.0, report.subtitle, 8.0, GREY)]
    for line in textwrap.wrap(report.headline, 80):
        yield [Words(0.0, line, 10.0, _MOODS[report.mood], bold=True)]
    yield []
    across = 3 if len(report.facts) % 4 else 4
    for first in range(0, len(report.facts), across):
        facts = list(enumerate(report.facts[first : first + across]))
        yield [Words(k / across, fact.value, 9.5, _MOODS[fact.mood], bold=True) for k, fact in facts]
        yield [Words(k / across, fact.label, colour=GREY) for k, fact in facts]
        yield []
    if report.picture is not None:
        yield from [[]] * PICTURE_ROWS


def _table_lines(table: Table, caption: str) -> Iterator[Line]:
    """Caption, names and rows; columns are as wide as their longest text, which is wrapped if it is long."""
    yield [Words(0.0, caption, 9.0, bold=True)]
    rows = [[as_cell(item) for item in row] for row in table.rows]
    texts = [[textwrap.wrap(cell.text, _LONGEST_CELL) or [""] for cell in row] for row in rows]
    heads = [head.rstrip(">") for head in table.columns]
    widths = [max(map(len, (head, *chain(*(row[k] for row in texts))))) + 3 for k, head in enumerate(heads)]
    total = max(sum(widths), 110)
    starts = np.concatenate([[0], np.cumsum(widths)]) / total

    def line(texts: Iterable[str], colours: Iterable[str]) -> Line:
        found: Line = []
        for k, (text, colour) in enumerate(zip(texts, colours, strict=True)):
            numbers = table.columns[k].endswith(">")
            place = starts[k + 1] - 2 / total if numbers else starts[k]
            found.append(Words(place, text, colour=colour, align="right" if numbers else "left"))
        return found

    yield line(heads, [GREY] * len(heads))
    for row, parts in zip(rows, texts, strict=True):
        for part in zip_longest(*parts, fillvalue=""):
            yield line(part, (_MOODS[cell.mood] for cell in row))
