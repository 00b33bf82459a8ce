"""Flights whose gyros saturate at parachute opening: bridged, or taken at their word as on Schiaparelli."""

import numpy as np
import pytest

import edl6dof
from edl6dof.sim.flight import fly

INSTRUMENTS = (
    "sensors.carried=[inertial_unit, star_tracker, ground_tracking, radar, switches]",
    "flight_software.navigation.filter=error_state",
)
GUARDS = "flight_software.navigation.guards"
RELEASE_M = 1219.0


def first(flight, key):
    return next(event for event in flight.events if event["key"] == key)


def vertical_error(flight, t):
    """Angle (deg) between the true vertical and the estimated one at ``t``."""
    row = flight.log["nav"][np.searchsorted(flight.log["t"], t)]
    return np.degrees(np.hypot(row["error_attitude_north"], row["error_attitude_east"]))


def said(flight):
    return [event["name"] for event in flight.events if event["key"] in ("guard", "vertical_found")]


@pytest.mark.parametrize("later", [0.0, 0.9, 1.3, 1.6, 2.5])
def test_vertical_after_all_gyros_were_saturated_for_a_second_at_the_parachute_opening(later):
    """Before the snatch of the lines, over it, and while the canopy fills; the wind is not known on board and
    the radar sees nothing yet.
    """
    gap = f"{{kind: gyros_saturated, at: {{phase: parachute, plus_s: {later}}}}}"
    flight = fly(edl6dof.load("tianwen1", [*INSTRUMENTS, f"faults=[{gap}]"]))
    end = first(flight, "phase.parachute")["t_s"] + later + 1.0
    assert vertical_error(flight, end + 0.1) < 1.0
    assert vertical_error(flight, end + 20.0) < 1.0
    assert vertical_error(flight, first(flight, "ignition")["t_s"]) < 0.1
    assert flight.success and said(flight) == []


@pytest.fixture(scope="module")
def unguarded():
    return fly(edl6dof.load("schiaparelli_like"))


def test_without_guards_it_goes_the_way_of_schiaparelli(unguarded):
    """The attitude turns over, the height becomes negative, and the parachute is released kilometres up; what
    the guards would have said is noted all the same.
    """
    log, opened = unguarded.log, first(unguarded, "phase.parachute")["t_s"]
    assert vertical_error(unguarded, opened + 5.0) > 60.0
    told = log["truth"]["height"] + log["nav"]["error_height"]
    release = first(unguarded, "backshell")
    assert told[log["t"] < release["t_s"]].min() < -1000.0
    assert release["height_m"] > 2.5 * RELEASE_M
    assert not unguarded.success
    assert said(unguarded) == [
        "guard: height below ground",
        "guard: echo from above the horizon",
        "guard: speed against the beams",
    ]


@pytest.mark.parametrize("guard", ["below_ground", "speed", "vertical"])
def test_each_guard_alone_rescues_it(guard):
    flight = fly(edl6dof.load("schiaparelli_like", [f"{GUARDS}.{guard}=true"]))
    release = first(flight, "backshell")
    found = first(flight, "vertical_found")["t_s"]
    assert found < release["t_s"] and release["height_m"] == pytest.approx(RELEASE_M, abs=20.0)
    assert vertical_error(flight, found + 20.0) < 1.0
    assert flight.success


def test_leaving_the_saturated_gyro_out_needs_no_guard():
    flight = fly(edl6dof.load("schiaparelli_like", ["flight_software.navigation.saturation.left_out=true"]))
    opened = first(flight, "phase.parachute")["t_s"]
    assert vertical_error(flight, opened + 20.0) < 1.0
    assert flight.success and said(flight) == []
