"""Column of air in hydrostatic balance over a place, computed from the pressure at the ground and the
temperature at each height.

The balance is d(ln p)/dh = -g / (R T) = -s with the pressure p, the height h above the areoid, gravity g, the
gas constant R and the temperature T. The column stores the smooth function s(h). ln p is minus the integral
of s, and T is g / (R s), so that pressure, density, temperature and gravity agree at every height and not
only in the rows of the table.

Source: hydrostatics of an ideal gas, Anderson, Introduction to Flight (1989), section 3.2. The daily change
of the temperature, one wave that decreases upwards, is an estimate [E].
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from edl6dof.environment.areoid import areoid_at, areoid_map
from edl6dof.environment.gravity import gravity_F
from edl6dof.environment.height_map import MapFile
from edl6dof.environment.planet import PLANET, PlanetParams, fill_planet
from edl6dof.environment.profiles import MAX_ROWS, cubic_coefficients, integral, monotone_slopes
from edl6dof.records import record
from edl6dof.spatial import arrays
from edl6dof.spatial.elementary import cos, log, sin
from edl6dof.spatial.frames import from_geodetic
from edl6dof.spatial.vector import dot

#: Climate of the place in the rows of the table: temperature (K) and gravity with rotation (m/s2), gas
#: constant (J/(kg K)); place of the ground in rows, and natural log of the pressure (Pa) there.
CLIMATE = record(
    ("temperature", "f8", (MAX_ROWS,)),
    ("gravity", "f8", (MAX_ROWS,)),
    ("gas_constant", "f8"),
    ("ground", "f8"),
    ("ln_ground_pressure", "f8"),
)

#: Column of one case: cubics of s, 1/m, and ln p (Pa) in the row below each.
COLUMN = record(("inverse_scale_height", "f8", (MAX_ROWS - 1, 4)), ("ln_pressure", "f8", (MAX_ROWS - 1,)))

#: Coldest air (K) that a dispersion may make.
_COLDEST = 30.0


class ClimateInputs(NamedTuple):
    """Climate of a place at a moment, further inputs of the table."""

    planet: PlanetParams  # its gravity and gas
    latitude: float  # geodetic, rad
    longitude: float  # rad
    elevation: float  # of the ground, m above the areoid
    pressure: float  # at the ground, Pa
    areoid: MapFile | None  # map of the areoid, from which heights count; ``None``: from the ellipsoid
    lapse_rate: float  # rise of temperature per metre downwards, below the table, K/m
    near_ground: float  # excess of the temperature at the ground over the table at this hour, K
    depth: float  # height above ground over which this excess falls by e, m


def _gravity_along(place: ClimateInputs, heights: np.ndarray) -> np.ndarray:
    """Gravity (m/s2) with rotation, downwards along the vertical, at ``heights`` (m) above the areoid."""
    planet, record = place.planet, np.zeros(1, PLANET)[0]
    fill_planet(record, planet)
    lat, lon, spin = place.latitude, place.longitude, planet.rotation_rate_rad_s
    up = (cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat))
    base, found = areoid_at(areoid_map(place.areoid), lat, lon)[0], np.empty(len(heights))
    for i, height in enumerate(heights):
        r = from_geodetic(planet.equatorial_radius_m, planet.flattening, lat, lon, height + base)
        pull = gravity_F(record["gravity"], tuple(r))
        found[i] = -dot(pull, up) - spin * spin * (r[0] * up[0] + r[1] * up[1])
    return found


def fill_climate(
    record: np.void, grid: np.ndarray, temperature: np.ndarray, first: float, place: ClimateInputs
) -> None:
    """Fill a ``CLIMATE`` record from the evenly spaced rows of a table: heights above the areoid ``grid``
    (m), ``temperature`` (K), which is held below the ``first`` height of the table (m).
    """
    rows = len(grid)
    below, above_ground = np.maximum(first - grid, 0.0), np.maximum(grid - place.elevation, 0.0)
    warmed = (
        temperature + place.lapse_rate * below + place.near_ground * arrays.exp(-above_ground / place.depth)
    )
    record["temperature"][:rows] = warmed
    record["gravity"][:rows] = _gravity_along(place, grid)
    record["gas_constant"] = place.planet.gas.gas_constant_j_kg_k
    record["ground"] = (place.elevation - grid[0]) / (grid[1] - grid[0])
    record["ln_ground_pressure"] = log(place.pressure)


def fill_column(
    record: np.void, climate: np.void, rows: int, step: float, pressure_factor: float, warmer: np.ndarray
) -> None:
    """Fill the ``COLUMN`` record of one case from the climate of the place.

    Args:
        record: ``COLUMN`` record, written.
        climate: ``CLIMATE`` record.
        rows: number of rows of the table.
        step: height between two rows, m.
        pressure_factor: factor on the pressure at the ground.
        warmer: temperature that is added to the climate in each row, K, shape (rows,).
    """
    temperature = np.maximum(climate["temperature"][:rows] + warmer, _COLDEST)
    s = climate["gravity"][:rows] / (climate["gas_constant"] * temperature)
    curve = cubic_coefficients(s, monotone_slopes(s, sloping_ends=False))
    fallen = np.concatenate([[0.0], np.cumsum(arrays.product(curve, (1.0, 1 / 2, 1 / 3, 1 / 4)))])
    ground = float(climate["ground"])
    row = min(max(int(ground), 0), rows - 2)
    to_ground = fallen[row] + integral(curve, row, ground - row)
    ln_pressure = climate["ln_ground_pressure"] + log(pressure_factor) + step * (to_ground - fallen)
    record["inverse_scale_height"][: rows - 1] = curve
    record["ln_pressure"][: rows - 1] = ln_pressure[:-1]
