"""Constant thrust at a preset offset from the anti-velocity direction, then the polynomial law.

The engine burns at its full level, turned from the anti-velocity direction towards the target, so long that
a constant deceleration within the throttle band, less the reserve, takes the lander from there to the target:
the burn time follows from initial and target state.  The polynomial law meets the target after that.  Source:
CN108594802B, claim 1 (Tianwen-1: constant thrust at a preset offset from the anti-velocity, burn time from
initial and target state, then a refinement); offset, the condition at the end of the burn, and the refinement
are estimates.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from edl6dof.config.base import param
from edl6dof.fsw.guidance.powered.planning import (
    LEAST_HEIGHT,
    PlanningParams,
    planned_sideways,
    planned_upward,
    time_to_divert,
)
from edl6dof.fsw.guidance.powered.polynomial import meet
from edl6dof.jit import kernel
from edl6dof.records import FLAG
from edl6dof.registry import Member
from edl6dof.spatial.elementary import cos, sin


class ConstantThrustParams(PlanningParams):
    """Constant thrust at an offset from the anti-velocity, then polynomial guidance."""

    offset_deg: float = param(
        15.0, "angle from the anti-velocity direction to the thrust", status="estimate", ge=0.0, le=45.0
    )


MEMORY = np.dtype(
    [("begun", FLAG), ("over", FLAG), ("burn_end", "f8"), ("arrival", "f8")],  # s, flight times
    align=True,
)


@kernel
def burn_time(strong, weak, height, descent):
    """How long (s) to decelerate with ``strong`` so that ``weak`` (m/s2, gravity taken off) does the rest of
    the ``height`` (m) to rest; as long as it takes to come to rest if even that is too little, and not at all
    if ``weak`` can do it alone.
    """
    excess = descent * descent - 2.0 * weak * height
    if excess <= 0.0 or strong <= weak:
        return 0.0
    return (descent - sqrt(max(descent * descent - strong * excess / (strong - weak), 0.0))) / strong


@kernel
def against_velocity(offset, size, nav, target):
    """Acceleration north, east, up of ``size`` (m/s2), turned by ``offset`` (rad) from the anti-velocity
    direction towards the target.
    """
    speed = max(nav.speed, 1e-6)
    a_n, a_e, a_u = -nav.v_N[0] / speed, -nav.v_N[1] / speed, nav.v_N[2] / speed
    north, east = target.point_L[1] - nav.site_L[1], target.point_L[0] - nav.site_L[0]
    along = north * a_n + east * a_e
    w_n, w_e, w_u = north - along * a_n, east - along * a_e, -along * a_u
    width = max(sqrt(w_n * w_n + w_e * w_e + w_u * w_u), 1e-6)
    ahead, beside = size * cos(offset), size * sin(offset) / width
    return ahead * a_n + beside * w_n, ahead * a_e + beside * w_e, ahead * a_u + beside * w_u


@kernel
def plan_burn(p, state, nav, target, memory):
    """When the constant burn that begins now ends."""
    memory.begun = 1
    strong = state.engine.full_thrust / state.mass * cos(p.offset) - nav.gravity
    height = max(nav.height - target.height, LEAST_HEIGHT)
    weak = planned_upward(p.thrust_reserve, state, nav, target)
    memory.burn_end = nav.t + burn_time(strong, weak, height, nav.v_N[2])


@kernel
def plan_rest(p, state, nav, target, memory):
    """When the polynomial law that begins now arrives: after a constant deceleration, or as late as the
    divert asks for.
    """
    memory.over = 1
    straight = 2.0 * max(nav.height - target.height, LEAST_HEIGHT) / max(nav.v_N[2], 1.0)
    sideways = planned_sideways(p.thrust_reserve, p.tilt_limit, state)
    memory.arrival = nav.t + max(straight, time_to_divert(sideways, nav, target))


@kernel
def guide(params, vehicle, state, nav, target, memory, out):
    """Commanded thrust acceleration north, east, up (m/s2, gravity included) and the tilt limit (rad)."""
    p = params
    if memory.begun == 0:
        plan_burn(p, state, nav, target, memory)
    if nav.t < memory.burn_end:
        out.time_to_go = max(target.arrival - nav.t, memory.burn_end - nav.t + p.lateral_time_floor)
        north, east, up = against_velocity(p.offset, state.engine.full_thrust / state.mass, nav, target)
        return north, east, max(up, 0.5 * nav.gravity), p.tilt_limit
    if memory.over == 0:
        plan_rest(p, state, nav, target, memory)
    out.time_to_go = memory.arrival - nav.t
    north, east, up = meet(p.time_floor, p.lateral_time_floor, out.time_to_go, nav, target)
    return north, east, up, p.tilt_limit


MEMBER = Member(
    "constant_thrust",
    ConstantThrustParams,
    {"guide": guide},
    "CN108594802B (Tianwen-1: constant thrust at an offset, refined)",
    MEMORY,
)
