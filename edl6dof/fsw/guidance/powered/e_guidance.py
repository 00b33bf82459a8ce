"""E-guidance, which is zero-effort-miss/zero-effort-velocity guidance: least integral of the squared thrust
acceleration to a final position at rest.

a = 6 ZEM / t_go^2 - 2 ZEV / t_go, linear in time; ZEM and ZEV are the errors of position and velocity at
arrival without thrust. The time to go is that of the least integral over all times (a quartic equation), or
longer where engine and tilt require it (:mod:`.target`). Sources: Cherry, AIAA 64-638 (E-guidance); D'Souza,
AIAA 97-3709 (time to go); Ebrahimi, Bahrami & Roshanian, Acta Astronautica 62 (2008) 556-562, and Guo,
Hawkins & Wie, J. Guidance 36 (2013) 810-820 (ZEM/ZEV).
"""

from __future__ import annotations

from edl6dof.config.base import param
from edl6dof.fsw.guidance.powered.target import PLAN, PlanningParams, plan_arrival
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.vector import clamp, dot


class EGuidanceParams(PlanningParams):
    """E-guidance (ZEM/ZEV)."""

    lateral_time_floor_s: float = param(
        7.0, "smallest time to go used in the lateral gains, which the attitude has to follow", gt=0.0
    )


#: At arrival the upward acceleration is (6 h - 2 V T) / T^2.
_GAINS = (2.0, 6.0)


#: Search for the root of the quartic: shortest and longest time to go (s), ratio of neighbours, bisections.
_SHORTEST, _LONGEST, _RATIO, _HALVINGS = 0.1, 1e4, 1.1, 40


@kernel
def effort_rate(t, gravity, position, velocity):
    """t^4 times the rate at which the cost changes with the time to go ``t``, up to its sign; the position is
    relative to the target.  D'Souza 1997, without a weight of the flight time.
    """
    rr, rv, vv = dot(position, position), dot(position, velocity), dot(velocity, velocity)
    return (0.5 * gravity * gravity * t * t - 2.0 * vv) * t * t - 12.0 * rv * t - 18.0 * rr


@kernel
def optimal_time(gravity, position, velocity):
    """Time to go (s) of least cost, for a state relative to the target (m, m/s; north, east, up).

    Of several minima the first is taken: the later ones pass the target and return.
    """
    high = _SHORTEST
    while effort_rate(high, gravity, position, velocity) <= 0.0 and high < _LONGEST:
        high *= _RATIO
    low = high / _RATIO
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if effort_rate(middle, gravity, position, velocity) > 0.0:
            high = middle
        else:
            low = middle
    return high


@kernel
def zem_zev(miss, velocity, gravity, t_go):
    """Thrust acceleration (m/s2) along one axis to rest at arrival; ``miss``: target less position, m."""
    zem = miss - velocity * t_go - 0.5 * gravity * t_go * t_go
    zev = -velocity - gravity * t_go
    return 6.0 * zem / (t_go * t_go) - 2.0 * zev / t_go


@kernel
def guide(params, vehicle, state, nav, target, memory, out):
    """Return the thrust acceleration north, east, up (m/s2, including the part that balances gravity) and the
    tilt limit (rad).
    """
    p = params
    north, east = target.point_L[1] - nav.site_L[1], target.point_L[0] - nav.site_L[0]
    up = target.height - nav.height
    least = 0.0
    if memory.made == 0:
        velocity = nav.v_N[0], nav.v_N[1], -nav.v_N[2]
        least = optimal_time(nav.gravity, (-north, -east, -up), velocity)
    out.time_to_go = plan_arrival(p, _GAINS, least, state, nav, target=target, plan=memory)
    t_go = max(out.time_to_go, p.time_floor)
    upward = zem_zev(up, -nav.v_N[2], -nav.gravity, t_go)
    t_go = max(out.time_to_go, p.lateral_time_floor)
    return (
        zem_zev(north, nav.v_N[0], 0.0, t_go),
        zem_zev(east, nav.v_N[1], 0.0, t_go),
        clamp(upward, 0.5 * nav.gravity, 20.0),
        p.tilt_limit,
    )


MEMBER = Member(
    "e_guidance", EGuidanceParams, {"guide": guide}, "Cherry 1964; D'Souza 1997; Guo et al. 2013", PLAN
)
