"""Faults of one of several instruments that measure the same, in flight: Tianwen-1 carries two radars and two
star trackers.
"""

import numpy as np
import pytest

import edl6dof

AT = "at: {phase: parachute, plus_s: 1}"
#: The first of the two radars alone: four beams on one cone.
ONE_RADAR = "sensors.radar.beams=[" + ", ".join(
    f"{{name: b{k + 1}, axis: [0.90631, {y * 0.29884}, {z * 0.29884}]}}"
    for k, (y, z) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1)))
) + "]"  # fmt: skip


def flown(fault, *sets, at=AT):
    """Flight with a fault, and the names of its excluded instruments."""
    flight = edl6dof.fly("tianwen1", [f"faults=[{{{fault}, {at}}}]", *sets])
    return flight, {one.instrument for one in flight.exclusions if not one.back}


@pytest.mark.parametrize("beam, speed", [("b2", 0.45), ("c3", -0.8)])
def test_of_two_radars_the_biased_beam_is_excluded_and_the_landing_does_not_feel_it(beam, speed):
    flight, excluded = flown(
        f"kind: reading_bias, beam: {beam}, reading_bias: {{range_m: 0, speed_m_s: {speed}}}"
    )
    assert flight.success and excluded == {beam}
    assert flight.figures["touchdown_nav_velocity_m_s"] < 0.1
    assert flight.figures["instrument_false_alarms"] == 0.0


@pytest.mark.parametrize("beam, speed", [("b1", 0.45), ("b2", 0.6), ("b4", 0.8)])
def test_of_one_radar_with_four_beams_no_healthy_beam_is_excluded(beam, speed):
    """Any of them may be wrong; least squares lets the velocity err by 1.21 times the bias.  The look in
    which one beam seems worse than the others is followed for a while, so the error varies around that.
    """
    fault = f"kind: reading_bias, beam: {beam}, reading_bias: {{range_m: 0, speed_m_s: {speed}}}"
    flight, excluded = flown(fault, ONE_RADAR)
    assert excluded <= {beam}
    assert flight.figures["touchdown_nav_velocity_m_s"] < 1.5 * speed
    t, table = flight.telemetry["t_s"], flight.telemetry
    errors = np.array([table[f"nav.error_v_{axis}_m_s"] for axis in ("north", "east", "down")])
    last = (t > flight.figures["touchdown_s"] - 40.0) & (t < flight.figures["touchdown_s"])
    assert np.sqrt((errors[:, last] ** 2).sum(axis=0)).mean() == pytest.approx(1.21 * speed, rel=0.2)


def test_a_dead_radar_is_excluded_and_the_other_lands_the_vehicle():
    flight, excluded = flown("kind: reading_outage, radar: r1")
    assert flight.success and excluded == {"b1", "b2", "b3", "b4"}
    assert flight.figures["instrument_false_alarms"] == 0.0


@pytest.mark.parametrize(
    "fault", ["reading_bias, reading_bias: {attitude_deg: 0.1}", "reading_stuck", "reading_outage"]
)
@pytest.mark.parametrize("head", ["s1", "s2"])
def test_of_two_star_trackers_the_failed_one_is_excluded_and_the_attitude_does_not_feel_it(head, fault):
    flight, excluded = flown(f"star_tracker: {head}, kind: {fault}", at="at: {time_s: 1.0}")
    assert flight.success and excluded == {head}
    assert flight.figures["instrument_false_alarms"] == 0.0
    assert flight.figures["backshell_nav_attitude_deg"] < 0.05
