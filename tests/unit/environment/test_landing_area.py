"""Generated ground: the raster against its nodes, slopes against differences, relief, craters and rocks
against their laws.
"""

from concurrent.futures import ThreadPoolExecutor
from math import atan, degrees, exp, pi, radians, sqrt, tan

import numpy as np
import pytest
from scipy import integrate, stats

from edl6dof.config.errors import ConfigError
from edl6dof.environment.landing_area.population import (
    DEPTH,
    EDGE,
    POPULATION,
    RIM,
    WORN_DEPTH,
    crater_height,
    drawn_in,
    list_within,
    rock_height,
    within,
)
from edl6dof.environment.landing_area.raster import RASTER_WORK, lay_raster
from edl6dof.environment.landing_area.relief import (
    CRATER_DIAMETER,
    LandingAreaParams,
    corners,
    landing_area_problems,
    relief,
)
from edl6dof.environment.terrain import (
    TERRAIN,
    TerrainParams,
    fill_terrain,
    geodetic_of,
    ground,
    ground_arrays,
    ground_inputs,
    place_of,
    regional,
)
from edl6dof.scenario.loading import load_scenario
from edl6dof.spatial.frames import fixed_to_enu, from_geodetic

PLANET = load_scenario("tianwen1").scenario.planet
ELEVATION = -4099.4
#: Neither craters nor rocks, and no fractal relief.
BARE = {"crater_density_per_km2": 0.0, "rock_abundance": 0.0}
SMOOTH = {"rms_slope_deg": 0.0}


def build(seed=1, given=None, case=0, **area):
    params = TerrainParams(
        **{"site_elevation_m": ELEVATION, "site_latitude_deg": 25.066, "site_longitude_deg": 109.925},
        **(given or {}),
        landing_area=LandingAreaParams(**{"model": "generated", **area}),
    )
    terrain, grid = np.zeros(1, TERRAIN)[0], ground_arrays(ground_inputs(params, PLANET))
    fill_terrain(terrain, params, grid, PLANET, seed, case)
    return terrain, grid


def laid(terrain, grid, north, east, size=512):
    heights = np.zeros((size, size), "f4")
    return heights, *lay_raster(
        terrain, grid, float(north), float(east), heights, np.zeros(1, RASTER_WORK)[0]
    )


@pytest.mark.parametrize("seed, north, east", [(1, -20.0, -30.0), (2, 4321.0, -1234.5), (7, -19.98e3, 55.55)])
def test_painted_raster_is_what_its_nodes_are(seed, north, east):
    terrain, grid = build(seed, rock_abundance=0.2, crater_density_per_km2=200.0, given={"slope_deg": 3.0})
    heights, south, west = laid(terrain, grid, north, east, 256)
    assert (south, west) == pytest.approx((north, east), abs=0.051)
    step = terrain["landing_area"]["cell"]
    i, j = round(south / step), round(west / step)
    for a, b in np.random.default_rng(1).integers(0, 256, (200, 2)).tolist():
        own = corners(terrain["landing_area"], grid["tiles"], i + a, j + b)[0]
        below = regional(terrain, grid, *geodetic_of(terrain, south + a * step, west + b * step))[0]
        height = below - ELEVATION + own
        assert heights[a, b] == pytest.approx(height, abs=1e-6 + 2.0**-23 * abs(height))


def test_neighbouring_cells_agree_to_the_last_bit_on_their_corners():
    terrain, grid = build(rock_abundance=0.3, crater_density_per_km2=500.0)
    area, tiles = terrain["landing_area"], grid["tiles"]
    for i, j in np.random.default_rng(2).integers(-(10**5), 10**5, (500, 2)).tolist():
        sw, se, nw, ne = corners(area, tiles, i, j)
        assert se == corners(area, tiles, i, j + 1)[0]
        assert nw == corners(area, tiles, i + 1, j)[0]
        assert ne == corners(area, tiles, i + 1, j + 1)[0] == corners(area, tiles, i, j + 1)[2]
        assert sw == corners(area, tiles, i - 1, j - 1)[3]


def test_ground_is_bilinear_between_the_nodes_and_its_slope_its_gradient():
    terrain, grid = build(rock_abundance=0.2, given={"model": "plane"})
    heights, south, west = laid(terrain, grid, 210.0, -90.0, 64)
    rng = np.random.default_rng(3)
    for _ in range(300):
        row, column, u, t = *rng.integers(0, 62, 2), *rng.uniform(0.02, 0.98, 2)
        sw, se, nw, ne = heights[row : row + 2, column : column + 2].astype(float).ravel()
        north, east = south + 0.1 * (row + u), west + 0.1 * (column + t)
        elevation, rise_north, rise_east = ground(terrain, grid, *geodetic_of(terrain, north, east))
        between = (1 - u) * ((1 - t) * sw + t * se) + u * ((1 - t) * nw + t * ne)
        assert elevation - ELEVATION == pytest.approx(between, abs=1e-5)

        def along(d_north, d_east, north=north, east=east):
            up, down = (
                ground(terrain, grid, *geodetic_of(terrain, north + k * d_north, east + k * d_east))[0]
                for k in (1.0, -1.0)
            )
            return (up - down) / (2.0 * (d_north + d_east))

        d = 5e-4
        assert (along(d, 0.0), along(0.0, d)) == pytest.approx((rise_north, rise_east), abs=1e-4)


@pytest.mark.parametrize("north, east", [(0.0, 0.0), (700.0, -400.0), (-3e3, 5e3)])
def test_metres_of_the_plane_are_metres_on_the_ground(north, east):
    terrain, _ = build()
    lat, lon = geodetic_of(terrain, north, east)
    assert place_of(terrain, lat, lon + 2.0 * pi) == pytest.approx((north, east), abs=1e-6)
    altitude = ELEVATION + load_scenario("tianwen1").scenario.site_areoid_m
    shape = PLANET.equatorial_radius_m, PLANET.flattening
    at = radians(25.066), radians(109.925)
    site = from_geodetic(*shape, *at, altitude)
    enu = fixed_to_enu(
        site,
        (np.sin(at[0]), np.cos(at[0]), np.sin(at[1]), np.cos(at[1])),
        from_geodetic(*shape, lat, lon, altitude),
    )
    turned = 1e-6 + (north**2 + east**2) / PLANET.mean_radius_m
    assert enu[:2] == pytest.approx((east, north), abs=turned)


@pytest.mark.parametrize(
    "hurst, slope, baseline",
    [
        (0.5, 2.0, 5.0),
        pytest.param(0.75, 4.0, 1.0, marks=pytest.mark.long),
        pytest.param(0.8, 1.0, 20.0, marks=pytest.mark.long),
    ],
)
def test_relief_has_the_slope_at_its_baseline_and_the_hurst_exponent(hurst, slope, baseline):
    """Structure function over several seeds and places (Shepard et al. 2001)."""
    area = {"hurst": hurst, "rms_slope_deg": slope, "slope_baseline_m": baseline}
    lags = np.array([4, 8, 16, 32, 64, 128, 256])
    square, own, count = np.zeros(len(lags)), 0.0, 0
    for seed in range(14):
        terrain, grid = build(seed, given={"model": "plane"}, **area, **BARE)
        for north, east in np.random.default_rng(seed).uniform(-5e3, 5e3, (3, 2)):
            z = laid(terrain, grid, north, east)[0].astype(float)
            for k, lag in enumerate(lags):
                rises = z[lag:] - z[:-lag], z[:, lag:] - z[:, :-lag]
                square[k] += np.mean([np.mean(rise**2) for rise in rises])
            lag = round(baseline / 0.1)
            own += np.mean((z[lag:] - z[:-lag]) ** 2) + np.mean((z[:, lag:] - z[:, :-lag]) ** 2)
            count += 2
    assert sqrt(own / count) / baseline == pytest.approx(tan(radians(slope)), rel=0.06)
    found = np.polyfit(np.log(lags), np.log(square), 1)[0] / 2.0
    assert found == pytest.approx(hurst, abs=0.05)


def test_site_keeps_its_elevation_under_the_relief():
    terrain, grid = build(**BARE)
    assert ground(terrain, grid, radians(25.066), radians(109.925))[0] == pytest.approx(ELEVATION, abs=1e-6)


def golombek(abundance, diameter):
    """Rocks of at least ``diameter`` on a square metre, by quadrature."""
    q = 1.79 + 0.152 / abundance
    return integrate.quad(lambda x: 4 * q * abundance * exp(-q * x) / (pi * x * x), diameter, np.inf)[0]


@pytest.mark.parametrize(
    "abundance, diameter, per_m2",
    [(0.1, 0.3, 0.211), (0.1, 0.5, 0.050), (0.1, 1.0, 0.0031), (0.04, 0.3, 0.0546), (0.04, 0.5, 0.0078)]
    + [(0.04, 1.0, 0.00014)],
)
def test_rocks_are_as_many_as_golombek_says(abundance, diameter, per_m2):
    assert golombek(abundance, diameter) == pytest.approx(per_m2, rel=0.035)  # as printed
    radius, found, expected = 150.0, 0, 0.0
    for seed in range(6):
        terrain, _ = build(seed, rock_abundance=abundance)
        for north, east in np.random.default_rng(seed).uniform(-9e3, 9e3, (3, 2)):
            found += within(terrain["landing_area"]["rocks"], north, east, radius, diameter)[0]
            expected += pi * radius**2 * golombek(abundance, diameter)
    assert abs(found - expected) < 3.5 * sqrt(expected)


@pytest.mark.parametrize("abundance, share", [(0.1, 0.467), (0.04, 0.094)])
def test_a_place_taken_blindly_has_a_rock_under_the_lander_as_often_as_it_must(abundance, share):
    """Rocks of half a metre and more in a disc of 12.6 m2, at places of many cases."""
    assert 1.0 - exp(-12.6 * golombek(abundance, 0.5)) == pytest.approx(share, abs=0.0005)
    hit, count = 0, 8000
    for seed in range(20):
        rocks = build(seed, rock_abundance=abundance)[0]["landing_area"]["rocks"]
        for north, east in np.random.default_rng(seed).uniform(-15e3, 15e3, (count // 20, 2)):
            hit += within(rocks, north, east, sqrt(12.6 / pi), 0.5)[0] > 0
    low, high = stats.binom.interval(0.999, count, share)
    assert low <= hit <= high


@pytest.mark.parametrize("abundance", [0.04, 0.1, 0.2])
def test_rocks_cover_the_share_of_the_ground_that_golombek_says(abundance):
    terrain, _ = build(3, rock_abundance=abundance)
    rocks, side = np.zeros((2_000_000, 4)), 600.0
    count = list_within(terrain["landing_area"]["rocks"], -700.0, 150.0, side, rocks)
    diameters = rocks[:count, 2]
    q = 1.79 + 0.152 / abundance
    for smallest in (0.2, 0.4, 0.8):
        areas = pi / 4.0 * diameters[diameters >= smallest] ** 2
        spread = sqrt(np.sum(areas**2)) / side**2
        assert abs(np.sum(areas) / side**2 - abundance * exp(-q * smallest)) < 3.5 * spread
    turned = 2.0 * pi * rocks[:count, :2] / 0.5  # the cells of the smallest do not show
    assert abs(np.exp(1j * turned).mean(axis=0)).max() < 4.0 / sqrt(count)


def test_rock_is_the_upper_half_of_a_sphere():
    """Height half the diameter: the height z at a distance r fulfils r^2 + z^2 = (D/2)^2."""
    for distance in (0.0, 0.1, 0.25, 0.39):
        assert rock_height(0.8, distance**2) == pytest.approx(sqrt(0.4**2 - distance**2), rel=1e-12)
    assert rock_height(0.8, 0.41**2) == 0.0


@pytest.mark.parametrize("mean", [0.3, 2.5, 8.0])
def test_number_in_a_cell_is_the_quantile_of_poisson_at_its_bits(mean):
    population = np.zeros(1, POPULATION).view(np.recarray)[0]
    population["mean"][0], population["empty"][0] = mean, exp(-mean)
    for share in np.random.default_rng(3).uniform(size=200):
        bits = np.uint64(int(share * 2.0**53) << 11)
        assert drawn_in(population, 0, bits) == stats.poisson.ppf(share, mean)


@pytest.mark.parametrize("exponent, density", [(2.0, 40.0), (3.0, 5.0)])
def test_craters_are_as_many_as_their_law_says(exponent, density):
    expected = {10.0: 0.0, 20.0: 0.0, 50.0: 0.0}
    found = dict.fromkeys(expected, 0)
    for seed in range(8):
        terrain, _ = build(seed, crater_exponent=exponent, crater_density_per_km2=density)
        rows = np.zeros((400_000, 4))
        count = list_within(terrain["landing_area"]["craters"], -8e3, -8e3, 6e3, rows)
        for diameter in expected:
            law = density * (
                (diameter / CRATER_DIAMETER) ** -exponent - (200.0 / CRATER_DIAMETER) ** -exponent
            )
            expected[diameter] += 36.0 * law
            found[diameter] += int(np.sum(rows[:count, 2] >= diameter))
    for diameter, number in expected.items():
        assert abs(found[diameter] - number) < 3.5 * sqrt(number)


def test_fresh_crater_is_a_fifth_deep_and_a_worn_one_a_twentieth_and_both_end():
    at = [crater_height(10.0, 1.0, (5.0 * r) ** 2) for r in (0.0, 1.0, 1.0 + 1e-12, EDGE - 1e-9, EDGE)]
    assert at[1] - at[0] == pytest.approx(DEPTH * 10.0)
    assert at[1:3] == pytest.approx([RIM * 10.0] * 2) and at[3:] == pytest.approx([0.0, 0.0], abs=1e-8)
    assert crater_height(10.0, 0.0, 0.0) == pytest.approx(-WORN_DEPTH * 10.0)
    assert crater_height(10.0, 0.0, 100.0) == 0.0


def test_a_crater_and_a_rock_of_the_census_lie_in_the_ground():
    terrain, grid = build(5, rock_abundance=0.1, **SMOOTH)
    area, rows = terrain["landing_area"], np.zeros((200_000, 4))
    for k in range(list_within(area["rocks"], 0.0, 0.0, 100.0, rows)):
        north, east, diameter, _ = rows[k]
        if diameter > 1.0 and within(area["craters"], north, east, 200.0, 2.0)[0] == 0:
            top = relief(area, grid["tiles"], north, east)[0]
            assert top == pytest.approx(0.5 * diameter, abs=0.1 * diameter)
    count = list_within(area["craters"], 0.0, 0.0, 2000.0, rows)
    largest = rows[:count][np.argmax(rows[:count, 2])]
    middle = relief(area, grid["tiles"], largest[0], largest[1])[0]
    depth = largest[2] * (largest[3] * (DEPTH - RIM) + (1 - largest[3]) * WORN_DEPTH)
    assert middle == pytest.approx(-depth, abs=0.25 * depth + 0.5)


def test_every_case_and_every_seed_has_its_own_ground_and_always_the_same():
    (one, grid), (two, _), (again, _) = build(1), build(2), build(1)
    z = laid(one, grid, 0.0, 0.0, 64)[0]
    assert np.mean(z == laid(two, grid, 0.0, 0.0, 64)[0]) < 0.01
    assert np.mean(z == laid(build(1, case=1)[0], grid, 0.0, 0.0, 64)[0]) < 0.01
    with ThreadPoolExecutor(4) as pool:
        places = [(0.0, 0.0), (3.2, -1.6), (-5.0, 2.0), (0.0, 0.0)]
        parts = list(pool.map(lambda place: laid(again, grid, *place, 64)[0], places))
    assert np.array_equal(parts[0], z) and np.array_equal(parts[3], z)
    assert np.array_equal(parts[1][:32, 16:], z[32:, :48])


def test_edge_of_the_area_fades_and_beyond_it_the_ground_is_the_map():
    terrain, grid = build(extent_m=500.0)
    for north, east in ((501.0, 0.0), (1e5, -1e6), (0.0, -501.0)):
        place = geodetic_of(terrain, north, east)
        assert ground(terrain, grid, *place) == regional(terrain, grid, *place)
    heights = [relief(terrain["landing_area"], grid["tiles"], 499.9 + k * 0.01, 3.0)[0] for k in range(12)]
    assert np.max(np.abs(np.diff(heights))) < 0.01
    assert len(ground(terrain, grid, np.nan, np.nan)) == 3


def test_without_a_landing_area_the_ground_is_the_map_and_the_raster_follows_it():
    terrain, grid = build(model="none", given={"slope_deg": 5.0})
    heights, south, west = laid(terrain, grid, -10.0, 20.0, 200)
    for a, b in ((0, 0), (17, 150), (199, 199)):
        place = geodetic_of(terrain, south + 0.1 * a, west + 0.1 * b)
        assert ground(terrain, grid, *place) == regional(terrain, grid, *place)
        assert heights[a, b] == pytest.approx(ground(terrain, grid, *place)[0] - ELEVATION, abs=1e-6)
    gradient = np.hypot(heights[100, 0] - heights[0, 0], heights[0, 100] - heights[0, 0]) / 10.0
    assert degrees(atan(gradient)) == pytest.approx(5.0, abs=0.7)  # on the map's own slope


def test_numbers_that_do_not_fit_together_are_named():
    crowded = LandingAreaParams(crater_density_per_km2=500.0, crater_exponent=3.5, smallest_crater_m=1.0)
    assert "reach one place" in landing_area_problems(crowded)["smallest_crater_m"]
    upside_down = LandingAreaParams(smallest_rock_m=1.0, largest_rock_m=1.0)
    assert landing_area_problems(upside_down).keys() == {"smallest_rock_m"}
    assert not landing_area_problems(LandingAreaParams(rock_abundance=0.4, smallest_rock_m=0.05))
    with pytest.raises(ConfigError, match="terrain.landing_area.smallest_crater_m"):
        load_scenario("tianwen1_hazards", ["terrain.landing_area.smallest_crater_m=300"])
