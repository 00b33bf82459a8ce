"""Flow meters: one in each propellant branch, which counts the propellant that flows through.

An ultrasonic meter derives the flow from the difference of two transit times of sound, with and against it,
in a few milliseconds and without a part in the flow. Its errors are those of a line: a scale factor, a zero
offset, and white noise; the latter two relative to the flow with all thrusters of the branch open. A count
loses nothing between two readings, as that of an inertial unit, and has the same delay.

Left out: the mixture ratio (both propellants are metered as one), temperature, and water hammer.

Source: such meters are made for bipropellant satellites, non-intrusive and rapid (Moog, Ultrasonic Flow
Meter, product page); their errors are estimates.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.config.dtype import in_si
from edl6dof.interface.capacities import MAX_BRANCHES
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, record
from edl6dof.registry import Member
from edl6dof.sensors.counters import faulty_count
from edl6dof.spatial.random_numbers import Stream, normal_pair
from edl6dof.spatial.table_index import wrapped
from edl6dof.vehicle.plant import WORKING

#: Readings that can be under way.
DEPTH = 8
#: Normals that the meters may use in a cycle, and the first of those for the noise of faults.
_NORMALS, _FAULTY = 64, 32


class FlowMetersParams(Params):
    """Flow meters of the propellant branches; errors as standard deviations, drawn for each case."""

    delay_cycles: int = param(
        1,
        "base cycles between a reading and its arrival in the flight computer, as of the inertial unit",
        status="estimate",
        ge=0,
        le=DEPTH - 1,
    )
    scale_pct: float = param(1.0, "error of the scale factor", status="estimate", ge=0.0, le=50.0)
    bias_pct: float = param(
        0.2, "zero offset, as a share of the full flow of the branch", status="estimate", ge=0.0, le=50.0
    )
    noise_pct: float = param(
        0.1,
        "white noise of a mean over one second, of the full flow; 0.5 in a control cycle of 40 ms",
        status="estimate",
        ge=0.0,
        le=50.0,
    )
    quantum_kg: float = param(1e-6, "mass of one count; 0: none", status="estimate", ge=0.0, le=1.0)


#: Errors of the meters in this case.
UNIT = record(
    ("scale", "f8", (MAX_BRANCHES,)),  # relative
    ("bias", "f8", (MAX_BRANCHES,)),  # of the full flow
    ("key", "i8"),  # of the noise
)

#: Memory of the meters: time of the last reading, mass that had flowed and been counted, readings under way.
MEMORY = record(
    ("taken", COUNT),
    ("t", "f8"),  # s
    ("flowed", "f8", (MAX_BRANCHES,)),  # kg
    ("count", "f8", (MAX_BRANCHES,)),  # kg
    ("last", "f8", (MAX_BRANCHES,)),  # kg, counted in the last cycle
    ("under_way", "f8", (DEPTH, MAX_BRANCHES)),  # kg
)


@kernel
def measure(params, unit, case, tables, plant, outputs, memory, sensed):
    """Count the flow since the last reading and deliver the count of ``delay_cycles`` ago."""
    cycle, dt = memory.taken, plant.t - memory.t
    now, old = cycle % DEPTH, max(cycle - params.delay_cycles, 0) % DEPTH
    walk, second = params.noise * sqrt(dt), 0.0
    for k in range(case.branches.count):
        if k % 2 == 0:
            white, second = normal_pair(unit.key, _NORMALS * cycle + k)
        else:
            white = second
        full, fault = case.branches.full_flow[k], plant.instruments.flow[k]
        error = (unit.bias[k] * dt + walk * white) * full + fault.offset * dt
        if fault.noise > 0.0:
            error += fault.noise * dt * normal_pair(unit.key, _NORMALS * cycle + _FAULTY + k)[0]
        counted = (1.0 + unit.scale[k]) * (plant.branch_used[k] - memory.flowed[k]) + error
        if fault.mode != WORKING:
            counted = faulty_count(fault.mode, memory.last[k], counted, full * dt)
        memory.last[k], memory.flowed[k] = counted, plant.branch_used[k]
        memory.count[k] += counted
        total = memory.count[k]
        memory.under_way[now, k] = total - wrapped(total, params.quantum) if params.quantum > 0.0 else total
        sensed.branch_used[k] = memory.under_way[old, k]
    memory.t = plant.t
    memory.taken += 1


def plan(params: FlowMetersParams, rng: Stream, unit: np.void) -> None:
    """Draw the errors of the meters in this case."""
    given = in_si(params)
    unit["scale"] = given["scale"] * rng.standard_normal(MAX_BRANCHES)
    unit["bias"] = given["bias"] * rng.standard_normal(MAX_BRANCHES)
    unit["key"] = rng.keys()


MEMBER = Member(
    "flow_meters",
    FlowMetersParams,
    {"measure": measure},
    "Moog, Ultrasonic Flow Meter, product page",
    memory=MEMORY,
    tables=UNIT,
    plan=plan,
    writes=("branch_used",),
)
