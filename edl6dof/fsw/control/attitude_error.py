"""Attitude errors, the velocity frame, and torques from angular accelerations, shared by the controllers."""

from __future__ import annotations

from math import pi

from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import atan2, sincos
from edl6dof.spatial.frames import attitude_from_wind_angles
from edl6dof.spatial.quaternion import (
    conjugate,
    from_axes,
    from_frame,
    multiply,
    normalise,
    rotation_vector,
    to_frame,
)
from edl6dof.spatial.vector import cross, dot, scale, sub, take3, take4


@kernel
def inertia_torque(inertia, acceleration):
    """Return the torque (N m, B) that accelerates a body with the principal moments ``inertia`` (kg m2) by
    ``acceleration`` (rad/s2).
    """
    return inertia[0] * acceleration[0], inertia[1] * acceleration[1], inertia[2] * acceleration[2]


@kernel
def gyroscopic_torque(inertia, w):
    """Return the torque (N m, B) that holds the rate ``w`` (rad/s) of a body with the principal moments
    ``inertia`` (kg m2) constant: w x J w.
    """
    return cross(w, (inertia[0] * w[0], inertia[1] * w[1], inertia[2] * w[2]))


@kernel
def beyond(x, limit):
    """Return the part of ``x`` outside the interval [-limit, limit]."""
    if x > limit:
        return x - limit
    if x < -limit:
        return x + limit
    return 0.0


@kernel
def path_rate(nav):
    """Return the rate (rad/s, B) at which the planet-relative velocity turns, from gravity and the measured
    specific force.

    Rotation of the planet and centrifugal terms are left out: they are below 0.01 deg/s.
    """
    q = take4(nav.q_I2B)
    v = take3(nav.v_rel_I, 0)
    acceleration = sub(from_frame(q, take3(nav.specific_force_B, 0)), scale(nav.gravity, take3(nav.up_I, 0)))
    speed2 = max(nav.speed * nav.speed, 1.0)
    return to_frame(q, scale(1.0 / speed2, cross(v, acceleration)))


@kernel
def wind_attitude_error(nav, command):
    """Return the rotation vector (rad, B) from the actual attitude to the commanded bank and angle of attack
    without sideslip, and the body rate relative to the velocity (rad/s, B), which is to become zero.
    """
    up_I = take3(nav.up_I, 0)
    goal = attitude_from_wind_angles(take3(nav.v_rel_I, 0), up_I, command.bank, command.alpha, 0.0)
    q = take4(nav.q_I2B)
    error = rotation_vector(multiply(conjugate(q), goal))
    return error, sub(take3(nav.w_B, 0), path_rate(nav))


@kernel
def velocity_axes(alpha, beta):
    """Return the axes of the velocity frame V in B: the direction of the velocity, the axis of the angle of
    attack, and the axis of minus the sideslip. They are the columns of C_cv of Hu et al. 2022, eq. 1, for B
    instead of the frame c of the paper (x and z reversed).
    """
    (sa, ca), (sb, cb) = sincos(alpha), sincos(beta)
    return (ca * cb, sb, sa * cb), (-ca * sb, cb, -sa * sb), (-sa, 0.0, ca)


@kernel
def shortest_arc(a, b):
    """Return the unit quaternion of the shortest rotation from the unit vector ``a`` to ``b``; any such
    rotation where they are opposite.
    """
    s = 1.0 + dot(a, b)
    if s < 1e-12:
        across = cross(a, (0.0, 1.0, 0.0)) if abs(a[1]) < 0.9 else cross(a, (1.0, 0.0, 0.0))
        return normalise((0.0, across[0], across[1], across[2]))
    v = cross(a, b)
    return normalise((s, v[0], v[1], v[2]))


@kernel
def goal_attitude(north_I, east_I, up_I, direction_I):
    """Return the goal attitude ``q_I2B``: the local geographic frame turned by the shortest path until its
    thrust axis points along ``direction_I``.

    In the geographic frame x of the paper's frame c points up (x of B down) and y south. Source: Hu et al.
    2022, eqs. 2 and 3. Figs. 9 and 10 make the paper's z the axis of the angle of attack, y of B; with that,
    the roll goal used here would be 90 deg off. It is used because a lander that arrives flying south then
    has to roll by 90 deg, and the real lander rolled at 0.5 deg/s for 156 s and had 7.7 deg left.
    """
    upright = from_axes(scale(-1.0, up_I), scale(-1.0, north_I), scale(-1.0, east_I))
    return multiply(shortest_arc(up_I, direction_I), upright)


@kernel
def shortest_path_error(q, goal):
    """Return the rotation vector (rad, B) from the attitude ``q`` to ``goal``. Source: Hu et al.
    2022, eq. 4.
    """
    return rotation_vector(multiply(conjugate(q), goal))


@kernel
def decoupled_error(q, goal):
    """Return the errors of roll, pitch and yaw (rad, B; goal minus actual): pitch and yaw are the error of
    the thrust direction, roll is the error that remains when this is removed.

    The first rotation turns the thrust axis by the shortest path into that of the goal; the second rotation,
    about the thrust axis, removes the remaining error and is the roll error. Source: Hu et al. 2022, Fig. 6
    and eqs. 5-7. Differences from the print: eq. 5 has S_d x S_1 for the axis, the rotation of the error
    actual minus goal; here the error is goal minus actual. Eq. 6 gives 2 sin(phi/2) for the angle phi; the
    angle itself is used, which agrees below 30 deg to 1.2 %. Eq. 5 leaves no pitch and yaw error when the
    thrust points exactly the wrong way; here the vehicle turns about some axis across it.
    """
    thrust_axis = (-1.0, 0.0, 0.0)
    tilt = shortest_arc(thrust_axis, to_frame(q, from_frame(goal, thrust_axis)))
    left = multiply(conjugate(multiply(q, tilt)), goal)
    roll = 2.0 * atan2(left[1], left[0])
    if roll > pi:
        roll -= 2.0 * pi
    elif roll <= -pi:
        roll += 2.0 * pi
    _, pitch, yaw = rotation_vector(tilt)
    return roll, pitch, yaw
