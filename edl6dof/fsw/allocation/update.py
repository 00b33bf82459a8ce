"""One control cycle of thruster allocation: duties for the demand, and what stays unallocated."""

from __future__ import annotations

import numpy as np

from edl6dof.fsw.allocation.effectiveness import ROWS
from edl6dof.fsw.allocation.registry import ALLOCATORS, share_out
from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.jit import kernel
from edl6dof.records import FLAG

#: Share of the torque scale from which an unallocated torque counts as saturation.
SATURATED_FROM = 0.2

ALLOCATION = np.dtype(
    [
        ("duty", "f8", (MAX_THRUSTERS,)),  # of each thruster, 0..1
        ("unallocated", "f8", (ROWS,)),  # demand less what the duties give, N and N m, B
        ("saturated", FLAG),  # a torque was left unallocated: the integrators of attitude control stand still
        ("method", ALLOCATORS.memory),
    ],
    align=True,
)


@kernel
def is_anything(wrench):
    """Whether a force or torque is demanded."""
    wanted = 0.0
    for i in range(ROWS):
        wanted += abs(wrench[i])
    return wanted > 0.0


@kernel
def allocate(params, vehicle, healthy, effectiveness, demand, out):
    """Share the demand out over the thrusters.

    Args:
        params: allocation record.
        vehicle: believed vehicle (thrusters).
        healthy: whether each thruster may be used.
        effectiveness: ``EFFECTIVENESS`` record.
        demand: ``DEMAND`` record.
        out: ``ALLOCATION`` record, written.
    """
    if is_anything(demand.wrench) or demand.boosting != 0:
        share_out(
            params.method,
            params,
            shared=params,
            vehicle=vehicle,
            healthy=healthy,
            effectiveness=effectiveness,
            demand=demand,
            memory=out.method,
            duty=out.duty,
            unallocated=out.unallocated,
        )
    else:
        for i in range(vehicle.n_thrusters):
            out.duty[i] = 0.0
        for i in range(ROWS):
            out.unallocated[i] = 0.0
    out.saturated = 0
    for i in range(3, ROWS):
        if abs(out.unallocated[i]) > SATURATED_FROM * params.torque_scale:
            out.saturated = 1
