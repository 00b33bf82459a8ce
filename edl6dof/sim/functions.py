"""The functions that the loop is given: a cycle of the flight software with those that it is given itself,
sensors and kinds of fault.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numba import float64, types
from numba.extending import typeof_impl

from edl6dof.fsw.cycle import run
from edl6dof.fsw.functions import CYCLE, SOFTWARE, software_functions
from edl6dof.fsw.onboard import FSW
from edl6dof.kernels.cache import SETTINGS
from edl6dof.kernels.functions import NOTHING, Given, kind_of, together
from edl6dof.registry import place
from edl6dof.scenario.records import TABLES
from edl6dof.scenario.truth import CASE
from edl6dof.sensors.registry import SENSORS, measure
from edl6dof.vehicle.faults.fault import FAULT, inflict_kind
from edl6dof.vehicle.plant import OUTPUTS, STATE

#: Where the loop is given members of families.
PLACES = {
    "measure": place(
        *("measure", measure, (), NOTHING),
        *(kind_of(CASE, "sensors", "params"), kind_of(CASE, "sensors", "unit"), kind_of(CASE)),
        *(kind_of(TABLES), kind_of(STATE), kind_of(OUTPUTS), kind_of(SENSORS), kind_of(SENSORS, "sensed")),
    ),
    "inflict": place(
        *("inflict", inflict_kind, (), NOTHING),
        *(kind_of(FAULT), kind_of(CASE), float64, kind_of(FSW, "command"), kind_of(STATE)),
    ),
}
#: A cycle of the flight software, as the loop is given it, and the type of all that the loop is given.
RUN = Given(run, CYCLE)
FUNCTIONS = together(CYCLE, SOFTWARE, *(one.type for one in PLACES.values()))


class Functions(tuple[Any, ...]):
    """All that the loop is given: to find the type of a plain tuple of functions, numba warns of them."""


@typeof_impl.register(Functions)
def _(_given: Functions, _: Any) -> types.Type:
    return FUNCTIONS


def functions_of(cases: np.ndarray, onboard: Any) -> Any:
    """The functions of flights with these ``CASE`` records, an array of them, on one ``ONBOARD`` record."""
    params, faults = cases["sensors"]["params"], cases["faults"]
    sensors = _first(params["carried"], params["n_carried"])
    kinds = _first(faults["slots"]["params"]["kind"], faults["count"])
    plant = PLACES["measure"].function(sensors), PLACES["inflict"].function(kinds)
    functions = Functions((RUN, software_functions(onboard), *plant))
    if not SETTINGS.DISABLE_JIT:
        _compile(functions)
    return functions


def _compile(functions: Iterable[Any]) -> None:
    """Compile each alone: if the disk is full, a call goes on after one failure only."""
    for one in functions:
        if isinstance(one, Given):
            one.compile()
        else:
            _compile(one)


def _first(indices: np.ndarray, counts: np.ndarray) -> frozenset[int]:
    """Values in the first ``counts`` columns of each row."""
    return frozenset(map(int, indices[np.arange(indices.shape[1]) < counts[:, None]]))
