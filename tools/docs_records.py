"""Data dictionary: the records that laws, controllers, estimators, filters and sensors read or write.

Names and shapes come from the numpy dtypes. Units, frames and meanings come from the comment at each field,
where the dtype is declared; it reads ``unit, frame: meaning``, without unit or frame where there is none.
"""

from __future__ import annotations

import ast
import inspect
import re
import tokenize
from collections.abc import Iterator
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np

#: Records by the part of the flight software that they belong to: module, name, and what a kernel calls them.
RECORDS: dict[str, tuple[tuple[str, str, str], ...]] = {
    "Navigation, as laws and controllers read it": (("edl6dof.fsw.navigation.derived", "NAV", "`nav`"),),
    "Guidance": (
        ("edl6dof.fsw.guidance.guidance_command", "GUIDE", "`out` of a guidance law, `goal` of a controller"),
        ("edl6dof.fsw.guidance.powered.target", "POWERED_TARGET", "`target` of a powered law"),
        ("edl6dof.fsw.hazard.site_selection", "LANDING_POINT", "spots chosen by hazard avoidance"),
    ),
    "Attitude control and allocation": (
        ("edl6dof.fsw.control.registry", "CONTROL_INPUTS", "`inputs` of a controller"),
        ("edl6dof.fsw.allocation.registry", "DEMAND", "demand on the thrusters"),
    ),
    "Disturbance estimation": (
        ("edl6dof.fsw.estimation.registry", "MEASURED", "`measured` of an estimator"),
        ("edl6dof.fsw.estimation.registry", "DISTURBANCE", "`out` of an estimator"),
    ),
    "On-board model of vehicle and planet": (
        ("edl6dof.fsw.onboard", "ONBOARD", "`onboard`; `vehicle` is its part of that name"),
        ("edl6dof.fsw.onboard", "CONFIGURATION", "mass properties of one set of attached parts"),
        ("edl6dof.fsw.guidance.entry.airframe", "AIRFRAME", "trim, drag and lift by Mach number"),
        ("edl6dof.fsw.vehicle_state", "VEHICLE_STATE", "`state` of a powered law"),
        (
            "edl6dof.fsw.vehicle_state",
            "ENGINE_ABILITY",
            "thrust and specific impulse that engines can deliver",
        ),
        ("edl6dof.interface.effectors", "BRANCHES", "propellant branches"),
        ("edl6dof.spatial.frames", "LOCAL_FRAME", "local frame L of the landing site"),
    ),
    "Navigation filters": (
        ("edl6dof.fsw.navigation.solution", "MOTION", "`motion` of a filter"),
        (
            "edl6dof.fsw.navigation.solution",
            "POSITION_FIX",
            "`motion.position_fix`: position fix by landmarks",
        ),
        ("edl6dof.fsw.navigation.solution", "SOLUTION", "`solution` of a filter"),
        ("edl6dof.fsw.navigation.solution", "INSTRUMENT_HEALTH", "`health` of a filter"),
        ("edl6dof.fsw.navigation.solution", "ESTIMATE", "output of navigation"),
    ),
    "Between plant and flight software": (
        ("edl6dof.interface.sensed", "SENSED", "`sensed`: readings that sensors write and filters read"),
        ("edl6dof.interface.sensed", "INERTIAL", "inertial unit"),
        ("edl6dof.interface.sensed", "STARS", "star tracker"),
        ("edl6dof.interface.sensed", "RADAR", "landing radar"),
        ("edl6dof.interface.sensed", "TRACKING", "ground tracking"),
        ("edl6dof.interface.sensed", "LIDAR", "lidar"),
        ("edl6dof.interface.sensed", "STEREO", "stereo cameras"),
        ("edl6dof.interface.sensed", "CAMERA", "landing camera"),
        ("edl6dof.interface.sensed", "LANDMARKS", "landmark camera"),
        ("edl6dof.interface.command", "COMMAND", "commands to thrusters, engines and events"),
        ("edl6dof.interface.command", "EXTERNAL", "commands from outside (`edl6dof.Simulation`)"),
        ("edl6dof.interface.command", "GIVEN", "commands of `EXTERNAL` that are in force"),
    ),
}
#: Parts of ``ONBOARD`` that are left out: they are made from parameter models, which have pages of their own,
#: or are private to one module.
_OMITTED = (
    *("rates", "navigation", "hazard", "guidance", "control", "estimation", "diagnosis", "allocation"),
    *("modulation", "thrusters", "n_thrusters"),
    *("instruments", "drifter", "check_out", "mission", "reference", "plan"),
)

_UNIT = (
    r"1|deg|rad2|rad/s|rad|kg/s|kg m2|kg\^0\.5/m|kg|m/s2|m/s3|m/s4|m2/s2|m3/s2|m/s|m2|1/m|m|"
    r"N and N m|N m|N|Pa|s|Hz"
)
_COMMENT = re.compile(rf"(?P<unit>{_UNIT})(?:, (?P<frame>[IFNLBVC]))?(?::|,|$) ?")
#: Text above the tables.
INTRODUCTION = """These are the records that guidance laws, controllers, estimators, navigation filters
and sensors read and write. Frames and signs are those of the [conventions](../conventions.md).
Quantities are in SI units and radians. A frame is the one in which the components of a vector are
given. A flag is 0 or 1. `x[3]` is an array. Where a field is itself a record, the unit column names it.
*Believed* means according to the on-board model."""


class Field(NamedTuple):
    """One field of a record: dotted path, shape, unit, frame and meaning."""

    path: str
    shape: tuple[int, ...]
    unit: str
    frame: str
    meaning: str


def fields(module: str, name: str) -> list[Field]:
    """Fields of the record that ``module`` declares as ``name``.

    Raises:
        ValueError: a field has no meaning.
    """
    found = list(_fields(getattr(import_module(module), name), _declaration(module, name), ""))
    if bare := [field.path for field in found if not field.meaning]:
        raise ValueError(f"{module}.{name}: no comment with the meaning of {', '.join(bare)}")
    return found


def _fields(layout: np.dtype, declared: dict[str, Any], prefix: str) -> Iterator[Field]:
    """Fields of a dtype in their order, those of records declared in place with a dotted path."""
    for name in layout.names or ():
        if name in _OMITTED:
            continue
        entry, one = declared[name], layout[name]
        if isinstance(entry, dict):
            yield from _fields(one, entry, f"{prefix}{name}.")
            continue
        text, record = entry
        head = _COMMENT.match(text)
        unit, frame = (head["unit"], head["frame"] or "") if head else ("", "")
        meaning = text[head.end() :] if head else text
        yield Field(prefix + name, one.shape, unit or record or _kind(one.base), frame, meaning)


def _kind(one: np.dtype) -> str:
    """Unit of a number without one: its range where it is whole."""
    if one.kind not in "iu":
        return ""
    declared: Any = one.metadata or {}
    low, high = declared.get("low"), declared.get("high")
    if low is None:
        return "integer"
    return "flag" if (low, high) == (0, 1) else f"integer {low} .. {high}"


def _declaration(module: str, name: str) -> dict[str, Any]:
    """Comment at each field of ``name = record(...)``; a dict for a record declared in place."""
    source = inspect.getsource(import_module(module))
    comments = _comments(source)
    for statement in ast.parse(source).body:
        if isinstance(statement, ast.Assign) and getattr(statement.targets[0], "id", "") == name:
            return _entries(statement.value, comments)
    raise KeyError(f"{module}.{name}")


def _entries(call: Any, comments: dict[int, tuple[str, bool]]) -> dict[str, Any]:
    """Comment and record name of each field of a ``record`` call, or of one of ``np.dtype`` with a list."""
    found: dict[str, Any] = {}
    for entry in call.args[0].elts if _is_list(call) else call.args:
        if not isinstance(entry, ast.Tuple):
            continue
        name, kind = ast.literal_eval(entry.elts[0]), entry.elts[1]
        if isinstance(kind, ast.Call) and (getattr(kind.func, "id", "") == "record" or _is_list(kind)):
            found[name] = _entries(kind, comments)
        elif not (isinstance(kind, ast.Call) and getattr(kind.func, "id", "") == "dtype_of"):
            record = kind.id if isinstance(kind, ast.Name) and kind.id not in ("FLAG", "COUNT") else ""
            found[name] = (_comment_at(entry, comments), f"`{record}`" if record else "")
    return found


def _is_list(call: ast.Call) -> bool:
    return bool(call.args) and isinstance(call.args[0], ast.List)


def _comment_at(entry: Any, comments: dict[int, tuple[str, bool]]) -> str:
    """Comment behind a field, or the lines of comment alone before it."""
    behind = comments.get(entry.end_lineno or 0)
    if behind and not behind[1]:
        return behind[0]
    before: list[str] = []
    line = entry.lineno - 1
    while line in comments and comments[line][1]:
        before.insert(0, comments[line][0])
        line -= 1
    return " ".join(before)


def _comments(source: str) -> dict[int, tuple[str, bool]]:
    """Comments by line, and whether each stands alone on it."""
    lines = iter(source.splitlines(keepends=True))
    return {
        token.start[0]: (token.string.lstrip("#: "), token.line.lstrip().startswith("#"))
        for token in tokenize.generate_tokens(lambda: next(lines, ""))
        if token.type == tokenize.COMMENT
    }
