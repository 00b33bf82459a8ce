"""The true course of a made-up Mars landing: entry, parachute from 7 km, powered descent, hover, touchdown,
flown over the planet that the flight computer believes in.
"""

import numpy as np

from edl6dof.fsw.navigation.filters.kalman.antenna import level_axes
from edl6dof.jit import kernel
from edl6dof.spatial.frames import from_geodetic
from edl6dof.spatial.quaternion import (
    about_axis,
    conjugate,
    from_axes,
    from_frame,
    multiply,
    normalise,
    rotation_vector,
    to_frame,
)

DT = 0.05
MU, RADIUS, SPIN = 4.282837e13, 3396190.0, 7.088218e-5
FLATTENING = 1.0 / 169.89
LATITUDE, LONGITUDE, SITE = np.radians(25.0), np.radians(110.0), -4100.0


@kernel
def _axes_at(x, down, bank):
    """Attitude with ``x`` forward, z as far down as may be, then rolled by ``bank``."""
    y = np.cross(down, x)
    y /= np.sqrt(np.sum(y * y))
    z = np.cross(x, y)
    turned = from_axes((x[0], x[1], x[2]), (y[0], y[1], y[2]), (z[0], z[1], z[2]))
    return multiply(turned, about_axis((1.0, 0.0, 0.0), bank))


@kernel
def _bank(t):
    """A bank that is reversed three times."""
    return 1.0 * np.tanh(np.sin(2.0 * np.pi * t / 150.0) * 6.0)


@kernel
def _falling_speed(h):
    """Downward speed of the descent by height above the site."""
    if h > 1200.0:
        return 95.0
    if h > 100.0:
        return min(95.0, np.sqrt(2.0 * 4.0 * (h - 100.0)) + 2.0)
    if h > 20.0:
        return min(np.sqrt(1.0 * (h - 20.0)) + 1.5, 2.0)
    return 1.5


@kernel
def fly_truth(onboard, r, v, steps, entry):
    """True states and increments of the cycles: r, v, q, angle, gain, height above the site."""
    planet = onboard.planet
    rs, vs, qs = np.zeros((steps, 3)), np.zeros((steps, 3)), np.zeros((steps, 4))
    angles, gains, heights = np.zeros((steps, 3)), np.zeros((steps, 3)), np.zeros(steps)
    q = (1.0, 0.0, 0.0, 0.0)
    for k in range(steps):
        t = k * DT
        north, east, up, altitude = level_axes(planet, (r[0], r[1], r[2]), t)
        up, east, north = np.array(up), np.array(east), np.array(north)
        v_rel = np.array([v[0] + SPIN * r[1], v[1] - SPIN * r[0], v[2]])
        g = -MU / np.sum(r * r) ** 1.5 * r
        h = altitude - onboard.site.altitude
        if entry:
            speed = np.sqrt(np.sum(v_rel * v_rel))
            drag = 0.016 * np.exp(-altitude / 10e3) * speed**2 / (2.0 * 110.0)
            new = _axes_at(v_rel / speed, -up, _bank(t))
            pull = from_frame(new, (-drag, 0.0, -0.24 * drag))
            f = np.array(pull)
        else:
            goal = -_falling_speed(h) * up + (12.0 * east + 5.0 * north) * min(h / 3000.0, 1.0)
            f = (goal - v_rel) / (3.0 if h > 1200.0 else 0.8) - g
            swing = np.radians(6.0) * min(h / 3000.0, 1.0) * np.sin(2.5 * t)
            new = _axes_at(-f / np.sqrt(np.sum(f * f)), east, 0.3 * np.sin(0.1 * t))
            new = multiply(new, about_axis((0.0, 1.0, 0.0), swing))
            new = multiply(new, about_axis((0.0, 0.0, 1.0), 0.7 * swing))
        new = normalise(new)
        if k > 0:
            angle = rotation_vector(multiply(conjugate(q), new))
            half = multiply(q, (1.0, 0.25 * angle[0], 0.25 * angle[1], 0.25 * angle[2]))
            angles[k] = np.array(angle)
        q = new
        rs[k], vs[k], qs[k], heights[k] = r, v, np.array(q), h
        if k > 0:
            gained = (vs[k] - vs[k - 1]) - DT * (-MU / np.sum(rs[k - 1] ** 2) ** 1.5 * rs[k - 1])
            gains[k] = np.array(to_frame(normalise(half), (gained[0], gained[1], gained[2])))
        later = v + DT * (f + g)
        r = r + 0.5 * DT * (v + later)
        v = later
    return rs, vs, qs, angles, gains, heights


def truth(onboard, entry):
    """The entry, 300 s from 125 km; or the descent, from 7 km above the site to the ground."""
    above = 125e3 if entry else SITE + 7000.0
    r = np.array(from_geodetic(RADIUS, FLATTENING, LATITUDE, LONGITUDE, above))
    north, east, up, _ = (np.array(axis) for axis in level_axes(onboard[0]["planet"], tuple(r), 0.0))
    fall, across = (-4750.0 * np.sin(np.radians(11.0)), 4750.0 * np.cos(np.radians(11.0)))
    v_rel = fall * up + across * east if entry else -120.0 * up + 60.0 * east
    v = v_rel + np.array([-SPIN * r[1], SPIN * r[0], 0.0])
    steps = int(300.0 / DT) if entry else int(250.0 / DT)
    flown = fly_truth(onboard[0], r, v, steps, entry)
    if entry:
        return flown
    down = int(np.argmax(flown[5] < 0.5))
    assert down > 0
    return tuple(column[:down] for column in flown)
