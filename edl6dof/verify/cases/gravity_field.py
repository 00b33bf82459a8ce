"""Verifies: gravity by spherical harmonics (degree 4 and 12) and by J2.

gravity harmonics, J2 | atmosphere none | winds none | vehicle none | source: the potential in spherical
coordinates with scipy's associated Legendre functions, and its gradient by central differences with one
Richardson step | tolerance 1e-12 m/s2: differences over 1 and 2 km of a potential of 1e4 m2/s2 beyond the
centre round to 1e-14 and truncate at (12 x 2 km / 3,400 km)^4 of degree 12's 1e-4 m/s2, 3e-13.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from scipy.special import factorial, lpmv

from edl6dof.environment.gravity import gravity_F, read_coefficients
from edl6dof.scenario import records
from edl6dof.verify.case import Outcome, Result, scenes

POINTS = 12
RESULT = partial(
    Result,
    verifies="gravity field",
    source="finite difference of the potential, scipy",
    why="truncation and rounding of the difference",
)


def potential(p: np.ndarray, degree: int, only_j2: float | None = None) -> float:
    """Potential without its central term, m2/s2."""
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


def gradient(p: np.ndarray, degree: int, only_j2: float | None) -> np.ndarray:
    """Central differences with one Richardson step."""
    out = np.zeros(3)
    for axis, e in enumerate(np.eye(3)):
        near, far = (
            (potential(p + h * e, degree, only_j2) - potential(p - h * e, degree, only_j2)) / (2.0 * h)
            for h in (1000.0, 2000.0)
        )
        out[axis] = (4.0 * near - far) / 3.0
    return out


def run(planted: Sequence[str] = ()) -> Outcome:
    """Compare at random points up to 200 km above the surface."""
    rng = np.random.default_rng(5)
    direction = rng.normal(size=(POINTS, 3))
    points = direction / np.linalg.norm(direction, axis=1)[:, None] * rng.uniform(3.38e6, 3.6e6, (POINTS, 1))
    results = []
    for model, degree in (("harmonics", 4), ("harmonics", 12), ("j2", 2)):
        nominal, loaded = scenes(
            [f"planet.gravity.model={model}", f"planet.gravity.degree={degree}"], planted
        )
        field = records.build_case(loaded.truth, records.build_tables(loaded.truth))[0]["planet"]["gravity"]
        mu, only = nominal.planet.gravity.mu_m3_s2, nominal.planet.gravity.j2 if model == "j2" else None
        gaps = [
            gravity_F(field, tuple(p)) + mu * p / np.linalg.norm(p) ** 3 - gradient(p, degree, only)
            for p in points
        ]
        error = float(max(np.linalg.norm(gap) for gap in gaps))
        name = "J2" if model == "j2" else f"degree {degree}"
        results.append(RESULT(name, error, 1e-12, "m/s2"))
    return Outcome(results)
