"""Bank tracking with rate-damped angle of attack and sideslip: the lift-control phase.

Source: Hu et al. 2022, section 4. Until the trim wing opens the control is computed in the velocity frame V
(bank about the velocity, angle of attack and sideslip about the axes across it) and mapped to the body by
C_cv, eq. 1; angular accelerations are mapped, not torques, so that each axis of the body then gets its own
inertia. Afterwards the control is computed in B, with a larger rate gain on the angle of attack, which is
then weakly damped.

The vehicle trims its angle of attack and sideslip aerodynamically: only their rates are damped, and the angle
error is fed back only beyond a limit. In a phase with ``hold_alpha``, as after a trim wing that did not open
(section 4.3), the angle of attack is controlled to its goal: the thrusters hold it against the trim moment of
the centre-of-mass offset, so that the parachute can open.
"""

from __future__ import annotations

from edl6dof.config.base import Params, group, param
from edl6dof.fsw.control.attitude_error import (
    beyond,
    gyroscopic_torque,
    inertia_torque,
    path_rate,
    velocity_axes,
)
from edl6dof.fsw.control.phase_plane_zones import AXIS, ZoneParams, follow
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.registry import Member
from edl6dof.spatial.frames import wrap
from edl6dof.spatial.vector import add, dot, scale, sub, take3


class BankToSteerParams(Params):
    """Bank tracking in four zones; rate damping of angle of attack and sideslip."""

    bank: ZoneParams = group(ZoneParams, "bank channel")
    damping: float = param(0.8, "acceleration per rate of angle of attack and sideslip, 1/s", ge=0.0)
    damping_after_wing: float = param(
        2.0, "damping of the angle of attack after the trim wing is out, 1/s", ge=0.0
    )
    rate_deadband_deg_s: float = param(0.4, "rate of angle of attack or sideslip that is not damped", ge=0.0)
    angle_limit_deg: float = param(
        10.0, "angle error beyond which it is fed back", status="published", source="S1 4.1", gt=0.0
    )
    angle_gain: float = param(0.5, "acceleration per angle error beyond that limit, 1/s2", ge=0.0)
    held_alpha: ZoneParams = group(
        ZoneParams, "angle of attack and sideslip where a phase holds them by thrusters"
    )


MEMORY = record(("bank", AXIS), ("alpha", AXIS), ("beta", AXIS))


@kernel
def damped(p, damping, rate, error):
    """Return the angular acceleration (rad/s2) of an aerodynamically trimmed axis: damping of ``rate``
    (rad/s), and feedback of ``error`` (rad) beyond its limit.
    """
    return p.angle_gain * beyond(error, p.angle_limit) - damping * beyond(rate, p.rate_deadband)


@kernel
def control(params, nav, goal, inputs, dt, memory):
    """Return the torque for bank tracking and damping, and the errors of bank, angle of attack and
    sideslip.
    """
    p, inertia, wing_out = params, take3(inputs.inertia, 0), inputs.wing_commanded != 0
    frozen = inputs.saturated != 0
    along, across, aside = velocity_axes(nav.alpha, nav.beta)
    if wing_out:
        along, across, aside = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    rate = sub(take3(nav.w_B, 0), path_rate(nav))
    bank_error = wrap(goal.bank - nav.bank)
    alpha_goal = 0.0 if wing_out else goal.alpha
    roll = follow(p.bank, memory=memory.bank, error=bank_error, rate=dot(rate, along), dt=dt, frozen=frozen)
    # sideslip grows when the nose yaws left: yaw to the right, about z, removes it
    if inputs.hold_alpha != 0:
        alpha_error, beta = wrap(alpha_goal - nav.alpha_in_air), nav.beta_in_air
        pitch = follow(
            p.held_alpha, memory=memory.alpha, error=alpha_error, rate=dot(rate, across), dt=dt, frozen=frozen
        )
        yaw = follow(
            p.held_alpha, memory=memory.beta, error=beta, rate=dot(rate, aside), dt=dt, frozen=frozen
        )
    else:
        alpha_error, beta = wrap(alpha_goal - nav.alpha), nav.beta
        damping = p.damping_after_wing if wing_out else p.damping
        pitch = damped(p, damping, dot(rate, across), alpha_error)
        yaw = damped(p, p.damping, dot(rate, aside), beta)
    acceleration = add(scale(roll, along), add(scale(pitch, across), scale(yaw, aside)))
    torque = add(inertia_torque(inertia, acceleration), gyroscopic_torque(inertia, take3(nav.w_B, 0)))
    return torque, (bank_error, alpha_error, beta)


MEMBER = Member("bank_to_steer", BankToSteerParams, {"control": control}, "Hu et al. 2022, section 4", MEMORY)
