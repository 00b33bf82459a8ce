"""Gravitational acceleration of the planet in the planet-fixed frame: spherical harmonics, J2, central or
none.

The gradient of a solid harmonic is again a sum of solid harmonics, one degree higher.  The weights of that
sum are worked out once (:func:`fill_gravity`), which leaves one pass over the triangle of harmonics per call:
no scratch arrays, no trigonometry, no singularity at the poles.

Source: Cunningham, Celestial Mechanics 2 (1970) 207-216; Montenbruck and Gill, Satellite Orbits, eq.
3.29-3.33; normalisation as in Holmes and Featherstone, Journal of Geodesy 76 (2002) 279-299, eq. 11.  Left
out: tides, polar motion, other bodies.
"""

from __future__ import annotations

from functools import lru_cache
from math import factorial, sqrt
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import model_validator

from edl6dof.config.base import REQUIRED, Params, param
from edl6dof.config.document.regular import read_regular, read_regular_text
from edl6dof.config.dtype import extended, fill
from edl6dof.environment.height_map import DATA
from edl6dof.kernels import kernel
from edl6dof.records import require_finite
from edl6dof.spatial.vector import add, norm, scale

MAX_DEGREE = 12
HARMONICS, J2, CENTRAL, NONE = range(4)

_ROWS = (MAX_DEGREE + 2) * (MAX_DEGREE + 3) // 2


class GravityParams(Params):
    """Gravity field of the planet."""

    model: Literal["harmonics", "j2", "central", "none"] = param("harmonics", "terms of the field")
    degree: int = param(4, "highest degree and order of the harmonics that is used", ge=2, le=MAX_DEGREE)
    mu_m3_s2: float = param(
        REQUIRED,
        "gravitational parameter",
        status="published",
        source="planet file",
        gt=0.0,
        usual=(1e9, 1.3e17, "small moons to Jupiter"),
    )
    reference_radius_m: float = param(
        REQUIRED,
        "radius that the harmonics and J2 refer to",
        status="published",
        source="planet file",
        gt=0.0,
        usual=(100000, 8e7, "small moons to Jupiter"),
    )
    j2: float = param(
        REQUIRED,
        "oblateness, not normalised; used by model j2",
        status="published",
        source="planet file",
        ge=0.0,
        lt=0.1,
        usual=(0, 0.02, "sphere to Saturn"),
    )
    coefficients: str = param("", "harmonics file in edl6dof/data/gravity, or an absolute path", record=False)

    @model_validator(mode="after")
    def _harmonics_need_a_file(self) -> GravityParams:
        if self.model == "harmonics" and not self.coefficients:
            raise ValueError("model harmonics needs a coefficients file")
        return self


#: The parameters; ``term[k]``: weights of (V, W) in ax, ay, az and the factor of the step to the next degree,
#: for each harmonic (order, then degree).
GRAVITY = extended(GravityParams, term=("f8", (_ROWS, 7)))


@kernel
def gravity_F(g, r_F):
    """Gravitational (not centrifugal) acceleration, m/s2, in ``F`` at the position ``r_F``, m."""
    return add(central(g, r_F), noncentral_F(g, r_F))


@kernel
def central(g, r):
    """Central term of the field (m/s2) at ``r`` (m), in the frame of ``r``."""
    if g.model == NONE:
        return 0.0, 0.0, 0.0
    r2 = r[0] * r[0] + r[1] * r[1] + r[2] * r[2]
    return scale(-g.mu / (r2 * sqrt(r2)), r)


@kernel
def noncentral_F(g, r_F):
    """Noncentral part of gravitation (m/s2) at ``r_F`` (m); J2: Montenbruck and Gill, section 3.2."""
    if g.model == HARMONICS:
        return _harmonics_F(g, r_F)
    if g.model != J2:
        return 0.0, 0.0, 0.0
    x, y, z = r_F
    r2 = x * x + y * y + z * z
    q = 1.5 * g.j2 * g.reference_radius * g.reference_radius / r2
    s = 5.0 * z * z / r2
    k = -g.mu / (r2 * sqrt(r2)) * q
    return k * (1.0 - s) * x, k * (1.0 - s) * y, k * (3.0 - s) * z


@kernel
def _harmonics_F(g, r_F):
    """Sum of the weighted solid harmonics V, W, order by order, each from its sectorial harmonic upwards.

    A harmonic is scaled to one as the coefficient of its leading power, which saves two factors in each step.
    Without coefficients of degree 1 (the origin is the centre of mass) the sum begins with harmonics of
    degree 3.
    """
    term = g.term
    radius = g.reference_radius
    x, y, z = r_F
    r2 = x * x + y * y + z * z
    ratio = radius / r2
    x_r = x * ratio
    y_r = y * ratio
    z_r = z * ratio
    r_r = radius * ratio
    root = sqrt(r2)
    v_sector = radius / root
    w_sector = 0.0
    ax = ay = az = 0.0
    k = 0
    top = g.degree + 2
    for m in range(top):
        v = v_sector
        w = w_sector
        v_before = 0.0
        w_before = 0.0
        for _ in range(m, 3):
            down = term[k, 6] * r_r
            v, v_before = z_r * v - down * v_before, v
            w, w_before = z_r * w - down * w_before, w
            k += 1
        for _ in range(max(m, 3), top):
            ax += term[k, 0] * v + term[k, 1] * w
            ay += term[k, 2] * v + term[k, 3] * w
            az += term[k, 4] * v + term[k, 5] * w
            down = term[k, 6] * r_r
            v, v_before = z_r * v - down * v_before, v
            w, w_before = z_r * w - down * w_before, w
            k += 1
        v_sector, w_sector = x_r * v_sector - y_r * w_sector, x_r * w_sector + y_r * v_sector
    return scale(g.mu / (radius * radius), (ax, ay, az))


#: Nodes and weights of Gauss and Legendre on 0 .. 1, exact up to degree 13.
_NODES = (
    *(0.025446043828620757, 0.12923440720030277, 0.2970774243113014, 0.5),
    *(0.7029225756886985, 0.8707655927996972, 0.9745539561713792),
)
_WEIGHTS = (
    *(0.06474248308443485, 0.13985269574463832, 0.19091502525255946, 0.20897959183673470),
    *(0.19091502525255946, 0.13985269574463832, 0.06474248308443485),
)


@kernel
def potential_F(g, r_F):
    """Potential (J/kg, zero at infinity) of the field at ``r_F`` (m): its gradient is the gravitation.

    The central term in closed form; of the rest the integral of the radial component inwards from infinity,
    which in the inverse of the radius is a polynomial of the field's degree, at most 12.
    """
    x, y, z = r_F
    found = 0.0 if g.model == NONE else g.mu / norm(r_F)
    for k in range(len(_NODES)):
        u = _NODES[k]
        a = noncentral_F(g, (x / u, y / u, z / u))
        found -= _WEIGHTS[k] * (a[0] * x + a[1] * y + a[2] * z) / (u * u)
    return found


def coefficients_path(name: str) -> Path:
    """Path of a harmonics file by its name: a file of edl6dof/data/gravity, or an absolute path."""
    return DATA / "gravity" / name


def read_coefficients(name: str) -> tuple[float, float, np.ndarray, np.ndarray]:
    """Reference radius (m), GM (m3/s2) and normalised C, S of shape (13, 13) of a PDS ``*_sha.tab`` file."""
    lines = read_regular_text(coefficients_path(name), encoding="ascii").splitlines()
    head = lines[0].split(",")
    C = np.zeros((MAX_DEGREE + 1, MAX_DEGREE + 1))
    S = np.zeros_like(C)
    C[0, 0] = 1.0
    for line in lines[1:]:
        cells = line.split(",")
        n, m = int(cells[0]), int(cells[1])
        if n <= MAX_DEGREE:
            C[n, m], S[n, m] = float(cells[2]), float(cells[3])
    return float(head[0]) * 1e3, float(head[1]) * 1e9, C, S


def fill_gravity(record: np.void, params: GravityParams) -> None:
    """Copy the parameters and, for harmonics, the weights that :func:`gravity_F` sums.

    Raises:
        ValueError: the coefficients are of another field.
        OSError: their file cannot be read.
    """
    fill(record, params)
    record["term"] = 0.0
    if params.model == "harmonics":
        record["term"] = _terms(params, read_regular(coefficients_path(params.coefficients)))


@lru_cache(maxsize=8)
def _terms(params: GravityParams, content: bytes) -> np.ndarray:
    """Weights of the harmonics, shape (_ROWS, 7); ``content``: bytes of the file of coefficients."""
    field = np.zeros(1, GRAVITY)
    fill(field[0], params)
    radius, mu, C, S = read_coefficients(params.coefficients)
    if abs(radius / params.reference_radius_m - 1.0) > 1e-9 or abs(mu / params.mu_m3_s2 - 1.0) > 1e-6:
        raise ValueError(
            f"{params.coefficients} holds for reference_radius_m {radius!r} and mu_m3_s2 {mu!r}, "
            f"not {params.reference_radius_m!r} and {params.mu_m3_s2!r}"
        )
    fill_terms(field[0], C, S)
    require_finite(field)
    return field["term"][0]


def fill_terms(record: np.void, C: np.ndarray, S: np.ndarray) -> None:
    """Weights and recursion factors for normalised coefficients ``C[n, m]``, ``S[n, m]`` up to
    ``record["degree"]``; ``C[0, 0]`` counts as one and is left to the closed form.
    """
    degree = int(record["degree"])
    if np.any(C[1]) or np.any(S[1]):
        raise ValueError("gravity coefficients of degree 1 must vanish: the origin is the centre of mass")
    weight = _gradient_weights(C, S, degree)
    weight[:3] = 0.0
    k = 0
    sector = 1.0
    for m in range(degree + 2):
        # leading coefficient of the normalised harmonic
        leading = sector
        for n in range(m, degree + 2):
            record["term"][k, :6] = leading * weight[n, m]
            record["term"][k, 6] = (n * n - m * m) / (4 * n * n - 1)
            leading *= sqrt((2 * n + 1) * (2 * n + 3) / ((n + 1 - m) * (n + 1 + m)))
            k += 1
        sector *= sqrt((2 * m + 3) / (2 * m + 2)) if m else sqrt(3.0)


def _gradient_weights(C: np.ndarray, S: np.ndarray, degree: int) -> np.ndarray:
    """Weights (n, m, [ax of V, W, ay of V, W, az of V, W]): Montenbruck and Gill eq. 3.33, transposed."""
    out = np.zeros((degree + 2, degree + 2, 6))
    for n in range(degree + 1):
        for m in range(n + 1):
            c, s = C[n, m], S[n, m]
            above = _norm(n, m) / _norm(n + 1, m + 1) * (1.0 if m == 0 else 0.5)
            out[n + 1, m + 1] += above * np.array([-c, -s, s, -c, 0.0, 0.0])
            same = _norm(n, m) / _norm(n + 1, m) * (n - m + 1)
            out[n + 1, m] += same * np.array([0.0, 0.0, 0.0, 0.0, -c, -s])
            if m > 0:
                below = _norm(n, m) / _norm(n + 1, m - 1) * 0.5 * (n - m + 1) * (n - m + 2)
                out[n + 1, m - 1] += below * np.array([c, s, s, -c, 0.0, 0.0])
    return out


def _norm(n: int, m: int) -> float:
    """Full normalisation: normalised harmonic = norm * harmonic."""
    return sqrt((1 if m == 0 else 2) * (2 * n + 1) * factorial(n - m) / factorial(n + m))
