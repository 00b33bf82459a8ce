"""Apollo's quadratic guidance: final position, at rest, and final acceleration.

a = a_T - 6 (v_T + v) / t_go + 12 (r_T - r) / t_go^2 with v_T = 0, quadratic in time. The final acceleration
is upward and follows from the plan of the arrival (:mod:`.target`); the time to go is that of zero upward
jerk at arrival, as in Apollo, where it came from a condition on the final jerk. Source: Klumpp, "Apollo Lunar
Descent Guidance", Automatica 10 (1974) 133-146.
"""

from __future__ import annotations

from edl6dof.fsw.guidance.powered.target import PLAN, PlanningParams, plan_arrival
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.vector import clamp


class ApolloParams(PlanningParams):
    """Apollo's quadratic guidance."""


#: Without final jerk the upward acceleration at arrival is (4 h - V T) / T^2.
_GAINS = (1.0, 4.0)


@kernel
def quadratic(miss, velocity, final, t_go):
    """Return the acceleration along one axis (m/s2, gravity not included); ``miss``: position of the target
    minus that of the lander (m), ``final``: acceleration at arrival (m/s2).
    """
    return final - 6.0 * velocity / t_go + 12.0 * miss / (t_go * t_go)


@kernel
def guide(params, vehicle, state, nav, target, memory, out):
    """Return the thrust acceleration north, east, up (m/s2, including the part that balances gravity) and the
    tilt limit (rad).
    """
    p = params
    out.time_to_go = plan_arrival(p, _GAINS, 0.0, state, nav, target=target, plan=memory)
    t_go = max(out.time_to_go, p.time_floor)
    upward = quadratic(target.height - nav.height, -nav.v_N[2], memory.upward, t_go) + nav.gravity
    t_go = max(out.time_to_go, p.lateral_time_floor)
    return (
        quadratic(target.point_L[1] - nav.site_L[1], nav.v_N[0], 0.0, t_go),
        quadratic(target.point_L[0] - nav.site_L[0], nav.v_N[1], 0.0, t_go),
        clamp(upward, 0.5 * nav.gravity, 20.0),
        p.tilt_limit,
    )


MEMBER = Member("apollo", ApolloParams, {"guide": guide}, "Klumpp 1974 (Apollo quadratic guidance)", PLAN)
