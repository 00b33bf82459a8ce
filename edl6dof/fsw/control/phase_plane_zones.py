"""One axis of attitude control over the four zones of the phase plane.

Far from the goal the rate is controlled to a constant; nearer, to a parabola, which a constant deceleration
follows; near the goal a PID law controls the angle; beyond the rate limit the rate is only reduced. Source:
Hu et al. 2022, section 4.1 and Fig. 5.
"""

from __future__ import annotations

from math import copysign, sqrt

from edl6dof.config.base import Params, param
from edl6dof.kernels import kernel
from edl6dof.records import record, whole
from edl6dof.spatial.vector import clamp


class ZoneParams(Params):
    """Gains and zone boundaries of one axis."""

    rate_deg_s: float = param(5.0, "rate in the constant-rate zone (d_theta_r)", gt=0.0, le=60.0)
    far_deg: float = param(20.0, "error beyond which the rate is constant (theta_mL)", gt=0.0, le=180.0)
    near_deg: float = param(3.0, "error below which the PID law works (theta_mS)", gt=0.0, le=180.0)
    deceleration_deg_s2: float = param(5.0, "deceleration of the parabolic zone", gt=0.0)
    rate_gain: float = param(2.5, "acceleration per rate error in the rate zones, 1/s", gt=0.0)
    proportional: float = param(1.4, "acceleration per angle error, 1/s2", ge=0.0)
    integral: float = param(0.0, "acceleration per integrated angle error, 1/s3", ge=0.0)
    derivative: float = param(1.9, "acceleration per rate error in the PID zone, 1/s", ge=0.0)
    integral_limit_deg_s2: float = param(15.0, "largest acceleration from the integral", ge=0.0)


PID, PARABOLA, CONSTANT, LIMITER = range(4)

AXIS = record(("integral", "f8"), ("zone", whole(PID, LIMITER)))


@kernel
def target_rate(zone, error, bandwidth):
    """Return the signed rate (rad/s) to follow outside the PID zone, for an angle ``error`` (goal minus
    actual, rad); ``bandwidth`` as in :func:`axis_acceleration`.

    At the boundary of the PID zone the parabola has the rate that the PID law has there, so that the command
    is continuous.
    """
    size = abs(error)
    inner = bandwidth * zone.proportional / max(zone.derivative, 1e-9) * zone.near
    wanted = sqrt(inner * inner + 2.0 * zone.deceleration * max(size - zone.near, 0.0))
    if size > zone.far:
        wanted = zone.rate
    return copysign(min(wanted, zone.rate), error)


@kernel
def axis_acceleration(zone, memory, motion, dt, frozen, bandwidth):
    """Return the demanded angular acceleration (rad/s2) of one axis.

    Args:
        zone: ``ZoneParams`` record.
        memory: ``AXIS`` record.
        motion: goal minus actual angle, rad; rate wanted outside the PID zone, rad/s (:func:`target_rate`, or
            this axis' part of a slew about another axis); actual minus goal rate, rad/s.
        dt: control cycle, s.
        frozen: whether the integral is frozen: the thrusters are saturated, or a disturbance estimate
            replaces it.
        bandwidth: factor on the natural frequency of the PID law; its damping ratio stays.
    """
    error, wanted, rate = motion
    if abs(rate) > 1.15 * zone.rate:
        memory.zone = LIMITER
        return zone.rate_gain * (copysign(zone.rate, rate) - rate)
    if abs(error) > zone.near:
        memory.zone = CONSTANT if abs(error) > zone.far else PARABOLA
        return zone.rate_gain * (wanted - rate)
    memory.zone = PID
    if zone.integral > 0.0 and not frozen:
        limit = zone.integral_limit / zone.integral
        memory.integral = clamp(memory.integral + error * dt, -limit, limit)
    stiffness = bandwidth * bandwidth
    integral = stiffness * bandwidth * zone.integral * memory.integral
    return stiffness * zone.proportional * error + integral - bandwidth * zone.derivative * rate


@kernel
def follow(zone, memory, error, rate, dt, frozen):
    """Return the demanded acceleration (rad/s2) of an axis that is controlled on its own; ``error`` (rad) and
    ``rate`` (rad/s) as in :func:`axis_acceleration`.
    """
    motion = (error, target_rate(zone, error, 1.0), rate)
    return axis_acceleration(zone, memory, motion, dt, frozen, bandwidth=1.0)
