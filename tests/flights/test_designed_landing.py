"""The landing designed from the flight's own ignition: what it starts from, and what it saves."""

import numpy as np
import pytest

pytest.importorskip("cvxpy")
from edl6dof.design.powered_start import landing_of, powered_rows, states_of
from edl6dof.design.rigid_landing import figures_of, tilt_of
from edl6dof.design.successive import land


@pytest.fixture
def flight(nominal):
    return nominal


def test_states_are_those_of_the_flight(flight):
    rows, of = powered_rows(flight), flight.telemetry
    x = states_of(flight, rows)
    assert np.degrees(tilt_of(x)) == pytest.approx(of["truth.tilt_deg"][rows], abs=0.01)
    # where the axis points, what it is turned by, and how fast: one motion
    assert np.gradient(x[:, 3], of["t_s"][rows]) == pytest.approx(x[:, 6], abs=0.3)
    q, rate = x[:, 7:11], x[:, 11:]
    turned = np.gradient(q, of["t_s"][rows], axis=0)
    spin = -q[:, 1:2] * turned[:, :1] + q[:, :1] * turned[:, 1:] - np.cross(q[:, 1:], turned[:, 1:])
    assert 2.0 * spin == pytest.approx(rate, abs=0.03)


def test_thrusters_give_torque_about_every_axis_without_force(flight):
    landing = landing_of(flight, powered_rows(flight))
    # two opposite 250 N thrusters, one of them 1.1 m off the centre of mass
    assert np.all(landing.torque > 100.0)
    assert np.all(landing.torque < 2000.0)


def test_design_takes_less_than_the_law_of_the_scenario(flight):
    rows = powered_rows(flight)
    landing = landing_of(flight, rows)
    found = land(landing, 14)
    assert found.landed
    own = figures_of(landing, flight.telemetry["t_s"][rows], states_of(flight, rows))
    assert 0.85 * own.fuel_kg < found.fuel < own.fuel_kg
