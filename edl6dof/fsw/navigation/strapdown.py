"""Strapdown navigation: alignment, and integration of gyro and accelerometer increments.

The solution starts from ground tracking (position, velocity) and the star tracker (attitude), in the cycle in
which both have arrived.  Coning and sculling are compensated with the increments of this cycle and the one
before; the gravity model is the central field with J2, taken in the middle of the cycle.
Left out: higher harmonics of the field, which a filter has to allow for.

Source: Savage, Strapdown inertial navigation integration algorithm design, J. Guidance, Control and Dynamics
21(1, 2), 1998: two-sample coning and sculling; gravity: Montenbruck and Gill, Satellite
Orbits, section 3.2.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import sincos
from edl6dof.spatial.frames import geodetic, ned_to_fixed, rotate_z
from edl6dof.spatial.quaternion import from_frame, multiply, normalise
from edl6dof.spatial.vector import add, cross, dot, norm, put3, put4, scale, sub, take3, take4


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
    """Rotation vector (rad, B) of the cycle: its increments with two-sample coning compensation."""
    angle = take3(motion.angle, 0)
    return add(angle, scale(1.0 / 12.0, cross(take3(motion.last_angle, 0), angle)))


@kernel
def gain_in_first_axes(motion):
    """Velocity gained in the cycle (m/s) in B at its beginning, with rotation and two-sample sculling
    compensation.
    """
    angle, gain = take3(motion.angle, 0), take3(motion.gain, 0)
    last_angle, last_gain = take3(motion.last_angle, 0), take3(motion.last_gain, 0)
    rotation = scale(0.5, cross(angle, gain))
    sculling = scale(1.0 / 12.0, add(cross(last_angle, gain), cross(last_gain, angle)))
    return add(gain, add(rotation, sculling))


@kernel
def integrate(planet, motion, solution):
    """Propagate ``solution`` (``SOLUTION``) over the cycle of ``motion`` (``MOTION``)."""
    dt = motion.dt
    q = take4(solution.q_I2B)
    r, v = take3(solution.r_I, 0), take3(solution.v_I, 0)
    gravity = gravity_I(planet, add(r, scale(0.5 * dt, v)))
    change = add(from_frame(q, gain_in_first_axes(motion)), scale(dt, gravity))
    put3(solution.r_I, 0, add(r, scale(dt, add(v, scale(0.5, change)))))
    put3(solution.v_I, 0, add(v, change))
    turned = turn_by(q, rotation_vector_of(motion))
    put4(solution.q_I2B, turned)
    solution.t += dt


@kernel
def align(planet, t, sensed, motion, solution):
    """Start ``solution`` (``SOLUTION``) at ``t``, the time of the last reading of the inertial unit. The
    tracked state is that of ``sensed.t``; it is propagated back in free fall.
    """
    r, v, age = take3(sensed.tracking.r_I, 0), take3(sensed.tracking.v_I, 0), sensed.t - t
    fall = scale(age, gravity_I(planet, r))
    put3(solution.r_I, 0, sub(r, scale(age, sub(v, scale(0.5, fall)))))
    put3(solution.v_I, 0, sub(v, fall))
    solution.t, solution.started = t, 1
    adopt_attitude(sensed, motion, solution)


@kernel
def adopt_attitude(sensed, motion, solution):
    """Set the attitude to that of the star fix, turned back to the time of the solution."""
    back = scale(solution.t - sensed.t, take3(motion.rate, 0))
    put4(solution.q_I2B, turn_by(take4(motion.fix_q_I2B), back))
    solution.new_attitude_variance = motion.fix_doubt


@kernel
def level_axes(planet, r_I, t):
    """North, east and up (I) at the position ``r_I`` (m) and flight time ``t`` (s), and its height above the
    ellipsoid (m).
    """
    s, c = sincos(planet.rotation_rate * t)
    r_F = rotate_z(c, s, r_I)
    sin_lat, cos_lat, sin_lon, cos_lon, altitude = geodetic(planet.equatorial_radius, planet.flattening, r_F)
    north = rotate_z(c, -s, ned_to_fixed(sin_lat, cos_lat, sin_lon, cos_lon, (1.0, 0.0, 0.0)))
    east = rotate_z(c, -s, ned_to_fixed(sin_lat, cos_lat, sin_lon, cos_lon, (0.0, 1.0, 0.0)))
    up = rotate_z(c, -s, ned_to_fixed(sin_lat, cos_lat, sin_lon, cos_lon, (0.0, 0.0, -1.0)))
    return north, east, up, altitude


@kernel
def central_gravity(planet, r_I):
    """Central gravitational acceleration (m/s2, I) at ``r_I`` (m)."""
    distance = norm(r_I)
    return scale(-planet.mu / (distance * distance * distance), r_I)


@kernel
def attitude_at(solution, motion, t):
    """Attitude extrapolated from the last inertial reading to flight time ``t``."""
    return turn_by(take4(solution.q_I2B), turn_ahead(motion, t - solution.t))


@kernel
def turn_ahead(motion, age):
    """Rotation (rad, B) in the ``age`` (s) since the last reading, from the rotations of the last two cycles:
    the rate changes as between them.  While no gyro measures, the rate is constant.
    """
    if motion.rate_known == 0 or motion.dt <= 0.0:
        return scale(age, take3(motion.rate, 0))
    share = age / motion.dt
    angle, last = take3(motion.angle, 0), take3(motion.last_angle, 0)
    return add(scale(share, angle), scale(0.5 * share * (1.0 + share), sub(angle, last)))
