"""Ground: landers' elevations, fit to the site, slopes against finite differences, the plane and the null
model.
"""

from math import atan, cos, degrees, radians

import numpy as np
import pytest

from edl6dof.environment.areoid import map_height
from edl6dof.environment.height_map import map_file
from edl6dof.environment.terrain import (
    MAP,
    TERRAIN,
    GroundInputs,
    TerrainParams,
    fill_terrain,
    ground,
    ground_arrays,
)
from edl6dof.scenario.loading import load_scenario

GRID = ground_arrays(GroundInputs(map_file(MAP)))
PLANET = load_scenario("tianwen1").scenario.planet
SITE = (radians(25.066), radians(109.925))


def build(**given) -> np.void:
    record = np.zeros(1, TERRAIN)[0]
    site = {"site_elevation_m": -4099.4, "site_latitude_deg": 25.066, "site_longitude_deg": 109.925}
    fill_terrain(record, TerrainParams(**{**site, **given}), GRID, PLANET)
    return record


@pytest.mark.parametrize(
    ("name", "lat", "lon", "true", "tolerance"),
    [("Tianwen-1", 25.066, 109.925, -4099.4, 150.0), ("InSight", 4.502, 135.623, -2613.4, 100.0)],
)
def test_map_agrees_with_landers(name, lat, lon, true, tolerance):
    assert map_height(GRID["map"], radians(lat), radians(lon))[0] == pytest.approx(true, abs=tolerance)


def test_olympus_mons_and_hellas_are_where_they_are():
    assert map_height(GRID["map"], radians(18.65), radians(-133.8))[0] > 18e3
    assert map_height(GRID["map"], radians(-42.4), radians(70.5))[0] < -5.5e3


def test_map_is_fitted_to_the_site():
    elevation, *_ = ground(build(), GRID, *SITE)
    assert elevation == pytest.approx(-4099.4, abs=1e-9)
    far = ground(build(), GRID, 0.3, 0.4)[0] - map_height(GRID["map"], 0.3, 0.4)[0]
    assert far == pytest.approx(-4099.4 - map_height(GRID["map"], *SITE)[0], abs=1e-6)


@pytest.mark.parametrize("turn", [0.0, 2 * np.pi, -2 * np.pi])
def test_longitude_wraps_and_the_map_is_continuous(turn):
    terrain = build()
    assert ground(terrain, GRID, 0.2, 3.0 + turn)[0] == pytest.approx(
        ground(terrain, GRID, 0.2, 3.0)[0], abs=1e-6
    )
    seam = np.pi + turn
    assert ground(terrain, GRID, 0.2, seam - 1e-9)[0] == pytest.approx(
        ground(terrain, GRID, 0.2, seam + 1e-9)[0], abs=1e-2
    )
    assert np.all(np.isfinite(ground(terrain, GRID, np.pi / 2, turn)))
    assert np.all(np.isfinite(ground(terrain, GRID, -np.pi / 2, turn)))


@pytest.mark.parametrize(
    "given", [{}, {"slope_deg": 5.0, "slope_azimuth_deg": 200.0}, {"model": "plane", "slope_deg": 3.0}]
)
@pytest.mark.parametrize("offset", [(0.00011, 0.00007), (0.003, -0.004)])
def test_slopes_are_the_gradient(given, offset):
    terrain = build(**given)
    lat, lon = SITE[0] + offset[0], SITE[1] + offset[1]
    _, north, east = ground(terrain, GRID, lat, lon)
    d, radius = 1e-6, 3389500.0
    by_north = (ground(terrain, GRID, lat + d, lon)[0] - ground(terrain, GRID, lat - d, lon)[0]) / (
        2 * d * radius
    )
    by_east = (ground(terrain, GRID, lat, lon + d)[0] - ground(terrain, GRID, lat, lon - d)[0]) / (
        2 * d * radius * cos(lat)
    )
    # The tilt is a plane in site-centred metres and the map is planetocentric: both differ from this metric
    # by about 1 %.
    assert (north, east) == pytest.approx((by_north, by_east), rel=0.012, abs=2e-5)


def test_plane_falls_downhill_and_stops_at_its_radius():
    terrain = build(model="plane", slope_deg=10.0, slope_azimuth_deg=90.0, site_elevation_m=100.0)
    elevation, north, east = ground(terrain, GRID, *SITE)
    assert elevation == 100.0
    assert degrees(atan(-east)) == pytest.approx(10.0, rel=1e-12)
    assert north == pytest.approx(0.0, abs=1e-15)
    metre = 1.0 / (3389500.0 * cos(SITE[0]))
    assert ground(terrain, GRID, SITE[0], SITE[1] + 1000 * metre)[0] == pytest.approx(
        100.0 - 176.327, abs=1e-3
    )
    assert ground(terrain, GRID, SITE[0], SITE[1] + 1e5 * metre)[0] == pytest.approx(
        100.0 - 2 * 176.327, abs=1e-3
    )


def test_none_and_not_a_number():
    assert ground(build(model="none", slope_deg=4.0), GRID, *SITE) == (0.0, 0.0, 0.0)
    assert len(ground(build(), GRID, np.nan, np.nan)) == 3
