"""Compile a plugin's kernels alone, before the whole simulator with them in it: one line instead of a
compiler's page.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numba import NumbaError
from rich.text import Text

from edl6dof import plugins
from edl6dof.config.document.locate import shown
from edl6dof.config.dtype import dtype_of
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.environment.atmosphere import ATMOSPHERE
from edl6dof.environment.atmosphere_table import ATMOSPHERE_TABLE
from edl6dof.environment.gas import GAS
from edl6dof.environment.wind import WIND
from edl6dof.fsw.allocation.effectiveness import EFFECTIVENESS, ROWS
from edl6dof.fsw.allocation.registry import DEMAND
from edl6dof.fsw.control.registry import CONTROL_INPUTS
from edl6dof.fsw.estimation.registry import DISTURBANCE, MEASURED
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.guidance.powered.target import POWERED_TARGET
from edl6dof.fsw.hazard.elevation_map import ELEVATION_MAP, FOOTPRINT, SAFETY_MAP
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.fsw.navigation.solution import INSTRUMENT_HEALTH, MOTION, SOLUTION
from edl6dof.fsw.onboard import ONBOARD
from edl6dof.fsw.vehicle_state import HEALTH, VEHICLE_STATE
from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.interface.command import COMMAND
from edl6dof.interface.sensed import SENSED
from edl6dof.registry import Member
from edl6dof.vehicle.parachutes.parachute import PARACHUTE_PARAMS
from edl6dof.vehicle.plant import OUTPUTS, STATE
from edl6dof.vehicle.propulsion.engine import ENGINE


def _number(value: Any) -> bool:
    return isinstance(value, float)


def _numbers(count: int) -> Callable[[Any], bool]:
    return lambda value: isinstance(value, tuple) and len(value) == count


def _nothing(value: Any) -> bool:
    return value is None


#: What the kernel of each family and role must return, and whether a value is that.
_RETURNS: dict[tuple[str, str], tuple[str, Callable[[Any], bool]]] = {
    ("entry_law", "guide"): ("a bank angle (float)", _number),
    ("reversal", "side"): ("a side, 1.0 or -1.0", _number),
    ("powered_law", "guide"): ("four numbers: acceleration north, east, up, and tilt limit", _numbers(4)),
    ("controller", "control"): (
        "torque and attitude error, three numbers each",
        lambda value: isinstance(value, tuple) and [*map(np.size, value)] == [3, 3],
    ),
    ("engine_model", "goal"): ("two numbers: mean and slope of the thrust striven for", _numbers(2)),
    ("engine_model", "rate"): ("a number (float)", _number),
    ("engine_model", "specific_impulse"): ("a number (float)", _number),
    ("parachute_model", "inflation"): ("a number (float)", _number),
    ("parachute_model", "efficiency"): ("a number (float)", _number),
    ("allocator", "share_out"): ("nothing", _nothing),
    ("estimator", "estimate"): ("nothing", _nothing),
    ("hazard_detector", "classify"): ("nothing", _nothing),
    ("fault_kind", "inflict"): ("nothing", _nothing),
    ("sensor", "measure"): ("nothing", _nothing),
    ("navigation_filter", "start"): ("nothing", _nothing),
    ("navigation_filter", "correct"): ("nothing", _nothing),
    ("atmosphere", "air"): (
        "four numbers: density, pressure, temperature and speed of sound",
        _numbers(4),
    ),
    ("wind", "mean"): ("two numbers: wind towards east and north", _numbers(2)),
}


@cache
def try_out() -> None:
    """Run every kernel of every active plugin once, on records of zeros.

    Raises:
        ConfigError: kernels that do not compile, fail, or return something else than their family wants.
    """
    complaints = [
        Problem(shown(path), 0, 0, role, complaint)
        for path, (key, member) in plugins.ACTIVE.items()
        for role, arguments in plugins.FAMILIES[key].roles.items()
        if (complaint := _complaint(key, member, role, arguments))
    ]
    if complaints:
        raise ConfigError(complaints)


def _complaint(key: str, member: Member, role: str, arguments: tuple[str, ...]) -> str:
    try:
        value = member.kernels[role](*(_argument(name, key, member) for name in arguments))
    except NumbaError as error:
        return f"does not compile: {_first_cause(str(error))}"
    except KeyError as error:  # how numba reports an unknown field of a record
        return f"uses a field that its records do not have: {error}"
    except Exception as error:  # what the user's own code raises
        return f"fails on records of zeros: {type(error).__name__}: {error}"
    words, fits = _RETURNS[key, role]
    return "" if fits(value) else f"must return {words} (got {type(value).__name__})"


def _argument(name: str, key: str, member: Member) -> Any:
    # these import the schema, which tries plugins out
    from edl6dof.scenario.records import TABLES
    from edl6dof.scenario.truth import CASE
    from edl6dof.vehicle.faults.fault import FAULT

    values = {
        **{"dt": 0.04, "wanted": 1.0, "sign": 1.0, "alt": 1000.0},
        **{"since_line_stretch": 1.0, "mach": 1.5},
        **{"t": 10.0, "step": 0.02, "thrust": 1000.0, "command": 2000.0, "starting": False},
        **{"radius": 2.0, "deviation": 0.03, "since": 0.0},
        "healthy": np.ones(MAX_THRUSTERS, HEALTH["thruster"].base),
        **{"duty": np.zeros(MAX_THRUSTERS), "unallocated": np.zeros(ROWS)},
    }
    records = {
        "params": dtype_of(member.params),
        "plan": member.tables,
        "unit": member.tables,
        "case": CASE,
        "tables": TABLES,
        "memory": member.memory,
        "onboard": ONBOARD,
        "vehicle": ONBOARD["vehicle"],
        "state": VEHICLE_STATE,
        "target": POWERED_TARGET,
        "nav": NAV,
        "goal": np.dtype("f8") if key == "engine_model" else GUIDE,
        "inputs": CONTROL_INPUTS,
        "measured": MEASURED,
        "out": {"estimator": DISTURBANCE, "hazard_detector": SAFETY_MAP}.get(key, GUIDE),
        **{"shared": ONBOARD["allocation"], "effectiveness": EFFECTIVENESS, "demand": DEMAND},
        **{"elevation_map": ELEVATION_MAP, "footprint": FOOTPRINT, "fault": FAULT},
        "chute": PARACHUTE_PARAMS,
        "engine": ENGINE,
        "plant": STATE,
        "outputs": OUTPUTS,
        "sensed": SENSED,
        "health": INSTRUMENT_HEALTH,
        "motion": MOTION,
        "solution": SOLUTION,
        "atm": ATMOSPHERE,
        "wind": WIND,
        "gas": GAS,
        "table": ATMOSPHERE_TABLE,
    }
    if name == "command" and key == "fault_kind":
        return np.zeros(1, COMMAND)[0]
    return values[name] if name in values else np.zeros(1, records[name])[0]


def _first_cause(text: str) -> str:
    """Extract the line of a numba error that names the cause, which is coloured where colorama is, and the
    line that it is of.
    """
    text = Text.from_ansi(text).plain
    lines = [line.strip() for line in text.splitlines() if line.strip() and not line.startswith("Failed in")]
    place = re.search(r'File "([^"]*)", line (\d+)', text)
    where = f" (line {place[2]} of {Path(place[1]).name})" if place else ""
    return (
        re.sub(r"Record\([^ ]*.*?\)(?=\s|$)", "record", lines[0])[:300] + where
        if lines
        else "no reason given"
    )
