"""Thruster allocation: the family of methods, and the control cycle that runs the chosen one.

A member has one kernel, ``share_out(params, shared, vehicle, healthy, effectiveness, demand, memory, duty,
unallocated)``: it writes ``duty`` (0..1 each) and the part of the demand that these do not give.  ``params``
and ``memory`` are its own, ``shared`` the settings that all methods have in common.  A result derived from
the effectiveness is valid until ``effectiveness.mark`` changes.  An unallocated torque stops the integrators
of attitude control.  On the nominal flight
(``tests/flights/test_allocation_methods.py`` flies both):

    method          propellant   largest roll error   thrust direction   body rate at touchdown
    least_squares   137.0 kg     0.21 deg             10.3 deg           0.18 deg/s
    table           142.2 kg     0.42 deg             6.2 deg            0.36 deg/s

The table fires four thrusters for a roll torque where two would do, and lets one axis disturb the next.
"""

from __future__ import annotations

from typing import Any

from edl6dof.config.base import param
from edl6dof.fsw.allocation import least_squares, table
from edl6dof.fsw.allocation.effectiveness import ROWS
from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.registry import Family

ALLOCATORS = Family("thruster allocation", (least_squares.MEMBER, table.MEMBER))

_Methods: Any = ALLOCATORS.params_model(
    "AllocationMethods", "method", "least_squares", "Thruster allocation."
)


class AllocationParams(_Methods):
    """Thruster allocation: the method, and what all share."""

    torque_scale_nm: float = param(
        250.0,
        "torque error that weighs one; a fifth of it unallocated counts as saturated",
        usual=(0.1, 1e5, "about the torque of one thruster: of 1 N to some kN"),
        gt=0.0,
    )
    fine_share: float = param(
        0.8, "share of the fine thrusters' authority up to which they work alone", ge=0.0, le=1.0
    )


share_out = ALLOCATORS.role(
    "share_out",
    *("params", "shared", "vehicle", "healthy", "effectiveness", "demand", "memory", "duty", "unallocated"),
    own=("params", "memory"),
)


#: Share of the torque scale from which an unallocated torque counts as saturation.
SATURATED_FROM = 0.2

ALLOCATION = record(
    ("duty", "f8", (MAX_THRUSTERS,)),  # of each thruster, 0..1
    ("unallocated", "f8", (ROWS,)),  # demand less what the duties give, N and N m, B
    ("saturated", FLAG),  # a torque was left unallocated: the integrators of attitude control stand still
    ("method", ALLOCATORS.memory),
)


@kernel
def is_anything(wrench):
    """Return whether a force or torque is demanded."""
    wanted = 0.0
    for i in range(ROWS):
        wanted += abs(wrench[i])
    return wanted > 0.0


@kernel
def allocate(share_out, params, vehicle, healthy, effectiveness, demand, out):
    """Share the demand out over the thrusters.

    Args:
        share_out: the method that flies.
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
