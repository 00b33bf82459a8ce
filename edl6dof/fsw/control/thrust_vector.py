"""Powered descent: thrust axis to the commanded direction, roll to the local geographic frame; each axis has
its own phase-plane zones.

Two formulations of the attitude error (Hu et al. 2022, section 6.2): along the shortest path to the goal
attitude (eqs. 2-4), or decoupled (eqs. 5-8), where pitch and yaw control the thrust direction alone, so that
a roll error does not deflect the thrust. A slew of the thrust axis is one rotation: the zones of pitch and
yaw follow from the error of each axis, but their target rates are the components of one vector along the
rotation (eq. 8; the print has S_1 x S_d with a minus sign, which would turn the thrust away; the direction
follows from the error).

The estimated disturbance torque replaces the integral term (eq. 9), together with the difference between the
torque of the valve intervals and that of the duties: eq. 9 subtracts the *commanded* torque, so that this
difference is part of the disturbance; here the estimator subtracts the torque of the valve intervals, and the
difference is filtered with the same pole, so that the two sum up to the estimate of the paper. With the pole
lambda of the estimator the torque per inertia on an error e becomes

    (P + lambda D) e + lambda P int e dt + (D + lambda) e',

a PID law: proportional P + lambda D, integral lambda P, derivative D + lambda.
"""

from __future__ import annotations

from math import sqrt
from typing import Literal

from edl6dof.config.base import Params, group, param
from edl6dof.fsw.control.attitude_error import (
    decoupled_error,
    goal_attitude,
    inertia_torque,
    shortest_path_error,
)
from edl6dof.fsw.control.phase_plane_zones import AXIS, ZoneParams, axis_acceleration, target_rate
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.registry import Member
from edl6dof.spatial.elementary import exp
from edl6dof.spatial.vector import add, scale, sub, take3, take4

DECOUPLED, SHORTEST_PATH = range(2)
ESTIMATOR, INTEGRAL = range(2)


class ThrustVectorParams(Params):
    """Thrust-direction and roll control of the lander."""

    error: Literal["decoupled", "shortest_path"] = param(
        "decoupled",
        "thrust direction and roll apart, or shortest path",
        status="published",
        source="S1 6.2",
    )
    against_disturbance: Literal["estimator", "integral"] = param(
        "estimator", "disturbances compensated by estimate or integral", status="published", source="S1 6.2"
    )
    pitch_yaw: ZoneParams = group(ZoneParams, "pitch and yaw channels")
    roll: ZoneParams = group(ZoneParams, "roll channel")


MEMORY = record(
    ("axis", AXIS, (3,)),
    ("modulation_torque", "f8", (3,)),  # N m, B: torque of valve intervals less that of duties, filtered
    ("compensation", "f8", (3,)),  # N m, B: torque subtracted from the demand
)


@kernel
def thrust_direction(nav, goal):
    """Return the commanded thrust direction, a unit vector in I."""
    north, east = (
        scale(goal.thrust_direction_N[0], take3(nav.north_I, 0)),
        scale(goal.thrust_direction_N[1], take3(nav.east_I, 0)),
    )
    return sub(add(north, east), scale(goal.thrust_direction_N[2], take3(nav.up_I, 0)))


@kernel
def slew_rates(p, error, bandwidth):
    """Return the target rates (rad/s) of roll, pitch and yaw outside the PID zones: roll on its own, pitch
    and yaw as one rotation (eq. 8).
    """
    roll = target_rate(p.roll, error[0], bandwidth)
    angle = sqrt(error[1] * error[1] + error[2] * error[2])
    share = target_rate(p.pitch_yaw, angle, bandwidth) / angle if angle > 0.0 else 0.0
    return roll, share * error[1], share * error[2]


@kernel
def compensation(inputs, dt, memory):
    """Return the torque (N m, B) to subtract from the demand: the estimated disturbance, and the torque of
    the valve intervals beyond that of the duties.

    At a bandwidth below 1 the sum is smoothed, so that estimator and filter together lag by 1 / (bandwidth
    lambda).
    """
    pole, bandwidth = inputs.disturbance_pole, inputs.bandwidth
    step = 1.0 - exp(-pole * dt)
    for i in range(3):
        memory.modulation_torque[i] += step * (inputs.modulation_torque[i] - memory.modulation_torque[i])
    found = add(take3(inputs.disturbance_torque, 0), take3(memory.modulation_torque, 0))
    step = 1.0 - exp(-dt * pole * bandwidth / (1.0 - bandwidth)) if bandwidth < 1.0 else 1.0
    for i in range(3):
        memory.compensation[i] += step * (found[i] - memory.compensation[i])
    return take3(memory.compensation, 0)


@kernel
def control(params, nav, goal, inputs, dt, memory):
    """Return the torque towards the commanded thrust direction and roll, and the attitude error."""
    p, bandwidth = params, inputs.bandwidth
    q, w = take4(nav.q_I2B), take3(nav.w_B, 0)
    wanted_attitude = goal_attitude(
        take3(nav.north_I, 0), take3(nav.east_I, 0), take3(nav.up_I, 0), thrust_direction(nav, goal)
    )
    if p.error == SHORTEST_PATH:
        error = shortest_path_error(q, wanted_attitude)
    else:
        error = decoupled_error(q, wanted_attitude)
    wanted = slew_rates(p, error, bandwidth)
    frozen = inputs.saturated != 0 or p.against_disturbance == ESTIMATOR
    acceleration = (
        axis_acceleration(
            p.roll, memory.axis[0], (error[0], wanted[0], w[0]), dt, frozen, bandwidth=bandwidth
        ),
        axis_acceleration(
            p.pitch_yaw, memory.axis[1], (error[1], wanted[1], w[1]), dt, frozen, bandwidth=bandwidth
        ),
        axis_acceleration(
            p.pitch_yaw, memory.axis[2], (error[2], wanted[2], w[2]), dt, frozen, bandwidth=bandwidth
        ),
    )
    torque = inertia_torque(take3(inputs.inertia, 0), acceleration)
    against = compensation(inputs, dt, memory)
    return (sub(torque, against) if p.against_disturbance == ESTIMATOR else torque), error


MEMBER = Member(
    "thrust_vector", ThrustVectorParams, {"control": control}, "Hu et al. 2022, sections 6.1 and 6.2", MEMORY
)
