"""The report as people see it: rendered by a real browser from ``file://``, on screen and on paper."""

from __future__ import annotations

import re
import shutil
import subprocess

import numpy as np
import pytest
from browser import browser, print_out, share, show

from edl6dof.report.document import Report, Section
from edl6dof.report.figure import BLUE, GOOD, GREEN, PURPLE, VERMILION, Axis, Figure, Panel, Trace
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


def test_print_of_the_nominal_flight_is_short(written, tmp_path):
    pages = re.findall(rb"/Type /Page\b", print_out(written, tmp_path).read_bytes())
    assert 4 < len(pages) <= 12


def test_prints_on_a4_with_every_figure(written, run, tmp_path):
    if shutil.which("pdfinfo") is None or shutil.which("pdftotext") is None:
        pytest.skip(
            "no poppler-utils on this machine (Debian: apt-get install poppler-utils): the print is not read"
        )
    pdf = print_out(written, tmp_path)
    facts = subprocess.run(["pdfinfo", pdf], capture_output=True, text=True, check=True).stdout
    assert "A4" in facts
    text = " ".join(
        subprocess.run(
            ["pdftotext", "-layout", pdf, "-"], capture_output=True, text=True, check=True
        ).stdout.split()
    )
    for figure in flight_report(run).figures():
        assert figure.title in text
    assert "time since entry (s)" in text, "axis titles are drawn"
    assert run.summary["scenario_sha256"] in text
