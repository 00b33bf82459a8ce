"""Target of powered deceleration: position and height at which the lander comes to rest, and the time to go.

The position is chosen once, at ignition: ahead of the lander by a share of its drift during a constant
deceleration, less a divert against the drift, away from the backshell; or it is the choice of coarse hazard
avoidance. Source of backshell avoidance: Hu et al. 2022, section 6.2; the rule is an estimate.

A law that plans its time to go derives it from the limits of engine and tilt. At arrival, a law whose upward
acceleration is linear in time, or quadratic with zero final slope, needs a = (d h - s V T) / T^2, where h is
the height to lose, V the descent rate, T the time to go, and d and s are two numbers of the law. The plan
uses the shortest T that meets three conditions: a is within the throttle band less a reserve for feedback,
the divert is within the tilt limit, and T is at least the time that the law requires. From then on T is
computed from this a, which the law produces in the absence of disturbances. Source: Klumpp, Automatica 10
(1974) 133-146, who solves for T by a condition at arrival in every cycle; the limits are this project's own.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.config.base import Params, param
from edl6dof.config.units import G0
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.spatial.elementary import exp, sin
from edl6dof.spatial.vector import clamp

#: Least height above the target (m) and descent rate (m/s) in the computation of the time of arrival.
ARRIVAL_HEIGHT, ARRIVAL_DESCENT = 50.0, 5.0
#: Least height of rest where the target height is out of reach, over the target height.
LEAST_SHARE = 0.3


class PoweredTargetParams(Params):
    """Target of powered deceleration, which all powered laws share."""

    height_m: float = param(
        100.0,
        "height above ground at which velocity is zero",
        status="published",
        source="S1",
        gt=0.0,
        usual=(0.5, 1000, "airbags cut loose to hover"),
    )
    time_factor: float = param(
        1.0, "expected duration divided by that of a constant deceleration", status="estimate", gt=0.2, le=3.0
    )
    drift_share: float = param(
        0.33,
        "distance of the target ahead of the lander, as a share of velocity times expected duration",
        ge=0.0,
        le=1.0,
    )
    divert_m: float = param(
        120.0, "divert against the direction of drift, away from backshell and parachute", ge=0.0
    )


POWERED_TARGET = record(
    ("set", FLAG),  # the target has been chosen
    ("arrival", "f8"),  # s: flight time at which the lander is expected there
    ("point_L", "f8", (2,)),  # m, L: east and north of the landing site
    ("height", "f8"),  # m: above the ground
    ("least_height", "f8"),  # m: above the ground, least height of rest where the target is out of reach
)


@kernel
def choose_target(p, nav, point, target):
    """Set ``target`` (``POWERED_TARGET``) unless it is set already; ``point``: ``LANDING_POINT`` record,
    whose coarse point is used if chosen.
    """
    if target.set != 0:
        return
    target.set = 1
    target.height, target.least_height = p.height, LEAST_SHARE * p.height
    descent = max(nav.v_N[2], ARRIVAL_DESCENT)
    duration = p.time_factor * 2.0 * max(nav.height - p.height, ARRIVAL_HEIGHT) / descent
    target.arrival = nav.t + duration
    east, north = nav.v_N[1], nav.v_N[0]
    drift = sqrt(east * east + north * north)
    ahead = p.drift_share * duration
    back_e, back_n = (east / drift, north / drift) if drift > 0.5 else (0.0, 1.0)
    if point.coarse_known != 0:
        target.point_L[0], target.point_L[1] = point.coarse_L[0], point.coarse_L[1]
        return
    target.point_L[0] = nav.site_L[0] + ahead * east - p.divert * back_e
    target.point_L[1] = nav.site_L[1] + ahead * north - p.divert * back_n


@kernel
def meet(floor, lateral_floor, t_go, nav, target):
    """Return the thrust acceleration north, east, up (m/s2, including the part that balances gravity) with
    which the lander comes to rest at the target in ``t_go`` s; ``floor`` and ``lateral_floor``: smallest
    times to go (s) used for height and for lateral motion.
    """
    t = max(t_go, floor)
    up = 6.0 * (target.height - nav.height) / (t * t) + 4.0 * nav.v_N[2] / t
    t = max(t_go, lateral_floor)
    k_r, k_v = 12.0 / (t * t), 6.0 / t
    north = k_r * (target.point_L[1] - nav.site_L[1]) - k_v * nav.v_N[0]
    east = k_r * (target.point_L[0] - nav.site_L[0]) - k_v * nav.v_N[1]
    return north, east, clamp(up + nav.gravity, 0.5 * nav.gravity, 20.0)


#: Least planned upward acceleration at arrival (m/s2), also for a weak engine, to save propellant; least
#: height to lose (m).
LEAST_UPWARD, LEAST_HEIGHT = 0.5, 1.0


class PlanningParams(Params):
    """Parameters of laws that plan their time to go."""

    tilt_limit_deg: float = param(25.0, "largest tilt of the commanded thrust", gt=0.0, le=60.0)
    thrust_reserve: float = param(
        0.1, "share of throttle band and tilt limit reserved for feedback", status="estimate", ge=0.0, le=0.5
    )
    time_floor_s: float = param(2.5, "smallest time to go used in the gains of height", gt=0.0)
    lateral_time_floor_s: float = param(
        10.0, "smallest time to go used in the lateral gains, which the attitude has to follow", gt=0.0
    )


PLAN = record(
    ("made", FLAG),
    ("upward", "f8"),  # m/s2, at arrival, without gravity
    ("arrival", "f8"),  # s, flight time
)


@kernel
def planned_upward(reserve, state, nav, target):
    """Upward acceleration at arrival (m/s2, gravity subtracted) at the upper end of the throttle band less
    the reserve.
    """
    engine = state.engine
    spent = nav.speed + nav.gravity * max(target.arrival - nav.t, 0.0)
    mass = state.mass * exp(-spent / (G0 * engine.specific_impulse))
    return max((1.0 - reserve) * engine.throttle_max / mass - nav.gravity, LEAST_UPWARD)


@kernel
def root(a, s, d):
    """The positive T of a T^2 + s T - d = 0, for positive ``a`` and ``d``."""
    half = sqrt(s * s + 4.0 * a * d)
    return 2.0 * d / (half + s) if s > 0.0 else (half - s) / (2.0 * a)


@kernel
def time_to_divert(sideways, nav, target):
    """Shortest time to go (s) in which the lateral law of least effort, a = 6 r / T^2 - 4 v / T with the
    remaining way r, begins with no more than ``sideways`` (m/s2).
    """
    north, east = target.point_L[1] - nav.site_L[1], target.point_L[0] - nav.site_L[0]
    away = max(sqrt(north * north + east * east), 1e-6)
    closing = (nav.v_N[0] * north + nav.v_N[1] * east) / away
    return root(sideways, 4.0 * closing, 6.0 * away)


@kernel
def plan_arrival(p, gains, least, state, nav, target, plan):
    """Time to go (s) to the target: planned at the first call, then updated by the state, and at the end
    counted down.

    Args:
        p: parameters of the law, ``PlanningParams``.
        gains: s and d of the law, see the top of this module.
        least: least time to go of the law, s.
        state, nav, target: ``VEHICLE_STATE``, ``NAV`` and ``POWERED_TARGET`` records.
        plan: ``PLAN`` record, updated.
    """
    s, d = gains
    height, descent = max(nav.height - target.height, LEAST_HEIGHT), nav.v_N[2]
    if plan.made == 0:
        plan.made = 1
        upward = planned_upward(p.thrust_reserve, state, nav, target)
        # within the tilt limit, less the reserve, at the full level of the start
        sideways = (1.0 - p.thrust_reserve) * sin(p.tilt_limit) * state.engine.full_thrust / state.mass
        t = max(root(upward, s * descent, d * height), least, time_to_divert(sideways, nav, target))
        plan.upward = max((d * height - s * descent * t) / (t * t), LEAST_UPWARD)
        plan.arrival = nav.t + root(plan.upward, s * descent, d * height)
    elif plan.arrival - nav.t > p.lateral_time_floor:
        plan.arrival = nav.t + root(plan.upward, s * descent, d * height)
    return plan.arrival - nav.t
