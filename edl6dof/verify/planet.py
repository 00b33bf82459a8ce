"""Check cases of gravity and standard atmosphere."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
from scipy.special import factorial, lpmv

import edl6dof
from edl6dof.environment.atmosphere import air
from edl6dof.environment.gravity import gravity_F, read_coefficients
from edl6dof.scenario import records
from edl6dof.verify.case import History, Report, Result, largest, scenes

_CSV = Path(edl6dof.__file__).parent / "data" / "atmosphere" / "USStandardAtmosphere1976.csv"
_EARTH = 6356766.0
#: Geopotential altitude (m) of the base of the layers, and the pressure (Pa) there.
_BASES = (0.0, 11e3, 20e3, 32e3, 47e3, 51e3, 71e3)
_PRESSURES = (101325.0, 22632.06, 5474.889, 868.0187, 110.9063, 66.93887, 3.956420)


def us76_table(planted: Sequence[str] = ()) -> Report:
    """Verifies: the U.S. Standard Atmosphere 1976.

    gravity none | atmosphere us76 | winds none | vehicle none | source: published table (NOAA-S/T 76-1562):
    temperature and density against geopotential altitude as shipped (csv, up to 84 km), pressure at the layer
    bases of its table 4 | tolerance: half a unit of the last printed digit, which is what a table can prove:
    0.005 K (csv: two decimals), 5e-6 of six-digit densities and seven-digit pressures.

    Compare at every row of the table.

    ``planted``: see :func:`edl6dof.verify.case.scenes`.
    """
    _, loaded = scenes(["atmosphere.model=us76"], planted)
    tables = records.build_tables(loaded.truth)
    case = records.build_case(loaded.truth, tables)[0]

    def at(height: float) -> tuple[float, float, float, float]:
        geometric = _EARTH * height / (_EARTH - height)
        return air(case["atmosphere"], case["planet"]["gas"], tables[0]["atmosphere"], geometric)

    rows = np.genfromtxt(_CSV, delimiter=",", skip_header=2)
    rows = rows[(rows[:, 0] >= 0.0) & (rows[:, 0] <= 84500.0)]
    got = np.array([at(float(height)) for height in rows[:, 0]])
    pressed = largest(np.array([at(height)[1] for height in _BASES]) / _PRESSURES - 1.0)
    result = partial(Result, verifies="US76", source="published table")
    results = (
        result("temperature", largest(got[:, 2] - rows[:, 1]), 0.005, "K", why="two decimals printed"),
        result("density", largest(got[:, 0] / rows[:, 2] - 1.0), 5e-6, why="six digits printed"),
        result("pressure at layer bases", pressed, 5e-6, why="seven digits printed"),
    )
    labels = ("US76", "geopotential altitude (km)", "density (kg/m3)")
    return Report(results, History(*labels, rows[:, 0] / 1e3, got[:, 0], rows[:, 2]))


def potential(p: np.ndarray, degree: int, only_j2: float | None = None) -> float:
    """Potential (m2/s2) at ``p`` (m) without its central term."""
    radius, mu, C, S = read_coefficients("gmm3_degree12_sha.tab")
    r, lon = float(np.linalg.norm(p)), np.arctan2(p[1], p[0])
    if only_j2 is not None:
        return -mu / r * (radius / r) ** 2 * only_j2 * float(lpmv(0, 2, p[2] / r))
    total = 0.0
    for n in range(2, degree + 1):
        m = np.arange(n + 1)
        norm = np.sqrt(np.where(m == 0, 1, 2) * (2 * n + 1) * factorial(n - m) / factorial(n + m))
        legendre = (-1.0) ** m * lpmv(m, n, p[2] / r) * norm
        total += (radius / r) ** n * float(
            np.sum(legendre * (C[n, m] * np.cos(m * lon) + S[n, m] * np.sin(m * lon)))
        )
    return mu / r * total


def _gradient(p: np.ndarray, degree: int, only_j2: float | None) -> np.ndarray:
    """Gradient of :func:`potential` (m/s2), by central differences with one Richardson step."""
    out = np.zeros(3)
    for axis, e in enumerate(np.eye(3)):
        near, far = (
            (potential(p + h * e, degree, only_j2) - potential(p - h * e, degree, only_j2)) / (2.0 * h)
            for h in (1000.0, 2000.0)
        )
        out[axis] = (4.0 * near - far) / 3.0
    return out


def gravity_field(planted: Sequence[str] = ()) -> Report:
    """Verifies: gravity by spherical harmonics (degree 4 and 12) and by J2.

    gravity harmonics, J2 | atmosphere none | winds none | vehicle none | source: the potential in spherical
    coordinates with scipy's associated Legendre functions, and its gradient by central differences with one
    Richardson step | tolerance 1e-12 m/s2: differences over 1 and 2 km of a potential of 1e4 m2/s2 beyond the
    centre round to 1e-14 and truncate at (12 x 2 km / 3,400 km)^4 of degree 12's 1e-4 m/s2, 3e-13.

    Compare at random points up to 200 km above the surface.

    ``planted``: see :func:`edl6dof.verify.case.scenes`.
    """
    rng, count = np.random.default_rng(5), 12
    direction = rng.normal(size=(count, 3))
    points = direction / np.linalg.norm(direction, axis=1)[:, None] * rng.uniform(3.38e6, 3.6e6, (count, 1))
    source, why = "finite difference of the potential, scipy", "truncation and rounding of the difference"
    results = []
    for model, degree in (("harmonics", 4), ("harmonics", 12), ("j2", 2)):
        field_is = [f"planet.gravity.model={model}", f"planet.gravity.degree={degree}"]
        nominal, loaded = scenes(field_is, planted)
        field = records.build_case(loaded.truth, records.build_tables(loaded.truth))[0]["planet"]["gravity"]
        mu, only = nominal.planet.gravity.mu_m3_s2, nominal.planet.gravity.j2 if model == "j2" else None
        gaps = [
            gravity_F(field, tuple(p)) + mu * p / np.linalg.norm(p) ** 3 - _gradient(p, degree, only)
            for p in points
        ]
        error = float(max(np.linalg.norm(gap) for gap in gaps))
        name = "J2" if model == "j2" else f"degree {degree}"
        results.append(Result(name, error, 1e-12, "m/s2", "gravity field", source, why))
    return Report(results)
