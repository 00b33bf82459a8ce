"""Attitude errors, and torques from angular accelerations, shared by the controllers."""

from __future__ import annotations

from math import atan2, pi

from edl6dof.jit import kernel
from edl6dof.spatial.frames import attitude_from_wind_angles
from edl6dof.spatial.quaternion import conjugate, from_frame, multiply, rotation_vector, to_frame
from edl6dof.spatial.vector import cross, dot, scale, sub, take3


@kernel
def inertia_torque(onboard, configuration, acceleration):
    """Torque (N m, B) that gives the body ``acceleration`` (rad/s2) with the believed principal inertia of the configuration."""
    inertia = onboard.vehicle.configuration[configuration].inertia
    return inertia[0] * acceleration[0], inertia[1] * acceleration[1], inertia[2] * acceleration[2]


@kernel
def body_rate(nav):
    """Inertial body rate, rad/s, in B."""
    return nav.w_B[0], nav.w_B[1], nav.w_B[2]


@kernel
def path_rate(nav):
    """Rate at which the planet-relative velocity turns, rad/s, in B, from gravity and measured specific force.

    Rotation of the planet and centrifugal terms are left out: they are below 0.01 deg/s.
    """
    q = attitude(nav)
    v = take3(nav.v_I, 0)
    acceleration = sub(from_frame(q, take3(nav.specific_force_B, 0)), scale(nav.gravity, take3(nav.up_I, 0)))
    speed2 = max(nav.speed * nav.speed, 1.0)
    return to_frame(q, scale(1.0 / speed2, cross(v, acceleration)))


@kernel
def attitude(nav):
    """``q_I2B`` as a tuple."""
    return nav.q_I2B[0], nav.q_I2B[1], nav.q_I2B[2], nav.q_I2B[3]


@kernel
def wind_attitude_error(nav, guide):
    """Rotation vector from the actual attitude to the commanded bank, angle of attack and zero sideslip, and the rate to remove.

    Both in B: error (goal minus actual, rad) and rate (actual minus goal, rad/s).
    """
    goal = attitude_from_wind_angles(take3(nav.v_I, 0), take3(nav.up_I, 0), guide.bank, guide.alpha, 0.0)
    q = attitude(nav)
    error = rotation_vector(multiply(conjugate(q), goal))
    return error, sub(body_rate(nav), path_rate(nav))


@kernel
def thrust_direction_error(q, direction_I, roll_error):
    """Decoupled error of the thrust axis (-x of B) and of roll, as a rotation vector in B (goal minus actual, rad).

    Pitch and yaw components turn the thrust axis straight to ``direction_I``; the roll component is passed in.
    Source: Hu et al. 2022, eqs. 5-7.  The print takes the arccosine of one component of S_d (eq. 7), which holds because S_d is
    given in the body frame there; here the angle comes from the cross and scalar product, which keeps its accuracy near zero.
    """
    wanted = to_frame(q, direction_I)
    thrust_axis = (-1.0, 0.0, 0.0)
    axis = cross(thrust_axis, wanted)
    sine = dot(axis, axis) ** 0.5
    cosine = dot(thrust_axis, wanted)
    if sine < 1e-9:
        angle_over_sine = 0.0 if cosine > 0.0 else 1.0
        # exactly opposite: any axis across the thrust will do
        axis = (0.0, 0.0, 0.0) if cosine > 0.0 else (0.0, pi, 0.0)
    else:
        angle_over_sine = atan2(sine, cosine) / sine
    error = scale(angle_over_sine, axis)
    return roll_error, error[1], error[2]
