"""The functions that a cycle of the flight software is given: the chosen member of each family."""

from __future__ import annotations

from functools import reduce
from operator import getitem
from typing import Any

from numba import float64, int64, types

from edl6dof.fsw.allocation.registry import share_out
from edl6dof.fsw.control.registry import attitude_control
from edl6dof.fsw.estimation.registry import estimate
from edl6dof.fsw.guidance.entry.registry import wanted_bank
from edl6dof.fsw.guidance.entry.reversal.registry import bank_side
from edl6dof.fsw.guidance.powered.registry import powered_guidance
from edl6dof.fsw.hazard.registry import GIVEN, classify
from edl6dof.fsw.hazard.update import detect_hazards, detect_nothing
from edl6dof.fsw.navigation.filters.registry import correct_solution, start_filter
from edl6dof.fsw.onboard import FSW, ONBOARD
from edl6dof.interface.sensed import SENSED
from edl6dof.kernels.functions import NOTHING, NUMBER, Given, Passed, function_type, kind_of, numbers
from edl6dof.registry import Place


def _onboard(*path: str) -> types.Type:
    return kind_of(ONBOARD, *path)


def _fsw(*path: str) -> types.Type:
    return kind_of(FSW, *path)


def _type(title: str, returns: types.Type, *arguments: types.Type) -> Passed:
    """Type of a function of the index of a member and these arguments."""
    return function_type(title, returns, int64, *arguments)


_NAV, _GUIDE, _STATE, _SENSED = _fsw("nav"), _fsw("guide"), _fsw("vehicle"), kind_of(SENSED)

#: Where a cycle is given members of families.
PLACES = {
    "entry_law": Place(
        wanted_bank,
        _type(
            *("entry_law", NUMBER, _onboard("guidance", "entry"), _onboard("plan"), _onboard(), _NAV),
            *(_fsw("guidance", "entry", "law"), _GUIDE),
        ),
        ("guidance", "entry", "law"),
    ),
    "bank_side": Place(
        bank_side,
        _type(
            *("bank_side", NUMBER, _onboard("guidance", "entry", "reversal"), _onboard(), _NAV),
            *(_fsw("guidance", "entry", "steering", "reversal"), _GUIDE, float64, float64),
        ),
        ("guidance", "entry", "reversal", "logic"),
    ),
    "powered_law": Place(
        powered_guidance,
        _type(
            *("powered_law", numbers(4), _onboard("guidance", "powered"), _onboard("vehicle"), _STATE, _NAV),
            *(_fsw("guidance", "target"), _fsw("guidance", "powered"), _GUIDE),
        ),
        ("guidance", "powered", "law"),
    ),
    "control": Place(
        attitude_control,
        _type(
            *("control", numbers(2, 3), _onboard("control"), _NAV, _GUIDE, _fsw("control", "inputs")),
            *(float64, _fsw("control", "law")),
        ),
    ),
    "share_out": Place(
        share_out,
        _type(
            *("share_out", NOTHING, _onboard("allocation"), _onboard("allocation"), _onboard("vehicle")),
            *(
                _fsw("health", "thruster"),
                _fsw("effectiveness"),
                _fsw("demand"),
                _fsw("allocation", "method"),
            ),
            *(_fsw("allocation", "duty"), _fsw("allocation", "unallocated")),
        ),
        ("allocation", "method"),
    ),
    "estimate": Place(
        estimate,
        _type(
            *("estimate", NOTHING, _onboard("estimation"), _fsw("estimation", "measured"), float64),
            *(_fsw("estimation", "law"), _fsw("disturbance")),
        ),
        ("estimation", "estimator"),
    ),
    "start_filter": Place(
        start_filter,
        _type(
            *("start_filter", NOTHING, _onboard("navigation"), _onboard(), _SENSED),
            *(_fsw("navigation", "solution"), _fsw("navigation", "filter")),
        ),
        ("navigation", "filter"),
    ),
    "correct_solution": Place(
        correct_solution,
        _type(
            *("correct_solution", NOTHING, _onboard("navigation"), _onboard(), _fsw("navigation", "health")),
            *(_SENSED, _fsw("navigation", "motion"), _fsw("navigation", "solution")),
            _fsw("navigation", "filter"),
        ),
        ("navigation", "filter"),
    ),
    "classify": Place(
        classify,
        _type(
            *("classify", NOTHING, _onboard("hazard"), _fsw("hazard", "chart"), _fsw("hazard", "footprint")),
            *(float64, float64, _fsw("hazard", "safety_map")),
        ),
        ("hazard", "detection"),
    ),
}
#: Hazard detection is given as a whole, since few flights have any.
_DETECT = function_type(
    *("detect_hazards", NOTHING, PLACES["classify"].type, _onboard(), int64, float64, _SENSED, _NAV, _STATE),
    *(_fsw("hazard"), _fsw("landing_point"), _fsw("command")),
)
#: What a cycle is given: laws of guidance and the two parts of a navigation filter together.
_GROUPS = (
    *(("entry_law", "bank_side", "powered_law"), "control", "share_out", "estimate"),
    *(("start_filter", "correct_solution"), "classify", "detect_hazards"),
)
_TYPES = {name: place.type for name, place in PLACES.items()} | {"detect_hazards": _DETECT}
SOFTWARE = types.Tuple(
    [_TYPES[one] if isinstance(one, str) else types.Tuple([_TYPES[name] for name in one]) for one in _GROUPS]
)
#: A cycle of the flight software, :func:`edl6dof.fsw.cycle.run`.
CYCLE = function_type("run", NOTHING, SOFTWARE, _onboard(), _SENSED, int64, _fsw())


def chosen(name: str, onboard: Any) -> Given:
    """The function of one name that a flight computer chooses, an ``ONBOARD`` record."""
    place = PLACES[name]
    return place.function({int(reduce(getitem, place.path, onboard))})


def software_functions(onboard: Any) -> Any:
    """The functions that one flight computer chooses, an ``ONBOARD`` record."""
    mission = onboard["mission"]
    phases = {int(one) for one in mission["phases"]["control"][: int(mission["n_phases"])]}
    detects = int(onboard["hazard"]["detection"]) != GIVEN
    given = {name: chosen(name, onboard) for name, place in PLACES.items() if place.path}
    given["control"] = PLACES["control"].function(phases)
    given["detect_hazards"] = Given(detect_hazards if detects else detect_nothing, _DETECT)
    return tuple(
        given[one] if isinstance(one, str) else tuple(given[name] for name in one) for one in _GROUPS
    )
