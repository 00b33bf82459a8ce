"""A member of a family, and allocation as a whole, writes its memory and its outputs, and nothing that it is
given.
"""

import numpy as np
import pytest
from given_functions import allocate, entry_guidance

from edl6dof.fsw.allocation.effectiveness import EFFECTIVENESS
from edl6dof.fsw.allocation.registry import ALLOCATION, ALLOCATORS, DEMAND, share_out
from edl6dof.fsw.control.registry import CONTROL_INPUTS, CONTROLLERS, attitude_control
from edl6dof.fsw.estimation.registry import DISTURBANCE, ESTIMATORS, MEASURED, estimate
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS, ENTRY_MEMORY
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.guidance.powered.registry import POWERED_LAWS, powered_guidance
from edl6dof.fsw.guidance.powered.target import POWERED_TARGET
from edl6dof.fsw.hazard.elevation_map import ELEVATION_MAP, FOOTPRINT, SAFETY_MAP
from edl6dof.fsw.hazard.registry import HAZARD_DETECTION, classify
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.fsw.onboard import ONBOARD
from edl6dof.fsw.vehicle_state import HEALTH, VEHICLE_STATE
from edl6dof.records import numbers


def filled(dtype, seed=8):
    """A record of which every number is something: flags and indices one, the rest between a half and one."""
    record = np.zeros(1, dtype)
    rng = np.random.default_rng(seed)
    for numbers_ in numbers(record):
        numbers_.values[...] = 1 if numbers_.is_whole else rng.uniform(0.5, 1.0, numbers_.values.shape)
    return record[0]


def written(records, call):
    """Names of the records whose bytes a call changes."""
    before = {name: record.tobytes() for name, record in records.items()}
    call(*records.values())
    return {name for name, record in records.items() if record.tobytes() != before[name]}


CALLS = {
    **{
        f"{CONTROLLERS.title}: {name}": (
            {"params": ONBOARD["control"], "nav": NAV, "goal": GUIDE, "inputs": CONTROL_INPUTS}
            | {"memory": CONTROLLERS.memory},
            lambda p, nav, goal, inputs, memory, i=i: attitude_control(i, p, nav, goal, inputs, 0.04, memory),
            {"memory"},
        )
        for i, name in enumerate(CONTROLLERS.names)
    },
    **{
        f"{ALLOCATORS.title}: {name}": (
            {"params": ONBOARD["allocation"], "vehicle": ONBOARD["vehicle"], "health": HEALTH}
            | {"effectiveness": EFFECTIVENESS, "demand": DEMAND, "out": ALLOCATION},
            lambda p, vehicle, health, effectiveness, demand, out, i=i: share_out(
                *(i, p, p, vehicle, health["thruster"], effectiveness, demand),
                *(out["method"], out["duty"], out["unallocated"]),
            ),
            {"out"},
        )
        for i, name in enumerate(ALLOCATORS.names)
    },
    "allocation": (
        {"params": ONBOARD["allocation"], "vehicle": ONBOARD["vehicle"], "health": HEALTH}
        | {"effectiveness": EFFECTIVENESS, "demand": DEMAND, "out": ALLOCATION},
        allocate,
        {"out"},
    ),
    **{
        f"{ESTIMATORS.title}: {name}": (
            {"params": ONBOARD["estimation"], "measured": MEASURED, "memory": ESTIMATORS.memory}
            | {"out": DISTURBANCE},
            lambda p, measured, memory, out, i=i: estimate(i, p, measured, 0.04, memory, out),
            {"memory", "out"},
        )
        for i, name in enumerate(ESTIMATORS.names)
    },
    **{
        f"{HAZARD_DETECTION.title}: {name}": (
            {
                "params": ONBOARD["hazard"],
                "elevation_map": ELEVATION_MAP,
                "footprint": FOOTPRINT,
                "out": SAFETY_MAP,
            },
            lambda p, elevation_map, footprint, out, i=i: classify(
                i, p, elevation_map, footprint, 2.0, 0.03, out
            ),
            {"footprint", "out"},  # the planes of a row are scratch
        )
        for i, name in enumerate(HAZARD_DETECTION.names)
    },
    **{
        f"{POWERED_LAWS.title}: {name}": (
            {"params": ONBOARD["guidance"]["powered"], "vehicle": ONBOARD["vehicle"], "state": VEHICLE_STATE}
            | {"nav": NAV, "target": POWERED_TARGET, "memory": POWERED_LAWS.memory, "out": GUIDE},
            lambda *given, i=i: powered_guidance(i, *given),
            {"memory", "out"},
        )
        for i, name in enumerate(POWERED_LAWS.names)
    },
}


@pytest.mark.parametrize("records, call, own", CALLS.values(), ids=CALLS)
def test_member_writes_its_memory_and_its_outputs_and_nothing_else(records, call, own):
    assert written({name: filled(dtype) for name, dtype in records.items()}, call) <= own


@pytest.mark.parametrize("index", range(len(ENTRY_LAWS.members)), ids=ENTRY_LAWS.names)
def test_entry_law_does_not_write_what_the_flight_computer_believes(shared_onboard, whole_grid, index):
    records = {"onboard": shared_onboard[0], "nav": whole_grid[100]}
    memory, out = np.zeros(1, ENTRY_MEMORY)[0], np.zeros(1, GUIDE)[0]
    assert written(records, lambda onboard, nav: entry_guidance(index, onboard, nav, memory, out)) == set()


def test_planted_write_into_an_input_is_found():
    records = {"nav": filled(NAV), "memory": filled(POWERED_LAWS.memory)}
    assert written(records, lambda nav, memory: nav["v_N"].fill(0.0)) == {"nav"}
