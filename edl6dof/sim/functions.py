"""The functions that the loop is given: a cycle of the flight software with those that it is given itself,
sensors and kinds of fault.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numba import float64, types

from edl6dof.fsw.cycle import run
from edl6dof.fsw.functions import BUNDLE as SOFTWARE
from edl6dof.fsw.functions import CYCLE, software_functions
from edl6dof.fsw.onboard import FSW
from edl6dof.kernels.functions import NOTHING, Bundle, function_type, kind_of, passed
from edl6dof.registry import Place
from edl6dof.scenario.records import TABLES
from edl6dof.scenario.truth import CASE
from edl6dof.sensors.registry import SENSORS, measure
from edl6dof.vehicle.faults.fault import FAULT
from edl6dof.vehicle.faults.registry import inflict_kind
from edl6dof.vehicle.plant import OUTPUTS, STATE

#: Sensors and kinds of fault that there may be.
SENSORS_AT_MOST, FAULT_KINDS_AT_MOST = 24, 48

#: Where the loop is given members of families.
PLACES = {
    "measure": Place(
        measure,
        types.UniTuple(
            function_type(
                NOTHING,
                *(kind_of(CASE, "sensors", "params"), kind_of(CASE, "sensors", "unit"), kind_of(CASE)),
                *(kind_of(TABLES), kind_of(STATE), kind_of(OUTPUTS), kind_of(SENSORS)),
                kind_of(SENSORS, "sensed"),
            ),
            SENSORS_AT_MOST,
        ),
    ),
    "inflict": Place(
        inflict_kind,
        types.UniTuple(
            function_type(
                NOTHING, kind_of(FAULT), kind_of(CASE), float64, kind_of(FSW, "command"), kind_of(STATE)
            ),
            FAULT_KINDS_AT_MOST,
        ),
    ),
}
BUNDLE = Bundle(
    __file__,
    {"run": CYCLE, "software": SOFTWARE.type, **{name: place.type for name, place in PLACES.items()}},
)


def functions_of(cases: np.ndarray, onboard: Any) -> Any:
    """The functions of flights with these ``CASE`` records, an array of them, on one ``ONBOARD`` record."""
    params, faults = cases["sensors"]["params"], cases["faults"]
    return _functions(
        software=software_functions(onboard),
        sensors=_first(params["carried"], params["n_carried"]),
        faults=_first(faults["slots"]["params"]["kind"], faults["count"]),
    )


def _first(indices: np.ndarray, counts: np.ndarray) -> frozenset[int]:
    """What stands in the first ``counts`` columns of each row."""
    return frozenset(map(int, indices[np.arange(indices.shape[1]) < counts[:, None]]))


@cache
def _functions(software: Any, sensors: frozenset[int], faults: frozenset[int]) -> Any:
    return BUNDLE(
        run=passed(run),
        software=software,
        measure=PLACES["measure"].functions(sensors),
        inflict=PLACES["inflict"].functions(faults),
    )
