"""Planet and air where a body is: one place for the vehicle and for what has left it."""

from __future__ import annotations

from math import cos, sin

import numpy as np

from edl6dof.environment.atmosphere import air
from edl6dof.environment.gravity import central_F, departure_F
from edl6dof.environment.wind import wind
from edl6dof.jit import kernel
from edl6dof.records import TIME_IF_EVER
from edl6dof.spatial.frames import geodetic, ned_to_fixed, rotate_z
from edl6dof.spatial.vector import add, put3, sub, take3

#: What is kept for a body between calls: cosine and sine of the planet's turn angle at ``t`` (NaN at first);
#: and at ``at`` (m, in F; the centre of the planet at first) sine and cosine of latitude and longitude,
#: height, and departure of gravity from its central term.
KEPT = np.dtype(
    [
        ("t", TIME_IF_EVER),
        ("turn", "f8", (2,)),
        ("at", "f8", (3,)),
        ("direction", "f8", (4,)),
        ("altitude", "f8"),
        ("departure", "f8", (3,)),
    ],
    align=True,
)
#: Distance along each axis, m, within which the place is kept.
KEPT_WITHIN = 0.005


@kernel
def turn_of_planet(case, kept, t):
    """Cosine and sine of the planet's turn angle at ``t`` (s), worked out once for the calls that share a
    time.
    """
    if t != kept.t:
        angle = case.planet.rotation_rate * t
        kept.t, kept.turn[0], kept.turn[1] = t, cos(angle), sin(angle)
    return kept.turn[0], kept.turn[1]


@kernel
def place_and_gravity(planet, kept, r_F):
    """Sine and cosine of geodetic latitude and of longitude, and altitude (m); and gravitation in F (m/s2).

    What changes slowly with the place is worked out anew ``KEPT_WITHIN`` from where it last was.  The stages
    of an integration step meet in pairs (middle, and end with the next beginning), so this halves the work.
    Within that distance latitude and longitude are right to 3e-9 rad, altitude to 1e-11 m, gravity to 2e-10
    m/s2, on Mars and on Earth.
    """
    x, y, z = r_F
    away = sub(r_F, take3(kept.at, 0))
    if not (abs(away[0]) <= KEPT_WITHIN and abs(away[1]) <= KEPT_WITHIN and abs(away[2]) <= KEPT_WITHIN):
        away = (0.0, 0.0, 0.0)
        put3(kept.at, 0, r_F)
        sin_lat, cos_lat, sin_lon, cos_lon, altitude = geodetic(
            planet.equatorial_radius, planet.flattening, r_F
        )
        kept.direction[0], kept.direction[1], kept.direction[2], kept.direction[3] = (
            sin_lat,
            cos_lat,
            sin_lon,
            cos_lon,
        )
        kept.altitude = altitude
        put3(kept.departure, 0, departure_F(planet.gravity, x, y, z))
    sin_lat, cos_lat, sin_lon, cos_lon = (
        kept.direction[0],
        kept.direction[1],
        kept.direction[2],
        kept.direction[3],
    )
    altitude = kept.altitude + (cos_lat * (cos_lon * away[0] + sin_lon * away[1]) + sin_lat * away[2])
    g_F = add(central_F(planet.gravity, x, y, z), take3(kept.departure, 0))
    return (sin_lat, cos_lat, sin_lon, cos_lon, altitude), g_F


@kernel
def surroundings(case, tables, kept, t, r_I):
    """What surrounds the point ``r_I`` (m) at time ``t`` (s); ``kept`` is the ``KEPT`` record of the body
    there.

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
    place, g_F = place_and_gravity(case.planet, kept, rotate_z(c, s, r_I))
    sin_lat, cos_lat, sin_lon, cos_lon, altitude = place
    gas = air(case.atmosphere, case.planet.gas, tables.atmosphere, altitude)
    east, north, up = wind(case.wind, tables.atmosphere, altitude)
    carried = rotate_z(c, -s, ned_to_fixed(sin_lat, cos_lat, sin_lon, cos_lon, (north, east, -up)))
    air_I = (carried[0] - spin * r_I[1], carried[1] + spin * r_I[0], carried[2])
    return (c, s), place, gas, (north, east, -up), air_I, rotate_z(c, -s, g_F)
