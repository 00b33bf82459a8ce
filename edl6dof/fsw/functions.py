"""The functions that are passed into a cycle of the flight software: the chosen member of each family."""

from __future__ import annotations

from functools import reduce
from inspect import signature
from operator import getitem
from typing import Any

from numba import float64, int64, types

from edl6dof.fsw.allocation.registry import share_out
from edl6dof.fsw.control.registry import attitude_control
from edl6dof.fsw.cycle import run
from edl6dof.fsw.estimation.registry import estimate
from edl6dof.fsw.guidance.entry.registry import wanted_bank
from edl6dof.fsw.guidance.entry.reversal.registry import bank_side
from edl6dof.fsw.guidance.powered.registry import powered_guidance
from edl6dof.fsw.hazard.detection import detect_hazards, detect_nothing
from edl6dof.fsw.hazard.registry import GIVEN, classify
from edl6dof.fsw.navigation.filters.registry import correct_solution, start_filter
from edl6dof.fsw.onboard import FSW, ONBOARD
from edl6dof.interface.sensed import SENSED
from edl6dof.kernels.functions import NOTHING, NUMBER, Given, function_type, kind_of, numbers, together
from edl6dof.registry import place


def _onboard(*path: str) -> types.Type:
    return kind_of(ONBOARD, *path)


def _fsw(*path: str) -> types.Type:
    return kind_of(FSW, *path)


_NAV, _GUIDE, _STATE, _SENSED = _fsw("nav"), _fsw("guide"), _fsw("vehicle"), kind_of(SENSED)

#: Places of the cycle that take a member of a family.
PLACES = {
    "entry_law": place(
        *("entry_law", wanted_bank, ("guidance", "entry", "law"), NUMBER),
        *(_onboard("guidance", "entry"), _onboard("plan"), _onboard(), _NAV),
        *(_fsw("guidance", "entry", "law"), _GUIDE),
    ),
    "bank_side": place(
        *("bank_side", bank_side, ("guidance", "entry", "reversal", "logic"), NUMBER),
        *(_onboard("guidance", "entry", "reversal"), _onboard(), _NAV),
        *(_fsw("guidance", "entry", "steering", "reversal"), _GUIDE, float64, float64),
    ),
    "powered_law": place(
        *("powered_law", powered_guidance, ("guidance", "powered", "law"), numbers(4)),
        *(_onboard("guidance", "powered"), _onboard("vehicle"), _STATE, _NAV),
        *(_fsw("guidance", "target"), _fsw("guidance", "powered"), _GUIDE),
    ),
    "control": place(
        *("control", attitude_control, (), numbers(2, 3)),
        *(_onboard("control"), _NAV, _GUIDE, _fsw("control", "inputs"), float64, _fsw("control", "law")),
    ),
    "share_out": place(
        *("share_out", share_out, ("allocation", "method"), NOTHING),
        *(_onboard("allocation"), _onboard("allocation"), _onboard("vehicle")),
        *(_fsw("health", "thruster"), _fsw("effectiveness"), _fsw("demand")),
        *(_fsw("allocation", name) for name in ("method", "duty", "unallocated")),
    ),
    "estimate": place(
        *("estimate", estimate, ("estimation", "estimator"), NOTHING),
        *(_onboard("estimation"), _fsw("estimation", "measured"), float64),
        *(_fsw("estimation", "law"), _fsw("disturbance")),
    ),
    "start_filter": place(
        *("start_filter", start_filter, ("navigation", "filter"), NOTHING),
        *(_onboard("navigation"), _onboard(), _SENSED),
        *(_fsw("navigation", "solution"), _fsw("navigation", "filter")),
    ),
    "correct_solution": place(
        *("correct_solution", correct_solution, ("navigation", "filter"), NOTHING),
        *(_onboard("navigation"), _onboard(), _fsw("navigation", "health"), _SENSED),
        *(_fsw("navigation", name) for name in ("motion", "solution", "filter")),
    ),
    "classify": place(
        *("classify", classify, ("hazard", "detection"), NOTHING),
        *(_onboard("hazard"), _fsw("hazard", "elevation_map"), _fsw("hazard", "footprint")),
        *(float64, float64, _fsw("hazard", "safety_map")),
    ),
}
#: Hazard detection is passed as a whole, since few flights have it.
_DETECT = function_type(
    *("detect_hazards", signature(detect_hazards).parameters, NOTHING),
    *(PLACES["classify"].type, _onboard(), int64, float64, _SENSED, _NAV, _STATE),
    *(_fsw("hazard"), _fsw("landing_point"), _fsw("command")),
)
#: Functions in the order of the argument of a cycle: the guidance laws, and the two parts of a navigation
#: filter, are one tuple each.
_GROUPS = (
    *(("entry_law", "bank_side", "powered_law"), "control", "share_out", "estimate"),
    *(("start_filter", "correct_solution"), "classify", "detect_hazards"),
)
_TYPES = {name: one.type for name, one in PLACES.items()} | {"detect_hazards": _DETECT}
SOFTWARE = together(
    *(_TYPES[one] if isinstance(one, str) else together(*(_TYPES[name] for name in one)) for one in _GROUPS)
)
#: A cycle of the flight software, :func:`edl6dof.fsw.cycle.run`.
CYCLE = function_type("run", signature(run).parameters, NOTHING, SOFTWARE, _onboard(), _SENSED, int64, _fsw())


def chosen(name: str, onboard: Any) -> Given:
    """Return the function at place ``name`` (of ``PLACES``) that an ``ONBOARD`` record chooses."""
    one = PLACES[name]
    return one.function({int(reduce(getitem, one.path, onboard))})


def software_functions(onboard: Any) -> Any:
    """Return the functions that an ``ONBOARD`` record chooses, in the order of ``SOFTWARE``."""
    mission = onboard["mission"]
    phases = {int(one) for one in mission["phases"]["control"][: int(mission["n_phases"])]}
    hazard = onboard["hazard"]
    detects = int(hazard["detection"]) != GIVEN or float(hazard["sites"]["spacing"]) > 0.0
    given = {name: chosen(name, onboard) for name, one in PLACES.items() if one.path}
    given["control"] = PLACES["control"].function(phases)
    given["detect_hazards"] = Given(detect_hazards if detects else detect_nothing, _DETECT)
    return tuple(
        given[one] if isinstance(one, str) else tuple(given[name] for name in one) for one in _GROUPS
    )
