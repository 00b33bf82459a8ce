"""The study of Zheng & Cui on few runs: what is met as printed, what as inferred, and what must fail."""

from __future__ import annotations

import numpy as np
import pytest

from edl6dof.studies import zheng2015
from edl6dof.studies.samples import column, pick

RUNS = 6


@pytest.fixture(scope="module")
def report():
    return zheng2015.STUDY.fly(RUNS)


@pytest.fixture(scope="module")
def tables(report):
    return {one.name: pick(report.rows, experiment=one.name) for one in zheng2015.EXPERIMENTS}


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
    assert zheng2015.tolerance(zheng2015.ENOUGH - 1, 1.0) is None
    assert zheng2015.tolerance(500, 0.0) == pytest.approx(zheng2015.STATISTIC)


def test_experiments_fly_the_same_draws_and_differ_by_what_they_say(tables):
    assert all(len(rows) == RUNS for rows in tables.values())
    speeds = [column(table, "truth.initial.speed_m_s") for table in tables.values()]
    assert all(np.array_equal(speeds[0], other) for other in speeds)
    printed, none = tables["as printed"], tables["no density error"]
    assert np.std(column(printed, f"truth.{zheng2015.DENSITY}")) > 0.02
    assert np.isnan(column(none, f"truth.{zheng2015.DENSITY}")).all()
    assert not any(column(printed, f"belief.{zheng2015.UPDATE}"))
    assert all(column(tables["flown"], f"belief.{zheng2015.UPDATE}"))
    assert np.all(column(printed, "parachute_speed_m_s") == pytest.approx(400.0, abs=0.2))


@pytest.mark.parametrize("name", [experiment.name for experiment in zheng2015.PROFILES])
def test_a_density_error_of_any_correlation_spreads_the_altitudes_more_than_printed(tables, name):
    altitude = column(tables[name], "parachute_altitude_m")
    assert len(np.unique(altitude)) == RUNS and 3.0 * np.std(altitude) > 1000.0


def test_without_density_error_the_miss_is_that_of_the_entry_longitude(tables):
    """0.1 deg (3 sigma) of longitude is 2 km (1 sigma) on the ground, and nothing takes it out."""
    fixed = tables["no density error"]
    east = np.radians(column(fixed, "truth.initial.longitude_deg")) * 3394.5e3
    others = [column(fixed, f"truth.initial.{name}") for name in ("speed_m_s", "flight_path_angle_deg")]
    causes = np.column_stack([east, *(other - other.mean() for other in others), np.ones(RUNS)])
    effect = np.linalg.lstsq(causes, column(fixed, "parachute_downrange_m"))[0]
    assert effect[0] == pytest.approx(1.0, abs=0.1)


def test_observer_sees_the_disturbance(report):
    assert finding(report, "run shown: disturbance estimate, RMS error over RMS").computed < 10.0
