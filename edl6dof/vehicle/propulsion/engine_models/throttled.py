"""Throttled engine: first-order valve with a rate limit, specific impulse by throttle.

Source: an engineering model of this simulator, its numbers estimates.
"""

from __future__ import annotations

from edl6dof.config.base import Hardware, param
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.vector import clamp


class ThrottledParams(Hardware):
    """Throttled engine: first-order valve with a rate limit, specific impulse by throttle."""

    low_specific_impulse_s: float = param(
        285.0, "specific impulse at the lower end of the band", status="estimate", gt=0.0
    )
    lag_s: float = param(0.15, "first-order time constant of the thrust", status="estimate", gt=0.0)
    rate_n_s: float = param(
        1500.0,
        "largest rate of change of thrust while throttling",
        status="estimate",
        gt=0.0,
        usual=(100, 1e6, "throttle valves to pulsed rockets"),
    )
    start_rate_n_s: float = param(
        25000.0, "rate of thrust build-up at ignition and of decay at cut-off", status="estimate", gt=0.0
    )


@kernel
def goal(params, engine, t, step, command):
    """The commanded level, all the step."""
    return command, 0.0


@kernel
def rate(params, engine, goal, thrust, starting):
    """Time derivative of thrust (N/s) towards the commanded level; ``starting`` selects the fast build-up and
    cut-off rate.
    """
    limit = params.start_rate if starting else params.rate
    return clamp((goal - thrust) / params.lag, -limit, limit)


@kernel
def specific_impulse(params, engine, thrust):
    """Specific impulse (s), linear from the band's lower end to full thrust."""
    span = engine.full_thrust - engine.throttle_min
    share = clamp((thrust - engine.throttle_min) / span, 0.0, 1.0) if span > 0.0 else 1.0
    return params.low_specific_impulse + share * (engine.full_specific_impulse - params.low_specific_impulse)


MEMBER = Member(
    "throttled",
    ThrottledParams,
    {"goal": goal, "rate": rate, "specific_impulse": specific_impulse},
    "first-order valve with a rate limit, engineering model",
)
