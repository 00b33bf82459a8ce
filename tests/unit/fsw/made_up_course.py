"""The true course of a made-up Mars landing: entry, parachute from 7 km, powered descent, hover, touchdown,
flown over the planet that the flight computer believes in.

Vectors are tuples: with arrays it took three times as long to compile.
"""

import numpy as np

from edl6dof.fsw.navigation.strapdown import level_axes
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import exp, sin
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
from edl6dof.spatial.vector import add, cross, norm, put3, scale, sub, unit

DT = 0.05
MU, RADIUS, SPIN = 4.282837e13, 3396190.0, 7.088218e-5
FLATTENING = 1.0 / 169.89
LATITUDE, LONGITUDE, SITE = np.radians(25.0), np.radians(110.0), -4100.0


@kernel
def _axes_at(x, down, bank):
    """Attitude with ``x`` forward, z as far down as may be, then rolled by ``bank``."""
    y = unit(cross(down, x))
    return multiply(from_axes(x, y, cross(x, y)), about_axis((1.0, 0.0, 0.0), bank))


@kernel
def pull_of(r):
    """Gravity at a position, m/s2."""
    return scale(-MU / norm(r) ** 3, r)


@kernel
def moving(r, v):
    """Velocity relative to the planet."""
    return v[0] + SPIN * r[1], v[1] - SPIN * r[0], v[2]


@kernel
def half_turned(q, angle):
    """The attitude half way through a small turn."""
    return normalise(multiply(q, (1.0, 0.25 * angle[0], 0.25 * angle[1], 0.25 * angle[2])))


@kernel
def _bank(t):
    """A bank that is reversed three times."""
    return 2.0 / (1.0 + exp(-12.0 * sin(2.0 * np.pi * t / 150.0))) - 1.0


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
def fly_truth(onboard, start, entry, flown):
    """True states and increments of the cycles, written into the arrays ``flown``: r, v, q, angle, gain,
    height above the site.
    """
    rs, vs, qs, angles, gains, heights = flown
    q, (r, v) = (1.0, 0.0, 0.0, 0.0), start
    r_before, v_before = r, v
    for k in range(len(rs)):
        t = k * DT
        _, east, up, altitude = level_axes(onboard.planet, r, t)
        v_rel, h, g = moving(r, v), altitude - onboard.site.altitude, pull_of(r)
        if entry:
            speed = norm(v_rel)
            drag = 0.016 * np.exp(-altitude / 10e3) * speed**2 / (2.0 * 110.0)
            new = _axes_at(scale(1.0 / speed, v_rel), scale(-1.0, up), _bank(t))
            f = from_frame(new, (-drag, 0.0, -0.24 * drag))
        else:
            f = _steered(h, v_rel, g, onboard.planet, r, t)
            swing = np.radians(6.0) * min(h / 3000.0, 1.0) * np.sin(2.5 * t)
            new = _axes_at(unit(scale(-1.0, f)), east, 0.3 * np.sin(0.1 * t))
            new = multiply(new, about_axis((0.0, 1.0, 0.0), swing))
            new = multiply(new, about_axis((0.0, 0.0, 1.0), 0.7 * swing))
        new = normalise(new)
        if k > 0:
            angle = rotation_vector(multiply(conjugate(q), new))
            gained = sub(sub(v, v_before), scale(DT, pull_of(r_before)))
            put3(angles[k], 0, angle)
            put3(gains[k], 0, to_frame(half_turned(q, angle), gained))
        q, r_before, v_before, heights[k] = new, r, v, h
        put3(rs[k], 0, r)
        put3(vs[k], 0, v)
        qs[k, 0], qs[k, 1], qs[k, 2], qs[k, 3] = q
        later = add(v, scale(DT, add(f, g)))
        r = add(r, scale(0.5 * DT, add(v, later)))
        v = later


@kernel
def _steered(h, v_rel, g, planet, r, t):
    """Specific force of the descent: towards its speeds down and, high up, along the ground."""
    north, east, up, _ = level_axes(planet, r, t)
    along = scale(min(h / 3000.0, 1.0), add(scale(12.0, east), scale(5.0, north)))
    goal = sub(along, scale(_falling_speed(h), up))
    return sub(scale(1.0 / (3.0 if h > 1200.0 else 0.8), sub(goal, v_rel)), g)


def truth(onboard, entry):
    """The entry, 300 s from 125 km; or the descent, from 7 km above the site to the ground."""
    above = 125e3 if entry else SITE + 7000.0
    r = np.array(from_geodetic(RADIUS, FLATTENING, LATITUDE, LONGITUDE, above))
    north, east, up, _ = (np.array(axis) for axis in level_axes(onboard[0]["planet"], tuple(r), 0.0))
    fall, across = (-4750.0 * np.sin(np.radians(11.0)), 4750.0 * np.cos(np.radians(11.0)))
    v_rel = fall * up + across * east if entry else -120.0 * up + 60.0 * east
    v = v_rel + np.array([-SPIN * r[1], SPIN * r[0], 0.0])
    steps = int(300.0 / DT) if entry else int(250.0 / DT)
    flown = (*(np.zeros((steps, size)) for size in (3, 3, 4, 3, 3)), np.zeros(steps))
    fly_truth(onboard[0], (tuple(r), tuple(v)), entry, flown)
    if entry:
        return flown
    down = int(np.argmax(flown[5] < 0.5))
    assert down > 0
    return tuple(column[:down] for column in flown)
