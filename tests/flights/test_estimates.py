"""Disturbance estimates of the nominal flight against the truth, from delayed inertial measurements alone."""

import numpy as np
import pytest

import edl6dof
from edl6dof.fsw.estimation.registry import ESTIMATORS

POWERED = ("hover_imaging", "hazard_avoidance", "slow_descent")


def during(nominal, *names):
    inside = np.isin(nominal.telemetry["guide.phase"], [nominal.phase_names.index(name) for name in names])
    settled = np.convolve(inside, np.ones(50), "full")[: len(inside)] >= 50  # a second into the first of them
    return inside & settled


def columns(nominal, *names):
    return np.stack([nominal.telemetry[name] for name in names])


@pytest.mark.parametrize("names", [("trim_aoa",), POWERED])
def test_torque_estimate_is_the_true_disturbance(nominal, names):
    """5 N m of 20 N m: what is left is the believed inertia, that of the full tanks, times the thrusters' own
    torque.
    """
    there = during(nominal, *names)
    found = columns(nominal, *(f"estimate.torque_{axis}_nm" for axis in "xyz"))[:, there]
    truth = columns(nominal, *(f"truth.disturbance_{axis}_nm" for axis in "xyz"))[:, there]
    assert np.max(np.sqrt(np.mean((found - truth) ** 2, axis=1))) < 3.0


def test_lateral_force_estimate_is_within_the_forty_newtons_of_the_real_flight(nominal):
    """S1, Fig. 12: at most 40 N during hazard avoidance, with all thrusters sound."""
    there = during(nominal, "hazard_avoidance")
    assert np.max(np.abs(columns(nominal, "estimate.force_y_n", "estimate.force_z_n")[:, there])) < 40.0


def test_velocity_gain_is_the_integral_of_the_measured_acceleration(nominal):
    """Lift phase, 20 deg/s banking under 6 g: the counted axial gain against the trapezoidal integral of the
    specific force.
    """
    table = nominal.telemetry
    axial, t = -table["estimate.force_x_n"], table["t_s"]
    lift = (t > 100.0) & (t < 230.0)
    felt = -(table["truth.aero_force_x_n"] + table["truth.rcs_force_x_n"])
    assert np.trapezoid(axial[lift], t[lift]) == pytest.approx(np.trapezoid(felt[lift], t[lift]), rel=5e-3)


@pytest.mark.parametrize("name", ESTIMATORS.names)
def test_every_estimator_holds_the_thrust_direction_in_the_hover_and_lands(name):
    flight = edl6dof.fly("tianwen1", [f"flight_software.estimation.estimator={name}"])
    assert flight.outcome == "landed within limits" and flight.figures["false_alarms"] == 0.0
    there = during(flight, "hover_imaging")
    error = columns(flight, "control.error_pitch_deg", "control.error_yaw_deg")[:, there]
    assert np.max(np.abs(np.mean(error, axis=1))) < 0.3  # the integral part leaves no standing error


def test_unequal_axial_thrusters_show_in_the_estimated_torque_while_they_help_the_engine(nominal):
    """Less that of a flight with equal ones: the excess of each at its place, about y and z of the body.  The
    pulses of two flights differ by a few newton metres: median of fifteen pairs.
    """
    jets = [jet for jet in nominal.scenario.vehicle.rcs.thrusters if jet.group == "axial"]
    assert {jet.thrust_n for jet in jets} == {250.0} and max(jet.thrust_factor for jet in jets) == 1.03
    equal = ", ".join(f"vehicle.rcs.thrusters.{jet.name}.thrust_factor: 1" for jet in jets)

    def boosted(*overrides):
        """Mean estimated torque, and mean duty of each jet, while they help the engine."""
        flight = edl6dof.fly("tianwen1", list(overrides))
        table = flight.telemetry
        since = table["t_s"] - next(event["t_s"] for event in flight.events if event["key"] == "ignition")
        boosting = (since > 0.6) & (since < 1.2)
        torque = [table[f"estimate.torque_{axis}_nm"][boosting].mean() for axis in "yz"]
        return np.array(torque), [table[f"rcs.{jet.name}"][boosting].mean() for jet in jets]

    errors = []
    for seed in range(1, 16):
        torque, duty = boosted(f"seed={seed}")
        without, _ = boosted(f"seed={seed}", f"truth={{{equal}}}")
        excess = [250.0 * (jet.thrust_factor - 1.0) * on for jet, on in zip(jets, duty, strict=True)]
        arms = [np.cross(jet.position_m, (-f, 0, 0)) for jet, f in zip(jets, excess, strict=True)]
        expected = np.sum(arms, axis=0)[1:]
        assert np.hypot(*expected) > 14.0
        errors.append(torque - without - expected)
    assert np.median(errors, axis=0) == pytest.approx([0.0, 0.0], abs=1.5)
