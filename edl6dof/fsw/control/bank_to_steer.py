"""Bank tracking with rate-damped angle of attack and sideslip: the lift-control phase.

The control is computed in the velocity frame (bank about the velocity) and mapped to the body by C_cv, eq. 1 of the source.  Angle of
attack and sideslip trim themselves; they are rate-damped, and their angle loop closes beyond 10 deg.  After the trim wing is out the
goal is zero angle of attack with larger damping.  Source: Hu et al. 2022, section 4.
"""

from __future__ import annotations

from math import cos, sin

import numpy as np

from edl6dof.config.base import Params, group, param
from edl6dof.fsw.control.frames import body_rate, inertia_torque, path_rate
from edl6dof.fsw.control.zones import AXIS, ZoneParams, axis_acceleration
from edl6dof.jit import kernel
from edl6dof.registry import Member
from edl6dof.spatial.frames import wrap
from edl6dof.spatial.vector import add, cross, dot, inertia_times, scale, sub


class BankToSteerParams(Params):
    """Bank tracking in four zones; rate damping of angle of attack and sideslip."""

    bank: ZoneParams = group(ZoneParams, "bank channel")
    damping: float = param(0.8, "acceleration per rate in pitch and yaw, 1/s", ge=0.0)
    damping_after_wing: float = param(2.0, "the same after the trim wing is out, 1/s", ge=0.0)
    rate_deadband_deg_s: float = param(0.4, "pitch or yaw rate that is left alone", ge=0.0)
    angle_limit_deg: float = param(10.0, "error of angle of attack or sideslip beyond which its angle loop closes", gt=0.0)
    angle_gain: float = param(0.5, "acceleration per angle error beyond that limit, 1/s2", ge=0.0)


MEMORY = np.dtype([("bank", AXIS)], align=True)


@kernel
def beyond(x, limit):
    """The part of ``x`` outside the interval [-limit, limit]."""
    if x > limit:
        return x - limit
    if x < -limit:
        return x + limit
    return 0.0


@kernel
def control(onboard, nav, guide, dt, fsw):
    """Demand the torque for bank tracking and damping."""
    p = onboard.control.bank_to_steer
    memory = fsw.control.bank_to_steer
    # unit vector of the velocity in B: first column of C_cv
    ca, sa, cb, sb = cos(nav.alpha), sin(nav.alpha), cos(nav.beta), sin(nav.beta)
    along = (ca * cb, sb, sa * cb)
    rate = sub(body_rate(nav), path_rate(nav))
    bank_rate = dot(rate, along)
    error = wrap(guide.bank - nav.bank)
    bank_acceleration = axis_acceleration(p.bank, memory.bank, error, bank_rate, dt, fsw.saturated != 0)

    swing = sub(rate, scale(bank_rate, along))
    gain = p.damping_after_wing if fsw.wing_out != 0 else p.damping
    damping = (
        -gain * beyond(swing[0], p.rate_deadband),
        -gain * beyond(swing[1], p.rate_deadband),
        -gain * beyond(swing[2], p.rate_deadband),
    )
    goal_alpha = 0.0 if fsw.wing_out != 0 else guide.alpha
    alpha_error = wrap(nav.alpha - goal_alpha)
    pitch = -p.angle_gain * beyond(alpha_error, p.angle_limit)
    yaw = p.angle_gain * beyond(nav.beta, p.angle_limit)

    acceleration = add(scale(bank_acceleration, along), (damping[0], damping[1] + pitch, damping[2] + yaw))
    torque = inertia_torque(onboard, fsw.configuration, acceleration)
    inertia = onboard.vehicle.configuration[fsw.configuration].inertia
    w = body_rate(nav)
    gyroscopic = cross(w, inertia_times((inertia[0], inertia[1], inertia[2], 0.0, 0.0, 0.0), w))
    for i in range(3):
        fsw.demand[3 + i] = torque[i] + gyroscopic[i]
    fsw.attitude_error[0], fsw.attitude_error[1], fsw.attitude_error[2] = error, -alpha_error, nav.beta


MEMBER = Member("bank_to_steer", BankToSteerParams, {"control": control}, "Hu et al. 2022, section 4", MEMORY)
