"""Faults in the nominal flight: same bits before, the right consequence after, and in the timeline and the telemetry."""

import numpy as np
import pytest

import edl6dof


def flown(*faults):
    return edl6dof.fly("tianwen1", [f"faults=[{', '.join(faults)}]"])


@pytest.fixture(scope="module")
def dead_d7():
    return flown("{thruster: D7, kind: stuck_off, at: {phase: hazard_avoidance, plus_s: 2}}")


def test_flight_computer_flies_as_if_nothing_were_until_the_fault(nominal, dead_d7):
    since = next(event["t_s"] for event in dead_d7.events if event["key"] == "fault")
    before = dead_d7.log["t"] < since
    assert before.sum() > 20000
    assert nominal.log[: before.sum()].tobytes() == dead_d7.log[before].tobytes()


def test_fault_is_in_the_timeline_and_the_telemetry(dead_d7):
    event = next(event for event in dead_d7.events if event["key"] == "fault")
    start = next(event for event in dead_d7.events if event["key"] == "phase.hazard_avoidance")
    assert event["name"] == "fault: D7 stuck off" and event["t_s"] == pytest.approx(start["t_s"] + 2.0)
    after = dead_d7.telemetry["t_s"] > event["t_s"] + 0.03
    assert np.all(dead_d7.telemetry["fault.D7"][after] == 1) and np.all(dead_d7.telemetry["rcs.D7"][after] == 0.0)
    assert not np.any(dead_d7.telemetry["fault.D7"][~after][:-2]) and not np.any(dead_d7.telemetry["fault.D8"])


def test_lost_wing_leaves_the_trim_angle_at_minus_ten_degrees():
    flight = flown("{kind: wing_lost, at: {phase: lift}}")
    t, table = flight.metrics["trim_wing_s"], flight.telemetry
    assert np.all(table["truth.trim_wing"] == 0.0)
    trimmed = (table["t_s"] > t + 3.0) & (table["t_s"] < t + 10.0)
    assert np.mean(table["truth.alpha_deg"][trimmed]) == pytest.approx(-10.0, abs=1.5)


def test_late_parachute_opens_lower_and_slower(nominal):
    flight = flown("{kind: parachute_delay, parachute_delay: {delay_s: 4.0}, at: {time_s: 0}}")
    assert flight.metrics["parachute_s"] == pytest.approx(nominal.metrics["parachute_s"] + 4.0, abs=0.03)
    assert flight.metrics["parachute_mach"] < nominal.metrics["parachute_mach"]


def test_engine_shortfall_takes_away_its_share_of_thrust():
    flight = flown("{kind: engine_shortfall, engine_shortfall: {thrust_factor: 0.9}, at: {phase: powered_deceleration}}")
    assert flight.telemetry["truth.engine_thrust_n"].max() == pytest.approx(0.9 * 7500.0, rel=1e-3)
