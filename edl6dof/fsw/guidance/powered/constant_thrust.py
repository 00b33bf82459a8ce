"""Constant thrust at a preset offset from the anti-velocity direction, then the polynomial law.

The engine burns at its full level, turned from the anti-velocity direction towards the target. Each call
tests whether a constant deceleration within the throttle band, less the reserve, would stop the lander at the
target; from then on the polynomial law, with a planned time to go, flies to the target. Source: CN108594802B,
claim 1 (Tianwen-1: constant thrust at a preset offset from the anti-velocity, burn time from initial and
target state, then a refinement); offset, the condition at the end of the burn, and the refinement are
estimates.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.config.base import param
from edl6dof.fsw.guidance.powered.target import (
    LEAST_HEIGHT,
    PLAN,
    PlanningParams,
    meet,
    plan_arrival,
    planned_upward,
)
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.registry import Member
from edl6dof.spatial.elementary import cos, sin


class ConstantThrustParams(PlanningParams):
    """Constant thrust at an offset from the anti-velocity, then polynomial guidance."""

    offset_deg: float = param(
        15.0, "angle from the anti-velocity direction to the thrust", status="estimate", ge=0.0, le=45.0
    )


#: At arrival the upward acceleration of the polynomial law is (6 h - 2 V T) / T^2.
GAINS = (2.0, 6.0)

MEMORY = record(("over", FLAG), ("rest", PLAN))


@kernel
def too_fast(p, state, nav, target):
    """Return whether the throttle band, less the reserve, cannot stop the descent above the target height."""
    height = max(nav.height - target.height, LEAST_HEIGHT)
    weak = planned_upward(p.thrust_reserve, state, nav, target)
    return nav.v_N[2] > 0.0 and nav.v_N[2] * nav.v_N[2] > 2.0 * weak * height


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
def guide(params, vehicle, state, nav, target, memory, out):
    """Return the thrust acceleration north, east, up (m/s2, including the part that balances gravity) and the
    tilt limit (rad).
    """
    p = params
    if memory.over == 0 and too_fast(p, state, nav, target):
        out.time_to_go = max(target.arrival - nav.t, p.lateral_time_floor)
        north, east, up = against_velocity(p.offset, state.engine.full_thrust / state.mass, nav, target)
        return north, east, max(up, 0.5 * nav.gravity), p.tilt_limit
    memory.over = 1
    out.time_to_go = plan_arrival(p, GAINS, 0.0, state, nav, target=target, plan=memory.rest)
    north, east, up = meet(p.time_floor, p.lateral_time_floor, out.time_to_go, nav, target)
    return north, east, up, p.tilt_limit


MEMBER = Member(
    "constant_thrust", ConstantThrustParams, {"guide": guide}, "CN108594802B, claim 1 (Tianwen-1)", MEMORY
)
