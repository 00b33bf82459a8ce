"""Ideal inertial measurement unit and flow meters: body rate, the velocity gained, and the propellant used by
each branch, some cycles old when they reach the flight computer.

As in a real unit the accelerometers count up the integral of specific force, so that nothing between two
readings is lost.  Without noise, bias and quantisation; the unit sits at the centre of mass.

Source: Titterton and Weston, Strapdown Inertial Navigation Technology (2004), chapter 11.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.interface.capacities import MAX_BRANCHES
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, record
from edl6dof.registry import Member
from edl6dof.vehicle.plant import RATE

#: Readings that can be under way.
DEPTH = 8


class ImuParams(Params):
    """Inertial measurement unit."""

    delay_cycles: int = param(
        1,
        "base cycles between a reading and its arrival in the flight computer",
        status="estimate",
        ge=0,
        le=DEPTH - 1,
    )


#: Memory of the unit: readings that are under way.
READINGS = record(
    ("rate", "f8", (DEPTH, 3)),  # rad/s
    ("gain", "f8", (DEPTH, 3)),  # m/s
    ("used", "f8", (DEPTH, MAX_BRANCHES)),  # kg
    ("taken", COUNT),
)


@kernel
def measure(params, unit, case, tables, plant, outputs, memory, sensed):
    """Take a reading and deliver the one taken ``delay_cycles`` ago (at first, the first reading)."""
    slot = memory.taken % DEPTH
    old = max(memory.taken - params.delay_cycles, 0) % DEPTH
    memory.taken += 1
    for i in range(3):
        memory.rate[slot, i] = plant.y[RATE + i]
        memory.gain[slot, i] = plant.velocity_gain[i]
        sensed.imu_rate_B[i] = memory.rate[old, i]
        sensed.imu_gain_B[i] = memory.gain[old, i]
    for k in range(case.branches.count):
        memory.used[slot, k] = plant.branch_used[k]
        sensed.branch_used[k] = memory.used[old, k]


MEMBER = Member(
    "imu",
    ImuParams,
    {"measure": measure},
    "Titterton and Weston, Strapdown Inertial Navigation Technology (2004), chapter 11",
    memory=READINGS,
    writes=("imu_rate_B", "imu_gain_B", "branch_used"),
)
