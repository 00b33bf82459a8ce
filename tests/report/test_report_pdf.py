"""The word pages of the PDF: whole tables where they fit, the head of a longer one on each of its pages."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from edl6dof.report.document import Report, Section, Table, Text
from edl6dof.report.figure import Axis, Figure, Panel, Trace
from edl6dof.report.flight.flight_report import flight_report
from edl6dof.report.pdf import AHEAD, ROOM, ROWS_PER_PAGE, _pages, figure_pages


def words(lines):
    return [line[0].text if line else "" for line in lines]


def test_tables_are_not_torn():
    sizes = {"short": 20, "fits": 40, "long": 130, "last": 5}
    tables = [Table(["name"], [[f"{name} {k}"] for k in range(n)], name) for name, n in sizes.items()]
    report = Report("title", "headline", "good", sections=[Section("s", "S", tables)], footer="the end")
    pages = [words(lines) for lines in _pages(report)]
    assert max(map(len, pages)) <= ROWS_PER_PAGE
    for name, n in sizes.items():
        rows = [[word for word in page if word.startswith(f"{name} ")] for page in pages]
        assert sum(rows, []) == [f"{name} {k}" for k in range(n)]
        mine = [page for page, found in zip(pages, rows, strict=True) if found]
        assert len(mine) == {"long": 3}.get(name, 1)
        for page in mine:
            assert page[page.index(name) + 1 :][:1] == ["name"]
    assert pages[0][0] == "title" and pages[-1][-1] == "the end"


def test_paragraphs_and_long_cells_are_wrapped():
    blocks = [Text("word " * 60), Table(["name", "n>"], [["long " * 30, "7"], ["short", "8"]])]
    report = Report("title", "headline", "good", sections=[Section("s", "Section", blocks)], footer="the end")
    (page,) = _pages(report)
    found = [[word.text for word in line] for line in page if line]
    assert sum(line == ["Section"] for line in found) == 1  # above the paragraph, not again above the table
    assert max(len(text) for line in found for text in line) <= 130
    begun = next(k for k, line in enumerate(found) if line[0].startswith("long "))
    assert [line[1] for line in found[begun : begun + 4]] == ["7", "", "", "8"]
    assert " ".join(line[0] for line in found[begun : begun + 3]).split() == ["long"] * 30


def test_a_long_headline_is_broken_into_lines():
    lines = words(next(iter(_pages(Report("title", "crashed at a speed " * 9, "bad")))))
    assert max(map(len, lines)) <= 80 and sum(line.count("crashed") for line in lines) == 9


def test_figures_fill_two_columns_and_those_side_by_side_both():
    line = Trace(np.arange(3.0), np.arange(3.0))
    panel = Panel(Axis("x (m)"), Axis("y (m)"), [line])
    figures = [Figure(f"f{k}", "one", [panel], height=150 + 40 * (k % 3)) for k in range(20)]
    figures.insert(7, Figure("wide", "wide", [panel] * 3, columns=3))
    pages = figure_pages(figures)
    order = [figures.index(placed.figure) for page in pages for placed in page]
    assert sorted(order) == list(range(len(figures)))
    assert max(place - k for k, place in enumerate(order)) <= AHEAD, "none waits for long"
    assert len(pages) < 6
    for page in pages[:-1]:
        assert max(placed.foot for placed in page) > 0.9 * ROOM, "the page is filled"
    for page in pages:
        assert max(placed.foot for placed in page) <= ROOM
        for one, two in combinations(page, 2):
            apart = one.foot <= two.top or two.foot <= one.top
            assert apart or not set(one.columns) & set(two.columns)
    (wide,) = (placed for page in pages for placed in page if placed.figure.key == "wide")
    assert tuple(wide.columns) == (0, 1)


def test_pdf_of_the_nominal_flight_is_short(run):
    """By its pages alone, which test_plot_compare.py and failed flights draw."""
    report = flight_report(run)
    words, drawn = list(_pages(report)), list(figure_pages(report.figures()))
    assert len(words) >= 2 and len(drawn) >= 3
    assert len(words) + len(drawn) <= 10
    for page in drawn:
        covered = sum(len(placed.columns) * (placed.foot - placed.top) for placed in page) / (2.0 * ROOM)
        assert covered > 0.6, "no page is half empty"
    for page in words[:-1]:
        assert len(page) > 0.8 * ROWS_PER_PAGE
