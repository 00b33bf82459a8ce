"""Whether the tables that a scenario names can be built: mistakes in data files, found before a flight
begins.

The builders of the models say in plain words what is wrong with a file; here each is called once, on scratch
records, and what it says is put at the key that names the file.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from edl6dof.config.document.locate import shown
from edl6dof.environment.atmosphere import fill_atmosphere_table
from edl6dof.environment.atmosphere_table import ATMOSPHERE_TABLE, table_path
from edl6dof.environment.gravity import GRAVITY, coefficients_path, fill_gravity
from edl6dof.environment.terrain_map import require_map_of
from edl6dof.environment.wind import WIND, fill_wind
from edl6dof.vehicle.aerotable import build_aero_table, read_static_table, static_table_path

if TYPE_CHECKING:
    from edl6dof.scenario.schema import Scenario

#: Keys of a scenario that name a table, and the file that such a name means.
TABLES: dict[str, Callable[[str], Path]] = {
    "atmosphere.table": table_path,
    "planet.gravity.coefficients": coefficients_path,
    "vehicle.aero.capsule.static_table": static_table_path,
}

#: Beginnings of what Python and numpy say of text that is no number, and of rows of unequal length.
_NUMPY_WORDS = (
    "could not convert",
    "invalid literal",
    "setting an array",
    "zero-size array",
    "need at least",
)
_NOT_FINITE = "holds a number that is not finite, or one for which no table can be built"
_UNREADABLE = (OSError, ValueError, LookupError, ArithmeticError, MemoryError, csv.Error)


def file_problems(scenario: Scenario) -> dict[str, str]:
    """Dotted path to message of every table that cannot be built."""
    problems: dict[str, str] = {}
    air = np.zeros(1, ATMOSPHERE_TABLE)
    with _collected(problems, "atmosphere.table"):
        fill_atmosphere_table(air[0], scenario.atmosphere, scenario.planet)
        _require_finite(air)
    if "atmosphere.table" not in problems:
        with _collected(problems, "wind.model"):
            fill_wind(np.zeros(1, WIND)[0], scenario.wind, air[0], scenario.seed)
    if scenario.terrain.model == "mola":
        with _collected(problems, "terrain.model"):
            require_map_of(scenario.planet.mean_radius_m)
    gravity = np.zeros(1, GRAVITY)
    with _collected(problems, "planet.gravity.coefficients"):
        fill_gravity(gravity[0], scenario.planet.gravity)
        _require_finite(gravity)
    if scenario.vehicle.aero.model == "capsule":
        capsule = scenario.vehicle.aero.capsule
        with _collected(problems, "vehicle.aero.capsule.static_table"):
            if not all(np.isfinite(part).all() for part in read_static_table(capsule.static_table)):
                raise ValueError(_NOT_FINITE)
            with _collected(problems, "vehicle.aero.capsule"):
                _require_finite(
                    build_aero_table(capsule, scenario.planet.gas.shock_layer_heat_capacity_ratio)
                )
    return problems


@contextmanager
def _collected(problems: dict[str, str], key: str) -> Iterator[None]:
    try:
        with np.errstate(all="ignore"):
            yield
    except _UNREADABLE as error:
        problems[key] = _words(error)


def _words(error: Exception) -> str:
    if isinstance(error, OSError):
        return f"cannot be read: {error.strerror or error}" + (
            f" ({shown(Path(error.filename))})" if error.filename else ""
        )
    if isinstance(error, UnicodeDecodeError):
        return "is not a text file"
    if isinstance(error, LookupError):
        return "is not a complete table: a heading, a row or a column is missing"
    if isinstance(error, ValueError) and not str(error).startswith(_NUMPY_WORDS):
        return str(error)
    return f"is not a table of numbers ({error})"


def _require_finite(record: np.ndarray) -> None:
    for name in record.dtype.names:
        if record.dtype[name].base.kind == "f" and not np.isfinite(record[name]).all():
            raise ValueError(_NOT_FINITE)
