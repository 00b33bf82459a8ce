"""Mean wind, random gust and one discrete gust against height above the areoid.

Directions are those the air moves towards.  The wind depends on altitude alone: no change over ground or
time.
Source: discrete gust, MIL-F-8785C section 3.7.1.3 (1-cosine); strength and scale of the random gust are
estimates [E].
"""

from __future__ import annotations

from functools import lru_cache
from math import pi

import numpy as np
from pydantic import model_validator

from edl6dof.config.base import Params, Vec3, group, param
from edl6dof.config.dtype import extended, fill
from edl6dof.environment.profiles import (
    GUST_STREAM,
    MAX_ROWS,
    central_slopes,
    cubic,
    cubic_coefficients,
    gauss_markov,
)
from edl6dof.environment.wind_models import WindChoice, wind_of_model
from edl6dof.kernels import kernel
from edl6dof.spatial import arrays
from edl6dof.spatial.elementary import cos, log, sin
from edl6dof.spatial.random_numbers import Stream
from edl6dof.spatial.table_index import held_cell


class GustParams(Params):
    """Random gust of a case: Gauss-Markov in altitude, its scale length growing with altitude."""

    enabled: bool = param(False, "true: the random gust blows")
    sigma_scale: float = param(1.0, "factor on the sigmas", ge=0.0, le=5.0)
    altitudes_m: Vec3 = param(
        (0.0, 20e3, 60e3), "heights above the areoid of the sigmas, rising", status="estimate"
    )
    sigma_m_s: Vec3 = param(
        (3.0, 8.0, 20.0), "sigma of the east and of the north component at altitudes_m", status="estimate"
    )
    bottom_m: float = param(
        -8000.0, "height above the areoid below which the random gust stays the same", ge=-50e3, le=0.0
    )
    top_m: float = param(
        200e3, "height above the areoid above which the random gust stays the same", gt=0.0, le=1e7
    )
    vertical_ratio: float = param(0.5, "vertical over horizontal sigma", status="estimate", ge=0.0, le=1.0)
    scale_length_m: float = param(
        300.0,
        "altitude over which the correlation falls to 1/e, at 0 m and below",
        status="estimate",
        ge=100.0,
    )
    scale_growth: float = param(
        0.085,
        "growth of the scale length per metre of altitude: 2 km at 20 km",
        status="estimate",
        gt=1e-3,
        le=1.0,
    )

    @model_validator(mode="after")
    def _altitudes_rise(self) -> GustParams:
        if not self.altitudes_m[0] < self.altitudes_m[1] < self.altitudes_m[2]:
            raise ValueError("altitudes_m must rise")
        return self


class DiscreteGustParams(Params):
    """One gust of shape 1-cosine."""

    enabled: bool = param(False, "true: the gust blows")
    amplitude_m_s: float = param(20.0, "greatest speed", status="estimate", ge=0.0, le=200.0)
    altitude_m: float = param(5000.0, "height above the areoid of the greatest speed", ge=-10e3, le=200e3)
    half_length_m: float = param(100.0, "altitude from its edge to its middle", status="estimate", gt=0.0)
    azimuth_deg: float = param(
        90.0, "direction it blows towards, from north through east", ge=-360.0, le=360.0
    )


class WindParams(WindChoice):
    """True wind."""

    scale: float = param(1.0, "factor on the mean wind", ge=-10.0, le=10.0)
    gust: GustParams = group(GustParams, "random gust")
    discrete_gust: DiscreteGustParams = group(DiscreteGustParams, "single gust of shape 1-cosine")


#: The parameters, and the random gust of this case (m/s): cubics between rows evenly spaced in
#: :func:`gust_coordinate`.
WIND = extended(
    WindParams,
    gust_east=("f8", (MAX_ROWS - 1, 4)),
    gust_north=("f8", (MAX_ROWS - 1, 4)),
    gust_up=("f8", (MAX_ROWS - 1, 4)),
    gust_spacing="f8",
)


@kernel
def wind(w, table, alt):
    """Wind towards east, north and up, m/s, at ``alt``, m above the areoid."""
    east, north = wind_of_model(w.model, w, table, alt)
    east *= w.scale
    north *= w.scale
    up = 0.0
    if w.gust.enabled:
        gust_east, gust_north, up = _random_gust(w, alt)
        east += gust_east
        north += gust_north
    if w.discrete_gust.enabled:
        speed = _one_minus_cosine(w.discrete_gust, alt)
        east += speed * sin(w.discrete_gust.azimuth)
        north += speed * cos(w.discrete_gust.azimuth)
    return east, north, up


@kernel
def gust_coordinate(alt, bottom, length, growth):
    """Altitude in scale lengths above the gust's bottom: the integral of dh / L, L = length + growth max(h,
    0). Rows evenly spaced in it resolve 300 m near the ground and kilometres higher up.
    """
    if alt <= 0.0:
        return (alt - bottom) / length
    return -bottom / length + log(1.0 + growth * alt / length) / growth


@kernel
def _random_gust(w, alt):
    row, t = held_cell(
        gust_coordinate(alt, w.gust.bottom, w.gust.scale_length, w.gust.scale_growth) / w.gust_spacing,
        MAX_ROWS - 1,
    )
    return cubic(w.gust_east, row, t), cubic(w.gust_north, row, t), cubic(w.gust_up, row, t)


@kernel
def _one_minus_cosine(gust, alt):
    offset = (alt - gust.altitude) / gust.half_length
    if abs(offset) >= 1.0:
        return 0.0
    return 0.5 * gust.amplitude * (1.0 + cos(pi * offset))


def require_winds(params: WindParams, table: np.void) -> None:
    """Check that the table has winds, if the model reads them.

    Raises:
        ValueError: the table has no winds.
    """
    if params.model == "table" and not (np.any(table["east"]) or np.any(table["north"])):
        raise ValueError("wind model table: the atmosphere table has no winds")


def fill_wind(record: np.void, params: WindParams, table: np.void, seed: int = 0, case: int = 0) -> None:
    """Copy the parameters and draw the random gust that belongs to (seed, case).

    Raises:
        ValueError: as :func:`require_winds`.
    """
    require_winds(params, table)
    fill(record, params)
    gust = params.gust
    spacing, sigma = _gust_rows(gust)
    record["gust_spacing"] = spacing
    rng = Stream(seed, case, GUST_STREAM)
    for name, ratio in (("gust_east", 1.0), ("gust_north", 1.0), ("gust_up", gust.vertical_ratio)):
        record[name] = 0.0
        if gust.enabled:
            profile = ratio * sigma * gauss_markov(rng, MAX_ROWS, spacing)
            record[name] = cubic_coefficients(profile, central_slopes(profile))


@lru_cache(maxsize=8)
def _gust_rows(gust: GustParams) -> tuple[float, np.ndarray]:
    """Spacing of the rows of the random gust in :func:`gust_coordinate`, and the sigma (m/s) at each."""
    top = gust_coordinate(gust.top_m, gust.bottom_m, gust.scale_length_m, gust.scale_growth)
    return top / (MAX_ROWS - 1), gust.sigma_scale * arrays.interpolate(
        gust_altitudes(gust), gust.altitudes_m, gust.sigma_m_s
    )


def gust_altitudes(gust: GustParams) -> np.ndarray:
    """Altitude (m) of each row of the random gust: the inverse of :func:`gust_coordinate`."""
    bottom, length, growth = gust.bottom_m, gust.scale_length_m, gust.scale_growth
    s = np.linspace(0.0, gust_coordinate(gust.top_m, bottom, length, growth), MAX_ROWS)
    above = np.maximum(s + bottom / length, 0.0)
    grown = (arrays.exp(growth * above) - 1.0) * length / growth
    return np.where(above > 0.0, grown, bottom + s * length)
