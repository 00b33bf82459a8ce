"""Table of the atmosphere against altitude that all cases share: profiles of the air in csv files, on a
uniform grid with Hermite slopes, extended below and above the file.

Uniform, so that a lookup is one multiplication; Hermite, so that ln density, temperature and winds have
continuous slopes and the integrator sees no kinks; Fritsch-Carlson slopes, so that nothing overshoots between
nodes.

Source: Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300-304 (slopes on a uniform grid: harmonic
mean).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from edl6dof.environment.height_map import DATA
from edl6dof.environment.hydrostatic import CLIMATE, ClimateInputs, fill_climate
from edl6dof.environment.profiles import MAX_ROWS, cubic_coefficients, monotone_slopes
from edl6dof.interchange.number_csv import read_number_csv
from edl6dof.kernels import kernel
from edl6dof.records import require_finite
from edl6dof.spatial import arrays
from edl6dof.spatial.table_index import cell

#: Prefix of the heading of each column, and factor to SI; other columns are ignored.
_COLUMNS = {
    "altitude": ("h_", 1e3),
    "density": ("rho", 1.0),
    "pressure": ("P_Pa", 1.0),
    "temperature": ("T_K", 1.0),
    "east": ("EWind", 1.0),
    "north": ("NWind", 1.0),
    "sigma": ("sigma", 0.01),
}


class Profile(NamedTuple):
    """The air of a csv, SI units, each shape (n,), read-only."""

    altitude: np.ndarray  # m above the areoid, rising
    density: np.ndarray  # kg/m3
    temperature: np.ndarray  # K
    east: np.ndarray  # mean wind towards east, m/s; zero where the file has none, as the next two
    north: np.ndarray  # mean wind towards north, m/s
    sigma: np.ndarray  # relative 1-sigma of density


def profile_path(name: str) -> Path:
    """Path of a csv by its name: a file of edl6dof/data/atmosphere, or an absolute path."""
    return DATA / "atmosphere" / name


@lru_cache(maxsize=32)
def read_profile(name: str, content: bytes, gas_constant: float) -> Profile:
    """Read the profile of a csv; pressure in place of density is converted by p / (R T).

    Args:
        name: of the file, for messages.
        content: of the file.
        gas_constant: R, J/(kg K).

    Raises:
        ValueError: the csv is no atmosphere table; every wrong cell, row and missing column is named.
    """
    columns = read_number_csv(name, content, _named).columns
    found = {
        # altitudes may be in metres too: their heading says so
        key: values * (1.0 if key == "altitude" and heading.endswith("_m") else to_si)
        for key, (prefix, to_si) in _COLUMNS.items()
        for heading, values in reversed(columns.items())
        if heading.startswith(prefix)
    }
    if len(found["altitude"]) < 2:
        raise ValueError(f"{name}: must have a heading and two rows at least")
    if "density" not in found:
        found["density"] = found["pressure"] / (gas_constant * found["temperature"])
    positive = all(np.all(found[key] > 0.0) for key in ("density", "temperature"))
    if np.any(np.diff(found["altitude"]) <= 0.0) or not positive:
        raise ValueError(f"{name}: altitudes must rise, temperatures and densities be positive")
    nothing = np.zeros(len(found["altitude"]))
    return Profile(*(found.get(key, nothing) for key in Profile._fields))


def _named(headings: Sequence[str]) -> tuple[list[str], list[str]]:
    """Names of the columns that are read, which are their headings, and what is missing."""
    missing = [
        f"no column that begins with {_COLUMNS[key][0]!r}"
        for key in ("altitude", "temperature")
        if not any(heading.startswith(_COLUMNS[key][0]) for heading in headings)
    ]
    if not any(heading.startswith(("rho", "P_Pa")) for heading in headings):
        missing.append("no column that begins with 'rho' (density, kg/m3) or 'P_Pa' (pressure)")
    known = tuple(prefix for prefix, _ in _COLUMNS.values())
    return [heading if heading.startswith(known) else "" for heading in headings], missing


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


class AirInputs(NamedTuple):
    """Inputs of :func:`build_table`."""

    name: str  # of the csv; empty for none
    content: bytes  # of the csv
    bottom_m: float  # altitude down to which it is extended, m
    top_m: float  # altitude that the grid without a csv reaches, m
    gas_constant: float  # J/(kg K)
    gravity: float  # of the extension, m/s2
    sigma: float  # relative sigma of density where the csv has none
    climate: ClimateInputs | None = None  # of the place, for model seasonal


@lru_cache(maxsize=8)
def build_table(inputs: AirInputs) -> np.ndarray:
    """Build the table, shape (1,), dtype ``ATMOSPHERE_TABLE``, read-only; without a csv only grid and sigma.

    Below the file the air is isothermal and hydrostatic, p = rho R T and dp/dh = -rho g, so that ln rho falls
    by g / (R T) per metre; this is also the shape of the COSPAR reference below 0 km.  Winds and sigma keep
    their lowest value [E].  Beyond both ends the kernels continue ln density, the rest is held.

    Raises:
        ValueError: the csv is no atmosphere table.
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
        fill_climate(record["climate"], grid, temperature, first, climate)
    require_finite(table)
    return table
