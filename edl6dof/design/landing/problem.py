"""The fuel-optimal pinpoint landing of a point mass, and the maps from thrust to motion on a grid of times.

Axes: east, north, up, from the landing point.  Sources: Acikmese & Ploen 2007, "Convex programming approach
to powered descent guidance for Mars landing", J. Guidance 30(5); Acikmese, Carson, Blackmore 2013, "Lossless
convexification of nonconvex control bound and pointing constraints of the soft landing optimal control
problem", IEEE Trans. Control Systems Technology 21(6).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, pi, radians

import numpy as np

from edl6dof.config.units import G0


@dataclass(frozen=True)
class Landing:
    """A powered landing to rest at the origin.

    Attributes:
        mass: at the start, kg.
        thrust: least and largest thrust along the path, N.
        exhaust_speed: thrust over mass flow, m/s.
        gravity: downwards, m/s2.
        position, velocity: at the start, (east, north, up), m and m/s.
        glide_slope: least angle of the line from the landing point to the vehicle over the horizon, rad; 0:
            never below the landing point; -pi / 2: none.
        tilt: largest angle of thrust from the vertical, rad, at most pi / 2; pi: none.
        end_tilt: that of the last control, rad.
        full_thrust: of the start, N.
        full_time: how long the thrust is ``full_thrust`` before its bounds hold, s.
    """

    mass: float
    thrust: tuple[float, float]
    exhaust_speed: float
    gravity: float
    position: tuple[float, float, float]
    velocity: tuple[float, float, float]
    glide_slope: float = -pi / 2.0
    tilt: float = pi
    end_tilt: float = pi
    full_thrust: float = 0.0
    full_time: float = 0.0


def classic_mars(glide_slope_deg: float | None = None) -> Landing:
    """The example of Acikmese & Ploen 2007: six engines of 3.1 kN, canted by 27 deg, at 30 to 80 %."""
    full = 6.0 * 3100.0 * cos(radians(27.0))
    return Landing(
        mass=1905.0,
        thrust=(0.3 * full, 0.8 * full),
        exhaust_speed=225.0 * G0 * cos(radians(27.0)),
        gravity=3.7114,
        position=(2000.0, 0.0, 1500.0),
        velocity=(100.0, 0.0, -75.0),
        glide_slope=-pi / 2.0 if glide_slope_deg is None else radians(glide_slope_deg),
    )


@dataclass(frozen=True)
class Grid:
    """Times, and what each thrust acceleration of a control adds to velocity and position at them.

    Attributes:
        times: shape (n + 1,), from 0 to the time of flight, s.
        velocity: shape (n + 1, m): velocity at each time for 1 m/s2 of each control, s.
        position: shape (n + 1, m): position likewise, s2.
        spent: shape (m, m): integral of each control up to where the thrust bounds of each control hold, s.
        at: shape (m,): that time, s.
    """

    times: np.ndarray
    velocity: np.ndarray
    position: np.ndarray
    spent: np.ndarray
    at: np.ndarray


def held_controls(time: float, count: int, full_time: float = 0.0) -> Grid:
    """A grid of ``count`` controls, each held constant; the first share of them, if any, fills ``full_time``.

    The bounds of a held control are those of the mass in its middle.
    """
    first = full_intervals(time, count, full_time)
    edges = np.concatenate(
        [np.linspace(0.0, full_time, first + 1)[:-1], np.linspace(full_time, time, count - first + 1)]
        if first
        else [np.linspace(0.0, time, count + 1)]
    )
    steps, middles = np.diff(edges), 0.5 * (edges[1:] + edges[:-1])
    before = np.tri(count + 1, count, -1)
    velocity = before * steps
    position = velocity * (edges[:, None] - middles)
    return Grid(edges, velocity, position, np.tri(count, count, -1) * steps + np.diag(0.5 * steps), middles)


def full_intervals(time: float, count: int, full_time: float) -> int:
    """How many of ``count`` controls fill the start at full thrust."""
    if full_time <= 0.0:
        return 0
    return int(np.clip(round(count * full_time / time), 1, count - 2))


def interpolated_controls(time: float, count: int) -> Grid:
    """A grid of ``count`` controls, thrust acceleration linear between them (first-order hold)."""
    times = np.linspace(0.0, time, count)
    step = times[1]
    velocity, position = np.zeros((count, count)), np.zeros((count, count))
    for i in range(1, count):
        velocity[i] = velocity[i - 1]
        position[i] = position[i - 1] + step * velocity[i - 1]
        velocity[i, i - 1 : i + 1] += 0.5 * step
        position[i, i - 1] += step * step / 3.0
        position[i, i] += step * step / 6.0
    return Grid(times, velocity, position, velocity, times)
