"""Polynomial guidance: the thrust acceleration to a final position at rest in a given time to go.

Upwards a = 6 (r_f - r) / t_go^2 - 4 v / t_go, linear in time, with free final acceleration; sideways a = 12
(r_f - r) / t_go^2 - 6 v / t_go, quadratic in time, whose final acceleration is zero: the thrust ends upright,
as S1 6.2 requires, and most of the divert comes at the start. Gravity is added. The time to go ends at the
expected arrival. Source: the quadratic law of Apollo's powered descent (Klumpp, Automatica 10 (1974)
133-146), without and with a given final acceleration; used for Tianwen-1's powered deceleration as an
estimate (the flown law is published elsewhere).
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.powered.target import meet
from edl6dof.kernels import kernel
from edl6dof.registry import Member


class PolynomialParams(Params):
    """Polynomial powered guidance."""

    tilt_limit_deg: float = param(25.0, "largest tilt of the commanded thrust", gt=0.0, le=60.0)
    time_floor_s: float = param(2.5, "smallest time to go used in the gains of height", gt=0.0)
    lateral_time_floor_s: float = param(
        10.0, "smallest time to go used in the lateral gains, which the attitude has to follow", gt=0.0
    )


@kernel
def guide(params, vehicle, state, nav, target, memory, out):
    """Return the thrust acceleration north, east, up (m/s2, including the part that balances gravity) and the
    tilt limit (rad).
    """
    p = params
    out.time_to_go = target.arrival - nav.t
    north, east, up = meet(p.time_floor, p.lateral_time_floor, out.time_to_go, nav, target)
    return north, east, up, p.tilt_limit


MEMBER = Member("polynomial", PolynomialParams, {"guide": guide}, "Klumpp 1974 (Apollo quadratic guidance)")
