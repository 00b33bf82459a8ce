"""Landings on ground that slopes: healthy beams stay in use, velocity and height are known, and a beam that
has failed is still found.
"""

import numpy as np
import pytest

import edl6dof
from edl6dof.fsw.navigation.filters.kalman.states import TERRAIN


def fly(scenario, slope_deg, downhill_deg, seed, *more):
    tilted = [f"terrain.slope_deg={slope_deg}", f"terrain.slope_azimuth_deg={downhill_deg}"]
    return edl6dof.fly(scenario, [*tilted, "terrain.slope_radius_m=20000", f"seed={seed}", *more])


def excluded(flight):
    return [one.instrument for one in flight.exclusions if one.component == "beam"]


@pytest.mark.parametrize(("slope_deg", "downhill_deg", "seed"), [(8, 270, 1), (14, 45, 2), (20, 160, 3)])
def test_velocity_and_height_are_known_on_any_slope(slope_deg, downhill_deg, seed):
    flight = fly("tianwen1", slope_deg, downhill_deg, seed)
    channels = (
        "t_s",
        *(f"nav.error_v_{axis}_m_s" for axis in ("north", "east", "down")),
        "nav.error_height_m",
    )
    t, north, east, down, height = (np.array(flight.telemetry[name]) for name in channels)
    met = flight.figures["touchdown_s"]
    near = (t > met - 40.0) & (t < met)
    assert excluded(flight) == []
    assert np.sqrt(north**2 + east**2 + down**2)[near].max() < 0.1
    assert np.abs(height)[near & (t > met - 10.0)].max() < 0.5


@pytest.mark.parametrize("scenario", ["msl_landing", "insight"])
def test_other_beams_and_filters_keep_all_beams(scenario):
    assert excluded(fly(scenario, 12, 90, 1)) == []


FAULT = "faults=[{kind: false_lock, beam: b2, at: {time_s: 100}}]"


@pytest.mark.parametrize(
    ("slope_deg", "downhill_deg", "seed"),
    [(14, 45, 2), (8, 137.5, 1), (16, 327.5, 5), (20, 327.5, 5), (20, 105, 6)],
)
def test_a_beam_that_is_locked_on_something_else_is_found_on_a_slope(slope_deg, downhill_deg, seed):
    """And no other: three beams are left, whose ranges a plane always fits."""
    flight = fly("tianwen1", slope_deg, downhill_deg, seed, FAULT)
    assert excluded(flight) == ["b2"] and flight.landed


def test_a_beam_that_is_locked_on_something_else_is_found_over_hills():
    """And no other, though the plane through the three spots that are left changes from look to look."""
    relief = "hurst: 0.95, rms_slope_deg: 8, slope_baseline_m: 100, crater_density_per_km2: 0"
    hills = f"terrain.landing_area={{model: generated, {relief}}}"
    flight = edl6dof.fly("tianwen1", [hills, "seed=3", FAULT])
    assert set(excluded(flight)) == {"b2"} and flight.landed


def test_one_echo_alone_does_not_carry_the_height_of_the_ground_along_the_way():
    """Far above the range of the radar the slope of the ground is not known for hundreds of kilometres."""

    def ground_sigma(*faults):
        simulation = edl6dof.Simulation("tianwen1", faults, telemetry=False)
        simulation.step(cycles=10000)
        filters = simulation.state().fsw["navigation"]["filter"]
        return np.sqrt(filters["error_state"]["covariance"][0, TERRAIN, TERRAIN])

    assert ground_sigma(FAULT) == pytest.approx(ground_sigma(), rel=0.01)
