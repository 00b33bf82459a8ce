"""Convex optimal guidance: the landing of least fuel that the engine can fly, planned at ignition and again
while the engine burns; between plans the thrust of the plan, with feedback of the deviation of position and
velocity from it.

A share of the thrust is reserved for this feedback; a plan that cannot land without the reserve uses it.
Where no plan lands at the target, one constraint after another is relaxed for good: the shortest time in the
throttle band, the height of arrival, the glide slope, the tilt, and the target itself. Then the plan with the
least error is flown; ``landing_error`` is this error. Where the engine turns out to be weaker than planned
with, or a weak one cannot land in its throttle band, the next plan starts without the last solution, and may
use full level again.

Sources: Acikmese & Ploen 2007, "Convex programming approach to powered descent guidance for Mars landing", J.
Guidance 30(5): the problem; Yu, Elango, Acikmese 2021, IEEE Control Systems Letters 5(6): the method (PIPG);
Blackmore, Acikmese, Scharf 2010, J. Guidance 33(4): the least landing error.
"""

from __future__ import annotations

from math import inf

from edl6dof.config.base import Params, param
from edl6dof.config.units import G0
from edl6dof.fsw.guidance.guidance_command import ARRIVAL, DWELL, GLIDE_SLOPE, TARGET, TILT
from edl6dof.fsw.guidance.powered.convex.flight_time import (
    refine_throttled,
    search_time,
    search_times,
    try_earlier,
)
from edl6dof.fsw.guidance.powered.convex.landing_plan import (
    LANDING,
    PLAN,
    control_at,
    fly_plan,
    full_controls,
    shift_controls,
)
from edl6dof.fsw.guidance.powered.convex.pipg import solve
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, record, whole
from edl6dof.registry import Member
from edl6dof.spatial.elementary import atan, cos, tan
from edl6dof.spatial.vector import norm, take3

#: First guess of the time of flight: least descent rate (m/s), and longest time (s).
LEAST_DESCENT, LONGEST_GUESS = 10.0, 60.0
#: Errors of a plan (m) beyond which the reserve is used, and beyond which constraints are relaxed.
TOLERATED, UNACCEPTABLE = 1.0, 5.0
#: Shortest time in the throttle band, s, where this constraint is relaxed: time of the engine to throttle
#: down.
LEAST_THROTTLED = 2.0
#: How much earlier a new plan tries to arrive, over the time to go.
EARLIER = 0.015
#: Time from now for which a plan may use the reserve, s.
NOW = 3.0
#: First step of the search from the old time of arrival, over the time to go.
REACH = 0.02
#: First factor of the search from the old time in the throttle band.
FACTOR = 1.3
#: Full thrust, over that of the last plan, below which a plan starts without the last solution.
WEAKER = 0.97


class ConvexParams(Params):
    """Convex optimal powered guidance."""

    tilt_limit_deg: float = param(25.0, "largest tilt of the commanded thrust", gt=0.0, le=60.0)
    end_tilt_deg: float = param(3.0, "largest tilt of the thrust at the end of the plan", gt=0.0, le=60.0)
    glide_slope_deg: float = param(
        10.0, "least elevation of the lander seen from the target", ge=0.0, lt=80.0
    )
    thrust_reserve: float = param(
        0.1, "share of throttle band and tilt limit reserved for feedback", status="estimate", ge=0.0, le=0.5
    )
    throttled_s: float = param(
        8.0, "shortest time in the throttle band before the target, after the start at full thrust", gt=0.0
    )
    plan_interval_s: float = param(1.0, "time from one plan to the next", gt=0.0)
    last_plan_s: float = param(6.0, "time to go below which no new plan is made", gt=0.0)
    miss_price: float = param(
        1.0, "price of a miss if the target is out of reach: velocity change per metre, 1/s", gt=0.0
    )
    iterations: int = param(300, "most iterations of a solution", ge=50, le=10000)
    position_gain: float = param(0.05, "acceleration per distance from the plan, 1/s2", ge=0.0)
    velocity_gain: float = param(0.4, "acceleration per velocity deviation from the plan, 1/s", ge=0.0)


MEMORY = record(
    ("plans", COUNT),
    ("start", "f8"),  # s, flight time of the start of the plan
    ("landing_error", "f8"),  # m, see ``error_of``
    ("relaxed", whole(0, TARGET)),  # number of relaxed constraints, in their order
    ("landing", LANDING),  # problem that the plan solves
    ("plan", PLAN),
    ("other", PLAN),  # workspace
)


@kernel
def describe(p, state, nav, target, landing):
    """Write the landing problem of the present state, with no constraint relaxed; a believed loss of thrust
    is taken from the reserve.
    """
    left = 1.0 - state.thrust_lost
    landing.mass = state.mass
    landing.low = state.engine.throttle_min
    landing.high = state.engine.throttle_max * min((1.0 - p.thrust_reserve) / left, 1.0)
    landing.low_now = landing.low
    landing.high_now, landing.now = state.engine.throttle_max, 0.0
    landing.full = state.engine.full_thrust
    landing.exhaust_speed = state.engine.specific_impulse * G0
    landing.gravity = nav.gravity
    landing.position[0] = nav.site_L[0] - target.point_L[0]
    landing.position[1] = nav.site_L[1] - target.point_L[1]
    landing.position[2] = nav.height - target.height
    landing.velocity[0], landing.velocity[1], landing.velocity[2] = nav.v_N[1], nav.v_N[0], -nav.v_N[2]
    landing.slope = tan(p.glide_slope)
    landing.cos_tilt = cos(atan(tan(p.tilt_limit) * (1.0 - p.thrust_reserve)))
    landing.cos_last_tilt = cos(p.end_tilt)
    landing.miss_price = p.miss_price


@kernel
def relax(p, nav, target, memory):
    """Remove the relaxed constraints from the landing problem."""
    landing, relaxed = memory.landing, memory.relaxed
    if relaxed >= ARRIVAL:
        landing.position[2] = nav.height - target.least_height
    if relaxed >= GLIDE_SLOPE:
        landing.slope = -1.0
    if relaxed >= TILT:
        landing.cos_tilt = landing.cos_last_tilt = cos(p.tilt_limit)
    if relaxed >= TARGET:
        landing.miss_price = 0.0


@kernel
def least_throttled(p, memory):
    """Shortest time in the throttle band, s."""
    return LEAST_THROTTLED if memory.relaxed >= DWELL else p.throttled


@kernel
def first_plan(p, landing, throttled, memory):
    """Plan from a guess, the time of a constant deceleration, with at least ``throttled`` s in the throttle
    band.
    """
    plan = memory.plan
    descent = max(-landing.velocity[2], LEAST_DESCENT)
    plan.time = min(max(2.0 * landing.position[2] / descent, 2.0 * throttled), LONGEST_GUESS)
    plan.full_time = 0.0
    plan.u[:] = 0.0
    plan.glide[:] = 0.0
    plan.pull[:] = 0.0
    for k in range(plan.u.shape[0]):
        plan.u[k, 2] = landing.gravity
    plan.primer_end[0] = plan.primer_end[1] = 0.0
    plan.primer_end[2] = -1.0
    search_times(landing, throttled, p.iterations, plan, memory.other)


@kernel
def throttled_of(plan):
    """Return the time (s) that a plan spends in the throttle band after its start at full thrust. Without
    such a start the time is infinite, whatever the duration of the plan.
    """
    return plan.time - plan.full_time if plan.full_time > 0.0 else inf


@kernel
def next_plan(p, landing, elapsed, memory):
    """Plan from the last solution, which began ``elapsed`` s ago, with its time of arrival or a slightly
    earlier one.

    If this is not possible, the reserve may be used in the next ``NOW`` seconds; then the time of arrival is
    searched. As a last step the largest thrust of the throttle band is required now.
    """
    plan, other = memory.plan, memory.other
    time, full_time = plan.time - elapsed, max(plan.full_time - elapsed, 0.0)
    shift_controls(plan, elapsed, time, full_time)
    throttled = throttled_of(plan)
    solve(landing, p.iterations, plan)
    if error_of(landing, plan) <= TOLERATED:
        try_earlier(landing, throttled, share=EARLIER, most=p.iterations, plan=plan, other=other)
        return
    landing.now = NOW
    solve(landing, p.iterations, plan)
    if error_of(landing, plan) <= TOLERATED:
        return
    search_time(landing, throttled, REACH, p.iterations, plan)
    if error_of(landing, plan) > TOLERATED and throttled < inf:
        refine_throttled(
            landing, throttled, least_throttled(p, memory), FACTOR, p.iterations, plan=plan, other=other
        )
    if error_of(landing, plan) > TOLERATED:
        landing.low_now = landing.high = landing.high_now
        search_time(landing, throttled_of(plan), REACH, p.iterations, plan)


@kernel
def make_plan(p, state, nav, target, memory):
    """Plan from the present state; where no landing results, without the last solution and with more
    constraints relaxed.
    """
    landing, plan = memory.landing, memory.plan
    weaker = state.engine.full_thrust < WEAKER * landing.full
    describe(p, state, nav, target, landing)
    relax(p, nav, target, memory)
    if memory.plans == 0 or weaker:
        first_plan(p, landing, least_throttled(p, memory), memory)
    else:
        next_plan(p, landing, nav.t - memory.start, memory)
        if state.thrust_lost > 0.0 and error_of(landing, plan) > TOLERATED:
            describe(p, state, nav, target, landing)
            relax(p, nav, target, memory)
            first_plan(p, landing, least_throttled(p, memory), memory)
    while error_of(landing, plan) > UNACCEPTABLE and memory.relaxed < TARGET:
        memory.relaxed += 1
        describe(p, state, nav, target, landing)
        relax(p, nav, target, memory)
        first_plan(p, landing, p.throttled, memory)
        if error_of(landing, plan) > UNACCEPTABLE:
            first_plan(p, landing, LEAST_THROTTLED, memory)
    memory.plans += 1
    memory.start = nav.t
    memory.landing_error = error_of(landing, plan)


@kernel
def error_of(landing, plan):
    """Return the error (m) of the end of a plan: horizontal distance from the target, if a target is
    required, plus error of height, plus the distance covered in one second at the final velocity, which
    should be zero.
    """
    miss = plan.miss if landing.miss_price > 0.0 else 0.0
    return miss + plan.height_error + norm(take3(plan.end_velocity, 0))


@kernel
def guide(params, vehicle, state, nav, target, memory, out):
    """Return the thrust acceleration north, east, up (m/s2, including the part that balances gravity) and the
    tilt limit (rad).
    """
    p, plan, landing = params, memory.plan, memory.landing
    elapsed = nav.t - memory.start
    if memory.plans == 0 or (elapsed >= p.plan_interval and plan.time - elapsed > p.last_plan):
        make_plan(p, state, nav, target, memory)
        elapsed = 0.0
    out.time_to_go = plan.time - elapsed
    out.relaxed, out.landing_error = memory.relaxed, memory.landing_error
    (x, y, z), (vx, vy, vz) = fly_plan(landing, plan, elapsed)
    k = control_at(plan, elapsed)
    out.full_wanted = 1 if k < full_controls(plan) else 0
    k_r, k_v = p.position_gain, p.velocity_gain
    east = plan.w[k, 0] + k_r * (x - nav.site_L[0] + target.point_L[0]) + k_v * (vx - nav.v_N[1])
    north = plan.w[k, 1] + k_r * (y - nav.site_L[1] + target.point_L[1]) + k_v * (vy - nav.v_N[0])
    height = target.least_height if memory.relaxed >= ARRIVAL else target.height
    up = plan.w[k, 2] + k_r * (z - nav.height + height) + k_v * (vz + nav.v_N[2])
    return north, east, up, p.tilt_limit


MEMBER = Member(
    "convex", ConvexParams, {"guide": guide}, "Acikmese & Ploen 2007; Yu, Elango, Acikmese 2021", MEMORY
)
