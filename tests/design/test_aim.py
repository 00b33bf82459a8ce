"""The entry point that reaches another site: geometry against rotations, and planned entries of missions."""

from math import degrees, radians

import numpy as np
import pytest

import edl6dof
from edl6dof.config.errors import ConfigError
from edl6dof.design.aim import (
    CLOSE_ASIDE_M,
    CLOSE_M,
    Place,
    aim_entry,
    moved,
    planned_end,
    start_before,
)
from edl6dof.spatial.frames import great_circle
from tests.in_process import called


def direction(place):
    """Unit vector of a place, by numpy."""
    return np.array(
        [
            np.cos(place.latitude) * np.cos(place.longitude),
            np.cos(place.latitude) * np.sin(place.longitude),
            np.sin(place.latitude),
        ]
    )


def random_place(rng):
    return Place(np.arcsin(rng.uniform(-0.95, 0.95)), rng.uniform(-np.pi, np.pi))


@pytest.mark.parametrize("seed", range(20))
def test_a_great_circle_is_a_rotation_about_its_pole(seed):
    """Rodrigues' formula: the start turns about the normal of the plane of position and direction."""
    rng = np.random.default_rng(seed)
    start, bearing, distance = random_place(rng), rng.uniform(-np.pi, np.pi), rng.uniform(0.01, 1.5)
    r = direction(start)
    north = np.array([0.0, 0.0, 1.0]) - r[2] * r
    north /= np.linalg.norm(north)
    along = np.cos(bearing) * north + np.sin(bearing) * np.cross(north, r)
    end = moved(start, bearing, distance)
    assert direction(end) == pytest.approx(np.cos(distance) * r + np.sin(distance) * along, abs=1e-14)
    assert great_circle(start, end) == pytest.approx((distance, bearing), abs=1e-12)
    behind = moved(start, bearing, -distance)
    assert direction(behind) == pytest.approx(np.cos(distance) * r - np.sin(distance) * along, abs=1e-14)


@pytest.mark.parametrize("seed", range(20))
def test_start_is_where_a_course_of_that_bearing_and_length_comes_from(seed):
    rng = np.random.default_rng(seed)
    bearing, distance = rng.uniform(-np.pi, np.pi), rng.uniform(0.01, 0.5)
    end = moved(random_place(rng), bearing, distance)
    assert direction(moved(start_before(end, distance, bearing), bearing, distance)) == pytest.approx(
        direction(end), abs=1e-14
    )


def test_a_latitude_beyond_every_course_is_refused():
    with pytest.raises(ConfigError, match="of the scenario reaches the latitude 80.0 deg"):
        start_before(Place(radians(80.0), 0.0), distance=0.2, bearing=radians(90.0))


@pytest.mark.parametrize(
    "name, latitude, longitude",
    [
        ("tianwen1", 18.44, 77.45),
        pytest.param("tianwen1", -30.0, 10.0, marks=pytest.mark.long),
        pytest.param("msl", 18.44, 77.45, marks=pytest.mark.long),
        pytest.param("phoenix", 60.0, 100.0, marks=pytest.mark.long),
    ],
)
def test_the_planned_entry_ends_at_another_site_as_at_its_own(name, latitude, longitude):
    site = [f"terrain.site_latitude_deg={latitude}", f"terrain.site_longitude_deg={longitude}"]
    found = aim_entry(name, [], site)
    assert found.reached and found.entries <= 8
    new, old = edl6dof.load(name, [*site, *found.overrides]).scenario, edl6dof.load(name).scenario
    beyond, aside = np.subtract(planned_end(new), planned_end(old))
    assert (
        abs(beyond) < CLOSE_M + 5.0 and abs(aside) < CLOSE_ASIDE_M + 5.0
    )  # the place is rounded to 1e-6 deg
    here = Place(radians(found.entry_deg[0]), radians(found.entry_deg[1]))
    bearing = degrees(great_circle(here, Place(radians(latitude), radians(longitude)))[1])
    own = Place(radians(old.initial.latitude_deg), radians(old.initial.longitude_deg))
    site_of = Place(radians(old.terrain.site_latitude_deg), radians(old.terrain.site_longitude_deg))
    assert bearing % 360.0 == pytest.approx(degrees(great_circle(own, site_of)[1]) % 360.0, abs=1.0)


def test_without_the_change_of_the_entry_point_the_new_site_is_far():
    site = ["terrain.site_latitude_deg=18.44", "terrain.site_longitude_deg=77.45"]
    beyond, aside = planned_end(edl6dof.load("tianwen1", site).scenario)
    assert np.hypot(beyond, aside) > 500e3


def test_a_start_beyond_the_pole_is_refused():
    """Flying south over 13 deg of latitude, a capsule cannot reach 80 deg north."""
    with pytest.raises(ConfigError, match="reaches the latitude 80.0 deg"):
        start_before(Place(radians(80.0), 0.0), distance=radians(13.0), bearing=radians(181.0))


def test_the_command_writes_a_scenario_that_reaches_the_site(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = called("design", "aim", "tianwen1", "--site", "18.44", "77.45", "--out", "jezero.yaml")
    assert done.returncode == 0 and "new site: landed within limits" in done.stdout
    assert "tianwen1 at 18.44 N, 77.45 E" in done.stdout
    jezero, own = edl6dof.load("jezero.yaml").scenario, edl6dof.load("tianwen1").scenario
    assert (jezero.terrain.site_latitude_deg, jezero.terrain.site_longitude_deg) == (18.44, 77.45)
    assert jezero.initial.azimuth_deg == own.initial.azimuth_deg
    assert not [line for line in edl6dof.load("jezero.yaml").warnings if "beyond the estimated range" in line]


@pytest.mark.parametrize(
    "words, message",
    [
        (("--site", "98", "0"), "terrain.site_latitude_deg"),
        (("--site", "85", "0"), "reaches the latitude 85.0 deg"),
        (("--site", "0", "0", "--out", "x.txt"), "must end in .yaml, .yml"),
        (("--site", "0", "0", "--date", "tomorrow"), "initial.epoch_utc"),
    ],
)
def test_bad_input_is_refused_before_a_flight(words, message):
    done = called("design", "aim", "msl", *words)
    assert done.returncode == 2 and message in done.stderr and "Traceback" not in done.stderr
