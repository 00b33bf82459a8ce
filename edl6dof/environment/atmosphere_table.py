"""Shared table of the atmosphere against altitude: uniform grid, Hermite slopes, extended below and above its
file.

Uniform, so that a lookup is one multiplication; Hermite, so that ln density, temperature and winds have
continuous slopes and the integrator sees no kinks; Fritsch-Carlson slopes, so that nothing overshoots between
nodes.

Source: Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300-304 (slopes on a uniform grid: harmonic
mean).
"""

from __future__ import annotations

import csv
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from edl6dof.config.document.regular import read_regular_text
from edl6dof.jit import kernel
from edl6dof.records import require_finite
from edl6dof.spatial.lookups import cell

MAX_ROWS = 512

_DATA = Path(__file__).resolve().parents[1] / "data" / "atmosphere"
_CURVES = ("ln_density", "temperature", "east", "north")

#: ``bottom`` m and ``per_step`` 1/m place row 0 and the spacing of ``rows`` rows.  Density kg/m3 (natural
#: log), temperature K, mean wind towards east and north m/s: per row the four coefficients of the cubic up to
#: the next row.  Sigma: relative 1-sigma.
ATMOSPHERE_TABLE = np.dtype(
    [("bottom", "f8"), ("per_step", "f8"), ("rows", "i8"), ("sigma", "f8", (MAX_ROWS,))]
    + [(name, "f8", (MAX_ROWS, 4)) for name in _CURVES],
    align=True,
)


@kernel
def row_at(table, alt):
    """Row below ``alt`` (m) and the position above it in rows: in 0..1 inside the table, outside it the
    distance beyond.
    """
    return cell((alt - table.bottom) * table.per_step, table.rows - 1)


@kernel
def cubic(curve, row, t):
    """Cubic from ``row`` (t = 0) to the next row (t = 1)."""
    return curve[row, 0] + t * (curve[row, 1] + t * (curve[row, 2] + t * curve[row, 3]))


@kernel
def straight_beyond(curve, row, t):
    """What a straight line with the end slope adds beyond the table; zero inside."""
    if t < 0.0:
        return t * curve[row, 1]
    if t > 1.0:
        return (t - 1.0) * (curve[row, 1] + 2.0 * curve[row, 2] + 3.0 * curve[row, 3])
    return 0.0


def table_path(name: str) -> Path:
    """The csv that a name means: one of edl6dof/data/atmosphere, or an absolute path."""
    return _DATA / name


def read_table(name: str) -> dict[str, np.ndarray]:
    """Columns of a csv of edl6dof/data/atmosphere (or an absolute path) in SI units; a missing wind or sigma
    is zero.
    """
    rows = list(csv.reader(read_regular_text(table_path(name)).splitlines()))
    columns = {heading.strip(): [float(row[k]) for row in rows[1:]] for k, heading in enumerate(rows[0])}
    found = {}
    for key, prefix, to_si in (
        ("altitude", "h_", 1e3),
        ("density", "rho", 1.0),
        ("temperature", "T_K", 1.0),
        ("east", "EWind", 1.0),
        ("north", "NWind", 1.0),
        ("sigma", "sigma", 0.01),
    ):
        matches = [
            np.array(values) * to_si for heading, values in columns.items() if heading.startswith(prefix)
        ]
        if not matches and key in ("altitude", "density", "temperature"):
            raise ValueError(f"{name}: no column that begins with {prefix!r}")
        found[key] = matches[0] if matches else np.zeros(len(rows) - 1)
    if np.any(np.diff(found["altitude"]) <= 0.0) or np.any(found["density"] <= 0.0):
        raise ValueError(f"{name}: altitudes must rise and densities be positive")
    return found


class AirInputs(NamedTuple):
    """What the table follows from.

    Attributes:
        name: of the csv; empty for none.
        content: of the csv.
        bottom_m: altitude down to which it is extended, m.
        top_m: altitude that the grid without a csv reaches, m.
        gas_constant: J/(kg K).
        gravity: of the extension, m/s2.
        sigma: relative sigma of density where the csv has none.
    """

    name: str
    content: bytes
    bottom_m: float
    top_m: float
    gas_constant: float
    gravity: float
    sigma: float


@lru_cache(maxsize=8)
def build_table(inputs: AirInputs) -> np.ndarray:
    """The table, shape (1,), dtype ``ATMOSPHERE_TABLE``, for nobody to write to; without a csv only the grid
    and sigma count.

    Below the file the air is isothermal and hydrostatic, p = rho R T and dp/dh = -rho g, so that ln rho falls
    by g / (R T) per metre; this is also the shape of the COSPAR reference below 0 km.  Winds and sigma keep
    their lowest value [E].  Beyond both ends the kernels continue ln density, the rest is held.

    Raises:
        ValueError: the csv is no such table.
    """
    name, _, bottom_m, top_m, gas_constant, gravity, sigma = inputs
    if not name:
        altitude = np.array([bottom_m, top_m])
        ones = np.ones(2)
        data = {"altitude": altitude, "density": ones, "temperature": 200.0 * ones, "sigma": sigma * ones}
        data |= {"east": 0.0 * ones, "north": 0.0 * ones}
        step = max(500.0, (top_m - bottom_m) / (MAX_ROWS - 2))
    else:
        data = read_table(name)
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
    data["ln_density"] = np.log(data["density"])
    record["sigma"][: len(grid)] = np.interp(grid, data["altitude"], data["sigma"])
    for key in _CURVES:
        curve = np.interp(grid, data["altitude"], data[key])
        if key == "ln_density" and name:
            curve[:below] += (first - grid[:below]) * gravity / (gas_constant * data["temperature"][0])
        record[key][: len(grid) - 1] = cubic_coefficients(
            curve, monotone_slopes(curve, sloping_ends=key == "ln_density")
        )
    require_finite(table)
    return table


def cubic_coefficients(curve: np.ndarray, slope: np.ndarray) -> np.ndarray:
    """The (n-1, 4) coefficients of the cubics through n rows with these slopes per row; :func:`cubic` reads
    them.
    """
    s0, s1, rise = slope[:-1], slope[1:], np.diff(curve)
    out = np.empty((len(rise), 4))
    out[:, 0], out[:, 1], out[:, 2], out[:, 3] = (
        curve[:-1],
        s0,
        3.0 * rise - 2.0 * s0 - s1,
        s0 + s1 - 2.0 * rise,
    )
    return out


def monotone_slopes(curve: np.ndarray, sloping_ends: bool) -> np.ndarray:
    """Slopes per row: harmonic mean of the two neighbouring rises, zero at extremes; at the ends the rise or
    zero.
    """
    rise = np.diff(curve)
    product = rise[:-1] * rise[1:]
    inner = np.zeros(len(curve) - 2)
    same = product > 0.0
    inner[same] = 2.0 * product[same] / (rise[:-1] + rise[1:])[same]
    start, end = (rise[0], rise[-1]) if sloping_ends else (0.0, 0.0)
    return np.concatenate([[start], inner, [end]])
