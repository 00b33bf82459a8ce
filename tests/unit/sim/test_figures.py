"""The table of figures of merit: it and what flights produce are the same, and published values are compared
as it says.
"""

from __future__ import annotations

from math import nan

import pytest

import edl6dof
from edl6dof.config.document.locate import shipped_names
from edl6dof.config.units import split_unit
from edl6dof.metrics.diagnosis import diagnosis_figures
from edl6dof.metrics.evaluation import LIMITS, checks, peak_figures
from edl6dof.metrics.figures import FIGURES, figure_of_merit
from edl6dof.metrics.touchdown import touchdown_state
from edl6dof.report.flight.words import mood
from edl6dof.report.terminal import comparison, headline, published_table
from edl6dof.runs.results import summary
from edl6dof.scenario.schema import LimitParams

DECLARED = {figure.name for figure in FIGURES}
FAULT = "faults=[{thruster: D7, kind: stuck_off, at: {phase: hazard_avoidance, plus_s: 2}}]"


@pytest.fixture(scope="module")
def faulty():
    return edl6dof.fly("tianwen1", [FAULT])


def test_no_figure_is_declared_twice():
    assert len(DECLARED) == len(FIGURES) == len({figure.meaning for figure in FIGURES})


def test_every_figure_that_flights_produce_is_declared_and_the_other_way_round(nominal, faulty):
    produced = nominal.metrics.keys() | faulty.metrics.keys()
    for name in ("msl", "wu2013", "yan2016", "zheng2015", "nesc/case06"):
        produced |= edl6dof.fly(name).metrics.keys()
    assert produced == DECLARED


def test_figures_come_from_where_the_table_says(nominal, faulty):
    by_source = {
        source: {figure.name for figure in FIGURES if figure.source == source}
        for source in ("peaks", "contact", "diagnosis")
    }
    assert peak_figures(nominal.plant[0], nominal.peaks[0], {"mortar": 1.0}).keys() == by_source["peaks"]
    assert touchdown_state(nominal.case, nominal.plant).keys() == by_source["contact"]
    assert (
        diagnosis_figures(faulty.isolated_faults, faulty.loaded.truth.faults, faulty.plant[0]).keys()
        == by_source["diagnosis"]
    )


def test_limits_bound_figures_of_their_own_unit_and_none_is_left_out(nominal):
    """Limits that end a flight in the compiled loop are no figures."""
    ending = {"skip_out_m", "crash_speed_m_s", "body_rate_deg_s", "total_alpha_deg"}
    assert {figure.limit for figure in LIMITS} == LimitParams.model_fields.keys() - ending
    assert [figure.name for figure in LIMITS if split_unit(figure.limit)[1] != figure.unit] == []
    assert [check.label for check in checks(nominal.scenario.limits, nominal.metrics)] == [
        figure.meaning for figure in LIMITS
    ]


def test_published_figures_of_shipped_scenarios_are_declared():
    published = [
        edl6dof.load(name).scenario.published for name in shipped_names("scenarios") if "plugin" not in name
    ]
    assert any(published) and {name for values in published for name in values} <= DECLARED


@pytest.mark.parametrize(
    "name, own, published, shown, difference, kept",
    [
        ("roll_error_at_ignition_deg", -6.94, 7.7, "+-7.7", "-0.76", None),  # a magnitude was published
        ("touchdown_yaw_error_deg", -6.94, 7.7, "7.7", "-14.64", None),  # a signed value was
        ("max_rate_powered_deg_s", 8.3, 15.0, "<= 15", "kept", True),
        ("max_rate_powered_deg_s", 16.5, 15.0, "<= 15", "+1.5", False),
        ("bank_reversals", 3.0, 4.0, ">= 4", "-1", False),
        ("max_bank_rate_deg_s", 19.7, 20.0, "20", "-0.3", None),
        ("max_rate_powered_deg_s", nan, 15.0, "<= 15", "not reached", False),
        ("touchdown_s", None, 15.0, "15", "not reached", None),
    ],
)
def test_published_values_are_compared_as_declared(name, own, published, shown, difference, kept):
    (row,) = comparison({name: own}, {name: published})
    assert (row.figure, row.unit) == (figure_of_merit(name).meaning, figure_of_merit(name).unit.label)
    assert (row.published, row.difference, row.kept) == (shown, difference, kept)


def test_table_on_the_terminal_has_a_row_for_each_published_figure(nominal):
    table = published_table(nominal)
    assert table.row_count == len(nominal.scenario.published) and len(table.columns) == 5


def test_a_figure_of_another_version_speaks_for_itself():
    assert figure_of_merit("least_fuel_margin_kg").meaning == "least fuel margin"


def test_a_goal_reached_outside_limits_is_a_warning_whatever_the_words_say(nominal):
    outside = edl6dof.fly("msl", ["limits.parachute_mach_max=0.5"])
    short = edl6dof.fly("msl", ["simulation.time_limit_s=20"])
    assert [mood(summary(flight)) for flight in (nominal, outside, short)] == ["good", "warn", "bad"]
    assert [str(headline(flight).style) for flight in (nominal, outside, short)] == [
        "bold green",
        "bold yellow",
        "bold red",
    ]
