"""The study of Zheng & Cui on few runs: published bounds, and draws that do not
depend on the number of runs.
"""

from __future__ import annotations

import numpy as np
import pytest

from edl6dof.studies import zheng2015
from edl6dof.studies.cases import Spread, draw, values


def silent(done, total):
    pass


@pytest.fixture(scope="module")
def zheng():
    return zheng2015.run(8, silent)


def finding(report, label):
    return next(found for found in report.findings if found.label == label)


def test_draws_have_the_wanted_spread_and_a_longer_series_begins_like_a_shorter_one():
    spreads = (Spread("a.b", 10.0, 3.0), Spread("c", -1.0, 0.0))
    many = draw(spreads, 4000, 1)
    assert draw(spreads, 3, 1) == many[:3]
    first = np.array([row["a.b"] for row in many])
    assert (first.mean(), first.std()) == (pytest.approx(10.0, abs=0.05), pytest.approx(1.0, abs=0.04))
    assert {row["c"] for row in many} == {-1.0}


def test_zheng2015_keeps_the_published_bounds(zheng):
    assert [found.label for found in zheng.findings if not found.ok] == []
    assert sum(bool(found.bound) for found in zheng.findings) == 6


def test_zheng2015_flies_every_run_in_three_ways(zheng):
    assert zheng.runs == zheng.table.num_rows == 24
    assert zheng.table["way"].to_pylist() == [way for way in zheng2015.WAYS for _ in range(8)]
    density = values(zheng.table, "truth.atmosphere.density_factor")
    assert np.array_equal(density[:8], density[8:16]) and np.isnan(density[16:]).all()
    assert np.all(values(zheng.table, "parachute_speed_m_s") == pytest.approx(400.0, abs=0.2))


def test_zheng2015_observer_sees_the_disturbance(zheng):
    assert finding(zheng, "disturbance estimate, RMS error over RMS").computed < 5.0


def test_zheng2015_without_outer_loop_and_density_dispersion_misses_by_the_entry_longitude(zheng):
    """0.1 deg (3 sigma) of longitude is 2 km (1 sigma) on the ground, and nothing takes it out."""
    fixed = zheng.table.slice(16)
    east = np.radians(values(fixed, "truth.initial.longitude_deg")) * 3394.5e3
    others = [values(fixed, f"truth.initial.{name}") for name in ("speed_m_s", "flight_path_angle_deg")]
    causes = np.column_stack([east, *(column - column.mean() for column in others), np.ones(8)])
    effect = np.linalg.lstsq(causes, values(fixed, "parachute_downrange_m"))[0]
    assert effect[0] == pytest.approx(1.0, abs=0.03)


def test_figures_of_the_paper_are_drawn(zheng):
    assert [drawing.key[:4] for drawing in zheng.drawings] == ["fig3", "fig4", "fig5", "fig6"]
    for drawing in zheng.drawings:
        for panel in drawing.panels:
            assert all(
                len(curve.x) and np.isfinite(curve.x).all() and np.isfinite(curve.y).all()
                for curve in panel.traces
            )
