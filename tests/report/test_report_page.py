"""The report as a file: what a browser is given, against the telemetry it was made from."""

from __future__ import annotations

import base64
import json
import math
import re

import numpy as np
import plotly.graph_objects as go
import pytest

from edl6dof.config.errors import ConfigError
from edl6dof.report.document import Report, Section, Table, Text, significant
from edl6dof.report.figure import Axis, Band, Figure, Mark, Panel, Trace, thinned
from edl6dof.report.flight.flight_report import flight_report
from edl6dof.report.page import drawing, page, plotly_figure
from edl6dof.runs.files import atomic_file


@pytest.fixture(scope="module")
def report(run):
    return flight_report(run)


@pytest.fixture(scope="module")
def html(report):
    return page(report)


def unpacked(values) -> np.ndarray:
    if isinstance(values, dict):
        return np.frombuffer(base64.b64decode(values["bdata"]), "<f4").astype(float)
    return np.array([np.nan if value is None else value for value in values], float)


def test_every_figure_obeys_plotlys_own_schema(report):
    for figure in report.figures():
        go.Figure(plotly_figure(figure))  # raises for any property plotly does not know


def test_page_carries_the_drawings_unharmed(report, html):
    found = re.search(r'<script type="application/json" id="figure-data">(.*?)</script>', html, re.DOTALL)
    assert json.loads(found[1]) == {figure.key: drawing(figure) for figure in report.figures()}


def test_page_refers_to_nothing_outside_itself(html):
    assert not re.findall(r"(?:src|href)\s*=\s*['\"](?!#)", html)
    assert "default-src 'none'" in html


def test_page_is_small_enough_to_be_mailed(html):
    assert len(html.encode()) < 6_000_000


def test_outcome_limits_and_published_figures_are_on_the_page(run, html):
    assert run.summary["outcome"] in html
    for limit in run.summary["limits"]:
        assert limit["name"] in html
    for event in run.events[:-1]:
        assert f"{event['t_s']:.2f}" in html


def test_altitude_is_drawn_as_telemetry_has_it(run, report):
    overview = plotly_figure(next(figure for figure in report.figures() if figure.key == "overview"))
    curve = next(trace for trace in overview["data"] if trace["name"] == "above the ellipsoid")
    t, altitude = unpacked(curve["x"]), unpacked(curve["y"])
    assert altitude == pytest.approx(np.interp(t, run.t, run["truth.altitude_m"]) / 1e3, abs=0.02)
    assert t[0] == run.t[0] and t[-1] == pytest.approx(run.t[-1], abs=1e-3)


#: Figure, place of the panel, event since which and until which the peak counts, and the figures of merit.
PEAKS = (
    ("overview", 2, "", "", 1e-3, ("peak_dynamic_pressure_pa",)),
    ("overview", 3, "", "mortar", 1.0, ("peak_load_g0",)),
    ("overview", 3, "mortar", "backshell", 1.0, ("max_load_parachute_g0",)),
    ("overview", 4, "", "", 1.0, ("peak_heat_flux_w_cm2",)),
    ("inflation", 0, "", "", 1e-3, ("max_riser_tension_n",)),
    ("inflation", 1, "", "", 1.0, ("max_load_parachute_g0",)),
    ("bank", 1, "", "", 1.0, ("max_bank_rate_deg_s",)),
    ("rates", slice(0, 3), "mortar", "backshell", 1.0, ("max_rate_parachute_deg_s",)),
    ("rates", slice(0, 3), "ignition", "touchdown", 1.0, ("max_rate_powered_deg_s",)),
    (
        "disturbance_torque",
        slice(0, 3),
        "ignition",
        "touchdown",
        1.0,
        ("max_disturbance_torque_nm", "max_estimated_torque_nm"),
    ),
)


@pytest.mark.parametrize("key, panels, since, until, factor, names", PEAKS)
def test_the_largest_value_drawn_is_the_peak_of_the_flight(
    run, report, key, panels, since, until, factor, names
):
    figure = next(figure for figure in report.figures() if figure.key == key)
    some = figure.panels[panels] if isinstance(panels, slice) else [figure.panels[panels]]
    first, last = run.when.get(since, -np.inf), run.when.get(until, np.inf)
    drawn, pixel = 0.0, 0.0
    for panel in some:
        for trace in map(thinned, panel.traces):
            inside = (trace.x >= first) & (trace.x <= last)
            drawn = max(drawn, np.max(np.abs(trace.y[inside]), initial=0.0))
            pixel = max(pixel, np.nanmax(trace.y) - np.nanmin(trace.y)) if len(trace.y) else pixel
    lost = pixel / 4000 if since or until else 1e-12  # of another peak than the highest of its panel
    assert drawn == pytest.approx(max(run.summary["figures"][name] for name in names) * factor, abs=lost)


def test_thinning_keeps_a_lone_peak_and_the_gaps():
    rng = np.random.default_rng(1)
    t = np.linspace(0.0, 100.0, 50_001)
    y = np.sin(t) + 0.1 * rng.normal(size=len(t))
    y[31_234] = 7.5
    y[10_000:20_000] = np.nan
    few = thinned(Trace(t, y), 3000)
    assert len(few.x) < 3200
    assert np.nanmax(few.y) == 7.5 and t[31_234] in few.x and np.nanmin(few.y) == np.nanmin(y)
    assert not np.any((few.x > t[10_000]) & (few.x < t[19_999]) & np.isfinite(few.y))
    assert np.isnan(few.y).any(), "the gap stays one"


def test_a_smooth_curve_is_drawn_as_all_its_rows_would_be():
    t = np.linspace(0.0, 100.0, 50_001)
    y = np.exp(-0.1 * t) * np.sin(3.0 * t)
    few = thinned(Trace(t, y))
    assert len(few.x) < 4000
    assert np.abs(np.interp(t, few.x, few.y) - y).max() < np.ptp(y) / 4000


def test_a_curve_in_a_plane_keeps_every_bend():
    turn = np.linspace(0.0, 40.0 * np.pi, 20_001)
    x, y = turn * np.cos(turn), turn * np.sin(turn)
    few = thinned(Trace(x, y))
    kept = np.isin(x, few.x)
    drawn = [np.interp(np.arange(len(x)), np.flatnonzero(kept), way[kept]) for way in (x, y)]
    assert np.hypot(drawn[0] - x, drawn[1] - y).max() < 2.0 * np.ptp(x) / 4000
    assert len(few.x) < len(x)


def test_held_values_keep_each_of_their_steps():
    t = np.arange(10_000) * 0.02
    y = np.floor(t / 7.0) % 3
    few = thinned(Trace(t, y, kind="steps"))
    held = few.y[np.searchsorted(few.x, t, side="right") - 1]
    assert np.array_equal(held, y) and len(few.x) < 40


def test_words_cannot_break_out_of_the_page():
    nasty = "</script><script>alert(1)</script>"
    panel = Panel(
        Axis(nasty),
        Axis("y"),
        [Trace(np.arange(3.0), np.arange(3.0), nasty)],
        [Band("#fff", label=nasty)],
        [Mark("x", 1.0, nasty)],
    )
    sections = [
        Section("a", nasty, [Text(nasty), Table([nasty], [[nasty]]), Figure("f", nasty, [panel], nasty)])
    ]
    text = page(Report(nasty, nasty, "bad", nasty, sections=sections))
    assert "<script>alert" not in text
    assert text.count("</script>") == 4


def test_a_file_appears_whole_or_not_at_all(tmp_path):
    target = tmp_path / "deep" / "a.html"
    with pytest.raises(RuntimeError), atomic_file(target, force=False) as partial:
        partial.write_text("half")
        raise RuntimeError
    assert list(tmp_path.rglob("*.html")) == []
    with atomic_file(target, force=False) as partial:
        partial.write_text("one")
    with pytest.raises(ConfigError, match="--force"), atomic_file(target, force=False):
        pass
    with atomic_file(target, force=True) as partial:
        partial.write_text("two")
    assert [path.name for path in target.parent.iterdir()] == ["a.html"]
    assert target.read_text() == "two"


@pytest.mark.parametrize(
    "value, text",
    [
        (0.0, "0"),
        (1.23456, "1.235"),
        (-9876.54, "-9877"),
        (9999.96, "10000"),
        (1234567.8, "1234568"),
        (1e-7, "1e-07"),
        (math.inf, "inf"),
    ],
)
def test_large_numbers_are_written_whole(value, text):
    assert significant(value) == text
