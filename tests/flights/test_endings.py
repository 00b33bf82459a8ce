"""Verifies: every flight ends with a named cause, at once, with its telemetry kept."""

from __future__ import annotations

import numpy as np
import pytest

import edl6dof
from edl6dof.sim.flight import fly
from edl6dof.vehicle.plant import STATE_NAMES


def test_vehicle_without_flight_software_crashes_and_says_how_fast():
    flight = edl6dof.fly("tianwen1", ["mission.phases=[]"])
    assert flight.outcome.startswith("crashed at ")
    assert float(flight.outcome.split()[2]) > 100.0
    # the ground is met at the located time, not at the end of a step
    assert flight.figures["touchdown_s"] % 0.01 > 1e-6


def test_shallow_entry_skips_out():
    flight = edl6dof.fly("tianwen1", ["initial.flight_path_angle_deg=5", "mission.phases=[]"])
    assert flight.outcome.startswith("skipped out")


def test_a_flight_that_need_not_land_may_climb():
    flight = edl6dof.fly(
        "tianwen1", ["initial.flight_path_angle_deg=5", "mission={goal: time}", "simulation.time_limit_s=200"]
    )
    assert flight.outcome == "flown to the time limit"
    assert flight.log["truth"]["altitude"][-1] > flight.scenario.initial.altitude_m + 10e3


def test_backward_entry_loses_attitude():
    flight = edl6dof.fly("tianwen1", ["initial.alpha_deg=170", "mission.phases=[]"])
    assert flight.outcome.startswith("lost attitude")


def test_time_limit_is_kept():
    flight = edl6dof.fly("tianwen1", ["simulation.time_limit_s=30"])
    assert flight.outcome.startswith("time limit")
    assert flight.time_s == pytest.approx(30.0)


def test_parachute_that_never_opens_is_fatal_but_named():
    """Without the branch that leaves the backshell early, which would bring it down on its engine."""
    useless = "truth={vehicle.parachutes.main.drag_coefficient: 0.001}"
    flight = edl6dof.fly("tianwen1", [useless, "mission.phases.parachute.transitions=[]"])
    assert not flight.landed
    assert flight.outcome.split(" in ")[0].split(" at ")[0] in {"crashed", "lost attitude"}
    assert len(flight.log) > 1000


@pytest.mark.parametrize("index", [0, *(pytest.param(k, marks=pytest.mark.long) for k in (4, 7, 12)), 13])
def test_state_that_turns_non_finite_stops_the_flight_at_once(nominal, index):
    state = fly(nominal.loaded, save_at_s=150.0).saved
    state.plant["y"][0, index] = np.nan
    flight = fly(nominal.loaded, start=state)
    assert flight.outcome.startswith("not finite: ")
    assert "in phase lift" in flight.outcome
    assert any(name in flight.outcome for name in STATE_NAMES)
    assert flight.time_s == pytest.approx(150.0, abs=0.03)
