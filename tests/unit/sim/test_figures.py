"""The table of figures of merit: it and what flights produce are the same, and published values are compared
as it says.
"""

from __future__ import annotations

from io import StringIO
from math import nan

import numpy as np
import pytest
from rich.console import Console

import edl6dof
from edl6dof.config.document.locate import shipped_names
from edl6dof.config.units import split_unit
from edl6dof.metrics.evaluation import checks, peak_figures
from edl6dof.metrics.figures import BALANCES, FIGURES, LIMITS, figure_of_merit
from edl6dof.metrics.out_of_use import IsolatedFault, diagnosis_figures, failed_thrusters
from edl6dof.metrics.published import PublishedFigure, published_problems
from edl6dof.metrics.record_figures import balance_figures, touchdown_state, touchdown_terrain_figures
from edl6dof.report.document import Cell
from edl6dof.report.flight.flight_report import limits_and_published, mood
from edl6dof.report.terminal import LIMIT_STATUS, comparison, headline, published_table, show_flight
from edl6dof.runs.files import atomic_folder
from edl6dof.runs.run import Run, summary, write_run
from edl6dof.scenario.schema import LimitParams
from edl6dof.vehicle.plant import STATE

DECLARED = {figure.name for figure in FIGURES}
FAULT = "faults=[{thruster: D7, kind: stuck_off, at: {phase: hazard_avoidance, plus_s: 2}}]"
GYRO = [
    "sensors.carried=[inertial_unit, star_tracker, ground_tracking, radar, switches]",
    "flight_software.navigation.filter=error_state",
    "faults=[{gyro: g3, kind: hardover, at: {phase: lift}}]",
]
RELAXED = ["flight_software.guidance.powered.law=convex", "mission.phases.parachute.until.value=300"]


@pytest.fixture(scope="module")
def faulty():
    return edl6dof.fly("tianwen1", [FAULT])


@pytest.fixture(scope="module")
def rough():
    return edl6dof.fly("tianwen1_hazards")


def test_no_figure_is_declared_twice():
    assert len(DECLARED) == len(FIGURES) == len({figure.meaning for figure in FIGURES})


def test_every_figure_that_flights_produce_is_declared_and_the_other_way_round(nominal, faulty, rough):
    produced = (
        rough.figures.keys()
        | nominal.figures.keys()
        | faulty.figures.keys()
        | edl6dof.fly("tianwen1", GYRO).figures.keys()
    )
    produced |= edl6dof.fly("tianwen1", RELAXED).figures.keys()
    for name in ("tianwen1_trn", "msl", "wu2013", "yan2016", "zheng2015", "nesc/case06"):
        produced |= edl6dof.fly(name).figures.keys()
    assert produced == DECLARED


def test_figures_come_from_where_the_table_says(nominal, faulty, rough):
    by_source = {
        source: {figure.name for figure in FIGURES if figure.source == source}
        for source in ("peaks", "contact", "footing", "diagnosis", "balance")
    }
    assert peak_figures(nominal.plant[0], nominal.peaks[0], {"mortar": 1.0}).keys() == by_source["peaks"]
    assert touchdown_state(nominal.case, nominal.plant).keys() == by_source["contact"]
    assert balance_figures(nominal.case, nominal.plant).keys() == by_source["balance"]
    footing = touchdown_terrain_figures(rough.case, rough.tables, rough.plant, rough.outputs)
    assert footing.keys() == by_source["footing"] | {"touchdown_slope_deg"}
    truth = faulty.loaded.truth
    figures = diagnosis_figures(
        faulty.isolated_faults, truth.faults, truth.components, truth.branches, faulty.plant[0]
    )
    assert figures.keys() == by_source["diagnosis"]


@pytest.mark.parametrize(
    "fault, failed, kind",
    [
        ("thruster: D7, kind: stuck_on", ["D7"], "stuck on"),
        ("branch: F34, kind: branch_dead", ["F3", "F4"], "stuck off"),
        ("kind: weak_thrusters", edl6dof.load("tianwen1").scenario.thruster_names, "degraded"),
        ("kind: wing_lost", [], "stuck off"),
    ],
)
def test_isolations_are_right_of_thrusters_that_a_fault_makes_fail_with_its_kind(fault, failed, kind):
    truth = edl6dof.load("tianwen1", [f"faults=[{{{fault}, at: {{time_s: 1}}}}]"]).truth
    names, branches = truth.components, truth.branches
    assert list(failed_thrusters(truth.faults[0], names, branches)) == failed
    plant = np.zeros(1, STATE)
    plant["fault_since"][0, 0] = 1.0
    for thruster in truth.thruster_names:
        for said in ("stuck off", "stuck on", "degraded"):
            found = [IsolatedFault(thruster, said, 0.9999, 1.0, 3.0)]
            figures = diagnosis_figures(found, truth.faults, names, branches, plant[0])
            right = thruster in failed and said == kind
            assert figures["false_alarms"] == (0.0 if right else 1.0)
            assert figures.get("time_to_detect_s") == (2.0 if right else None)
            assert figures.get("missed_isolations") == (len(failed) - right if failed else None)


def test_limits_bound_figures_of_their_own_unit_and_none_is_left_out(rough):
    """Limits that end a flight in the compiled loop are no figures."""
    ending = {"skip_out_m", "crash_speed_m_s", "body_rate_deg_s", "total_alpha_deg", "powered_tilt_deg"}
    assert {figure.limit for figure in LIMITS} == LimitParams.model_fields.keys() - ending
    assert [figure.name for figure in LIMITS if split_unit(figure.limit)[1] != figure.unit] == []
    assert [check.label for check in checks(rough.scenario.limits, rough.figures)] == [
        figure.meaning for figure in LIMITS
    ]


def test_limit_of_a_clearance_is_its_least_value(rough):
    """100 m are allowed to come down to 60 m: 80 m use 3/4 of the limit, 50 m violate it, and the quantile of
    99 % of the flights is that which 1 % of them are below.
    """
    figure, values = figure_of_merit("min_drift_distance_m"), np.array([100.0, 50.0, np.nan])
    assert figure.violates(values, 60.0).tolist() == [False, True, False]
    assert figure.used(80.0, 60.0) == pytest.approx(0.75) and figure.toward_limit(0.99) == pytest.approx(0.01)
    for distance, met in ((60.0, True), (59.9, False), (np.nan, False)):
        (check,) = checks(rough.scenario.limits, {"min_drift_distance_m": distance})
        assert (check.ok, check.allowed) == (met, ">=")


def test_published_figures_of_shipped_scenarios_are_declared():
    shipped = [edl6dof.load(name).scenario for name in shipped_names("scenarios") if "plugin" not in name]
    assert any(one.published for one in shipped)
    for one in shipped:
        assert not published_problems(one.published, one.mission.events)


@pytest.mark.parametrize(
    "name, own, published, shown, difference, kept",
    [
        ("roll_error_at_ignition_deg", -6.94, {"magnitude": 7.7}, "+-7.7", "-0.76", None),
        ("touchdown_yaw_error_deg", -6.94, 7.7, "7.7", "-14.64", None),  # a signed value was published
        ("max_rate_powered_deg_s", 8.3, {"at_most": 15.0}, "<= 15", "met", True),
        ("max_rate_powered_deg_s", 16.5, {"at_most": 15.0}, "<= 15", "violated", False),
        ("bank_reversals", 3.0, {"at_least": 4.0}, ">= 4", "violated", False),
        ("max_rate_powered_deg_s", 4.6, 15.0, "15", "-10.4", None),  # far below a flown value is far off
        ("max_rate_powered_deg_s", nan, {"at_most": 15.0}, "<= 15", "not reached", False),
        ("touchdown_s", None, 15.0, "15", "not reached", None),
    ],
)
def test_published_values_are_compared_as_they_are_given(name, own, published, shown, difference, kept):
    published = PublishedFigure(**published) if isinstance(published, dict) else published
    (row,) = comparison({name: own}, {name: published})
    assert (row.figure, row.unit) == (figure_of_merit(name).meaning, figure_of_merit(name).unit.label)
    assert (row.published, row.difference, row.kept) == (shown, difference, kept)


def test_differences_are_told_in_standard_deviations_of_what_was_published_and_of_the_mean():
    entry = PublishedFigure(value=10.0, sigma=0.3)
    assert entry.sigmas(10.6) == pytest.approx(2.0)
    assert entry.sigmas(9.0, deviation=0.4) == pytest.approx(-2.0)  # hypot(0.3, 0.4) = 0.5
    assert PublishedFigure(magnitude=10.0, sigma=0.5).sigmas(-9.0) == pytest.approx(-2.0)
    assert PublishedFigure(value=10.0).sigmas(9.0) is None


def test_one_flight_tells_no_standard_deviations():
    entry = {"touchdown_s": PublishedFigure(value=10.0, sigma=0.3)}
    (one,) = comparison({"touchdown_s": 9.0}, entry)
    (mean,) = comparison({"touchdown_s": 9.0}, entry, {"touchdown_s": 0.4})
    assert (one.sigmas, mean.sigmas) == ("", "-2.0")
    assert [len(published_table([row], "", "").columns) for row in (one, mean)] == [5, 6]


@pytest.mark.parametrize(
    "given, message",
    [
        ({}, "value"),
        ({"sigma": 1.0}, "value"),
        ({"value": 1.0, "at_most": 2.0}, "at_most"),
        ({"at_most": 2.0, "sigma": 0.1}, "sigma"),
        ({"value": 2.0, "sigma": 0.0}, "greater than 0"),
        ({"magnitude": -2.0}, "greater than or equal to 0"),
    ],
)
def test_a_published_figure_says_one_thing(given, message):
    with pytest.raises(ValueError, match=message):
        PublishedFigure(**given)


def test_a_broken_requirement_is_called_so_on_the_terminal_and_in_the_report(tmp_path):
    bounds = "published: {parachute_altitude_m: {at_most: 0.5}}\nlimits: {parachute_mach_max: 0.5}"
    (tmp_path / "low.yaml").write_text(f"extends: msl\n{bounds}\n")
    flight = edl6dof.fly(tmp_path / "low.yaml")
    for verbose, violated in ((True, 2), (False, 1)):
        console = Console(record=True, width=100, file=StringIO())
        show_flight(console, flight, verbose)
        assert console.export_text().count(" violated") == violated
    with atomic_folder(tmp_path / "run", "flight", False) as folder:
        write_run(flight, folder)
    tables = limits_and_published(Run(tmp_path / "run"))
    cells = [cell for table in tables for row in table.rows for cell in row if isinstance(cell, Cell)]
    assert [cell.mood for cell in cells if cell.text == LIMIT_STATUS[False]] == ["bad", "bad"]


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


def test_a_mission_is_judged_by_no_limit_that_it_does_not_set():
    """The limits of Tianwen-1 are no one else's: a probe on Titan is not held to its parachute."""
    assert {LimitParams().model_dump()[figure.limit] for figure in LIMITS} == {None}
    landing = edl6dof.load("titan_probe", ["mission.goal=landing"]).scenario
    others = DECLARED - {figure.name for figure in BALANCES}
    assert checks(landing.limits, dict.fromkeys(others, 1e9)) == []
    free = [f"limits.{figure.limit}=null" for figure in LIMITS]
    assert edl6dof.fly("tianwen1", free).outcome == "landed"
