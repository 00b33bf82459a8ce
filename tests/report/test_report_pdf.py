"""The word pages of the PDF: whole tables where they fit, the head of a longer one on each of its pages."""

from __future__ import annotations

from edl6dof.report.document import Report, Section, Table
from edl6dof.report.pdf import ROWS_PER_PAGE, _pages


def words(lines):
    return [line[0][2] if line else "" for line in lines]


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
        assert len(mine) == {"long": 4}.get(name, 1)
        for page in mine:
            assert page[page.index(name) + 1 :][:1] == ["name"]
    assert pages[0][0] == "title" and pages[-1][-1] == "the end"
