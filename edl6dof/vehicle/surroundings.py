"""Planet and air at the place of a body: the vehicle, or a part that has left it."""

from __future__ import annotations

from edl6dof.environment.atmosphere import air
from edl6dof.environment.gravity import central, noncentral_F
from edl6dof.environment.wind import wind
from edl6dof.kernels import inlined_kernel, kernel
from edl6dof.spatial.elementary import sincos
from edl6dof.spatial.frames import geodetic, ned_to_fixed, rotate_z
from edl6dof.spatial.vector import add, dot, take3


@kernel
def planet_rotation(planet, t):
    """Cosine and sine of the angle by which the planet has turned since t = 0, at time ``t`` (s)."""
    angle = planet.rotation_rate * t
    s, c = sincos(angle)
    return c, s


@inlined_kernel
def surroundings(case, tables, areoid, rotation, r_I):
    """Find place, gas and wind at the point ``r_I`` (m) at the time of ``rotation``
    (:func:`planet_rotation`); ``areoid``: plane of the height of the areoid, as in ``inputs``.

    Returns:
        place: sine and cosine of geodetic latitude and of longitude, altitude, and height above the areoid
            (m).
        gas: density (kg/m3), pressure (Pa), temperature (K), speed of sound (m/s).
        wind_N: wind towards north, east, down (m/s).
        air_I: velocity of the air, rotation of the planet included (m/s).
    """
    planet = case.planet
    c, s = rotation
    r_F = rotate_z(c, s, r_I)
    sin_lat, cos_lat, sin_lon, cos_lon, altitude = geodetic(planet.equatorial_radius, planet.flattening, r_F)
    height = altitude - (dot(take3(areoid, 0), r_F) + areoid[3])
    gas = air(case.atmosphere, planet.gas, tables.atmosphere, height)
    east, north, up = wind(case.wind, tables.atmosphere, height)
    carried = rotate_z(c, -s, ned_to_fixed(sin_lat, cos_lat, sin_lon, cos_lon, (north, east, -up)))
    spin = planet.rotation_rate
    air_I = (carried[0] - spin * r_I[1], carried[1] + spin * r_I[0], carried[2])
    place = (sin_lat, cos_lat, sin_lon, cos_lon, altitude, height)
    return place, gas, (north, east, -up), air_I


@kernel
def noncentral_I(planet, rotation, r_I):
    """Noncentral part of gravitation (I, m/s2) at ``r_I`` (m) on a planet turned by ``rotation``."""
    c, s = rotation
    return rotate_z(c, -s, noncentral_F(planet.gravity, rotate_z(c, s, r_I)))


@kernel
def gravity(field, inputs, r_I):
    """Gravitation (I, m/s2) at ``r_I`` (m): central term there, noncentral part from ``inputs``."""
    return add(central(field, r_I), take3(inputs.noncentral_I, 0))
