"""Gravity turn: thrust against the velocity, sized for a constant deceleration to rest at the final height.

Source: Cheng, "Lunar Terminal Descent Guidance by Gravity-Turn Trajectory", AIAA 66-1863; here the
deceleration needed is taken from the remaining height and speed, v^2 / (2 h), along the path. The turn ends
where the vehicle is at rest, since thrust against the velocity brings it no lower.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.powered.stopping import STOPPED
from edl6dof.kernels import kernel
from edl6dof.registry import Member


class GravityTurnParams(Params):
    """Gravity-turn powered guidance."""

    tilt_limit_deg: float = param(25.0, "largest tilt of the commanded thrust", gt=0.0, le=60.0)


@kernel
def guide(params, vehicle, state, nav, target, memory, out):
    """Commanded thrust acceleration north, east, up (m/s2) and the tilt limit (rad)."""
    path = max(nav.height - target.height, 1.0)
    speed = max(nav.speed, 0.1)
    descent = max(nav.v_N[2], 0.1)
    brake = 0.5 * speed * descent / path
    out.time_to_go = 2.0 * path / descent if descent > STOPPED else 0.0
    return (
        -brake * nav.v_N[0] / speed,
        -brake * nav.v_N[1] / speed,
        brake * nav.v_N[2] / speed + nav.gravity,
        params.tilt_limit,
    )


MEMBER = Member("gravity_turn", GravityTurnParams, {"guide": guide}, "Cheng 1966 (gravity turn)")
