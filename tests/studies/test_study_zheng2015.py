"""The study of Zheng & Cui on few runs: what is met as printed, what as inferred, and what must fail."""

from __future__ import annotations

import numpy as np
import pytest

from edl6dof.studies import zheng2015
from edl6dof.studies.cases import values
from edl6dof.studies.zheng2015 import experiments, findings
from edl6dof.studies.zheng2015.tracking import error_over_bound, input_shortage

RUNS = 6


@pytest.fixture(scope="module")
def report():
    return zheng2015.run(RUNS, lambda done, total: None)


@pytest.fixture(scope="module")
def tables(report):
    return findings.by_experiment(report.table, RUNS)


def finding(report, label):
    return next(found for found in report.findings if found.label == label)


def test_every_figure_is_as_the_study_says(report):
    assert [found.label for found in report.findings if not found.ok] == []


@pytest.mark.parametrize("name", ["median altitude", "range control begins", "range control ends"])
def test_levels_are_not_met_as_printed_and_are_in_denser_air(report, name):
    printed, inferred = finding(report, f"as printed: {name}"), finding(report, f"as inferred: {name}")
    assert not printed.holds and printed.why
    assert inferred.holds and not inferred.why


def test_a_statistic_of_few_flights_is_not_compared(report):
    assert finding(report, "as inferred: RMS miss").result == ""
    assert findings._within(findings.ENOUGH - 1, 1.0) is None
    assert findings._within(500, 0.0) == pytest.approx(findings.STATISTIC)


def test_experiments_fly_the_same_draws_and_differ_by_what_they_say(tables):
    assert set(tables) == {experiment.name for experiment in experiments.EXPERIMENTS}
    speeds = [values(table, "truth.initial.speed_m_s") for table in tables.values()]
    assert all(np.array_equal(speeds[0], other) for other in speeds)
    printed, none = tables["as printed"], tables["no density error"]
    assert np.std(values(printed, f"truth.{experiments.DENSITY}")) > 0.02
    assert np.isnan(values(none, f"truth.{experiments.DENSITY}")).all()
    assert not any(values(printed, f"belief.{experiments.UPDATE}"))
    assert all(values(tables["flown"], f"belief.{experiments.UPDATE}"))
    assert np.all(values(printed, "parachute_speed_m_s") == pytest.approx(400.0, abs=0.2))


@pytest.mark.parametrize("name", [experiment.name for experiment in experiments.PROFILES])
def test_a_density_error_of_any_correlation_spreads_the_altitudes_more_than_printed(tables, name):
    altitude = values(tables[name], "parachute_altitude_m")
    assert len(np.unique(altitude)) == RUNS and 3.0 * np.std(altitude) > 1000.0


def test_without_density_error_the_miss_is_that_of_the_entry_longitude(tables):
    """0.1 deg (3 sigma) of longitude is 2 km (1 sigma) on the ground, and nothing takes it out."""
    fixed = tables["no density error"]
    east = np.radians(values(fixed, "truth.initial.longitude_deg")) * 3394.5e3
    others = [values(fixed, f"truth.initial.{name}") for name in ("speed_m_s", "flight_path_angle_deg")]
    causes = np.column_stack([east, *(column - column.mean() for column in others), np.ones(RUNS)])
    effect = np.linalg.lstsq(causes, values(fixed, "parachute_downrange_m"))[0]
    assert effect[0] == pytest.approx(1.0, abs=0.1)


def test_observer_sees_the_disturbance(report):
    assert finding(report, "run shown: disturbance estimate, RMS error over RMS").computed < 10.0


def test_input_shortage_is_what_fed_the_virtual_state():
    t, authority = np.arange(0.0, 2.0, 0.02), np.linspace(-0.5, -30.0, 100)
    missing = np.random.default_rng(1).normal(size=99)
    virtual = np.zeros(100)
    for k in range(99):
        decay = 2.0 + 0.25 * authority[k] ** 2
        kept = np.exp(-decay * 0.02)
        virtual[k + 1] = kept * virtual[k] + (1.0 - kept) / decay * authority[k] * missing[k]
    assert input_shortage(t, virtual, authority, 2.0) == pytest.approx(missing, rel=1e-9)


def test_bound_of_eq_51_by_hand():
    """e = 2 for 10 s, delta = 3, c_s = 0.1, k_e = 2.1: 40 beside (2 + (0.1 + 90)/2)/0.1."""
    t = np.linspace(0.0, 10.0, 101)
    ratio = error_over_bound(t, np.full(101, 2.0), np.full(100, 3.0), 2.1, 0.1)
    assert ratio == pytest.approx(40.0 / 470.5)


def test_bound_of_eq_51_holds_under_the_law_and_not_under_a_constant_bank(report):
    label = "error energy over the bound of eq. 51"
    assert finding(report, f"run shown, settled: {label}").computed < 0.01
    assert finding(report, f"constant bank: {label}").computed > 100.0


def test_figures_say_of_which_experiment_they_are(report):
    assert [drawing.key for drawing in report.drawings] == [
        "fig3_drag_and_bank",
        "fig4_error_and_surface",
        "fig5_disturbance",
        "fig6_as_printed",
        "fig6_as_inferred",
        "fig6_flown",
    ]
    for drawing in report.drawings:
        for panel in drawing.panels:
            assert any(panel.title.endswith(name) for name in ("as printed", "as inferred", "flown"))
            assert all(
                len(curve.x) and np.isfinite(curve.x).all() and np.isfinite(curve.y).all()
                for curve in panel.traces
            )
