"""Data files that a scenario names: their whole paths, and mistakes in them, found before a flight begins.

The builders of the models say in plain words what is wrong with a file; here each is called, and what it says
is put at the key that names the file.  They keep what they build, and the flight finds it there.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from edl6dof.config.document.document import Document
from edl6dof.config.document.locate import shown
from edl6dof.config.document.regular import read_regular
from edl6dof.config.errors import Inconsistent
from edl6dof.environment.areoid import areoid_path, require_areoid_of
from edl6dof.environment.atmosphere import air_inputs
from edl6dof.environment.atmosphere_table import build_table, profile_path, read_profile
from edl6dof.environment.gravity import GRAVITY, coefficients_path, fill_gravity
from edl6dof.environment.terrain import ground_arrays, ground_inputs, require_topography_of
from edl6dof.environment.wind import require_winds
from edl6dof.interchange.meshes import read_mesh_file
from edl6dof.scenario.schema import Scenario
from edl6dof.vehicle.aerodynamics.body_table import body_inputs, build_body_table
from edl6dof.vehicle.aerodynamics.capsule_table import (
    aero_inputs,
    build_aero_table,
    read_static_table,
    static_table_path,
)

#: Keys of a scenario that name a table, and the file that such a name means.
TABLES: dict[str, Callable[[str], Path]] = {
    "atmosphere.table": profile_path,
    "planet.areoid": areoid_path,
    "terrain.landing_area.dtm.file": Path,
    "planet.gravity.coefficients": coefficients_path,
    "vehicle.aero.capsule.static_table": static_table_path,
    "vehicle.aero.body.file": Path,
}

#: Section of names for tables of the air.
PROFILES = "atmosphere.profiles"
#: Where a scenario names the meshes of its vehicle, and the file of a body of any shape.
MESHES = ("vehicle", "appearance", "meshes")
BODY = ("vehicle", "aero", "body")

#: Beginnings of what Python and numpy say of text that is no number, and of rows of unequal length.
_NUMPY_WORDS = (
    "could not convert",
    "invalid literal",
    "setting an array",
    "zero-size array",
    "need at least",
)
_UNREADABLE = (OSError, ValueError, LookupError, ModuleNotFoundError, ArithmeticError, MemoryError, csv.Error)


def file_problems(scenario: Scenario) -> dict[str, str]:
    """Dotted path to message of every table that cannot be built."""
    problems: dict[str, str] = {}
    with _collected(problems, "planet.areoid"):
        require_areoid_of(scenario.planet)
    with _collected(problems, "atmosphere.table"):
        without_map = scenario.planet.model_copy(update={"areoid": ""})  # its mistakes are not the air's
        of_air = air_inputs(scenario.atmosphere, without_map, scenario.place)
        air = build_table(of_air._replace(climate=None))  # the column of a climate is made of the same rows
        with _collected(problems, "wind.model"):
            require_winds(scenario.wind, air[0])
    for name, file in scenario.atmosphere.profiles.items():
        with _collected(problems, f"{PROFILES}.{name}"):
            read_profile(file, read_regular(profile_path(file)), scenario.planet.gas.gas_constant_j_kg_k)
    if scenario.terrain.model == "mola":
        with _collected(problems, "terrain.model"):
            require_topography_of(scenario.planet.mean_radius_m)
    if scenario.terrain.landing_area.dtm.file:
        with _collected(problems, "terrain.landing_area.dtm.file"):
            ground_arrays(ground_inputs(scenario.terrain, scenario.planet)._replace(map=None, hurst=None))
    with _collected(problems, "planet.gravity.coefficients"):
        fill_gravity(np.zeros(1, GRAVITY)[0], scenario.planet.gravity)
    if scenario.vehicle.aero.model == "capsule":
        capsule = scenario.vehicle.aero.capsule
        with _collected(problems, "vehicle.aero.capsule.static_table"):
            inputs = aero_inputs(capsule, scenario.planet.gas.shock_layer_heat_capacity_ratio)
            if capsule.coefficients == "table":
                read_static_table(capsule.static_table)
            with _collected(problems, "vehicle.aero.capsule"):
                build_aero_table(inputs)
    if scenario.vehicle.aero.model == "body":
        with _collected(problems, "vehicle.aero.body.file"):
            ratio = scenario.planet.gas.shock_layer_heat_capacity_ratio
            sheds = scenario.vehicle.showing("capsule") is not None
            build_body_table(body_inputs(scenario.vehicle.aero.body, ratio, sheds))
    for k, mesh in enumerate(scenario.vehicle.appearance.meshes):
        with _collected(problems, f"{'.'.join(MESHES)}.{k}.file"):
            read_mesh_file(Path(mesh.file))
    return problems


@contextmanager
def _collected(problems: dict[str, str], key: str) -> Iterator[None]:
    try:
        with np.errstate(all="ignore"):
            yield
    except Inconsistent as error:
        problems.update(error.problems)
    except _UNREADABLE as error:
        problems[key] = _words(error)


def _words(error: Exception) -> str:
    if isinstance(error, OSError):
        file = f" ({shown(Path(error.filename))})" if error.filename else ""
        return f"cannot be read: {error.strerror or error}{file}"
    if isinstance(error, ModuleNotFoundError):
        return str(error)
    if isinstance(error, UnicodeDecodeError):
        return "is not a text file"
    if isinstance(error, LookupError):
        return "is not a complete table: a heading, a row or a column is missing"
    if isinstance(error, ValueError) and not str(error).startswith(_NUMPY_WORDS):
        return str(error)
    return f"is not a table of numbers ({error})"


def with_whole_paths(document: Document) -> Document:
    """Make the paths of mesh and body files whole; values of another form are left to validation."""
    found = _at(document, MESHES)
    for k, mesh in enumerate(found if isinstance(found, list) else ()):
        _make_whole(document, (*MESHES, k), mesh)
    _make_whole(document, BODY, _at(document, BODY))
    return document


def _at(document: Document, keys: tuple[str, ...]) -> Any:
    found: Any = document.data
    for key in keys:
        found = found.get(key) if isinstance(found, dict) else None
    return found


def _make_whole(document: Document, keys: tuple[str | int, ...], named: Any) -> None:
    """Make whole the path of the ``file`` of ``named``, which stands at ``keys``."""
    if isinstance(named, dict) and isinstance(name := named.get("file"), str) and name:
        named_in = Path(document.mark((*keys, "file")).file)
        folder = named_in.parent if named_in.is_file() else Path.cwd()
        named["file"] = str((folder / name).resolve())
