"""The report as people see it: rendered by a real browser from ``file://``, on screen and on paper."""

from __future__ import annotations

import re
import shutil
import subprocess

import numpy as np
import pytest
from browser import browser, print_out, share, show

from edl6dof.report.dark import DARK
from edl6dof.report.document import Report, Section
from edl6dof.report.figure import (
    BLUE,
    GOOD,
    GREEN,
    PAPER,
    PURPLE,
    VERMILION,
    Axis,
    Figure,
    Mark,
    Panel,
    Trace,
)
from edl6dof.report.flight.build import flight_report
from edl6dof.report.flight.overlay import comparison_report, darker
from edl6dof.report.page import page


@pytest.fixture(scope="module")
def written(run, tmp_path_factory):
    browser()
    path = tmp_path_factory.mktemp("page") / "report.html"
    path.write_text(page(flight_report(run)), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def shown(written, tmp_path_factory):
    return show(written, tmp_path_factory.mktemp("look"))


def test_console_of_the_browser_is_heard(tmp_path):
    (tmp_path / "bad.html").write_text("<script>console.error('planted'); nowhere();</script>")
    said = "\n".join(show(tmp_path / "bad.html", tmp_path, 300, 300).console)
    assert "planted" in said and "nowhere" in said


def test_no_error_on_the_console_and_no_call_to_the_network(shown):
    assert shown.console == []


def test_two_flights_compared_are_painted(run, tmp_path):
    browser()
    (tmp_path / "two.html").write_text(page(comparison_report(run, run)), encoding="utf-8")
    seen = show(tmp_path / "two.html", tmp_path)
    assert seen.console == []
    for colour in (BLUE, darker(BLUE)):
        assert share(seen.pixels, colour) * seen.pixels.shape[0] * seen.pixels.shape[1] > 600, colour


def test_headline_curves_and_phases_are_painted(shown):
    assert share(shown.pixels[:400], GOOD) > 0.01, "the green headline"
    for colour in (BLUE, VERMILION, GREEN, PURPLE):
        assert share(shown.pixels, colour) * shown.pixels.shape[0] * shown.pixels.shape[1] > 600, colour


def test_a_curve_stands_where_its_numbers_say(tmp_path):
    """A straight line from corner to corner must run through the middle of its panel."""
    browser()
    line = Trace(np.linspace(0.0, 1.0, 50), np.linspace(0.0, 1.0, 50), colour=BLUE, width=4.0)
    figure = Figure(
        "one", "one", [Panel(Axis("x (m)", (0.0, 1.0)), Axis("y (m)", (0.0, 1.0)), [line])], height=400
    )
    (tmp_path / "one.html").write_text(
        page(Report("one", "fine", "good", sections=[Section("s", "s", [figure])])), encoding="utf-8"
    )
    pixels = show(tmp_path / "one.html", tmp_path, 1000, 900).pixels
    rows, columns = np.nonzero(np.max(np.abs(pixels.astype(int) - (0, 0x72, 0xB2)), axis=-1) < 20)
    assert len(rows) > 500
    slope, _ = np.polyfit(columns, rows, 1)
    height, width = np.ptp(rows), np.ptp(columns)
    assert height == pytest.approx(400, abs=6) and width > 500
    assert slope == pytest.approx(-height / width, rel=0.02)
    middle = rows[np.abs(columns - columns.min() - width / 2) < 2]
    assert middle.mean() == pytest.approx(rows.min() + height / 2, abs=4)


#: Says on the console which words of a plot lie over each other or leave it, and how many there are.
MEASURE = """<script>
const wait = setInterval(() => {
  if (!document.documentElement.dataset.drawn) return;
  clearInterval(wait);
  const kinds = ".textpoint text, text.annotation-text, .legendtext, .xtick text, .ytick text, [class^=g-x] text, [class^=g-y] text";
  let count = 0;
  for (const plot of document.querySelectorAll("div.plot")) {
    const edge = plot.getBoundingClientRect();
    const boxes = [...plot.querySelectorAll(kinds)].map((text) => [text.textContent, text.getBoundingClientRect()])
      .filter(([words, box]) => words && box.width > 0);
    count += boxes.length;
    boxes.forEach(([words, a], i) => {
      if (a.left < edge.left - 1 || a.right > edge.right + 1) console.log(`OUTSIDE ${plot.dataset.figure}: ${words}`);
      for (const [others, b] of boxes.slice(0, i)) {
        const wide = Math.min(a.right, b.right) - Math.max(a.left, b.left);
        const high = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
        if (wide > 2 && high > 3) console.log(`OVER ${plot.dataset.figure}: ${words} | ${others}`);
      }
    });
  }
  console.log(`MEASURED ${count}`);
}, 100);
</script></body>"""  # noqa: E501


#: Says which tables are wider than their place, and how many there are.
TABLES = """<script>addEventListener("load", () => {
  for (const place of document.querySelectorAll("div.table"))
    if (place.scrollWidth > place.clientWidth + 1) console.log("CUT " + place.textContent.slice(0, 40));
  console.log("LOOKED " + document.querySelectorAll("div.table").length);
});</script></body>"""


def in_the_way(shown) -> list[str]:
    """What a page with the measuring script says."""
    said = " ".join(shown.console)
    assert int(re.search(r"MEASURED (\d+)", said)[1]) > 10
    return re.findall(r"(?:OVER|OUTSIDE) [^\"]*", said)


def words_in_the_way(html: str, place, width: int) -> list[str]:
    (place / "measured.html").write_text(html.replace("</body>", MEASURE), encoding="utf-8")
    return in_the_way(show(place / "measured.html", place, width, 1000))


@pytest.fixture(scope="module")
def windows(written, tmp_path_factory):
    """The measured page in a wide window, of a reader who prefers it dark, and in a narrow one."""
    place = tmp_path_factory.mktemp("windows")
    html = written.read_text(encoding="utf-8")
    for script in (MEASURE, TABLES):
        html = html.replace("</body>", script)
    (place / "measured.html").write_text(html, encoding="utf-8")
    return {
        "wide": show(place / "measured.html", place, 1100, 2500, "--blink-settings=preferredColorScheme=0"),
        "narrow": show(place / "measured.html", place, 500, 1000),
    }


@pytest.mark.parametrize("window", ["wide", "narrow"])
def test_words_of_the_plots_do_not_cover_each_other(windows, window):
    assert in_the_way(windows[window]) == []


def test_words_over_each_other_are_heard_of(tmp_path):
    browser()
    labels = Trace(np.arange(12.0) / 100.0, np.zeros(12), "", "points", labels=["word"] * 12)
    panel = Panel(Axis("x (m)", (0.0, 10.0)), Axis("y (m)"), [labels])
    report = Report("t", "h", "good", sections=[Section("s", "S", [Figure("f", "F", [panel])])])
    assert any(said.startswith("OVER f: word") for said in words_in_the_way(page(report), tmp_path, 600))


@pytest.mark.parametrize("width", [1100, 500])
def test_words_of_lines_and_points_near_each_other_stand_apart(tmp_path, width):
    browser()
    t = np.linspace(0.0, 500.0, 101)
    marks = [Mark("x", 200.0, "fault"), Mark("x", 200.4, "diagnosed"), Mark("x", 300.0, "parachute")]
    places = Trace(
        np.array([400.0, 406.0, 412.0]), np.full(3, 0.5), "events", "points", labels=("one", "two", "three")
    )
    panel = Panel(Axis("time (s)"), Axis("height (m)"), [Trace(t, np.sin(t / 50.0)), places], marks=marks)
    report = Report("t", "h", "good", sections=[Section("s", "S", [Figure("f", "F", [panel])])])
    assert words_in_the_way(page(report), tmp_path, width) == []


def test_tables_are_not_cut_in_a_narrow_window(windows):
    said = " ".join(windows["narrow"].console)
    assert int(re.search(r"LOOKED (\d+)", said)[1]) >= 5 and "CUT" not in said


def test_page_is_dark_where_the_reader_prefers_it(windows):
    pixels = windows["wide"].pixels
    assert np.median(pixels) < 40
    assert share(pixels, PAPER) < 0.001 < share(pixels, DARK[PAPER])


@pytest.fixture(scope="module")
def printed(written, tmp_path_factory):
    return print_out(written, tmp_path_factory.mktemp("print"))


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
