"""The study of MSL's entry on few flights: how it stands to the published one, and what it hangs on."""

from __future__ import annotations

import numpy as np
import pytest

import edl6dof
from edl6dof.studies import msl
from edl6dof.studies.samples import column

RUNS = 2


@pytest.fixture(scope="module")
def report():
    return msl.STUDY.fly(RUNS)


@pytest.fixture(scope="module")
def lines(report):
    """Lines of the table by name, their figures by column."""
    (table,) = report.grids
    return {line[0]: dict(zip(table.heads[1:], line[1:], strict=True)) for line in table.rows}


def found(report, label):
    return next(finding for finding in report.findings if finding.label == label)


def test_the_first_line_is_the_scenario_and_every_other_changes_it(lines):
    own, first = edl6dof.fly("msl").figures, lines["as it is"]
    assert first["mortar s"] == pytest.approx(own["parachute_s"], abs=2.0)
    assert first["q Pa"] == pytest.approx(own["parachute_dynamic_pressure_pa"], rel=1e-2)
    scenario = edl6dof.load("msl").scenario
    for name, overrides in msl.CHANGES.items():
        assert (edl6dof.load("msl", overrides).scenario == scenario) == (name == "as it is"), name


def test_a_tail_wind_makes_the_true_mach_number_less_than_the_navigated_one(report, lines):
    navigated = found(report, "Mach at mortar fire, as navigated").computed
    assert navigated - found(report, "Mach at mortar fire").computed > 0.05
    still, windy = lines["no wind"], lines["as it is"]
    assert still["Mach"] == pytest.approx(navigated, abs=0.02)
    assert still["range km"] < windy["range km"] - 0.5


def test_a_tail_wind_that_the_plan_does_not_expect_explains_where_the_rover_came_down(lines):
    """2.385 km beyond the target (Way et al. 2013)."""
    assert lines["wind unexpected"]["beyond km"] == pytest.approx(2.385, abs=0.6)
    assert abs(lines["as it is"]["beyond km"]) < 1.2


def test_published_figures_stand_beside_and_the_flight_near_them(report):
    beside = {f.label: f for f in report.findings if f.published is not None}
    assert {"mortar fire", "Mach at mortar fire", "reversals of range control"} <= beside.keys()
    assert beside["mortar fire"].computed == pytest.approx(259.12, abs=7.0)
    assert beside["peak load of the entry"].computed == pytest.approx(12.58, rel=0.02)
    assert beside["reversals of range control"].computed == 3.0
    for k in (1, 2, 3):
        name = f"reversal {k}, through zero bank"
        assert beside[name].computed == pytest.approx(beside[name].published, abs=8.0)
    assert report.ok


def test_every_flight_is_a_row(report):
    assert report.runs == len(report.rows) == RUNS * len(msl.CHANGES)
    assert np.all(column(report.rows, "parachute_s") > 200.0)
    assert [row["success"] for row in report.rows].count(False) <= 2 * RUNS
