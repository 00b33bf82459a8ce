"""Trial of plugins: each kernel is compiled and called alone, so that a mistake is one line instead of a page
of the compiler.

Every kernel is called on records of zeros and on made-up numbers.  The chosen entry law and reversal logic
are called along the planned entry, too, where their results must be finite.  No call may change a record that
the kernel may only read.
"""

from __future__ import annotations

import re
from collections.abc import Callable
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
from edl6dof.records import first_not_finite, numbers
from edl6dof.registry import Member
from edl6dof.scenario.schema import Scenario
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


#: Arguments that a kernel may write, and those that it may write in some families.
_WRITTEN = {"memory", "out", "solution", "sensed", "duty", "unallocated"}
_WRITTEN_IN = {
    "reversal": {"memory"},
    "hazard_detector": {"out", "footprint"},
    "fault_kind": {"command", "plant"},
}
#: States of the planned entry on which the laws are tried.
_STATES = 60


@cache
def try_out() -> None:
    """Call every kernel of every active plugin on records of zeros and of made-up numbers.

    Raises:
        ConfigError: kernels that do not compile, fail, return another type than their family requires, or
            write what they may only read.
    """
    _refuse(_complaint)


def try_on_plan(scenario: Scenario) -> None:
    """Call the entry law and the reversal logic that a scenario chooses, if they are plugins, along the
    planned entry.

    Raises:
        ConfigError: one of them fails, writes what it may only read, or has a result that is not finite.
    """
    if any(phase.guidance == "entry" for phase in scenario.mission.phases):
        _refuse(lambda *kernel: _on_plan(scenario, *kernel))


def _refuse(complain: Callable[[str, Member, str, tuple[str, ...]], str]) -> None:
    """Raise ``ConfigError`` with what ``complain`` says of the kernels of all active plugins."""
    complaints = [
        Problem(shown(path), 0, 0, role, complaint)
        for path, (key, member) in plugins.ACTIVE.items()
        for role, arguments in plugins.FAMILIES[key].roles.items()
        if (complaint := complain(key, member, role, arguments))
    ]
    if complaints:
        raise ConfigError(complaints)


def _complaint(key: str, member: Member, role: str, arguments: tuple[str, ...]) -> str:
    given = {name: _argument(name, key, member) for name in arguments}
    value, wrong = _called(key, member.kernels[role], given)
    words, shape = _RETURNS.get((key, role), ("nothing", None))
    if not wrong and not _has_shape(value, shape):
        return f"must return {words} (got {type(value).__name__})"
    for field in (one for record in given.values() if _is_record(record) for one in numbers(record)):
        made_up = np.linspace(0.5, 1.0, field.values.size).reshape(field.values.shape)
        field.values[...] = 1 if field.is_whole else made_up
    return wrong or _called(key, member.kernels[role], given)[1]


def _on_plan(scenario: Scenario, key: str, member: Member, role: str, arguments: tuple[str, ...]) -> str:
    from edl6dof.scenario.planned_entry import planned_states
    from edl6dof.scenario.records import build_onboard

    software = scenario.flight_software.guidance.entry
    if member.name != {"entry_law": software.law, "reversal": software.reversal.logic}.get(key):
        return ""
    onboard = build_onboard(scenario)
    entry = onboard["guidance"]["entry"]
    given = {name: _argument(name, key, member) for name in arguments} | {"onboard": onboard}
    given["params"] = (entry if key == "entry_law" else entry["reversal"])[member.name]
    if "plan" in arguments:
        given["plan"] = onboard["plan"][member.name]
    navs, guides = planned_states(onboard, scenario)
    for k in np.linspace(0, len(navs) - 1, _STATES).astype(int):
        given |= {"nav": navs[k : k + 1], "out": guides[k : k + 1]}
        value, wrong = _called(key, member.kernels[role], {name: given[name] for name in arguments})
        for name in ("memory", "out"):
            if not wrong and (place := first_not_finite(given[name])):
                wrong = f"writes {name}.{place}, which is not finite,"
        if wrong or not np.isfinite(value):
            return f"{wrong or f'returns {value}'} at {navs['speed'][k]:.0f} m/s of the planned entry"
    return ""


def _called(key: str, kernel: Callable[..., Any], given: dict[str, Any]) -> tuple[Any, str]:
    """Result of a kernel, and what is wrong with the call: it fails, or writes what it may only read."""
    read = {name: given[name] for name in given.keys() - _WRITTEN_IN.get(key, _WRITTEN)}
    before = {name: record.copy() for name, record in read.items() if isinstance(record, np.ndarray)}
    try:
        value = kernel(*(one[0] if _is_record(one) else one for one in given.values()))
    except NumbaError as error:
        return None, f"does not compile: {_first_cause(str(error))}"
    except KeyError as error:  # how numba reports an unknown field of a record
        return None, f"uses a field that its records do not have: {error}"
    except Exception as error:  # what the user's own code raises
        return None, f"fails: {type(error).__name__}: {error}"
    for name in (name for name, record in before.items() if record.tobytes() != read[name].tobytes()):
        for old, new in zip(numbers(before[name], name), numbers(read[name], name), strict=True):
            if old.values.tobytes() != new.values.tobytes():
                wrong = old.values != new.values
                was, now = old.values[wrong][0], new.values[wrong][0]
                return value, f"writes {new.place(wrong)}, which it may only read (was {was:g}, now {now:g})"
    return value, ""


def _is_record(given: Any) -> bool:
    return isinstance(given, np.ndarray) and given.dtype.names is not None


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
    if name in arrays:
        return arrays[name]
    zeros = np.zeros(1, layout or _RECORDS[name])
    return zeros if _is_record(zeros) else float(zeros[0])


def _first_cause(text: str) -> str:
    """Line of a numba error that names the cause (coloured if colorama is installed), and its place."""
    text = Text.from_ansi(text).plain
    lines = [line.strip() for line in text.splitlines() if line.strip() and not line.startswith("Failed in")]
    place = re.search(r'File "([^"]*)", line (\d+)', text)
    where = f" (line {place[2]} of {Path(place[1]).name})" if place else ""
    if not lines:
        return "no reason given"
    return re.sub(r"Record\([^ ]*.*?\)(?=\s|$)", "record", lines[0])[:300] + where
