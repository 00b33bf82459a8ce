"""Planet and air where a body is: one place for the vehicle and for what has left it."""

from __future__ import annotations

from math import cos, sin

import numpy as np

from edl6dof.environment.atmosphere import air
from edl6dof.environment.gravity import DEPARTURE, gravity_nearby_F
from edl6dof.environment.wind import wind
from edl6dof.jit import kernel
from edl6dof.spatial.frames import geodetic, ned_to_fixed, rotate_z

#: What is kept for a body between calls: cosine and sine of the planet's turn angle at ``t`` (NaN at first), departure of gravity.
KEPT = np.dtype([("t", "f8"), ("turn", "f8", (2,)), ("departure", DEPARTURE)], align=True)


@kernel
def turn_of_planet(case, kept, t):
    """Cosine and sine of the planet's turn angle at ``t`` (s), worked out once for the calls that share a time."""
    if t != kept.t:
        angle = case.planet.rotation_rate * t
        kept.t, kept.turn[0], kept.turn[1] = t, cos(angle), sin(angle)
    return kept.turn[0], kept.turn[1]


@kernel
def surroundings(case, tables, kept, t, r_I):
    """What surrounds the point ``r_I`` (m) at time ``t`` (s); ``kept`` is the ``KEPT`` record of the body there.

    Returns:
        turn: cosine and sine of the planet's turn angle.
        place: sine and cosine of geodetic latitude and of longitude, and altitude (m).
        gas: density (kg/m3), pressure (Pa), temperature (K), speed of sound (m/s).
        wind_N: wind towards north, east, down (m/s).
        air_I: velocity of the air, rotation of the planet included (m/s).
        g_I: gravitational acceleration (m/s2).
    """
    spin = case.planet.rotation_rate
    c, s = turn_of_planet(case, kept, t)
    r_F = rotate_z(c, s, r_I)
    sin_lat, cos_lat, sin_lon, cos_lon, altitude = geodetic(case.planet.equatorial_radius, case.planet.flattening, r_F)
    g_I = rotate_z(c, -s, gravity_nearby_F(case.planet.gravity, kept.departure, r_F[0], r_F[1], r_F[2]))
    gas = air(case.atmosphere, tables.atmosphere, altitude)
    east, north, up = wind(case.wind, tables.atmosphere, altitude)
    carried = rotate_z(c, -s, ned_to_fixed(sin_lat, cos_lat, sin_lon, cos_lon, (north, east, -up)))
    air_I = (carried[0] - spin * r_I[1], carried[1] + spin * r_I[0], carried[2])
    return (c, s), (sin_lat, cos_lat, sin_lon, cos_lon, altitude), gas, (north, east, -up), air_I, g_I
