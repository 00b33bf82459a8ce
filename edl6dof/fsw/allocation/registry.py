"""Thruster allocation: the demand on the thrusters in a control cycle, the family of methods, and the step
that runs the chosen one.

A member has one kernel, ``share_out(params, shared, vehicle, healthy, effectiveness, demand, memory, duty,
unallocated)``: it writes ``duty`` (0..1 of each thruster) and ``unallocated``, the part of the demand that
the duties do not give. ``params`` and ``memory`` belong to the member, ``shared`` are the settings that all
methods have in common. A result derived from the effectiveness is valid until ``effectiveness.mark`` changes.
An unallocated torque freezes the integrators of attitude control. On the nominal flight
(``tests/flights/test_allocation_methods.py`` flies both methods):

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
from edl6dof.interface.effectors import ATTITUDE, AXIAL, ENGINE_FULL, THRUSTER_GROUPS
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record, whole
from edl6dof.registry import Family
from edl6dof.spatial.quaternion import to_frame
from edl6dof.spatial.vector import add, put3, scale, take3, take4

DEMAND = record(
    ("attitude_error", "f8", (3,)),  # rad: attitude error that the controller returned
    ("wrench", "f8", (ROWS,)),  # N and N m, B: force x, y, z and torque x, y, z on the vehicle
    ("groups", whole(0, 2 ** len(THRUSTER_GROUPS) - 1)),  # bit mask of the groups that may fire
    ("translating", FLAG),  # lateral force is demanded; otherwise it is only discouraged
    ("boosting", FLAG),  # the axial thrusters help or replace the engine; otherwise axial force has no weight
)


@kernel
def no_demand(demand):
    """Set the demanded force and torque to zero."""
    for i in range(ROWS):
        demand.wrench[i] = 0.0


@kernel
def groups_of(phase, boosting, thrusters, count, healthy):
    """Return the bit mask of the thruster groups that may fire: those of the phase; the axial group as well
    while boosting or while an attitude thruster is out of use.
    """
    mask = 1 << AXIAL if boosting else 0
    for i in range(phase.n_thrusters):
        mask |= 1 << phase.thrusters[i]
    for i in range(count):
        if thrusters[i].group == ATTITUDE and healthy[i] == 0:
            mask |= 1 << AXIAL
    return mask


@kernel
def largest_axial_force(vehicle, effectiveness):
    """Return the axial force (N) of all axial thrusters at full duty; the torque demand decides how much of
    it they give.
    """
    force = 0.0
    for i in range(vehicle.n_thrusters):
        if vehicle.thrusters[i].group == AXIAL:
            force += effectiveness[i, 0]
    return force


@kernel
def compose_demand(phase, vehicle, effectiveness, state, healthy, nav, goal, torque, error, demand):
    """Combine the controller's ``torque`` (N m, B), the lateral force and thrust of guidance (``goal``), and
    the groups that may give them into ``demand`` (``DEMAND``); ``error``: attitude error to remove, rad.
    """
    burns = state.ignited != 0
    descending = burns and state.engine.by_thrusters > 0.0 and nav.t >= state.ignition_time - 1e-9
    boosting = descending or (burns and goal.engine_mode == ENGINE_FULL)
    put3(demand.attitude_error, 0, error)
    no_demand(demand)
    put3(demand.wrench, 3, torque)
    if descending:
        demand.wrench[0] = -state.engine.by_thrusters * goal.thrust
    elif boosting:
        demand.wrench[0] = largest_axial_force(vehicle, effectiveness)
    if goal.translating != 0:
        q = take4(nav.q_I2B)
        north, east = take3(nav.north_I, 0), take3(nav.east_I, 0)
        force = to_frame(q, add(scale(goal.force_N[0], north), scale(goal.force_N[1], east)))
        demand.wrench[1], demand.wrench[2] = force[1], force[2]
    demand.groups = groups_of(phase, boosting, vehicle.thrusters, vehicle.n_thrusters, healthy)
    demand.translating, demand.boosting = goal.translating, 1 if boosting else 0


ALLOCATORS = Family("thruster allocation", (least_squares.MEMBER, table.MEMBER))

_Methods: Any = ALLOCATORS.params_model(
    "AllocationMethods", "method", "least_squares", "Thruster allocation."
)


class AllocationParams(_Methods):
    """Thruster allocation: the method, and the settings that all methods share."""

    torque_scale_nm: float = param(
        250.0,
        "torque error of weight one; a fifth of it unallocated counts as saturated",
        usual=(0.1, 1e5, "about the torque of one thruster: of 1 N to some kN"),
        gt=0.0,
    )
    fine_share: float = param(
        0.8, "share of the fine thrusters' authority up to which only they fire", ge=0.0, le=1.0
    )


share_out = ALLOCATORS.role(
    "share_out",
    *("params", "shared", "vehicle", "healthy", "effectiveness", "demand", "memory", "duty", "unallocated"),
    own=("params", "memory"),
)


#: Share of the torque scale from which an unallocated torque counts as saturation.
SATURATED_FROM = 0.2

ALLOCATION = record(
    ("duty", "f8", (MAX_THRUSTERS,)),  # 0..1, of each thruster
    ("unallocated", "f8", (ROWS,)),  # demand less what the duties give, N and N m, B
    ("saturated", FLAG),  # a torque was left unallocated: the integrators of attitude control are frozen
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
    """Distribute the ``demand`` (``DEMAND``) over the thrusters by the chosen method; ``out``: ``ALLOCATION``
    record, written.
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
