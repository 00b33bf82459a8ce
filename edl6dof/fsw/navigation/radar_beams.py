"""Beams of the landing radar: usable beams, velocity and height by their readings, and expected ranges.

Velocity in B and height below a given vertical follow from the beams alone, whatever the attitude is.
"""

from __future__ import annotations

from edl6dof.fsw.navigation.strapdown import attitude_at, central_gravity, level_axes
from edl6dof.kernels import kernel
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import add, cross, dot, inertia_solve, norm, scale, sub, take3, unit


@kernel
def beam_usable(healthy, radar, beam):
    """Return whether a beam has an echo and its flag in ``healthy`` is set."""
    return healthy[beam] != 0 and radar.locked[beam] != 0


@kernel
def count_usable_beams(health, radar, n_beams):
    """Count the beams with an echo whose range or speed is trusted."""
    count = 0
    for beam in range(n_beams):
        count += beam_usable(health.beam_range, radar, beam) or beam_usable(health.beam_speed, radar, beam)
    return count


@kernel
def locked_beams(radar, n_beams):
    """Bits of the beams that have an echo."""
    bits = 0
    for beam in range(n_beams):
        bits |= radar.locked[beam] << beam
    return bits


#: Least determinant of the axes of the beams; largest residual (m/s) of a beam.
_SPANS, _AGREE = 1e-3, 3.0


@kernel
def velocity_from_beams(instruments, health, radar):
    """Velocity (m/s, B) of the antenna relative to the ground, by least squares over the speeds of all beams
    with an echo, and whether it is valid: this needs four beams that agree, as three always agree.
    """
    xx = yy = zz = xy = xz = yz = 0.0
    seen, count = (0.0, 0.0, 0.0), 0
    if radar.fresh == 0:
        return seen, False
    for i in range(instruments.n_beams):
        if radar.locked[i] != 0 and health.beam_speed[i] != 0:
            x, y, z = take3(instruments.beam_axis[i], 0)
            xx, yy, zz = xx + x * x, yy + y * y, zz + z * z
            xy, xz, yz = xy + x * y, xz + x * z, yz + y * z
            seen, count = add(seen, scale(radar.speed[i], (x, y, z))), count + 1
    if count < 4 or dot((xx, xy, xz), cross((xy, yy, yz), (xz, yz, zz))) < _SPANS:
        return seen, False
    velocity = inertia_solve((xx, yy, zz, xy, xz, yz), seen)
    for i in range(instruments.n_beams):
        if radar.locked[i] != 0 and health.beam_speed[i] != 0:
            off = radar.speed[i] - dot(take3(instruments.beam_axis[i], 0), velocity)
            if abs(off) > _AGREE:
                return velocity, False
    return velocity, True


@kernel
def height_from_beams(instruments, health, radar, down):
    """Mean height (m) of the antenna above the points that the beams hit, along ``down`` (unit, B); 0 without
    an echo.
    """
    total, count = 0.0, 0
    for i in range(instruments.n_beams):
        if radar.locked[i] != 0 and health.beam_range[i] != 0:
            total += radar.range[i] * dot(take3(instruments.beam_axis[i], 0), down)
            count += 1
    return total / count if count > 0 else 0.0


#: Least cosine between a beam and the normal of the ground for the use of its range.
STEEPEST = 0.1


@kernel
def place_antenna(onboard, motion, solution, t):
    """Position and motion of the antenna at flight time ``t``.

    Returns (q_I2B, lever from the centre of mass, velocity of the centre relative to the planet, velocity
    that the rotation adds, up, height above the believed ground), vectors in I.
    """
    planet, ahead = onboard.planet, t - solution.t
    q = attitude_at(solution, motion, t)
    r_I, v_I = take3(solution.r_I, 0), take3(solution.v_I, 0)
    if motion.dt > 0.0:
        pull = add(central_gravity(planet, r_I), from_frame(q, scale(1.0 / motion.dt, take3(motion.gain, 0))))
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
    """North and east (I) at the vertical ``up`` (I)."""
    east = unit((-up[1], up[0], 0.0))
    return cross(up, east), east


@kernel
def ground_normal(up, slope):
    """Normal (I) of ground that rises by ``slope`` per metre north and east, with a component of one along
    ``up``.
    """
    north, east = horizontal(up)
    return sub(up, add(scale(slope[0], north), scale(slope[1], east)))


@kernel
def expected_range(u, up, normal, height, radius):
    """Return the range (m) along ``u`` (unit, I) to ground that is ``height`` (m) below, on a sphere of
    ``radius`` (m), with the ``normal`` of :func:`ground_normal`; minus the component of ``u`` along the
    normal; and the horizontal distance of the spot (m). ``u`` must not be flatter than ``STEEPEST``.
    """
    steepness = -dot(u, normal)
    off = abs(height) / steepness * norm(cross(u, up))
    return (height + 0.5 * off * off / radius) / steepness, steepness, off
