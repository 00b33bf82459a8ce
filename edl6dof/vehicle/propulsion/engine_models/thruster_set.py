"""Engine made of thrusters: the axial ones of ``vehicle.rcs.thrusters``, which brake and steer at once.

It gives no thrust of its own.  What it is commanded is asked of the axial thrusters together with the torque
of attitude control, and shared out as pulses: longer on one side and shorter on the other turns the vehicle.
Source: pulsed descent engines of Mars Polar Lander and Phoenix, Grover et al., "Overview of the Phoenix
Entry, Descent, and Landing System Architecture", AIAA 2008-7218, from memory.
"""

from __future__ import annotations

from edl6dof.config.base import Params
from edl6dof.kernels import kernel
from edl6dof.registry import Member

NAME = "thruster_set"


class ThrusterSetParams(Params):
    """The axial thrusters, pulsed together."""


@kernel
def goal(params, engine, t, step, command):
    """No thrust beside that of the thrusters."""
    return 0.0, 0.0


@kernel
def rate(params, engine, goal, thrust, starting):
    """It stays none."""
    return 0.0


@kernel
def specific_impulse(params, engine, thrust):
    """Specific impulse (s) at full thrust."""
    return engine.full_specific_impulse


MEMBER = Member(
    NAME,
    ThrusterSetParams,
    {"goal": goal, "rate": rate, "specific_impulse": specific_impulse},
    "Grover et al., AIAA 2008-7218",
)
