"""Pulsed engine: full thrust or none, its mean set by the length of pulses of a fixed frequency.

The valve opens at the start of each period for the commanded share of full thrust.  A pulse shorter than the
valve can make is left out, a pause shorter than that is not made; the thrust follows the valve with one lag,
so that the impulse of a pulse is full thrust times the time the valve is open.
Source: pulse-width modulation of Wie, "Space Vehicle Dynamics and Control", 2008; descent engines so
driven at 10 Hz: Grover et al., "Overview of the Phoenix Entry, Descent, and Landing System Architecture",
AIAA 2008-7218; both from memory.
"""

from __future__ import annotations

from edl6dof.config.base import Hardware, param
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.vehicle.propulsion.line_in_step import line_in_step


class PulsedParams(Hardware):
    """Pulsed engine: full thrust or none, in pulses of a fixed frequency and a shortest length."""

    period_s: float = param(
        0.1,
        "time from the start of a pulse to that of the next",
        status="recalled",
        source="Phoenix, Grover et al. 2008",
        gt=0.0,
        le=10.0,
    )
    minimum_pulse_s: float = param(0.02, "shortest pulse, and shortest pause", status="estimate", ge=0.0)
    lag_s: float = param(
        0.02, "first-order time constant of the thrust behind the valve", status="estimate", ge=0.005
    )


@kernel
def goal(params, engine, t, step, command):
    """Full thrust while the valve is open, none else: as a line over the step."""
    period, shortest = params.period, params.minimum_pulse
    opened = period * command / engine.full_thrust
    if opened < shortest:
        opened = 0.0
    elif period - opened < shortest:
        opened = period
    first = second = 0.0
    start = -(t % period)  # of the pulse, after the start of the step
    while start < step:
        begin, end = max(start, 0.0), min(start + opened, step)
        if begin < end:
            first += end - begin
            second += (end - begin) * (step - 0.5 * (begin + end))
        start += period
    return line_in_step(engine.full_thrust * first, engine.full_thrust * second, step)


@kernel
def rate(params, engine, goal, thrust, starting):
    """Time derivative of thrust (N/s) behind the valve."""
    return (goal - thrust) / params.lag


@kernel
def specific_impulse(params, engine, thrust):
    """Specific impulse (s): that at full thrust, the only level."""
    return engine.full_specific_impulse


MEMBER = Member(
    "pulsed",
    PulsedParams,
    {"goal": goal, "rate": rate, "specific_impulse": specific_impulse},
    "Wie 2008; Grover et al., AIAA 2008-7218",
)
