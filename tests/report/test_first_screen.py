"""The first screen of a report: outcome, five numbers, a picture of the flight, its track on the relief; and
the heights near the ground, and the colours of legends.
"""

from __future__ import annotations

import numpy as np
import pytest

from edl6dof.report.flight.first_screen import first_screen
from edl6dof.report.flight.flight_report import flight_report
from edl6dof.report.page import page
from edl6dof.report.pdf import PICTURE_ROWS, _pages


@pytest.fixture(scope="module")
def report(run):
    return flight_report(run)


def test_outcome_five_numbers_and_the_picture_come_before_the_sections(report):
    assert len(report.facts) == 5 and report.headline
    text = page(report)
    first, rest = text.split("<main>")
    assert 'data-figure="first_screen"' in first and 'data-figure="first_screen"' not in rest
    words = next(iter(_pages(report)))
    assert any(words[k : k + PICTURE_ROWS] == [[]] * PICTURE_ROWS for k in range(12)), "room on paper, too"


def test_picture_shows_the_flight_above_its_ground_and_the_track_on_the_relief(run):
    beside, above = first_screen(run).panels
    ground, path, marks = beside.traces
    assert marks.labels == ["peak heating", "peak load", "parachute", "touchdown"]
    assert np.all(np.diff(path.x[: len(path.x) // 2]) < 0.0) and path.x[-1] < 5.0, "towards the site"
    entry = run.between(until="mortar")
    peak = float(run["truth.height_above_areoid_m"][entry][np.argmax(run["truth.load_g0"][entry])]) / 1e3
    assert marks.y[1] == pytest.approx(peak)
    assert marks.y[-1] == pytest.approx(float(ground.y[:-2][-1]), abs=0.02), "it stands on the ground"
    heat, track = above.heat, above.traces[0]
    assert np.isfinite(heat.values).all() and np.ptp(heat.values) > 0.5
    for axis, cells in ((track.x, heat.x), (track.y, heat.y)):
        assert cells.min() < axis.min() and axis.max() < cells.max()
    site = heat.values[np.abs(heat.y).argmin(), np.abs(heat.x).argmin()]
    assert site == pytest.approx(run.scenario["terrain"]["site_elevation_m"] / 1e3, abs=0.2)


def test_the_last_four_kilometres_have_their_own_axis(report, run):
    (figure,) = (one for one in report.figures() if one.key == "near_ground")
    low, high = figure.spans(0)[1]
    assert low > -5.0 and 3.8 < high < 4.5
    rows = run["truth.height_m"] < 4000.0
    assert figure.spans(0)[0] == pytest.approx((run.t[rows][0], run.t[rows][-1]), abs=0.5)


def test_names_in_a_legend_have_distinct_colours(report):
    for figure in report.figures():
        looks: dict[str, set] = {}
        for panel in figure.panels:
            for trace in panel.coloured():
                if trace.legend and trace.name:
                    looks.setdefault(trace.name, set()).add(trace.colour)
        assert all(len(look) == 1 for look in looks.values()), figure.key
        assert len(set.union(set(), *looks.values())) == len(looks), (figure.key, looks)


def test_the_drawing_of_the_vehicle_is_in_the_report(report):
    assert "vehicle" in [figure.key for figure in report.figures()]
