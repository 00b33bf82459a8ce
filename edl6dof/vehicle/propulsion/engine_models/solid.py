"""Solid motor: once it is lit it burns at its full thrust until it is empty, whatever is commanded.

Source: definition; the first-order build-up is an engineering model of this simulator.
"""

from __future__ import annotations

from edl6dof.config.base import Hardware, param
from edl6dof.kernels import kernel
from edl6dof.registry import Member

NAME = "solid"


class SolidParams(Hardware):
    """Solid motor: full thrust from ignition to burn-out."""

    lag_s: float = param(
        0.02, "first-order time constant of build-up and decay of the thrust", status="estimate", gt=0.0
    )


@kernel
def goal(params, engine, t, step, command):
    """The thrust of a motor that is lit, all the step."""
    return command, 0.0


@kernel
def rate(params, engine, goal, thrust, starting):
    """Time derivative of thrust (N/s) towards that of the motor."""
    return (goal - thrust) / params.lag


@kernel
def specific_impulse(params, engine, thrust):
    """Specific impulse (s), one at all times."""
    return engine.full_specific_impulse


MEMBER = Member(
    NAME,
    SolidParams,
    {"goal": goal, "rate": rate, "specific_impulse": specific_impulse},
    "definition; build-up an engineering model",
)
