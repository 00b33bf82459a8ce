"""The methods of allocation beside each other on the nominal flight: propellant and tracking."""

import pytest

import edl6dof
from edl6dof.fsw.allocation.registry import ALLOCATORS


@pytest.fixture(scope="module")
def flights():
    return {
        name: edl6dof.fly("tianwen1", [f"flight_software.allocation.method={name}"])
        for name in ALLOCATORS.names
    }


@pytest.mark.parametrize("name", ALLOCATORS.names)
def test_lands_within_limits_and_tracks(flights, name):
    flight = flights[name]
    assert flight.outcome == "landed within limits" and flight.isolated_faults == []
    assert flight.metrics["max_roll_error_powered_deg"] < (0.5 if name == "least_squares" else 1.25)
    assert flight.metrics["max_attitude_error_powered_deg"] < 25.0  # the tilt that guidance may command


def test_least_squares_uses_no_more_propellant_than_the_table(flights):
    used = {name: flight.metrics["propellant_used_kg"] for name, flight in flights.items()}
    assert used["least_squares"] < 1.01 * used["table"]


def test_table_lands_with_a_dead_horizontal_thruster():
    fault = "faults=[{thruster: D7, kind: stuck_off, at: {phase: hazard_avoidance, plus_s: 1}}]"
    flight = edl6dof.fly("tianwen1", [fault, "flight_software.allocation.method=table"])
    assert flight.landed and [one.thruster for one in flight.isolated_faults] == ["D7"]
