"""Where an eye stands over the ground and how it looks at it, in the places of the landing area: metres north
and east of the site, and metres above its elevation.

These places are straight over the hundred metres that an eye sees at once; the curvature of the planet makes
less than a tenth of a millimetre there.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.environment.terrain import ground, place_of
from edl6dof.kernels import kernel
from edl6dof.sensors.echo import antenna
from edl6dof.spatial.elementary import atan2
from edl6dof.spatial.frames import fixed_to_ned, geodetic, rotate_z
from edl6dof.spatial.quaternion import from_frame, multiply, normalise
from edl6dof.spatial.vector import cross, dot, scale, take3
from edl6dof.vehicle.plant import ATTITUDE
from edl6dof.vehicle.surroundings import planet_rotation


@kernel
def eye_attitude(plant, turn):
    """Attitude in I of the axes of an eye that is turned against B by ``turn`` (rad, B, small)."""
    y = plant.y
    q = (y[ATTITUDE], y[ATTITUDE + 1], y[ATTITUDE + 2], y[ATTITUDE + 3])
    return normalise(multiply(q, (1.0, 0.5 * turn[0], 0.5 * turn[1], 0.5 * turn[2])))


@kernel
def sight(case, tables, plant, outputs, position, turn):
    """How an eye at ``position`` (m, B) is placed that is turned against B by ``turn`` (rad, B, small).

    Returns:
        origin: m north and east of the site, and above it.
        axes: its own (those of B but for the turn), each as m north, east and up for a metre along it.
        height: m above the ground below.
    """
    planet, areoid = case.planet, plant.inputs.areoid
    c, s = planet_rotation(planet, plant.t)
    r, _ = antenna(case, plant, outputs, position, (c, s))
    vertical = geodetic(planet.equatorial_radius, planet.flattening, r)
    lat, lon = atan2(vertical[0], vertical[1]), atan2(vertical[2], vertical[3])
    north, east = place_of(case.terrain, lat, lon)
    above = vertical[4] - dot(take3(areoid, 0), r) - areoid[3]
    height = above - ground(case.terrain, tables.terrain, lat, lon)[0]
    # half way down, where a metre is as long as on the mean of a ray
    stretch = places_per_metre(case.terrain, planet, vertical[0], vertical[1], vertical[4] - 0.5 * height)
    q = eye_attitude(plant, turn)
    axes = (
        _axis(rotate_z(c, s, from_frame(q, (1.0, 0.0, 0.0))), vertical, areoid, stretch),
        _axis(rotate_z(c, s, from_frame(q, (0.0, 1.0, 0.0))), vertical, areoid, stretch),
        _axis(rotate_z(c, s, from_frame(q, (0.0, 0.0, 1.0))), vertical, areoid, stretch),
    )
    return (north, east, above - case.terrain.site_elevation), axes, height


@kernel
def _axis(axis_F, vertical, areoid, stretch):
    """A unit vector (F) as m north, east and above the areoid for a metre along it."""
    north, east, down = fixed_to_ned(vertical[0], vertical[1], vertical[2], vertical[3], axis_F)
    return stretch[0] * north, stretch[1] * east, -down - dot(take3(areoid, 0), axis_F)


@kernel
def along(axes, look_B):
    """A direction of B as m north, east and up for a metre along it."""
    x, y, z = axes
    return (
        look_B[0] * x[0] + look_B[1] * y[0] + look_B[2] * z[0],
        look_B[0] * x[1] + look_B[1] * y[1] + look_B[2] * z[1],
        look_B[0] * x[2] + look_B[1] * y[2] + look_B[2] * z[2],
    )


@kernel
def across(axes):
    """Vectors whose products with a way (m north, east and up) are its parts along the axes: places are a
    little skewed against them, where the areoid is no sphere.
    """
    x, y, z = axes
    inverse = 1.0 / dot(x, cross(y, z))
    return scale(inverse, cross(y, z)), scale(inverse, cross(z, x)), scale(inverse, cross(x, y))


@kernel
def places_per_metre(terrain, planet, sin_lat, cos_lat, altitude):
    """Metres of place, which are true at the site, for a metre north and a metre east at an
    altitude (m).
    """
    e2 = planet.flattening * (2.0 - planet.flattening)
    root = sqrt(1.0 - e2 * sin_lat * sin_lat)
    prime = planet.equatorial_radius / root
    meridian = prime * (1.0 - e2) / (root * root)
    return terrain.metres_north / (meridian + altitude), terrain.metres_east / ((prime + altitude) * cos_lat)
