"""Search for the time of flight, and for the part of it at full thrust.

Full thrust is used only at the start; the rest, ``throttled`` seconds, is within the throttle band. For a
given ``throttled`` the time of flight is found by bisection on the derivative of the cost by this time, which
follows from the multipliers (the Hamiltonian at the end, Pontryagin); where the landing is out of reach the
cost includes its errors. Then ``throttled`` is increased from its least value while the cost falls.
"""

from __future__ import annotations

from math import inf, sqrt

from edl6dof.fsw.guidance.powered.convex.landing_plan import (
    CONTROLS,
    copy_plan,
    full_controls,
    shift_controls,
)
from edl6dof.fsw.guidance.powered.convex.pipg import solve
from edl6dof.kernels import kernel
from edl6dof.spatial.vector import dot, norm, take3

#: Shortest time of flight (s), longest over its first guess, and shortest start at full thrust (s).
SHORTEST, LONGEST, LEAST_FULL = 2.0, 4.0, 0.5
#: The search for the time of flight ends when its bracket is narrower than this share of it.
CLOSE = 0.01
#: Divisor of the iterations of a trial solution, of which only the derivative of the cost is used.
TRIAL = 3
#: First step away from a guess of the time of flight, over it.
REACH = 0.1
#: First factor by which the throttled time is varied, and the factor at which the refinement ends.
LONGER, FINEST = 1.5, 1.08


@kernel
def growth(landing, plan):
    """Derivative of the cost (m/s) by the time of flight (s) at constant time in the throttle band, m/s2."""
    last = CONTROLS - 1
    thrust = take3(plan.w[last], 0)
    primer, pull = take3(plan.primer_end, 0), take3(plan.pull, 0)
    size = max(norm(thrust), landing.low / plan.mass[last])
    rate = size + dot(primer, thrust) - primer[2] * landing.gravity + dot(pull, take3(plan.end_velocity, 0))
    first = full_controls(plan)
    if first > 0:
        # one more moment at full thrust, and one later in the throttle band
        to_go = plan.time - plan.full_time
        primer = primer[0] + pull[0] * to_go, primer[1] + pull[1] * to_go, primer[2] + pull[2] * to_go
        full, band = take3(plan.w[first - 1], 0), take3(plan.w[first], 0)
        rate += landing.full / plan.mass[first - 1] + dot(primer, full)
        rate -= max(norm(band), landing.low / plan.mass[first]) + dot(primer, band)
    return rate


@kernel
def try_time(landing, time, throttled, most, plan):
    """Solve for the time of flight ``time`` (s) with ``throttled`` s of it in the throttle band, from the
    solution in ``plan``; returns the derivative of the cost.
    """
    shift_controls(plan, 0.0, time, max(time - throttled, 0.0))
    solve(landing, most, plan)
    return growth(landing, plan)


@kernel
def search_time(landing, throttled, reach, most, plan):
    """Find the best time of flight with ``throttled`` s of it in the throttle band.

    Args:
        landing: ``LANDING`` record.
        throttled: time in the throttle band, s; infinite: all of the flight.
        reach: first step away from the time in ``plan``, over it.
        most: most iterations of the final solution; trial solutions get a share of them.
        plan: ``PLAN`` record: first guess, then the solution.
    """
    few = most // TRIAL
    longest = LONGEST * plan.time
    shortest = SHORTEST if throttled == inf else throttled + LEAST_FULL
    low = high = max(plan.time, shortest)
    shorter = try_time(landing, low, throttled, few, plan) > 0.0
    crossed = False
    while not crossed and (low > shortest if shorter else high < longest):
        if shorter:
            low, high = max(low * (1.0 - reach), shortest), low
        else:
            low, high = high, min(high * (1.0 + reach), longest)
        reach *= 2.0
        beyond = low if shorter else high
        crossed = (try_time(landing, beyond, throttled, few, plan) > 0.0) != shorter
    # the upper end is where the landing can be had
    while high - low > CLOSE * high:
        middle = 0.5 * (low + high)
        if try_time(landing, middle, throttled, few, plan) > 0.0:
            high = middle
        else:
            low = middle
    try_time(landing, high, throttled, most, plan)


@kernel
def try_throttled(landing, throttled, most, plan, other):
    """Put the best plan with ``throttled`` s in the throttle band into ``plan`` if it costs less; returns
    whether it does. ``other``: workspace.
    """
    copy_plan(plan, other)
    if throttled < inf:
        shift_controls(other, 0.0, throttled + other.full_time, other.full_time)
    search_time(landing, throttled, REACH, most, other)
    if other.cost >= plan.cost:
        return False
    copy_plan(other, plan)
    return True


@kernel
def try_earlier(landing, throttled, share, most, plan, other):
    """Put a plan that arrives earlier by a ``share`` of the time to go into ``plan`` if it costs less."""
    if growth(landing, plan) <= 0.0:
        return
    copy_plan(plan, other)
    try_time(landing, (1.0 - share) * plan.time, throttled, most, other)
    if other.cost < plan.cost:
        copy_plan(other, plan)


@kernel
def refine_throttled(landing, throttled, least, factor, most, plan, other):
    """Vary ``throttled`` (s) by ever smaller factors, and keep each plan that costs less."""
    while factor > FINEST:
        factor = sqrt(factor)
        if try_throttled(landing, factor * throttled, most, plan, other):
            throttled *= factor
        elif throttled > factor * least and try_throttled(landing, throttled / factor, most, plan, other):
            throttled /= factor


@kernel
def search_times(landing, least, most, plan, other):
    """Find the best time of flight, and the best time in the throttle band, which may be all of it.

    Args:
        landing: ``LANDING`` record.
        least: shortest time in the throttle band, s.
        most: iterations of each solution.
        plan, other: ``PLAN`` records: first guess of the time of flight, then the solution; workspace.
    """
    throttled = least
    search_time(landing, throttled, REACH, most, plan)
    # a time longer than any flight, or not finite, cannot cost less
    while throttled < LONGEST * plan.time and try_throttled(landing, LONGER * throttled, most, plan, other):
        throttled *= LONGER
    refine_throttled(landing, throttled, least, factor=LONGER, most=most, plan=plan, other=other)
    try_throttled(landing, inf, most, plan, other)
