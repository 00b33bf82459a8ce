"""Landings on generated ground: footpads and figures against the ground itself, worked out with numpy."""

from itertools import count, islice
from math import atan, degrees, hypot

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import edl6dof
from edl6dof.environment.areoid import areoid_height
from edl6dof.environment.landing_area.population import list_within
from edl6dof.environment.terrain import ground, place_of
from edl6dof.scenario.terrain_preview import TerrainPreview
from edl6dof.sim.outcome import LANDED, TIME_LIMIT, TIPPED_OVER
from edl6dof.spatial.frames import geodetic

#: First seed to try and share of rocks: ground of many kinds.
CASES = [(1, 0.04), (3, 0.2), (4, 0.3)]
#: As it comes down where it comes down.
BLIND = "flight_software.hazard.detection=given"


@pytest.fixture(
    scope="module",
    params=[pytest.param(case, marks=pytest.mark.long if case == (3, 0.2) else []) for case in CASES],
    ids=[f"seed {seed}, {share:.0%}" for seed, share in CASES],
)
def landed(request):
    """The first of the seeds that lands."""
    seed, share = request.param
    return next(flight for flight in flights_over(share, range(seed, seed + 10)) if flight.code == LANDED)


def flights_over(share, seeds):
    """Flights over ground with a share of rocks, one of each seed."""
    rocks = f"terrain.landing_area.rock_abundance={share}"
    return (edl6dof.fly("tianwen1_hazards", [f"seed={seed}", rocks, BLIND]) for seed in seeds)


def points_F(flight, points):
    """Points of the body (B, m) in F at the end of the flight."""
    y, t = flight.plant["y"][0], flight.time_s
    to_I = Rotation.from_quat([*y[7:10], y[6]])
    to_F = Rotation.from_euler("z", -flight.scenario.planet.rotation_rate_rad_s * t)
    return to_F.apply(y[:3] + to_I.apply(np.array(points) - flight.outputs["centre"][0]))


def up_at(flight, point):
    """Outward normal of the ellipsoid at a point in F."""
    planet = flight.scenario.planet
    sl, cl, so, co, _ = geodetic(planet.equatorial_radius_m, planet.flattening, tuple(point))
    return np.array([cl * co, cl * so, sl])


def above_ground(flight, point):
    """Height (m) of a point in F above the ground below it, its place (m north and east of the site), and the
    elevation (m) of the ground there.
    """
    case, planet = flight.case[0], flight.scenario.planet
    sl, cl, so, co, altitude = geodetic(planet.equatorial_radius_m, planet.flattening, tuple(point))
    lat, lon = np.arctan2(sl, cl), np.arctan2(so, co)
    elevation = ground(case["terrain"], flight.tables["terrain"][0], lat, lon)[0]
    height = altitude - elevation - areoid_height(planet, lat, lon)
    return height, *place_of(case["terrain"], lat, lon), elevation


def test_footpads_stand_on_the_ground_under_each_of_them(landed):
    """Points press on it by what the weight pushes them in, the more the more it leans; no other is below
    it.
    """
    gear = landed.scenario.vehicle.landing_gear
    pads = np.array([above_ground(landed, point)[0] for point in points_F(landed, gear.footpads_m)])
    below = np.array([above_ground(landed, point)[0] for point in points_F(landed, gear.underside_m)])
    depths = -np.concatenate([pads, below])
    weight = float(landed.outputs["mass"][0]) * 3.72
    assert np.sum(depths > 0.0) >= 2 and landed.outputs["pads"][0] == np.sum(pads < 0.0)
    carried = np.sum(gear.stiffness_n_m * np.maximum(depths, 0.0))
    assert 0.7 * weight < carried < 2.5 * weight


def test_figures_of_the_footing_are_those_of_the_ground(landed):
    gear, figures = landed.scenario.vehicle.landing_gear, landed.figures
    pads = np.array([above_ground(landed, point) for point in points_F(landed, gear.footpads_m)])
    design = np.column_stack([pads[:, 1:3] - pads[:, 1:3].mean(axis=0), np.ones(4)])
    rise = np.linalg.lstsq(design, pads[:, 3] - pads[:, 3].mean(), rcond=None)[0]
    assert figures["touchdown_slope_deg"] == pytest.approx(degrees(atan(hypot(*rise[:2]))), abs=0.02)

    middle = above_ground(landed, points_F(landed, [landed.outputs["centre"][0]])[0])
    rocks = np.zeros((1000, 4))
    count = list_within(
        landed.case["terrain"]["landing_area"]["rocks"][0], middle[1] - 3, middle[2] - 3, 6.0, rocks
    )
    inside = rocks[:count][np.hypot(rocks[:count, 0] - middle[1], rocks[:count, 1] - middle[2]) <= 2.0027]
    assert figures["rocks_under_lander"] == np.sum(inside[:, 2] >= 0.5)
    assert figures["largest_rock_m"] == pytest.approx(inside[:, 2].max(initial=0.0))
    assert figures["largest_rock_height_m"] == pytest.approx(0.5 * figures["largest_rock_m"])

    angles, radii = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False), np.linspace(0.0, 0.8485, 30)
    lowest = max(point[0] for point in gear.underside_m)
    disc = [(lowest, r * np.cos(a), r * np.sin(a)) for r in radii for a in angles]
    clearances = [above_ground(landed, point)[0] for point in points_F(landed, disc)]
    assert figures["belly_clearance_m"] == pytest.approx(min(clearances), abs=0.03)


def test_a_rock_under_the_belly_is_the_cause_of_no_success():
    """Whatever the limits break on: success means no large rock and no ground into the belly.  Seeds are
    flown until one of another kind has come.
    """
    seen = set()
    for flight in islice(flights_over(0.2, count(1)), 25):
        rock, reach = flight.figures["largest_rock_m"], flight.figures["ground_under_belly_m"]
        if flight.code != LANDED:
            continue
        assert ("largest rock under the lander" in flight.outcome) == (rock > 0.5)
        assert ("ground under the belly" in flight.outcome) == (reach > 0.28)
        assert flight.success == (rock <= 0.5 and reach <= 0.28)
        seen.add((rock > 0.5, reach > 0.28))
        if len(seen) > 1:
            break
    assert len(seen) > 1


def test_what_ends_on_hills_and_holes_stands_or_has_tipped_over():
    """A lander that still rocks on its legs at the time limit stands as well.

    Which of them it is follows from the motion: see tests/unit/vehicle/test_touchdown.py.
    """
    rough = ["terrain.landing_area.rms_slope_deg=20", "terrain.landing_area.slope_baseline_m=3"]
    for seed in range(1, 4):
        flight = edl6dof.fly("tianwen1_hazards", [f"seed={seed}", *rough, BLIND])
        nose, middle = points_F(flight, [(1.0, 0.0, 0.0), (0.0, 0.0, 0.0)])
        tilt = np.arccos((middle - nose) @ up_at(flight, middle))
        assert flight.code in ((TIPPED_OVER,) if tilt > 0.8 else (LANDED, TIME_LIMIT))


def test_without_a_generated_landing_area_there_are_no_such_figures():
    assert "rocks_under_lander" not in edl6dof.fly("tianwen1").figures


def test_viewers_see_the_ground_of_the_flight(landed):
    scenario, case = landed.scenario, landed.case[0]
    relief = TerrainPreview(scenario.terrain, scenario.planet, scenario.seed, scenario.profile)
    lat, lon = (
        np.radians(25.066 + np.linspace(-0.01, 0.01, 40)),
        np.radians(109.925 + np.linspace(-0.02, 0.03, 40)),
    )
    own = [
        ground(case["terrain"], landed.tables["terrain"][0], *place)[0]
        for place in zip(lat, lon, strict=True)
    ]
    assert np.array_equal(relief.heights(lat, lon)[0], own)
