"""The convex landing solved on the ground by the kernels that solve it in flight."""

from __future__ import annotations

from math import cos, pi, tan

import numpy as np

from edl6dof.design.landing.problem import Landing
from edl6dof.fsw.guidance.powered.convex.flight_time import search_times
from edl6dof.fsw.guidance.powered.convex.pipg import solve
from edl6dof.fsw.guidance.powered.convex.problem import LANDING, PLAN


def landing_record(landing: Landing, miss_price: float = 1.0) -> np.ndarray:
    """The ``LANDING`` record of a landing, shape (1,); ``miss_price`` 1/s: velocity worth a metre of miss."""
    record = np.zeros(1, LANDING)
    own = record[0]
    own["mass"], own["exhaust_speed"], own["gravity"] = landing.mass, landing.exhaust_speed, landing.gravity
    own["low"], own["high"], own["full"] = *landing.thrust, landing.full_thrust
    own["position"], own["velocity"] = landing.position, landing.velocity
    own["slope"] = tan(landing.glide_slope) if landing.glide_slope > -pi / 2.0 else -1.0
    own["cos_tilt"] = cos(landing.tilt)
    own["cos_last_tilt"] = cos(min(landing.tilt, landing.end_tilt))
    own["miss_price"] = miss_price
    return record


def first_guess(landing: Landing, time: float) -> np.ndarray:
    """A ``PLAN`` record, shape (1,), that holds against gravity for ``time`` s."""
    record = np.zeros(1, PLAN)
    plan = record[0]
    plan["time"], plan["full_time"] = time, landing.full_time
    plan["u"][:, 2], plan["primer_end"][2] = landing.gravity, -1.0
    return record


def solve_onboard(landing: Landing, time: float, most: int = 3000, miss_price: float = 1.0) -> np.ndarray:
    """The ``PLAN`` record, shape (1,), of a landing of given time."""
    plan = first_guess(landing, time)
    solve(landing_record(landing, miss_price)[0], most, plan[0])
    return plan


def plan_onboard(landing: Landing, throttled: float, guess: float, most: int = 300) -> np.ndarray:
    """The ``PLAN`` record, shape (1,), of a landing of free time: at least ``throttled`` s in the throttle
    band; ``guess`` s: the first time of flight to look at.
    """
    plan, other = first_guess(landing, guess), np.zeros(1, PLAN)
    search_times(landing_record(landing)[0], throttled, most, plan[0], other[0])
    return plan
