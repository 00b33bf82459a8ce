"""Strapdown integration: attitude, velocity and position from the increments of gyros and accelerometers.

Coning and sculling are allowed for with the increments of this cycle and the one before, the gravity model on
board is the central field with J2, taken in the middle of the cycle.
Left out: higher harmonics of the field, which a filter has to allow for.

Source: Savage, Strapdown inertial navigation integration algorithm design, J. Guidance, Control and Dynamics
21(1, 2), 1998: two-sample coning and sculling; gravity: Montenbruck and Gill, Satellite
Orbits, section 3.2.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import sincos
from edl6dof.spatial.quaternion import from_frame, multiply, normalise
from edl6dof.spatial.vector import add, cross, dot, put3, scale, take3


@kernel
def turn_by(q, angle):
    """Attitude ``q_I2B`` after a rotation vector ``angle`` (rad, B)."""
    square = dot(angle, angle)
    if square < 1e-4:  # series: the next terms are below 1e-13
        c, s = 1.0 - square / 8.0 + square * square / 384.0, 0.5 - square / 48.0 + square * square / 3840.0
    else:
        size = sqrt(square)
        s, c = sincos(0.5 * size)
        s = s / size
    return normalise(multiply(q, (c, s * angle[0], s * angle[1], s * angle[2])))


@kernel
def gravity_I(planet, r):
    """Gravitational acceleration (m/s2, I) of the believed planet at ``r`` (m, I)."""
    r2 = dot(r, r)
    k = -planet.mu / (r2 * sqrt(r2))
    q = 1.5 * planet.j2 * planet.gravity_radius * planet.gravity_radius / r2
    s = 5.0 * r[2] * r[2] / r2
    return (
        k * (1.0 + q * (1.0 - s)) * r[0],
        k * (1.0 + q * (1.0 - s)) * r[1],
        k * (1.0 + q * (3.0 - s)) * r[2],
    )


@kernel
def rotation_vector_of(motion):
    """Rotation vector of the cycle: its increments with two-sample coning."""
    angle = take3(motion.angle, 0)
    return add(angle, scale(1.0 / 12.0, cross(take3(motion.last_angle, 0), angle)))


@kernel
def gain_in_first_axes(motion):
    """Velocity that the specific force gave in the cycle, m/s, in the axes that B had at its beginning:
    rotation and two-sample sculling.
    """
    angle, gain = take3(motion.angle, 0), take3(motion.gain, 0)
    last_angle, last_gain = take3(motion.last_angle, 0), take3(motion.last_gain, 0)
    rotation = scale(0.5, cross(angle, gain))
    sculling = scale(1.0 / 12.0, add(cross(last_angle, gain), cross(last_gain, angle)))
    return add(gain, add(rotation, sculling))


@kernel
def integrate(planet, motion, solution):
    """Bring ``solution`` (``SOLUTION``) over the cycle of ``motion`` (``MOTION``)."""
    dt = motion.dt
    q = (solution.q_I2B[0], solution.q_I2B[1], solution.q_I2B[2], solution.q_I2B[3])
    r, v = take3(solution.r_I, 0), take3(solution.v_I, 0)
    gravity = gravity_I(planet, add(r, scale(0.5 * dt, v)))
    change = add(from_frame(q, gain_in_first_axes(motion)), scale(dt, gravity))
    put3(solution.r_I, 0, add(r, scale(dt, add(v, scale(0.5, change)))))
    put3(solution.v_I, 0, add(v, change))
    turned = turn_by(q, rotation_vector_of(motion))
    for i in range(4):
        solution.q_I2B[i] = turned[i]
    solution.t += dt
