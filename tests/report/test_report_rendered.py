"""The report as people see it: rendered by a real browser from ``file://``, on screen and on paper.

One browser shows all pages, and the report three times: wide, on paper, and with few of its figures narrow
in the dark.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from browser import Shown, share, show
from live_page import NO_GL, opened

from edl6dof.report.document import Report, Section
from edl6dof.report.figure import Axis, Figure, Mark, Panel, Trace
from edl6dof.report.flight.flight_report import flight_report
from edl6dof.report.flight.overlay import comparison_report, darker
from edl6dof.report.page import page
from edl6dof.report.palette import BLUE, DARK, GOOD, GREEN, PAPER, PURPLE, VERMILION


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    """A browser, which draws nothing again for the screen once it has printed."""
    with opened("about:blank", tmp_path_factory.mktemp("profile"), options=NO_GL) as page:
        stop = "addEventListener('afterprint', (event) => event.stopImmediatePropagation(), true)"
        page.ask("Page.addScriptToEvaluateOnNewDocument", source=stop)
        yield page


class Window(NamedTuple):
    """The report in a window: what is seen, words that lie over each other or leave their plot, how many
    words and tables were looked at, tables that are cut.
    """

    shown: Shown
    in_the_way: list[str]
    words: int
    tables: int
    cut: list[str]


@pytest.fixture(scope="module")
def written(run, browser, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "report.html"
    path.write_text(page(flight_report(run)), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def wide(written, browser):
    """In a wide window; and the print of it, PDF."""
    return window(browser, written, 1100, 6000), browser.printed()


@pytest.fixture(scope="module", params=["few figures", pytest.param("whole", marks=pytest.mark.long)])
def narrow(request, run, browser, tmp_path_factory):
    """In a narrow window of a reader who prefers it dark, with the first figure of each section or whole."""
    report = flight_report(run)
    if request.param == "few figures":
        report = replace(report, sections=[_of_few_figures(section) for section in report.sections])
    path = tmp_path_factory.mktemp("narrow") / "report.html"
    path.write_text(page(report), encoding="utf-8")
    return window(browser, path, 500, 2500, dark=True)


def _of_few_figures(section: Section) -> Section:
    figures = (block for block in section.blocks if isinstance(block, Figure))
    first = next(figures, None)
    few = [block for block in section.blocks if block is first or not isinstance(block, Figure)]
    return replace(section, blocks=few)


@pytest.fixture(scope="module")
def shown(wide):
    return wide[0].shown


def test_console_of_the_browser_is_heard(browser, tmp_path):
    script = "<script>console.error('planted'); console.log('remark'); nowhere();</script>"
    (tmp_path / "bad.html").write_text(f"<img src='http://127.0.0.1:9/far.png'>{script}")
    said = "\n".join(show(browser, tmp_path / "bad.html", 300, 300).console)
    assert all(word in said for word in ("planted", "remark", "nowhere", "net::ERR")), said


def test_no_error_on_the_console_and_no_call_to_the_network(shown):
    assert shown.console == []


def test_two_flights_compared_are_painted(run, browser, tmp_path):
    """The first of its figures: the others are drawn by what draws the report of one flight."""
    whole = comparison_report(run, run)
    drawn = [part for part in whole.sections if any(isinstance(block, Figure) for block in part.blocks)]
    few = replace(whole, sections=drawn[:2])
    (tmp_path / "two.html").write_text(page(few), encoding="utf-8")
    seen = show(browser, tmp_path / "two.html")
    assert seen.console == []
    for colour in (BLUE, darker(BLUE)):
        assert share(seen.pixels, colour) * seen.pixels.shape[0] * seen.pixels.shape[1] > 600, colour


def test_headline_curves_and_phases_are_painted(shown):
    assert share(shown.pixels[:400], GOOD) > 0.01, "the green headline"
    for colour in (BLUE, VERMILION, GREEN, PURPLE):
        assert share(shown.pixels, colour) * shown.pixels.shape[0] * shown.pixels.shape[1] > 600, colour


def test_a_curve_stands_where_its_numbers_say(browser, tmp_path):
    """A straight line from corner to corner must run through the middle of its panel."""
    line = Trace(np.linspace(0.0, 1.0, 50), np.linspace(0.0, 1.0, 50), colour=BLUE, width=4.0)
    figure = Figure(
        "one", "one", [Panel(Axis("x (m)", (0.0, 1.0)), Axis("y (m)", (0.0, 1.0)), [line])], height=400
    )
    (tmp_path / "one.html").write_text(
        page(Report("one", "fine", "good", sections=[Section("s", "s", [figure])])), encoding="utf-8"
    )
    pixels = show(browser, tmp_path / "one.html", 1000, 900).pixels
    rows, columns = np.nonzero(np.max(np.abs(pixels.astype(int) - (0, 0x72, 0xB2)), axis=-1) < 20)
    assert len(rows) > 500
    slope, _ = np.polyfit(columns, rows, 1)
    height, width = np.ptp(rows), np.ptp(columns)
    assert height == pytest.approx(400, abs=6) and width > 500
    assert slope == pytest.approx(-height / width, rel=0.02)
    middle = rows[np.abs(columns - columns.min() - width / 2) < 2]
    assert middle.mean() == pytest.approx(rows.min() + height / 2, abs=4)


#: Words of plots that lie over each other or leave it, and how many there are.
MEASURE = """(() => {
  const kinds = ".textpoint text, text.annotation-text, .legendtext, .xtick text, .ytick text, [class^=g-x] text, [class^=g-y] text";
  let count = 0;
  const found = [];
  for (const plot of document.querySelectorAll("div.plot")) {
    const edge = plot.getBoundingClientRect();
    const boxes = [...plot.querySelectorAll(kinds)].map((text) => [text.textContent, text.getBoundingClientRect()])
      .filter(([words, box]) => words && box.width > 0);
    count += boxes.length;
    boxes.forEach(([words, a], i) => {
      if (a.left < edge.left - 1 || a.right > edge.right + 1) found.push(`OUTSIDE ${plot.dataset.figure}: ${words}`);
      for (const [others, b] of boxes.slice(0, i)) {
        const wide = Math.min(a.right, b.right) - Math.max(a.left, b.left);
        const high = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
        if (wide > 2 && high > 3) found.push(`OVER ${plot.dataset.figure}: ${words} | ${others}`);
      }
    });
  }
  return [found, count];
})()"""  # noqa: E501


#: How many tables there are, and those wider than their place.
TABLES = """(() => {
  const places = [...document.querySelectorAll("div.table")];
  const cut = places.filter((place) => place.scrollWidth > place.clientWidth + 1);
  return [places.length, cut.map((place) => place.textContent.slice(0, 40))];
})()"""


def window(browser, path, width, height, *, dark=False) -> Window:
    """A page in a window."""
    shown = show(browser, path, width, height, dark=dark)
    return Window(shown, *browser.value(MEASURE), *browser.value(TABLES))


def words_in_the_way(browser, report, place, width: int) -> list[str]:
    (place / "measured.html").write_text(page(report), encoding="utf-8")
    found = window(browser, place / "measured.html", width, 1000)
    assert found.words > 10
    return found.in_the_way


def test_words_of_the_plots_do_not_cover_each_other(wide):
    assert wide[0].words > 100 and wide[0].in_the_way == []


def test_words_of_the_plots_do_not_cover_each_other_in_a_narrow_window(narrow):
    assert narrow.words > 50 and narrow.in_the_way == []


def test_words_over_each_other_are_heard_of(browser, tmp_path):
    labels = Trace(np.arange(12.0) / 100.0, np.zeros(12), "", "points", labels=["word"] * 12)
    panel = Panel(Axis("x (m)", (0.0, 10.0)), Axis("y (m)"), [labels])
    report = Report("t", "h", "good", sections=[Section("s", "S", [Figure("f", "F", [panel])])])
    assert any(said.startswith("OVER f: word") for said in words_in_the_way(browser, report, tmp_path, 600))


@pytest.mark.parametrize("width", [1100, 500])
def test_words_of_lines_and_points_near_each_other_stand_apart(browser, tmp_path, width):
    t = np.linspace(0.0, 500.0, 101)
    marks = [Mark("x", 200.0, "fault"), Mark("x", 200.4, "diagnosed"), Mark("x", 300.0, "parachute")]
    places = Trace(
        np.array([400.0, 406.0, 412.0]), np.full(3, 0.5), "events", "points", labels=("one", "two", "three")
    )
    panel = Panel(Axis("time (s)"), Axis("height (m)"), [Trace(t, np.sin(t / 50.0)), places], marks=marks)
    report = Report("t", "h", "good", sections=[Section("s", "S", [Figure("f", "F", [panel])])])
    assert words_in_the_way(browser, report, tmp_path, width) == []


def test_tables_are_not_cut_in_a_narrow_window(narrow):
    assert narrow.tables >= 5 and narrow.cut == []


def test_page_is_dark_where_the_reader_prefers_it(narrow):
    pixels = narrow.shown.pixels
    assert np.median(pixels) < 40
    assert share(pixels, PAPER) < 0.001 < share(pixels, DARK[PAPER])


@pytest.fixture(scope="module")
def printed(wide, tmp_path_factory):
    path = tmp_path_factory.mktemp("print") / "page.pdf"
    path.write_bytes(wide[1])
    return path


def test_print_of_the_nominal_flight_is_short(printed):
    pages = re.findall(rb"/Type /Page\b", printed.read_bytes())
    assert 4 < len(pages) <= 12


def test_prints_on_a4_with_every_figure(printed, run):
    if shutil.which("pdfinfo") is None or shutil.which("pdftotext") is None:
        pytest.skip(
            "no poppler-utils on this machine (Debian: apt-get install poppler-utils): the print is not read"
        )
    facts = subprocess.run(["pdfinfo", printed], capture_output=True, text=True, check=True).stdout
    assert "A4" in facts
    text = " ".join(
        subprocess.run(
            ["pdftotext", "-layout", printed, "-"], capture_output=True, text=True, check=True
        ).stdout.split()
    )
    for figure in flight_report(run).figures():
        assert figure.title in text
    assert "time since entry (s)" in text, "axis titles are drawn"
    assert run.summary["scenario_sha256"] in text
