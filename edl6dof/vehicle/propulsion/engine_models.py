"""Models of how the thrust of an engine follows its command; each of ``vehicle.engines`` may name one as its
``model``.

A member has three kernels.  ``goal(params, engine, t, step, command)`` gives the goal of the thrust under a
``command`` (N) over the ``step`` (s) that begins at time ``t`` (s), as a line: mean (N) and slope (N/s;
:func:`line_in_step`).  ``rate(params, engine, goal, thrust, starting)`` gives the time derivative (N/s) of
the thrust; ``starting`` is true while the engine starts or is cut off.  ``specific_impulse(params, engine,
thrust)`` gives the specific impulse (s).  ``params`` are the member's own, ``engine`` those of all engines.

Throttled: first-order valve with a rate limit.  Pulsed: the valve opens at the start of each period for the
commanded share of full thrust; a pulse or a pause shorter than the valve can make is left out; the thrust
follows the valve with one lag, so that the impulse of a pulse is full thrust times the time the valve is
open.  Thruster set: gives no thrust of its own; its command is allocated to the axial thrusters together with
the torque of attitude control, as pulses that are longer on one side to turn the vehicle.  Solid: once lit it
burns at full thrust until it is empty, whatever is commanded.
Source: throttled and solid: engineering models of this simulator, their numbers estimates.  Pulsed:
pulse-width modulation of Wie, "Space Vehicle Dynamics and Control", 2008.  Descent engines driven by pulses,
of thruster sets too: Grover et al., "Overview of the Phoenix Entry, Descent, and Landing System
Architecture", AIAA 2008-7218; both from memory.
"""

from __future__ import annotations

from edl6dof.config.base import Hardware, Params, param
from edl6dof.kernels import kernel
from edl6dof.registry import Family, Member
from edl6dof.spatial.vector import clamp


@kernel
def line_in_step(first, second, step):
    """Mean, and slope (per s) about the middle, of the straight line over ``step`` s that has the ``first``
    and the ``second`` time integral of a jagged thrust.

    A pulse begins and ends anywhere in a step, of which Runge-Kutta sees the ends and the middle.  The line
    gives the vehicle the same speed and the same displacement, and is integrated exactly.
    """
    mean = first / step
    return mean, (6.0 * mean - 12.0 * second / (step * step)) / step


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
def commanded_goal(params, engine, t, step, command):
    """Constant goal at the commanded level; a solid motor that is lit has full thrust as its command."""
    return command, 0.0


@kernel
def lagging_rate(params, engine, goal, thrust, starting):
    """Time derivative of thrust (N/s) towards the goal behind one lag."""
    return (goal - thrust) / params.lag


@kernel
def full_specific_impulse(params, engine, thrust):
    """Specific impulse (s) at full thrust, the only level."""
    return engine.full_specific_impulse


@kernel
def throttled_rate(params, engine, goal, thrust, starting):
    """Time derivative of thrust (N/s); ``starting`` selects the fast build-up and cut-off rate."""
    limit = params.start_rate if starting else params.rate
    return clamp((goal - thrust) / params.lag, -limit, limit)


@kernel
def throttled_specific_impulse(params, engine, thrust):
    """Specific impulse (s), linear from the band's lower end to full thrust."""
    span = engine.full_thrust - engine.throttle_min
    share = clamp((thrust - engine.throttle_min) / span, 0.0, 1.0) if span > 0.0 else 1.0
    return params.low_specific_impulse + share * (engine.full_specific_impulse - params.low_specific_impulse)


THROTTLED = Member(
    "throttled",
    ThrottledParams,
    {"goal": commanded_goal, "rate": throttled_rate, "specific_impulse": throttled_specific_impulse},
    "first-order valve with a rate limit, engineering model",
)


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
def pulsed_goal(params, engine, t, step, command):
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


PULSED = Member(
    "pulsed",
    PulsedParams,
    {"goal": pulsed_goal, "rate": lagging_rate, "specific_impulse": full_specific_impulse},
    "Wie 2008; Grover et al., AIAA 2008-7218",
)


class ThrusterSetParams(Params):
    """The axial thrusters, pulsed together."""


@kernel
def thruster_set_goal(params, engine, t, step, command):
    """Give no thrust beyond that of the thrusters."""
    return 0.0, 0.0


@kernel
def thruster_set_rate(params, engine, goal, thrust, starting):
    """Keep the thrust at zero."""
    return 0.0


THRUSTER_SET = Member(
    "thruster_set",
    ThrusterSetParams,
    {"goal": thruster_set_goal, "rate": thruster_set_rate, "specific_impulse": full_specific_impulse},
    "Grover et al., AIAA 2008-7218",
)


class SolidParams(Hardware):
    """Solid motor: full thrust from ignition to burn-out."""

    lag_s: float = param(
        0.02, "first-order time constant of build-up and decay of the thrust", status="estimate", gt=0.0
    )


SOLID = Member(
    "solid",
    SolidParams,
    {"goal": commanded_goal, "rate": lagging_rate, "specific_impulse": full_specific_impulse},
    "definition; build-up an engineering model",
)


ENGINE_MODELS = Family("engine model", (THROTTLED, PULSED, THRUSTER_SET, SOLID))

#: Index of the member whose thrust is that of the axial thrusters.
BY_THRUSTERS = ENGINE_MODELS.names.index(THRUSTER_SET.name)

#: Index of the member that burns at full thrust from ignition on.
UNCOMMANDED = ENGINE_MODELS.names.index(SOLID.name)

EngineChoice = ENGINE_MODELS.params_model(
    "EngineChoice", "model", "throttled", "How the thrust of an engine follows its command."
)

goal_of_model = ENGINE_MODELS.switch("goal", "params", "engine", "t", "step", "command", own=("params",))
rate_of_model = ENGINE_MODELS.switch(
    "rate", "params", "engine", "goal", "thrust", "starting", own=("params",)
)
specific_impulse_of_model = ENGINE_MODELS.switch(
    "specific_impulse", "params", "engine", "thrust", own=("params",)
)
