"""What is kept of a place while a body moves a few millimetres, against the place where the body is."""

import json
from pathlib import Path

import numpy as np
import pytest
import yaml

import edl6dof
from edl6dof.environment.gravity import gravity_F
from edl6dof.environment.planet import PLANET, PlanetParams, fill_planet
from edl6dof.spatial.frames import from_geodetic, geodetic
from edl6dof.vehicle.surroundings import KEPT, KEPT_WITHIN, place_and_gravity

PLANETS = Path(edl6dof.__file__).parent / "data" / "planets"


@pytest.fixture(params=["mars", "earth"])
def planet(request):
    record = np.zeros(1, PLANET)[0]
    fill_planet(
        record,
        PlanetParams.model_validate_json(
            json.dumps(yaml.safe_load((PLANETS / f"{request.param}.yaml").read_text()))
        ),
    )
    return record


def places(planet, count=300):
    rng = np.random.default_rng(2)
    for lat, lon, height in zip(
        rng.uniform(-1.57, 1.57, count),
        rng.uniform(-3.1, 3.1, count),
        rng.uniform(-8e3, 2e5, count),
        strict=True,
    ):
        yield (
            rng,
            np.array(from_geodetic(planet["equatorial_radius"], planet["flattening"], lat, lon, height)),
        )


def exactly(planet, r):
    return geodetic(planet["equatorial_radius"], planet["flattening"], tuple(r)), gravity_F(
        planet["gravity"], *r
    )


def test_new_place_is_that_of_the_body(planet):
    for _, r in places(planet):
        assert place_and_gravity(planet, np.zeros(1, KEPT)[0], tuple(r)) == exactly(planet, r)


def test_kept_place_is_as_good_as_the_docstring_says(planet):
    for rng, r in places(planet):
        kept = np.zeros(1, KEPT)[0]
        place_and_gravity(planet, kept, tuple(r))
        beside = r + rng.uniform(-KEPT_WITHIN, KEPT_WITHIN, 3)
        (*direction, altitude), gravity = place_and_gravity(planet, kept, tuple(beside))
        assert np.array_equal(kept["at"], r)
        (*best_direction, best_altitude), best_gravity = exactly(planet, beside)
        cos_lat = best_direction[1]
        assert np.allclose(direction[:2], best_direction[:2], rtol=0.0, atol=3e-9)
        assert np.allclose(direction[2:], best_direction[2:], rtol=0.0, atol=3e-9 / cos_lat)
        # rounding of the two positions; the method's share is 1e-11 m
        assert altitude == pytest.approx(best_altitude, abs=5e-9)
        assert np.allclose(gravity, best_gravity, rtol=0.0, atol=2e-10)


def test_place_is_worked_out_anew_where_the_body_has_gone_farther(planet):
    for _, r in places(planet, 20):
        kept = np.zeros(1, KEPT)[0]
        place_and_gravity(planet, kept, tuple(r))
        away = r + np.array([0.0, 0.0, 1.01 * KEPT_WITHIN])
        assert place_and_gravity(planet, kept, tuple(away)) == exactly(planet, away)
