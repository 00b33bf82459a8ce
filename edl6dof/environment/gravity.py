"""Gravitational acceleration of the planet in the planet-fixed frame: spherical harmonics, J2, central or none.

The gradient of a solid harmonic is again a sum of solid harmonics, one degree higher.  The weights of that sum are worked out
once (:func:`fill_gravity`), which leaves one pass over the triangle of harmonics per call: no scratch arrays, no trigonometry,
no singularity at the poles.

Source: Cunningham, Celestial Mechanics 2 (1970) 207-216; Montenbruck and Gill, Satellite Orbits, eq. 3.29-3.33; normalisation as
in Holmes and Featherstone, Journal of Geodesy 76 (2002) 279-299, eq. 11.  Left out: tides, polar motion, other bodies.
"""

from __future__ import annotations

from math import factorial, sqrt
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import model_validator

from edl6dof.config.base import REQUIRED, Params, param
from edl6dof.config.dtype import fill
from edl6dof.environment.layout import extended
from edl6dof.jit import kernel

MAX_DEGREE = 12
HARMONICS, J2, CENTRAL, NONE = range(4)

_DATA = Path(__file__).resolve().parents[1] / "data" / "gravity"
_ROWS = (MAX_DEGREE + 2) * (MAX_DEGREE + 3) // 2


class GravityParams(Params):
    """Gravity field of the planet."""

    model: Literal["harmonics", "j2", "central", "none"] = param("harmonics", "how detailed the field is")
    degree: int = param(4, "highest degree and order that is used of the harmonics", ge=2, le=MAX_DEGREE)
    mu_m3_s2: float = param(REQUIRED, "gravitational parameter", status="published", source="planet file", gt=0.0)
    reference_radius_m: float = param(
        REQUIRED, "radius that the harmonics and J2 refer to", status="published", source="planet file", gt=0.0
    )
    j2: float = param(
        REQUIRED, "oblateness, not normalised; used by model j2", status="published", source="planet file", ge=0.0, lt=0.1
    )
    coefficients: str = param("", "harmonics file in edl6dof/data/gravity, or an absolute path", record=False)

    @model_validator(mode="after")
    def _harmonics_need_a_file(self) -> GravityParams:
        if self.model == "harmonics" and not self.coefficients:
            raise ValueError("model harmonics needs a coefficients file")
        return self


#: The parameters; ``term[k]``: weights of (V, W) in ax, ay, az and the two factors of the step to the next degree, for each
#: harmonic (order, then degree); ``sector[m]``: factor of the step from (m, m) to (m+1, m+1).
GRAVITY = extended(GravityParams, term=("f8", (_ROWS, 8)), sector=("f8", (MAX_DEGREE + 2,)))


@kernel
def gravity_F(g, x, y, z):
    """Gravitational (not centrifugal) acceleration, m/s2, in ``F`` at the position ``x, y, z``, m, in ``F``.

    Source: see the module; J2 in closed form, Montenbruck and Gill, Satellite Orbits, section 3.2.
    """
    if g.model == NONE:
        return 0.0, 0.0, 0.0
    if g.model == HARMONICS:
        return _harmonics_F(g, x, y, z)
    r2 = x * x + y * y + z * z
    k = -g.mu / (r2 * sqrt(r2))
    if g.model == CENTRAL:
        return k * x, k * y, k * z
    q = 1.5 * g.j2 * g.reference_radius * g.reference_radius / r2
    s = 5.0 * z * z / r2
    k_xy = k * (1.0 + q * (1.0 - s))
    return k_xy * x, k_xy * y, k * (1.0 + q * (3.0 - s)) * z


@kernel
def _harmonics_F(g, x, y, z):
    """Sum of the weighted solid harmonics V, W, order by order, each order from its sector upwards in degree."""
    term = g.term
    radius = g.reference_radius
    r2 = x * x + y * y + z * z
    ratio = radius / r2
    x_r = x * ratio
    y_r = y * ratio
    z_r = z * ratio
    r_r = radius * ratio
    v_sector = radius / sqrt(r2)
    w_sector = 0.0
    ax = 0.0
    ay = 0.0
    az = 0.0
    k = 0
    top = g.degree + 2
    for m in range(top):
        v = v_sector
        w = w_sector
        v_before = 0.0
        w_before = 0.0
        for _ in range(m, top):
            ax += term[k, 0] * v + term[k, 1] * w
            ay += term[k, 2] * v + term[k, 3] * w
            az += term[k, 4] * v + term[k, 5] * w
            up = term[k, 6] * z_r
            down = term[k, 7] * r_r
            v, v_before = up * v - down * v_before, v
            w, w_before = up * w - down * w_before, w
            k += 1
        c = g.sector[m]
        v_sector, w_sector = c * (x_r * v_sector - y_r * w_sector), c * (x_r * w_sector + y_r * v_sector)
    scale = g.mu / (radius * radius)
    return scale * ax, scale * ay, scale * az


def read_coefficients(name: str) -> tuple[float, float, np.ndarray, np.ndarray]:
    """Reference radius (m), GM (m3/s2) and normalised C, S of shape (13, 13) of a PDS ``*_sha.tab`` file."""
    lines = (_DATA / name).read_text(encoding="ascii").splitlines()
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
    """Copy the parameters and, for harmonics, work out the weights that :func:`gravity_F` sums."""
    fill(record, params)
    record["term"] = 0.0
    record["sector"] = 0.0
    if params.model != "harmonics":
        return
    radius, mu, C, S = read_coefficients(params.coefficients)
    if abs(radius / params.reference_radius_m - 1.0) > 1e-9 or abs(mu / params.mu_m3_s2 - 1.0) > 1e-6:
        raise ValueError(
            f"{params.coefficients} holds for reference_radius_m {radius!r} and mu_m3_s2 {mu!r}, "
            f"not {params.reference_radius_m!r} and {params.mu_m3_s2!r}"
        )
    fill_terms(record, C, S)


def fill_terms(record: np.void, C: np.ndarray, S: np.ndarray) -> None:
    """Weights and recursion factors for normalised coefficients ``C[n, m]``, ``S[n, m]`` up to ``record["degree"]``."""
    degree = int(record["degree"])
    weight = _gradient_weights(C, S, degree)
    k = 0
    for m in range(degree + 2):
        record["sector"][m] = sqrt((2 * m + 3) / (2 * m + 2)) if m else sqrt(3.0)
        for n in range(m, degree + 2):
            record["term"][k, :6] = weight[n, m]
            up, along = n + 1 - m, n + 1 + m
            record["term"][k, 6] = sqrt((2 * n + 1) * (2 * n + 3) / (up * along))
            record["term"][k, 7] = sqrt((2 * n + 3) * (n + m) * (n - m) / ((2 * n - 1) * along * up)) if n > m else 0.0
            k += 1


def _gradient_weights(C: np.ndarray, S: np.ndarray, degree: int) -> np.ndarray:
    """Weights (n, m, [ax of V, ax of W, ay of V, ay of W, az of V, az of W]): Montenbruck and Gill eq. 3.33, transposed."""
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
