"""Verifies: flights with seeded density perturbations and gusts all end in a named outcome, 95 % of them
within limits.
"""

from __future__ import annotations

import pytest
from chance import fewest

import edl6dof

PERTURBED = ["atmosphere.perturbation.enabled=true", "wind.gust.enabled=true"]


@pytest.mark.parametrize("count", [8, pytest.param(60, marks=pytest.mark.long)])
def test_seeds_with_perturbations_on(count):
    flights = [edl6dof.fly("tianwen1", [f"seed={seed}", *PERTURBED]) for seed in range(1, count + 1)]
    assert all(flight.outcome and flight.outcome != "flying" for flight in flights)
    assert sum(flight.success for flight in flights) >= fewest(count, 0.95)
    # they really differ: landing points spread over more than a kilometre
    east = [flight.figures["landing_east_m"] for flight in flights if flight.landed]
    assert max(east) - min(east) > 1000.0


@pytest.mark.parametrize(
    "change",
    [
        "atmosphere.density_factor: 0.8",
        pytest.param("initial.flight_path_angle_deg: -11.3", marks=pytest.mark.long),
        pytest.param("vehicle.mass.entry_kg: 1300", marks=pytest.mark.long),
        "wind.scale: 2.0",
        pytest.param("atmosphere.density_factor: 1.2", marks=pytest.mark.long),
        pytest.param("initial.flight_path_angle_deg: -11.85", marks=pytest.mark.long),
    ],
)
def test_flight_computer_copes_with_what_it_was_not_told(change):
    """Density, flight-path angle, mass and wind of the truth changed while the belief stays nominal."""
    flight = edl6dof.fly("tianwen1", [f"truth={{{change}}}"])
    assert flight.landed, flight.outcome
    assert flight.figures["landing_distance_m"] < 10000.0
