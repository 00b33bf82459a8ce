"""Verifies: the U.S. Standard Atmosphere 1976.

gravity none | atmosphere us76 | winds none | vehicle none | source: published table (NOAA-S/T 76-1562):
temperature and density against geopotential altitude as shipped (csv, up to 84 km), pressure at the layer
bases of its table 4 | tolerance: half a unit of the
last printed digit, which is what a table can prove: 0.005 K (csv: two decimals), 5e-6 of six-digit densities
and seven-digit pressures.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np

import edl6dof
from edl6dof.environment.atmosphere import air
from edl6dof.scenario import records
from edl6dof.verify.case import History, Outcome, Result, largest, scenes

_CSV = Path(edl6dof.__file__).parent / "data" / "atmosphere" / "USStandardAtmosphere1976.csv"
_EARTH = 6356766.0
#: Pressure (Pa) at the base of the layers, geopotential altitude in m.
BASES = (
    (0, 101325.0),
    (11e3, 22632.06),
    (20e3, 5474.889),
    (32e3, 868.0187),
    (47e3, 110.9063),
    (51e3, 66.93887),
    (71e3, 3.956420),
)


def run(planted: Sequence[str] = ()) -> Outcome:
    """Compare at every row of the table."""
    _, loaded = scenes(["atmosphere.model=us76"], planted)
    tables = records.build_tables(loaded.truth)
    case = records.build_case(loaded.truth, tables)[0]

    def at(height: float) -> tuple[float, float, float, float]:
        geometric = _EARTH * height / (_EARTH - height)
        return air(case["atmosphere"], case["planet"]["gas"], tables[0]["atmosphere"], geometric)

    rows = np.genfromtxt(_CSV, delimiter=",", skip_header=2)
    rows = rows[(rows[:, 0] >= 0.0) & (rows[:, 0] <= 84500.0)]
    got = np.array([at(float(height)) for height in rows[:, 0]])
    pressed = largest([at(float(height))[1] / pressure - 1.0 for height, pressure in BASES])
    result = partial(Result, verifies="US76", source="published table")
    results = (
        result("temperature", largest(got[:, 2] - rows[:, 1]), 0.005, "K", why="two decimals printed"),
        result("density", largest(got[:, 0] / rows[:, 2] - 1.0), 5e-6, why="six digits printed"),
        result("pressure at layer bases", pressed, 5e-6, why="seven digits printed"),
    )
    labels = ("US76", "geopotential altitude (km)", "density (kg/m3)")
    return Outcome(results, History(*labels, rows[:, 0] / 1e3, got[:, 0], rows[:, 2]))
