"""Powered descent: thrust axis to the commanded direction, roll to the local geographic frame, each axis in its own zones.

The two are decoupled (Hu et al. 2022, eqs. 5-8), so a roll error does not slow the thrust axis.  The estimated disturbance torque takes
the place of the integral term (eq. 9).
"""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import Params, group
from edl6dof.fsw.control.frames import attitude, body_rate, inertia_torque, thrust_direction_error
from edl6dof.fsw.control.zones import AXIS, ZoneParams, axis_acceleration
from edl6dof.jit import kernel
from edl6dof.registry import Member
from edl6dof.spatial.quaternion import to_frame
from edl6dof.spatial.vector import add, scale, sub, take3


class ThrustVectorParams(Params):
    """Thrust-direction and roll control of the lander."""

    pitch_yaw: ZoneParams = group(ZoneParams, "pitch and yaw channels")
    roll: ZoneParams = group(ZoneParams, "roll channel")


MEMORY = np.dtype([("axis", AXIS, (3,))], align=True)


@kernel
def control(onboard, nav, guide, dt, fsw):
    """Demand the torque towards the commanded thrust direction and roll; pass the lateral force on."""
    p = onboard.control.thrust_vector
    memory = fsw.control.thrust_vector
    q = attitude(nav)
    direction = take3(guide.thrust_direction_N, 0)
    north, east, up = take3(nav.north_I, 0), take3(nav.east_I, 0), take3(nav.up_I, 0)
    direction_I = sub(add(scale(direction[0], north), scale(direction[1], east)), scale(direction[2], up))
    error = thrust_direction_error(q, direction_I, nav.roll_to_south)
    w = body_rate(nav)
    saturated = fsw.saturated != 0
    acceleration = (
        axis_acceleration(p.roll, memory.axis[0], error[0], w[0], dt, saturated),
        axis_acceleration(p.pitch_yaw, memory.axis[1], error[1], w[1], dt, saturated),
        axis_acceleration(p.pitch_yaw, memory.axis[2], error[2], w[2], dt, saturated),
    )
    torque = inertia_torque(onboard, fsw.configuration, acceleration)
    for i in range(3):
        fsw.demand[3 + i] = torque[i] - fsw.disturbance.torque[i]
        fsw.attitude_error[i] = error[i]
    if guide.translating != 0:
        force = to_frame(q, add(scale(guide.force_N[0], north), scale(guide.force_N[1], east)))
        fsw.demand[1], fsw.demand[2] = force[1], force[2]


MEMBER = Member("thrust_vector", ThrustVectorParams, {"control": control}, "Hu et al. 2022, section 6.1 and eqs. 5-8", MEMORY)
