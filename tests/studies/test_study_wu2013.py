"""The study of Wu, Cui & Cui on few runs: published bounds, and what the observer does that feedback
linearisation alone does not.
"""

from __future__ import annotations

import numpy as np
import pytest

from edl6dof.studies import wu2013
from edl6dof.studies.cases import values

RUNS = 8


@pytest.fixture(scope="module")
def report():
    return wu2013.run(RUNS, lambda done, total: None)


def group(report, law, update):
    rows = zip(report.table["law"].to_pylist(), report.table["range_update"].to_pylist(), strict=True)
    return report.table.filter(np.array([row == (law, update) for row in rows]))


def test_published_bounds_are_kept(report):
    assert [found.label for found in report.findings if not found.ok] == []
    assert sum(bool(found.bound) for found in report.findings) == 4


def test_every_entry_is_flown_by_both_laws_with_the_update_and_without(report):
    assert report.runs == report.table.num_rows == 4 * RUNS
    for law in ("fl", "ehgo_fl"):
        for update in (True, False):
            part = group(report, law, update)
            assert part.num_rows == RUNS
            assert values(part, "truth.initial.speed_m_s") == pytest.approx(
                values(report.table, "truth.initial.speed_m_s")[:RUNS]
            )


def test_observer_takes_out_the_tracking_error_that_a_wrong_lift_leaves(report):
    """FL is left with an error that grows with the error of L/D; with the observer it is several times
    smaller.
    """
    alone, observed = (values(group(report, law, False), "rms_error_m_s2") for law in ("fl", "ehgo_fl"))
    wrong = np.abs(values(group(report, "fl", False), "truth.vehicle.aero.lift_drag.lift_to_drag") - 0.24)
    assert np.corrcoef(alone, wrong)[0, 1] > 0.9
    assert np.mean(observed) < 0.35 * np.mean(alone)


def test_misses_without_the_range_update_are_those_of_the_entry_errors(report):
    with_update, without = (
        values(group(report, "ehgo_fl", update), "parachute_miss_m") for update in (True, False)
    )
    assert np.max(with_update) < 1500.0 < np.max(without)
    north = np.radians(values(group(report, "ehgo_fl", False), "truth.initial.latitude_deg")) * 3397.2e3
    assert np.corrcoef(north, values(group(report, "ehgo_fl", False), "parachute_downrange_m"))[0, 1] > 0.3


def test_figures_are_drawn(report):
    assert [drawing.key for drawing in report.drawings] == [
        "fig3_estimates",
        "fig4_tracking",
        "fig5_fig6_misses",
        "misses_without_update",
    ]
    for drawing in report.drawings:
        for panel in drawing.panels:
            assert all(
                len(curve.x) and np.isfinite(curve.x).all() and np.isfinite(curve.y).all()
                for curve in panel.traces
            )
