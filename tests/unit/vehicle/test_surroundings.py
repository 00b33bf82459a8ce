"""What surrounds a body: place, moving air and gravitation, against the functions for each in planet-fixed
axes.
"""

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation

import edl6dof
from edl6dof.environment.gravity import central, gravity_F
from edl6dof.environment.planet import PLANET, PlanetParams, fill_planet
from edl6dof.scenario import records
from edl6dof.spatial.frames import from_geodetic, geodetic
from edl6dof.vehicle.surroundings import noncentral_I, planet_rotation, surroundings

PLANETS = Path(edl6dof.__file__).parent / "data" / "planets"
T = 4321.0


@pytest.fixture(params=["mars", "earth"])
def planet(request):
    record = np.zeros(1, PLANET)[0]
    text = json.dumps(yaml.safe_load((PLANETS / f"{request.param}.yaml").read_text()))
    fill_planet(record, PlanetParams.model_validate_json(text))
    return record


def places(planet, count=300):
    """Positions in F, m."""
    rng = np.random.default_rng(2)
    for _ in range(count):
        lat, lon, height = rng.uniform(-1.57, 1.57), rng.uniform(-3.1, 3.1), rng.uniform(-8e3, 2e5)
        yield np.array(from_geodetic(planet["equatorial_radius"], planet["flattening"], lat, lon, height))


def turned(planet):
    return Rotation.from_rotvec([0.0, 0.0, planet["rotation_rate"] * T])


def test_central_and_noncentral_part_are_the_whole_of_gravitation(planet):
    turn, rotation = turned(planet), planet_rotation(planet, T)
    for r_F in places(planet):
        r_I = tuple(turn.apply(r_F))
        found = np.add(central(planet["gravity"], r_I), noncentral_I(planet, rotation, r_I))
        assert found == pytest.approx(turn.apply(gravity_F(planet["gravity"], tuple(r_F))), abs=1e-12)


def test_place_is_that_in_planet_fixed_axes_and_the_air_turns_with_the_planet():
    loaded = edl6dof.load("tianwen1", ["wind.model=none"])
    tables = records.build_tables(loaded.truth)
    case = records.build_case(loaded.truth, tables)[0]
    planet = case["planet"]
    turn, spin = turned(planet), np.array([0.0, 0.0, planet["rotation_rate"]])
    for r_F in places(planet, 50):
        r_I = turn.apply(r_F)
        place, _, wind, air_I = surroundings(
            case, tables[0], np.zeros(4), planet_rotation(planet, T), tuple(r_I)
        )
        best = geodetic(planet["equatorial_radius"], planet["flattening"], tuple(r_F))
        assert place[:4] == pytest.approx(best[:4], abs=1e-12) and place[4] == pytest.approx(
            best[4], abs=5e-9
        )
        assert wind == (0.0, 0.0, 0.0)
        assert air_I == pytest.approx(np.cross(spin, r_I), abs=1e-12)
