"""Least distance from what drifts, between rows too."""

import numpy as np
import pytest

from edl6dof.metrics.record_figures import drift_figures, least_length


def test_least_length_of_a_straight_way_is_between_its_rows():
    assert least_length(np.array([(-30.0, 4.0, 3.0), (50.0, 4.0, 3.0)])) == pytest.approx(5.0)
    assert least_length(np.array([(3.0, 4.0), (6.0, 8.0)])) == pytest.approx(5.0)
    assert least_length(np.array([(3.0, 4.0), (3.0, 4.0)])) == pytest.approx(5.0)


def flown(off):
    """Channels of a lander that stands still 100 m up, and a backshell ``off`` of it, a row a second."""
    t = np.arange(len(off), dtype=float)
    places = dict(zip(("east", "north", "up"), np.transpose(off), strict=True))
    return {
        "t_s": t,
        **{f"truth.site_{axis}_m": np.full(len(t), 100.0) for axis in places},
        **{f"truth.backshell_{axis}_m": values + 100.0 for axis, values in places.items()},
    }


def test_figures_begin_when_lander_and_backshell_have_parted():
    # together, then apart, then past on the east side, between rows 8 and 9
    off = [(0.0, 0.0, 30.0 * k) for k in range(7)] + [
        (60.0, 0.0, 150.0),
        (60.0, -40.0, 20.0),
        (60.0, 40.0, -20.0),
    ]
    when = {"backshell": 0.0, "ignition": 1.0, "role.hover_imaging": 7.0}
    figures = drift_figures(flown(off), when, line_m=0.0)
    assert figures["min_drift_distance_m"] == pytest.approx(60.0, abs=1e-9)
    assert figures["min_overhead_m"] == pytest.approx(60.0, abs=1e-9)
    # the canopy passes lower where the backshell hangs below it
    assert drift_figures(flown(off), when, line_m=30.0)["min_drift_distance_m"] == pytest.approx(
        60.0, abs=1e-9
    )


def test_what_is_below_the_lander_is_not_overhead():
    off = [(0.0, 0.0, 100.0 - 40.0 * k) for k in range(8)]
    when = {"backshell": 0.0, "ignition": -5.0, "role.hover_imaging": 4.0}
    figures = drift_figures(flown(off), when, line_m=10.0)
    assert "min_overhead_m" not in figures
    assert figures["min_drift_distance_m"] == 0.0


def test_flight_without_release_or_engine_has_no_such_figures():
    assert drift_figures(flown([(0.0, 0.0, 1.0)] * 3), {"ignition": 1.0}, 30.0) == {}


def test_every_flight_with_a_backshell_has_its_distance(nominal):
    assert nominal.scenario.flight_software.hazard.detection == "given"
    assert nominal.figures["min_drift_distance_m"] <= nominal.figures["min_backshell_distance_m"]
