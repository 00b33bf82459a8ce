"""Flights on an inertial unit, a star tracker and ground tracking alone, down to the engine."""

import numpy as np
import pytest

import edl6dof
from edl6dof.sim.flight import fly

INERTIAL = (
    "sensors.carried=[inertial_unit, star_tracker, ground_tracking, switches]",
    "flight_software.navigation.filter=dead_reckoning",
)
AXES = ("north", "east", "down")


def flown(*overrides):
    return fly(edl6dof.load("tianwen1", [*INERTIAL, *overrides]))


def errors(flight, t, kind=""):
    """Errors of the estimate north, east and down at ``t``."""
    row = flight.log["nav"][np.searchsorted(flight.log["t"], t)]
    return np.array([row[f"error_{kind}{axis}"] for axis in AXES], dtype=float)


def sigmas(flight, t, kind=""):
    row = flight.log["nav"][np.searchsorted(flight.log["t"], t)]
    return np.array([row[f"sigma_{kind}{axis}"] for axis in AXES], dtype=float)


def excluded(flight, kind):
    health = flight.fsw["navigation"]["health"][kind][0]
    return [i + 1 for i in range(6) if not health[i]]


def time_of(flight, key):
    return next(event["t_s"] for event in flight.events if event["key"] == key)


@pytest.mark.parametrize("flights", [3, pytest.param(12, marks=pytest.mark.long)])
def test_errors_stay_within_what_is_claimed_and_nothing_is_excluded(flights):
    scaled = []
    for seed in range(1, flights + 1):
        flight = flown(f"seed={seed}")
        assert excluded(flight, "gyro") == excluded(flight, "accelerometer") == []
        for t in (100.0, 280.0, 440.0):
            scaled.append(
                [errors(flight, t, kind) / sigmas(flight, t, kind) for kind in ("", "v_", "attitude_")]
            )
    assert np.max(np.abs(scaled)) < 4.5
    assert 0.6 < np.sqrt(np.mean(np.square(scaled))) < 1.4


@pytest.mark.parametrize(
    "name, kind",
    [
        ("gyro: g2", "reading_bias"),
        pytest.param("gyro: g5", "reading_stuck", marks=pytest.mark.long),
        pytest.param("accelerometer: a3", "hardover", marks=pytest.mark.long),
        ("accelerometer: a6", "reading_drift"),
    ],
)
def test_failed_instrument_is_named_within_seconds(name, kind):
    flight = flown(f"faults=[{{{name}, kind: {kind}, at: {{phase: lift, plus_s: 2}}}}]")
    component, number = name.split(": ")[0], int(name[-1])
    other = "accelerometer" if component == "gyro" else "gyro"
    assert excluded(flight, component) == [number] and excluded(flight, other) == []
    assert 0.0 < time_of(flight, "exclusion") - time_of(flight, "phase.lift") - 2.0 < 5.0
    assert np.hypot(*errors(flight, 280.0, "attitude_")[:2]) < np.radians(0.05)


def test_vertical_after_all_gyros_were_saturated_for_a_second_at_the_mortar():
    """Until then nothing else tells the rotation; the vertical is within 1 deg, there and 20 s later."""
    gap = "gyros_saturated"
    flight = flown(f"faults=[{{kind: {gap}, duration_s: 1, at: {{phase: parachute}}}}]")
    end = time_of(flight, "phase.parachute") + 1.0
    for later in (0.5, 20.0):
        assert np.hypot(*errors(flight, end + later, "attitude_")[:2]) < np.radians(1.0)
    assert excluded(flight, "gyro") == []
