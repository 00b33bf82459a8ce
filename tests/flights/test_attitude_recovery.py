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


def first(flight, key):
    return next(event for event in flight.events if event["key"] == key)


def vertical_error(flight, t):
    """Angle (deg) between the true vertical and the estimated one at ``t``."""
    row = flight.log["nav"][np.searchsorted(flight.log["t"], t)]
    return np.degrees(np.hypot(row["error_attitude_north"], row["error_attitude_east"]))


def said(flight):
    return [event["name"] for event in flight.events if event["key"] in ("guard", "vertical_found")]


@pytest.mark.parametrize(
    "later", [1.3, *(pytest.param(later, marks=pytest.mark.long) for later in (0.0, 0.9, 1.6, 2.5))]
)
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
    return fly(edl6dof.load("schiaparelli"))


def test_schiaparelli_is_lost_to_its_sensors_alone(unguarded):
    """No fault: the swing under the opening canopy goes beyond the range of a gyro, the limit is integrated,
    the height on board becomes negative, parachute and backshell go kilometres up, the engines burn for three
    seconds.
    """
    flight, figures = unguarded, unguarded.figures
    assert not flight.scenario.faults and flight.outcome.startswith("crashed")
    swing = np.abs(flight.telemetry["truth.rate_r_deg_s"]).max()
    assert swing > flight.scenario.sensors.inertial_unit.gyros.range_deg_s
    flagged = flight.telemetry["sensed.gyros_saturated"] > 0
    assert 0.9 < np.count_nonzero(flagged) / 50.0 < 1.5
    assert figures["backshell_told_height_m"] < -1000.0
    assert figures["backshell_height_m"] == pytest.approx(3700.0, abs=300.0)
    assert figures["engine_burn_s"] == pytest.approx(3.0, abs=0.2)
    assert figures["touchdown_vertical_m_s"] == pytest.approx(150.0, abs=10.0)
    assert said(flight) == [
        "guard: height below ground",
        "guard: echo from above the horizon",
        "guard: speed against the beams",
        "guard: height jumps",
    ]


@pytest.mark.parametrize("guard", ["below_ground", "speed", "vertical"])
def test_each_guard_alone_rescues_it(guard):
    flight = fly(edl6dof.load("schiaparelli", [f"{GUARDS}.{guard}=true"]))
    found = first(flight, "vertical_found")["t_s"]
    assert found < flight.figures["backshell_s"]
    assert flight.figures["backshell_height_m"] == pytest.approx(1200.0, abs=20.0)
    assert flight.landed


def test_to_leave_out_saturated_readings_errs_less_than_to_integrate_the_limit():
    """It does not always save the flight: the rate of an axis is unknown as long as its gyro is left out."""
    errors = {"true": [], "false": []}
    for bank in range(-120, -86, 6):
        for left_out, found in errors.items():
            change = [
                f"flight_software.navigation.saturation.left_out={left_out}",
                f"initial.bank_deg={bank}",
            ]
            flight = fly(edl6dof.load("schiaparelli", change))
            found.append(vertical_error(flight, flight.figures["parachute_s"] + 20.0))
    assert np.median(errors["true"]) < 0.3 * np.median(errors["false"])


@pytest.mark.parametrize(
    "change",
    [
        pytest.param("sensors.inertial_unit.gyros.persistence_s=0.015", marks=pytest.mark.long),
        "sensors.inertial_unit.gyros.range_deg_s=300",
    ],
)
def test_nothing_need_be_guarded_where_the_limit_is_not_integrated(unguarded, change):
    """A few degrees at most, of 150 deg where it is integrated: most openings leave 0.3 deg, some 2 deg."""
    flight = fly(edl6dof.load("schiaparelli", [change]))
    assert vertical_error(unguarded, unguarded.figures["parachute_s"] + 20.0) > 90.0
    assert vertical_error(flight, flight.figures["parachute_s"] + 20.0) < 5.0
    assert flight.landed and "guard: height below ground" not in said(flight)
