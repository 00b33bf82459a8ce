"""Trial of plugins: each kernel is compiled and called alone, so that a mistake is one line instead of a page
of the compiler.
"""

from __future__ import annotations

import re
from functools import cache
from math import prod
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
from edl6dof.scenario.truth import CASE
from edl6dof.vehicle.faults.fault import FAULT
from edl6dof.vehicle.parachutes.parachute import PARACHUTE_PARAMS
from edl6dof.vehicle.plant import OUTPUTS, STATE
from edl6dof.vehicle.propulsion.engine import ENGINE

_NUMBER: tuple[str, tuple[int, ...]] = ("a number (float)", ())
#: Description and shape of what the kernel of a family and role must return: ``()`` is a number, ``(4,)`` a
#: tuple of four.  Kernels of other roles return nothing.
_RETURNS: dict[tuple[str, str], tuple[str, tuple[int, ...]]] = {
    ("entry_law", "guide"): ("a bank angle (float)", ()),
    ("reversal", "side"): ("a side, 1.0 or -1.0", ()),
    ("powered_law", "guide"): ("four numbers: acceleration north, east, up, and tilt limit", (4,)),
    ("controller", "control"): ("torque and attitude error, three numbers each", (2, 3)),
    ("engine_model", "goal"): ("two numbers: mean and slope of the thrust striven for", (2,)),
    ("engine_model", "rate"): _NUMBER,
    ("engine_model", "specific_impulse"): _NUMBER,
    ("parachute_model", "inflation"): _NUMBER,
    ("parachute_model", "efficiency"): _NUMBER,
    ("atmosphere", "air"): ("four numbers: density, pressure, temperature and speed of sound", (4,)),
    ("wind", "mean"): ("two numbers: wind towards east and north", (2,)),
}
#: Numbers that a kernel is called with, and the layouts of its records and arrays, by argument.
_NUMBERS = {
    **{"dt": 0.04, "wanted": 1.0, "sign": 1.0, "alt": 1000.0, "since_line_stretch": 1.0, "mach": 1.5},
    **{"t": 10.0, "step": 0.02, "thrust": 1000.0, "command": 2000.0, "starting": False},
    **{"radius": 2.0, "deviation": 0.03, "since": 0.0},
}
_RECORDS = {
    **{"case": CASE, "plant": STATE, "outputs": OUTPUTS, "sensed": SENSED, "fault": FAULT},
    **{"atm": ATMOSPHERE, "wind": WIND, "gas": GAS, "table": ATMOSPHERE_TABLE},
    **{"engine": ENGINE, "chute": PARACHUTE_PARAMS},
    **{"onboard": ONBOARD, "vehicle": ONBOARD["vehicle"], "state": VEHICLE_STATE, "nav": NAV, "goal": GUIDE},
    **{"target": POWERED_TARGET, "inputs": CONTROL_INPUTS, "measured": MEASURED, "out": GUIDE},
    **{"shared": ONBOARD["allocation"], "effectiveness": EFFECTIVENESS, "demand": DEMAND},
    **{"elevation_map": ELEVATION_MAP, "footprint": FOOTPRINT},
    **{"health": INSTRUMENT_HEALTH, "motion": MOTION, "solution": SOLUTION},
}
#: Arguments that are other records in one family.
_OF_FAMILY = {
    ("engine_model", "goal"): np.dtype("f8"),
    ("fault_kind", "command"): COMMAND,
    ("estimator", "out"): DISTURBANCE,
    ("hazard_detector", "out"): SAFETY_MAP,
}


@cache
def try_out() -> None:
    """Call every kernel of every active plugin once, on records of zeros.

    Raises:
        ConfigError: kernels that do not compile, fail, or return another type than their family requires.
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
    words, shape = _RETURNS.get((key, role), ("nothing", None))
    return "" if _has_shape(value, shape) else f"must return {words} (got {type(value).__name__})"


def _has_shape(value: Any, shape: tuple[int, ...] | None) -> bool:
    """Return whether a kernel's result is nothing (``None``), a number or a tuple of this shape."""
    if not shape:
        return value is None if shape is None else isinstance(value, float)
    sizes = [*map(np.size, value)] if isinstance(value, tuple) else []
    return sizes == [prod(shape[1:])] * shape[0]


def _argument(name: str, key: str, member: Member) -> Any:
    from edl6dof.scenario.records import TABLES  # loads the flight software, which few commands need

    arrays = {
        "healthy": np.ones(MAX_THRUSTERS, HEALTH["thruster"].base),
        **{"duty": np.zeros(MAX_THRUSTERS), "unallocated": np.zeros(ROWS)},
    }
    own = {
        **{"params": dtype_of(member.params), "memory": member.memory},
        **{"plan": member.tables, "unit": member.tables, "tables": TABLES},
    }
    layout = own.get(name) or _OF_FAMILY.get((key, name))
    if layout is None and name in _NUMBERS:
        return _NUMBERS[name]
    return arrays[name] if name in arrays else np.zeros(1, layout or _RECORDS[name])[0]


def _first_cause(text: str) -> str:
    """Line of a numba error that names the cause (coloured if colorama is installed), and its place."""
    text = Text.from_ansi(text).plain
    lines = [line.strip() for line in text.splitlines() if line.strip() and not line.startswith("Failed in")]
    place = re.search(r'File "([^"]*)", line (\d+)', text)
    where = f" (line {place[2]} of {Path(place[1]).name})" if place else ""
    if not lines:
        return "no reason given"
    return re.sub(r"Record\([^ ]*.*?\)(?=\s|$)", "record", lines[0])[:300] + where
