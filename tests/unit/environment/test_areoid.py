"""The areoid's map: known heights, its plane along a flight, and what is refused.  ``edl6dof verify areoid``
compares it with the potential.
"""

from math import cos, pi, radians, sin

import numpy as np
import pytest
import yaml

import edl6dof
from edl6dof.config.errors import ConfigError
from edl6dof.environment.areoid import areoid_height, areoid_map, areoid_path, lay_areoid, map_height
from edl6dof.environment.height_map import map_file
from edl6dof.spatial.frames import from_geodetic

NAME = "mars_gmm3_degree12"
ON = f"planet.areoid={NAME}"


@pytest.fixture(scope="module")
def mars():
    return edl6dof.load("tianwen1", [ON]).scenario.planet


@pytest.fixture(scope="module")
def grid():
    return areoid_map(map_file(areoid_path(NAME)))


@pytest.mark.parametrize(
    ("lat", "lon", "height"), [(68.0, 234.0, 1472.0), (-4.6, 137.4, -382.0), (25.066, 109.925, 466.0)]
)
def test_known_heights(mars, lat, lon, height):
    assert areoid_height(mars, radians(lat), radians(lon)) == pytest.approx(height, abs=30.0)


def test_the_map_says_what_it_counts_from(mars):
    about = yaml.safe_load(areoid_path(NAME).with_suffix(".yaml").read_text())
    assert about["planet"] == mars.name
    for name in ("mean_radius_m", "equatorial_radius_m", "flattening"):
        assert about[name] == getattr(mars, name)
    assert "gmm3_degree12" in about["origin"] and about["licence"]


def test_the_plane_follows_the_map_until_the_next_look_at_it(mars, grid):
    """A vehicle at 6 km/s is 120 m on after a cycle: at every height, a millimetre from the map where it has
    no bend, and less than a centimetre across one.
    """
    rng, plane = np.random.default_rng(3), np.zeros(4)
    apart = []
    for _ in range(200):
        lat, lon, altitude = rng.uniform(-1.5, 1.5), rng.uniform(-pi, pi), rng.uniform(-5e3, 125e3)
        ellipsoid = mars.equatorial_radius_m, mars.flattening
        here = from_geodetic(*ellipsoid, lat, lon, altitude)
        place = sin(lat), cos(lat), sin(lon), cos(lon)
        found = lay_areoid(grid, place, lat, lon, here, plane)
        assert found == map_height(grid, lat, lon)
        assert plane[:3] @ here + plane[3] == pytest.approx(found[0], abs=1e-6)
        turn, way = rng.uniform(0.0, 2.0 * pi), 120.0 / (mars.mean_radius_m + altitude)
        there = lat + way * cos(turn), lon + way * sin(turn) / cos(lat)
        moved = np.array(from_geodetic(*ellipsoid, *there, altitude))
        apart.append(abs(plane[:3] @ moved + plane[3] - map_height(grid, *there)[0]))
    assert np.median(apart) < 1e-3 and max(apart) < 1e-2


def test_without_a_map_the_areoid_is_the_ellipsoid():
    plane = np.ones(4)
    assert areoid_height(edl6dof.load("titan_probe").scenario.planet, 0.3, 0.4) == 0.0
    found = lay_areoid(areoid_map(None), (0.0, 1.0, 0.0, 1.0), 0.0, 0.0, (3.4e6, 0.0, 0.0), plane)
    assert found == (0.0, 0.0, 0.0) and not np.any(plane)


def refused(*overrides):
    with pytest.raises(ConfigError) as caught:
        edl6dof.load("tianwen1", overrides)
    (problem,) = caught.value.problems
    assert problem.path == "planet.areoid"
    return problem.message


def test_a_map_of_another_planet_or_ellipsoid_is_refused():
    radius = refused(ON, "planet.mean_radius_m=2574700", "terrain.model=plane")
    assert radius.startswith(f"'{NAME}' is the map of a planet of planet.mean_radius_m 3389500, not 2574700")
    assert "semi-axes of 3396190 and 3376200 m, not of 3396190 and 3396190 m" in refused(
        ON, "planet.flattening=0"
    )


@pytest.mark.parametrize("kind", ["missing", "text", "shape", "nan", "names", "no file beside it"])
def test_what_is_no_map_is_refused(kind, tmp_path):
    heights, about = np.load(areoid_path(NAME)), areoid_path(NAME).with_suffix(".yaml").read_text()
    if kind == "nan":
        heights[3, 4] = np.nan
    if kind == "shape":
        heights = heights[:, :10]
    if kind == "names":
        heights = heights.astype("U8")
        heights[0, 0] = "up"
    path = tmp_path / "made.npy"
    if kind != "missing":
        np.save(path, heights)
    if kind == "text":
        path.write_text("no map")
    if kind != "no file beside it":
        path.with_suffix(".yaml").write_text(about if kind != "text" else "planet: Mars\n")
    said = {
        "missing": "cannot be read: No such file",
        "text": "made.yaml must give planet, mean_radius_m, equatorial_radius_m, flattening",
        "shape": "made.npy must hold finite numbers, shape (180, 360) (got (180, 10))",
        "nan": "made.npy must hold finite numbers",
        "names": "made.npy is no .npy file of numbers",
        "no file beside it": "cannot be read: No such file",
    }
    for model in ("table", "seasonal"):  # which reads the areoid as well
        assert said[kind] in refused(f"planet.areoid={path}", f"atmosphere.model={model}")


def test_a_map_of_ones_own_is_read_again_when_it_changes(tmp_path):
    path = tmp_path / "own.npy"
    shipped = areoid_path(NAME)
    path.with_suffix(".yaml").write_text(shipped.with_suffix(".yaml").read_text())
    for level in (100.0, -40.0):
        np.save(path, np.full((180, 360), level) if level > 0.0 else np.full((180, 360), level, "f4"))
        scenario = edl6dof.load("tianwen1", [f"planet.areoid={path}"]).scenario
        assert scenario.site_areoid_m == level
