"""The functions that a cycle of the flight software is given: the chosen member of each family."""

from __future__ import annotations

from collections.abc import Collection
from functools import cache, reduce
from operator import getitem
from typing import Any

from numba import float64, int64, types

from edl6dof.fsw.allocation.registry import share_out
from edl6dof.fsw.control.registry import attitude_control
from edl6dof.fsw.estimation.registry import estimate
from edl6dof.fsw.guidance.entry.registry import wanted_bank
from edl6dof.fsw.guidance.entry.reversal.registry import bank_side
from edl6dof.fsw.guidance.powered.registry import powered_guidance
from edl6dof.fsw.hazard.registry import GIVEN, HAZARD_DETECTION, classify
from edl6dof.fsw.hazard.update import detect_hazards, detect_nothing
from edl6dof.fsw.navigation.filters.registry import correct_solution, start_filter
from edl6dof.fsw.onboard import FSW, ONBOARD
from edl6dof.interface.sensed import SENSED
from edl6dof.kernels.functions import NOTHING, NUMBER, Bundle, function_type, kind_of, numbers, passed
from edl6dof.registry import Place

#: Attitude controllers that there may be.
CONTROLLERS_AT_MOST = 16


def _onboard(*path: str) -> types.Type:
    return kind_of(ONBOARD, *path)


def _fsw(*path: str) -> types.Type:
    return kind_of(FSW, *path)


_NAV, _GUIDE, _STATE, _SENSED = _fsw("nav"), _fsw("guide"), _fsw("vehicle"), kind_of(SENSED)

#: Where a cycle is given members of families.
PLACES = {
    "entry_law": Place(
        wanted_bank,
        function_type(
            NUMBER,
            *(_onboard("guidance", "entry"), _onboard("plan"), _onboard(), _NAV),
            *(_fsw("guidance", "entry", "law"), _GUIDE),
        ),
        ("guidance", "entry", "law"),
    ),
    "bank_side": Place(
        bank_side,
        function_type(
            NUMBER,
            *(_onboard("guidance", "entry", "reversal"), _onboard(), _NAV),
            *(_fsw("guidance", "entry", "steering", "reversal"), _GUIDE, float64, float64),
        ),
        ("guidance", "entry", "reversal", "logic"),
    ),
    "powered_law": Place(
        powered_guidance,
        function_type(
            numbers(4),
            *(_onboard("guidance", "powered"), _onboard("vehicle"), _STATE, _NAV),
            *(_fsw("guidance", "target"), _fsw("guidance", "powered"), _GUIDE),
        ),
        ("guidance", "powered", "law"),
    ),
    "control": Place(
        attitude_control,
        types.UniTuple(
            function_type(
                numbers(2, 3),
                *(_onboard("control"), _NAV, _GUIDE, _fsw("control", "inputs"), float64),
                _fsw("control", "law"),
            ),
            CONTROLLERS_AT_MOST,
        ),
    ),
    "share_out": Place(
        share_out,
        function_type(
            NOTHING,
            *(_onboard("allocation"), _onboard("allocation"), _onboard("vehicle")),
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
        function_type(
            NOTHING,
            *(_onboard("estimation"), _fsw("estimation", "measured"), float64),
            *(_fsw("estimation", "law"), _fsw("disturbance")),
        ),
        ("estimation", "estimator"),
    ),
    "start_filter": Place(
        start_filter,
        function_type(
            NOTHING,
            *(_onboard("navigation"), _onboard(), _SENSED),
            *(_fsw("navigation", "solution"), _fsw("navigation", "filter")),
        ),
        ("navigation", "filter"),
    ),
    "correct_solution": Place(
        correct_solution,
        function_type(
            NOTHING,
            *(_onboard("navigation"), _onboard(), _fsw("navigation", "health"), _SENSED),
            *(_fsw("navigation", "motion"), _fsw("navigation", "solution"), _fsw("navigation", "filter")),
        ),
        ("navigation", "filter"),
    ),
    "classify": Place(
        classify,
        function_type(
            NOTHING,
            *(_onboard("hazard"), _fsw("hazard", "chart"), _fsw("hazard", "footprint"), float64, float64),
            _fsw("hazard", "safety_map"),
        ),
        ("hazard", "detection"),
    ),
}
#: What hazard detection is given, and what a cycle is given: hazard detection as a whole, since few flights
#: have any.
HAZARDS = Bundle(__file__, {"classify": PLACES["classify"].type})
_DETECT = function_type(
    NOTHING,
    *(HAZARDS.type, _onboard(), int64, float64, _SENSED, _NAV, _STATE),
    *(_fsw("hazard"), _fsw("landing_point"), _fsw("command")),
)
BUNDLE = Bundle(
    __file__,
    {name: place.type for name, place in PLACES.items() if name != "classify"}
    | {"detect_hazards": _DETECT, "hazards": HAZARDS.type},
)
#: A cycle of the flight software, :func:`edl6dof.fsw.cycle.run`.
CYCLE = function_type(NOTHING, BUNDLE.type, _onboard(), _SENSED, int64, _fsw())


def software_functions(onboard: Any) -> Any:
    """The functions that one flight computer chooses, an ``ONBOARD`` record."""
    mission = onboard["mission"]
    chosen = {name: {int(reduce(getitem, one.path, onboard))} for name, one in PLACES.items() if one.path}
    chosen["control"] = {int(one) for one in mission["phases"]["control"][: int(mission["n_phases"])]}
    return _functions(**{name: frozenset(indices) for name, indices in chosen.items()})


@cache
def _functions(**chosen: frozenset[int]) -> Any:
    given = {name: place.functions(chosen[name]) for name, place in PLACES.items()}
    hazards = HAZARDS(classify=given.pop("classify"))
    detect = detect_nothing if GIVEN in chosen["classify"] else detect_hazards
    return BUNDLE(detect_hazards=passed(detect), hazards=hazards, **given)


def compile_members(names: Collection[str]) -> None:
    """Compile the members of these names, and hazard detection if one of its own is among them."""
    for place in PLACES.values():
        place.compile(names)
    if set(HAZARD_DETECTION.names[GIVEN + 1 :]) & set(names):
        passed(detect_hazards).compile(_DETECT.signature)
