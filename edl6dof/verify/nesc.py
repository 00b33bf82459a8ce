"""NASA NESC 6-DOF check cases 1 to 10 (NASA/TM-2015-218675) on Earth.

gravity central or J2 | atmosphere US76 | winds none, steady or sheared | vehicle sphere, brick | source:
simulation 04 of the NESC study, row by row in cases 1, 2, 6 and 9, at the end (30 s) in the others |
tolerance: set before the comparison, 0.01 ft, 0.001 ft/s, 1e-4 deg/s, 1e-3 deg, 1e-6 deg of latitude and
longitude.

The tolerances lie far above the differences found (the largest, 0.004 ft in case 9, comes from 1e-6 in the
constants of US76) and far below any mistake in a model.  In case 3 simulation 04 and this simulator damp the
inertial body rate; 05 and 06 damp the rate relative to the air, which makes 0.03 deg at 30 s.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

import edl6dof
from edl6dof.export.nesc import check_case_table
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.records import build_tables
from edl6dof.sim.flight import fly
from edl6dof.verify.case import Bench, NotInstalledError

DATA = Path(edl6dof.__file__).parent / "data" / "nesc"
#: Cases, and those of them whose every row is compared.
CASES, WHOLE = range(1, 11), (1, 2, 6, 9)

Columns = Mapping[str, np.ndarray]


class Tolerance(NamedTuple):
    """A quantity, the beginning of the names of its columns, and the largest difference allowed."""

    columns: str
    quantity: str
    limit: float
    unit: str


TOLERANCES = (
    Tolerance("altitudeMsl_ft", "altitude", 0.01, "ft"),
    Tolerance("feVelocity_ft_s", "velocity", 1e-3, "ft/s"),
    Tolerance("bodyAngularRateWrtEi_deg_s", "body rate", 1e-4, "deg/s"),
    Tolerance("eulerAngle_deg", "attitude", 1e-3, "deg"),
    Tolerance("latitude_deg", "latitude", 1e-6, "deg"),
    Tolerance("longitude_deg", "longitude", 1e-6, "deg"),
)


def flown(number: int, overrides: Iterable[str] = ()) -> Columns:
    """Fly a case; return its telemetry in the columns of the check cases."""
    flight = fly(load_scenario(f"nesc/case{number:02d}", overrides))
    air = build_tables(flight.loaded.truth)[0]["atmosphere"]
    return check_case_table(flight.telemetry, flight.case[0], air)


def reference(number: int) -> Columns:
    """All rows of simulation 04, or the last one if only that is published."""
    if number in WHOLE:
        return read(DATA / f"Atmos_{number:02d}_sim_04.csv")
    ends = read(DATA / "ends_sim_04.csv")
    mine = ends.pop("case") == number
    return {column: values[mine] for column, values in ends.items()}


def read(path: Path) -> dict[str, np.ndarray]:
    """Columns of a csv of numbers."""
    with path.open(encoding="utf-8", newline="") as stream:
        header, *rows = csv.reader(stream)
    return dict(zip(header, np.array(rows, dtype=float).T, strict=True))


def differences(own: Columns, other: Columns) -> dict[str, float]:
    """Largest difference of each quantity over the rows of ``other``; angles modulo a turn; infinite where a
    row is missing.
    """
    place = {round(float(t), 6): i for i, t in enumerate(own["time"])}
    rows = [place.get(round(float(t), 6), -1) for t in other["time"]]
    found = {}
    for start, quantity, *_ in TOLERANCES:
        apart = [np.inf if -1 in rows else 0.0]
        for column in (name for name in other if name.startswith(start)):
            difference = np.abs(own[column][rows] - other[column])
            if start in ("eulerAngle_deg", "longitude_deg"):
                difference = np.minimum(difference, 360.0 - difference)
            apart.append(float(np.max(difference)))
        found[quantity] = float(np.max(apart))
    return found


def nesc(bench: Bench) -> None:
    """Fly every case that has reference data and compare it.

    Raises:
        NotInstalledError: reference data are not part of this installation.
    """
    if not any(DATA.glob("*.csv")):
        raise NotInstalledError("the NESC reference data are not part of this installation")
    source, why = "NASA/TM-2015-218675, simulation 04", "set beforehand; room for the constants of US76"
    compare = partial(bench.compare, verifies="whole plant on Earth", source=source, why=why)
    for number in CASES:
        found = differences(flown(number, bench.planted), reference(number))
        for _, quantity, limit, unit in TOLERANCES:
            compare(f"case {number}: {quantity}", found[quantity], limit, unit)
