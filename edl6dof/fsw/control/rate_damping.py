"""Control under the parachute: none at first, then damping of large pitch and yaw rates and a slow roll to
the local geographic frame.

Source: Hu et al. 2022, section 5.
"""

from __future__ import annotations

from edl6dof.config.base import Params, group, param
from edl6dof.fsw.control.attitude_error import beyond, inertia_torque
from edl6dof.fsw.control.phase_plane_zones import AXIS, ZoneParams, follow
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.registry import Member
from edl6dof.spatial.vector import take3


class RateDampingParams(Params):
    """Rate damping with large deadbands under the parachute."""

    rest_s: float = param(
        13.0, "time without control after the start of the phase", status="published", source="S1", ge=0.0
    )
    rate_deadband_deg_s: float = param(4.0, "pitch or yaw rate that is not damped", ge=0.0)
    damping: float = param(0.8, "acceleration per rate beyond the deadband, 1/s", ge=0.0)
    roll: ZoneParams = group(ZoneParams, "roll channel, to the local geographic frame")


MEMORY = record(("roll", AXIS))


@kernel
def control(params, nav, goal, inputs, dt, memory):
    """Return the damping torque in pitch and yaw and the roll torque after the time without control, and the
    roll error.
    """
    p = params
    error = (nav.roll_to_south, 0.0, 0.0)
    if inputs.phase_time < p.rest:
        return (0.0, 0.0, 0.0), error
    w = take3(nav.w_B, 0)
    roll = follow(
        p.roll, memory=memory.roll, error=nav.roll_to_south, rate=w[0], dt=dt, frozen=inputs.saturated != 0
    )
    acceleration = (
        roll,
        -p.damping * beyond(w[1], p.rate_deadband),
        -p.damping * beyond(w[2], p.rate_deadband),
    )
    return inertia_torque(take3(inputs.inertia, 0), acceleration), error


MEMBER = Member("rate_damping", RateDampingParams, {"control": control}, "Hu et al. 2022, section 5", MEMORY)
