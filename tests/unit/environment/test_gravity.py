"""Gravity kernel against the gradient of an independent potential, closed forms and symmetries."""

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from pydantic import ValidationError
from scipy.special import factorial, lpmv

import edl6dof
from edl6dof.environment.gravity import (
    GRAVITY,
    GravityParams,
    fill_gravity,
    fill_terms,
    gravity_F,
    read_coefficients,
)
from edl6dof.environment.planet import PLANET, PlanetParams, fill_planet

PLANETS = Path(edl6dof.__file__).parent / "data" / "planets"


def planet(name: str) -> PlanetParams:
    return PlanetParams.model_validate_json(
        json.dumps(yaml.safe_load((PLANETS / f"{name}.yaml").read_text()))
    )


def record(**changes) -> np.void:
    params = GravityParams(**(planet("mars").gravity.model_dump() | changes))
    out = np.zeros(1, GRAVITY)[0]
    fill_gravity(out, params)
    return out


def points(count: int, seed: int = 1) -> np.ndarray:
    rng = np.random.default_rng(seed)
    direction = rng.normal(size=(count, 3))
    return direction / np.linalg.norm(direction, axis=1)[:, None] * rng.uniform(3.38e6, 3.6e6, (count, 1))


def potential_beyond_centre(p: np.ndarray, degree: int) -> float:
    """U - mu/r in spherical coordinates, with scipy's Legendre functions (their Condon-Shortley sign
    removed).
    """
    radius, mu, C, S = read_coefficients("gmm3_degree12_sha.tab")
    r, lon = np.linalg.norm(p), np.arctan2(p[1], p[0])
    total = 0.0
    for n in range(2, degree + 1):
        m = np.arange(n + 1)
        norm = np.sqrt(np.where(m == 0, 1, 2) * (2 * n + 1) * factorial(n - m) / factorial(n + m))
        legendre = (-1.0) ** m * lpmv(m, n, p[2] / r) * norm
        total += (radius / r) ** n * np.sum(
            legendre * (C[n, m] * np.cos(m * lon) + S[n, m] * np.sin(m * lon))
        )
    return mu / r * total


def gradient(p: np.ndarray, degree: int) -> np.ndarray:
    """Central differences with one Richardson step: error of order h^4."""
    out = np.zeros(3)
    for axis in range(3):
        e = np.zeros(3)
        e[axis] = 1.0
        slope = [
            (potential_beyond_centre(p + h * e, degree) - potential_beyond_centre(p - h * e, degree))
            / (2 * h)
            for h in (1000.0, 2000.0)
        ]
        out[axis] = (4 * slope[0] - slope[1]) / 3
    return out


@pytest.mark.parametrize("degree", [2, 4, 12])
def test_is_the_gradient_of_the_potential(degree):
    g = record(degree=degree)
    for p in points(8):
        central = -float(g["mu"]) * p / np.linalg.norm(p) ** 3
        assert np.allclose(
            np.array(gravity_F(g, tuple(p))) - central, gradient(p, degree), rtol=0, atol=2e-10
        )


def test_j2_closed_form_is_the_gradient_of_its_potential():
    g = record(model="j2")
    mu, radius, j2 = (float(g[k]) for k in ("mu", "reference_radius", "j2"))
    for p in points(8):
        r = np.linalg.norm(p)
        s = p[2] / r
        # Vallado, Fundamentals of Astrodynamics, section 8.7.1: radial part and part along the pole.
        k = -1.5 * j2 * mu * radius**2 / r**4
        expected = -mu * p / r**3 + k * ((1 - 5 * s * s) * p / r + 2 * s * np.array([0.0, 0.0, 1.0]))
        assert np.allclose(gravity_F(g, tuple(p)), expected, rtol=1e-14, atol=1e-14)


def test_zonal_degree_two_equals_j2():
    j2 = record(model="j2")
    zonal = record(degree=2)
    C, S = np.zeros((13, 13)), np.zeros((13, 13))
    C[0, 0], C[2, 0] = 1.0, -float(j2["j2"]) / np.sqrt(5.0)
    fill_terms(zonal, C, S)
    for p in points(8):
        assert np.allclose(gravity_F(zonal, tuple(p)), gravity_F(j2, tuple(p)), rtol=1e-14, atol=1e-14)


def test_j2_of_the_planet_file_is_that_of_the_coefficients():
    C = read_coefficients("gmm3_degree12_sha.tab")[2]
    assert planet("mars").gravity.j2 == pytest.approx(-np.sqrt(5.0) * C[2, 0], rel=1e-6)


def test_turning_field_and_point_together_turns_the_acceleration():
    angle = 0.7
    _, _, C, S = read_coefficients("gmm3_degree12_sha.tab")
    m = np.arange(13)
    cos, sin = np.cos(m * angle), np.sin(m * angle)
    plain, turned = record(degree=12), record(degree=12)
    fill_terms(turned, C * cos - S * sin, S * cos + C * sin)
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    for p in points(5):
        assert np.allclose(
            gravity_F(turned, tuple(turn @ p)), turn @ gravity_F(plain, tuple(p)), rtol=0, atol=1e-14
        )


@pytest.mark.parametrize("model", ["harmonics", "j2", "central"])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_regular_at_the_poles(model, side):
    g = record(model=model, degree=12)
    at = np.array(gravity_F(g, (0.0, 0.0, side * 3.376e6)))
    beside = np.array(
        [gravity_F(g, (dx, dy, side * 3.376e6)) for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1))]
    ).mean(axis=0)
    assert np.all(np.isfinite(at))
    assert np.allclose(at, beside, atol=1e-11)


def test_null_model_and_central_model():
    assert gravity_F(record(model="none"), (3.4e6, 1.0, 2.0)) == (0.0, 0.0, 0.0)
    g = record(model="central")
    ax, ay, az = gravity_F(g, (3e6, 0.0, 4e6))
    assert np.allclose([ax, ay, az], -float(g["mu"]) / 5e6**3 * np.array([3e6, 0, 4e6]), rtol=1e-15)


def test_earth_file_gives_the_nesc_local_gravity():
    """Columns altitudeMsl_ft, localGravity_ft_s2 of NESC Atmos_06_sim_04.csv (NASA/TM-2015-218675), at the
    equator.
    """
    earth = np.zeros(1, PLANET)[0]
    fill_planet(earth, planet("earth"))
    for altitude_ft, g_ft in ((30000.0, 32.1065359519), (16284.443772, 32.14867306827697)):
        ax, _, _ = gravity_F(earth["gravity"], (earth["equatorial_radius"] + altitude_ft * 0.3048, 0.0, 0.0))
        assert -ax / 0.3048 == pytest.approx(g_ft, rel=1e-9)


def test_wrong_inputs_are_refused():
    with pytest.raises(ValidationError, match="coefficients"):
        record(coefficients="")
    with pytest.raises(ValueError, match="reference_radius_m"):
        record(reference_radius_m=3396190.0)
