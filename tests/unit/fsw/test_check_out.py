"""Check-out of thrusters from the gyro response: against rigid-body rate changes, and in flight with a dead
thruster.
"""

from math import radians

import numpy as np
import pytest

import edl6dof
from edl6dof.config.errors import ConfigError
from edl6dof.fsw.check_out import response

SHORT = ["simulation.time_limit_s=2.0"]


@pytest.mark.parametrize("level", [1.0, 0.5, 0.0])
def test_response_is_the_share_of_full_thrust_whatever_else_turns_about_other_axes(level):
    inertia, pulse = (1150.0, 900.0, 950.0), 0.08
    effect = (0.0, 250.0, 0.0, -265.0, 0.0, 0.0)
    before = np.radians([1.0, -2.0, 0.5])
    after = before + np.array([level * effect[3] * pulse / inertia[0], radians(0.3), radians(-0.2)])
    assert response(effect, inertia, pulse, tuple(before), tuple(after)) == pytest.approx(level, abs=1e-12)


def index(flight, name):
    return flight.scenario.thruster_names.index(name)


def test_working_thrusters_respond_in_full_and_stay_in_the_selection(nominal):
    assert nominal.fsw["check_out"]["next"][0] == 2
    assert nominal.fsw["check_out"]["response"][0, :2] == pytest.approx(1.0, abs=0.1)
    assert nominal.fsw["health"]["thruster"][0, index(nominal, "D1")] == 1
    assert nominal.fsw["health"]["thruster"][0, index(nominal, "D2")] == 1


@pytest.mark.parametrize("thruster", ["D1", pytest.param("D2", marks=pytest.mark.long)])
def test_a_dead_thruster_is_taken_out_and_never_fired_again(thruster):
    fault = f"faults=[{{thruster: {thruster}, kind: stuck_off, at: {{time_s: 0}}}}]"
    flight = edl6dof.fly("tianwen1", [fault])
    other = "D2" if thruster == "D1" else "D1"
    assert flight.fsw["health"]["thruster"][0, index(flight, thruster)] == 0
    assert flight.fsw["health"]["thruster"][0, index(flight, other)] == 1
    assert flight.success, flight.outcome


def test_pulses_are_those_asked_for_one_thruster_at_a_time():
    flight = edl6dof.fly("tianwen1", SHORT)
    table = flight.telemetry
    begin = table["t_s"] < 0.45
    impulse = {
        name: np.trapezoid(table[f"rcs.{name}"][begin], table["t_s"][begin])
        for name in flight.scenario.thruster_names
    }
    assert impulse["D1"] == pytest.approx(0.08, abs=0.03)
    assert impulse["D2"] == pytest.approx(0.08, abs=0.03)
    assert np.all(table["rcs.D1"][begin] * table["rcs.D2"][begin] == 0.0)
    # the two turn the vehicle in opposite senses: what the first does, the second undoes
    rate = table["truth.rate_p_deg_s"]
    assert np.max(np.abs(rate - rate[0])) > 0.8
    assert abs(rate[np.searchsorted(table["t_s"], 0.34)] - rate[0]) < 0.1


def test_unknown_thruster_is_named():
    with pytest.raises(ConfigError, match="no thruster named 'D9'"):
        edl6dof.load("tianwen1", ["flight_software.check_out.thrusters=[D1, D9]"])
