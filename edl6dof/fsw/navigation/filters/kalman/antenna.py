"""Where the radar's antenna is and how it moves at the time of its reading, and what its beams should
return from level ground.
"""

from __future__ import annotations

from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import sincos
from edl6dof.spatial.frames import geodetic, ned_to_fixed, rotate_z
from edl6dof.spatial.quaternion import from_frame, multiply, normalise
from edl6dof.spatial.vector import add, cross, dot, norm, scale, sub, take3, unit

#: Least cosine of a beam to the normal of the ground with which its range tells anything of the height.
STEEPEST = 0.1


@kernel
def level_axes(planet, r_I, t):
    """North, east and up in I at a position, and its height above the ellipsoid (m)."""
    s, c = sincos(planet.rotation_rate * t)
    r_F = rotate_z(c, s, r_I)
    sin_lat, cos_lat, sin_lon, cos_lon, altitude = geodetic(planet.equatorial_radius, planet.flattening, r_F)
    north = rotate_z(c, -s, ned_to_fixed(sin_lat, cos_lat, sin_lon, cos_lon, (1.0, 0.0, 0.0)))
    east = rotate_z(c, -s, ned_to_fixed(sin_lat, cos_lat, sin_lon, cos_lon, (0.0, 1.0, 0.0)))
    up = rotate_z(c, -s, ned_to_fixed(sin_lat, cos_lat, sin_lon, cos_lon, (0.0, 0.0, -1.0)))
    return north, east, up, altitude


@kernel
def gravity(planet, r_I):
    """Central gravity, m/s2."""
    distance = norm(r_I)
    return scale(-planet.mu / (distance * distance * distance), r_I)


@kernel
def attitude_at(solution, motion, t):
    """Attitude brought forward from the last inertial reading to flight time ``t``."""
    half = 0.5 * (t - solution.t)
    w = take3(motion.rate, 0)
    q = (solution.q_I2B[0], solution.q_I2B[1], solution.q_I2B[2], solution.q_I2B[3])
    return normalise(multiply(q, (1.0, half * w[0], half * w[1], half * w[2])))


@kernel
def place_antenna(onboard, motion, solution, t):
    """The antenna at flight time ``t``.

    Returns (q_I2B, lever from the centre of mass, velocity of the centre relative to the planet, velocity
    that the turning adds, up, height above the believed ground), vectors in I.
    """
    planet, ahead = onboard.planet, t - solution.t
    q = attitude_at(solution, motion, t)
    r_I, v_I = take3(solution.r_I, 0), take3(solution.v_I, 0)
    if motion.dt > 0.0:
        pull = add(gravity(planet, r_I), from_frame(q, scale(1.0 / motion.dt, take3(motion.gain, 0))))
        v_I = add(v_I, scale(ahead, pull))
    r_I = add(r_I, scale(ahead, v_I))
    arm = sub(take3(onboard.instruments.antenna_position, 0), take3(motion.centre, 0))
    lever = from_frame(q, arm)
    swing = from_frame(q, cross(take3(motion.rate, 0), arm))
    place = add(r_I, lever)
    _, _, up, altitude = level_axes(planet, place, t)
    spin = planet.rotation_rate
    velocity = (v_I[0] + spin * place[1], v_I[1] - spin * place[0], v_I[2])
    return q, lever, velocity, swing, up, altitude - onboard.site.altitude - solution.terrain


@kernel
def horizontal(up):
    """North and east at the vertical ``up``, all I."""
    east = unit((-up[1], up[0], 0.0))
    return cross(up, east), east


@kernel
def ground_normal(up, slope):
    """Normal (I) of ground that rises by ``slope`` per metre towards north and east, of length one along
    ``up``.
    """
    north, east = horizontal(up)
    return sub(up, add(scale(slope[0], north), scale(slope[1], east)))


@kernel
def expected_range(u, up, normal, height, radius):
    """Range (m) along ``u`` to ground of a ``normal`` of length one along ``up``, ``height`` (m) below, on a
    sphere of ``radius``; minus the component of ``u`` along the normal, and how far off the spot lies.

    ``u`` must not be flatter than ``STEEPEST``.
    """
    steepness = -dot(u, normal)
    off = abs(height) / steepness * norm(cross(u, up))
    return (height + 0.5 * off * off / radius) / steepness, steepness, off
