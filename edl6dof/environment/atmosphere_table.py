"""Shared table of the atmosphere against altitude: uniform grid, Hermite slopes, extended below and above its
file.

Uniform, so that a lookup is one multiplication; Hermite, so that ln density, temperature and winds have
continuous slopes and the integrator sees no kinks; Fritsch-Carlson slopes, so that nothing overshoots between
nodes.

Source: Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300-304 (slopes on a uniform grid: harmonic
mean).
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from edl6dof.environment.hydrostatic import CLIMATE, Ground, Warmth, fill_climate
from edl6dof.environment.planet import PlanetParams
from edl6dof.environment.profile_file import read_profile
from edl6dof.environment.profiles import MAX_ROWS, cubic_coefficients, monotone_slopes
from edl6dof.kernels import kernel
from edl6dof.records import require_finite
from edl6dof.spatial import arrays
from edl6dof.spatial.table_index import cell

_CURVES = ("ln_density", "temperature", "east", "north")

#: ``bottom`` m and ``per_step`` 1/m place row 0 and the spacing of ``rows`` rows.  Density kg/m3 (natural
#: log), temperature K, mean wind towards east and north m/s: per row the four coefficients of the cubic up to
#: the next row.  Sigma: relative 1-sigma.  Climate: of model
#: seasonal alone.
ATMOSPHERE_TABLE = np.dtype(
    [("bottom", "f8"), ("per_step", "f8"), ("rows", "i8"), ("sigma", "f8", (MAX_ROWS,))]
    + [(name, "f8", (MAX_ROWS, 4)) for name in _CURVES]
    + [("climate", CLIMATE)],
    align=True,
)


@kernel
def row_at(table, alt):
    """Row below ``alt`` (m) and the position above it in rows: in 0..1 inside the table, outside it the
    distance beyond.
    """
    return cell((alt - table.bottom) * table.per_step, table.rows - 1)


class ClimateInputs(NamedTuple):
    """Further inputs of the table for the climate of a place."""

    planet: PlanetParams
    ground: Ground
    warmth: Warmth


class AirInputs(NamedTuple):
    """Inputs of the table.

    Attributes:
        name: of the csv; empty for none.
        content: of the csv.
        bottom_m: altitude down to which it is extended, m.
        top_m: altitude that the grid without a csv reaches, m.
        gas_constant: J/(kg K).
        gravity: of the extension, m/s2.
        sigma: relative sigma of density where the csv has none.
        climate: of the place, for model seasonal.
    """

    name: str
    content: bytes
    bottom_m: float
    top_m: float
    gas_constant: float
    gravity: float
    sigma: float
    climate: ClimateInputs | None = None


@lru_cache(maxsize=8)
def build_table(inputs: AirInputs) -> np.ndarray:
    """The table, shape (1,), dtype ``ATMOSPHERE_TABLE``, read-only; without a csv only the grid
    and sigma count.

    Below the file the air is isothermal and hydrostatic, p = rho R T and dp/dh = -rho g, so that ln rho falls
    by g / (R T) per metre; this is also the shape of the COSPAR reference below 0 km.  Winds and sigma keep
    their lowest value [E].  Beyond both ends the kernels continue ln density, the rest is held.

    Raises:
        ValueError: the csv is no such table.
    """
    name, content, bottom_m, top_m, gas_constant, gravity, sigma, climate = inputs
    if not name:
        altitude = np.array([bottom_m, top_m])
        ones = np.ones(2)
        data = {"altitude": altitude, "density": ones, "temperature": 200.0 * ones, "sigma": sigma * ones}
        data |= {"east": 0.0 * ones, "north": 0.0 * ones}
        step = max(500.0, (top_m - bottom_m) / (MAX_ROWS - 2))
    else:
        data = read_profile(name, content, gas_constant)._asdict()
        step = float(np.diff(data["altitude"]).min())
        if not np.any(data["sigma"]):
            data["sigma"] = np.full_like(data["density"], sigma)
    first = float(data["altitude"][0])
    below = max(0, int(np.ceil((first - bottom_m) / step)))
    above = int(round((float(data["altitude"][-1]) - first) / step))
    grid = first + step * np.arange(-below, above + 1)
    if len(grid) > MAX_ROWS:
        raise ValueError(f"{name}: {len(grid)} rows of {step} m, at most {MAX_ROWS} fit")
    table = np.zeros(1, ATMOSPHERE_TABLE)
    record = table[0]
    record["bottom"], record["per_step"], record["rows"] = grid[0], 1.0 / step, len(grid)
    data["ln_density"] = arrays.log(data["density"])
    record["sigma"][: len(grid)] = arrays.interpolate(grid, data["altitude"], data["sigma"])
    for key in _CURVES:
        curve = arrays.interpolate(grid, data["altitude"], data[key])
        if key == "ln_density" and name:
            curve[:below] += (first - grid[:below]) * gravity / (gas_constant * data["temperature"][0])
        record[key][: len(grid) - 1] = cubic_coefficients(
            curve, monotone_slopes(curve, sloping_ends=key == "ln_density")
        )
    if climate is not None:
        temperature = arrays.interpolate(grid, data["altitude"], data["temperature"])
        fill_climate(record["climate"], grid, temperature, first, *climate)
    require_finite(table)
    return table
