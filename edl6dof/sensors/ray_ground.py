"""Intersection of a ray with the ground, or with a nearer part that has left the vehicle.

All vectors are in the planet-fixed frame F except those of the parts, whose positions and velocities are
inertial. Source: false lock of a landing radar on its jettisoned heat shield: Chen and Pollard, IEEE
Aerospace Conference (2014).
"""

from __future__ import annotations

from math import sqrt

from edl6dof.environment.terrain import ground
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import atan2, cos
from edl6dof.spatial.frames import geodetic, ned_to_fixed, rotate_z
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import add, cross, dot, norm, scale, sub, take3
from edl6dof.vehicle.plant import ATTITUDE, POSITION, RATE, VELOCITY

#: Cosine of the angle to straight down beyond which a beam goes past the ground.
_LEVEL = 0.05
#: Iterations of the intersection; the error left is below a millimetre.
_ITERATIONS = 3


@kernel
def point_motion(case, plant, outputs, position, rotation):
    """Position, and velocity relative to the rotating planet, (F) of a point of the body at ``position`` (m,
    B); ``rotation`` is that of the planet.
    """
    c, s = rotation
    y = plant.y
    q = (y[ATTITUDE], y[ATTITUDE + 1], y[ATTITUDE + 2], y[ATTITUDE + 3])
    arm = sub(position, take3(outputs.centre, 0))
    r = add(take3(y, POSITION), from_frame(q, arm))
    v = add(take3(y, VELOCITY), from_frame(q, cross(take3(y, RATE), arm)))
    spin = case.planet.rotation_rate
    relative = (v[0] + spin * r[1], v[1] - spin * r[0], v[2])
    return rotate_z(c, s, r), rotate_z(c, s, relative)


@kernel
def height_over_ground(case, tables, areoid, r_F):
    """Height (m) of a point above the ground below it, and the upward normals of the ellipsoid and of the
    ground there.
    """
    planet = case.planet
    sin_lat, cos_lat, sin_lon, cos_lon, altitude = geodetic(planet.equatorial_radius, planet.flattening, r_F)
    lat, lon = atan2(sin_lat, cos_lat), atan2(sin_lon, cos_lon)
    elevation, north, east = ground(case.terrain, tables.terrain, lat, lon)
    below = dot(take3(areoid, 0), r_F) + areoid[3] + elevation
    up = ned_to_fixed(sin_lat, cos_lat, sin_lon, cos_lon, (0.0, 0.0, -1.0))
    inverse = 1.0 / sqrt(1.0 + north * north + east * east)
    leaning = (-north * inverse, -east * inverse, -inverse)
    return altitude - below, up, ned_to_fixed(sin_lat, cos_lat, sin_lon, cos_lon, leaning)


@kernel
def ray_to_ground(case, tables, areoid, r_F, beam_F, height, up_F):
    """Range (m) from ``r_F`` along the unit vector ``beam_F`` to the ground, and the cosine of the incidence
    there; both 0 where the beam goes past it.  ``height`` and ``up_F`` are those at ``r_F``.

    First down the slope of the beam, then by the secant.
    """
    down = -dot(beam_F, up_F)
    if down < _LEVEL or height <= 0.0:
        return 0.0, 0.0
    before, clear_before = 0.0, height
    reach, incidence = height / down, down
    for _ in range(_ITERATIONS):
        clear, _, normal = height_over_ground(case, tables, areoid, add(r_F, scale(reach, beam_F)))
        incidence = -dot(beam_F, normal)
        fall = (clear_before - clear) / (reach - before)
        if fall <= 0.0:
            return 0.0, 0.0
        before, clear_before, reach = reach, clear, reach + clear / fall
        if abs(reach - before) < 1e-4:
            break
    return max(reach, 0.0), max(incidence, 0.0)


@kernel
def ray_to_part(lobes, plant, rotation, r_F, v_F, beam_F, ground_range, spin):
    """Range (m) and closing speed (m/s) of the nearest part that the beam takes for the ground; range 0 for
    none.

    A part nearer than the ground is seen in the main lobe from anywhere, in a side lobe from close by.
    """
    c, s = rotation
    nearest, closing = 0.0, 0.0
    for k in range(plant.debris.shape[0]):
        part = plant.debris[k]
        if part.active == 0:
            continue
        to_part = sub(rotate_z(c, s, take3(part.r_I, 0)), r_F)
        distance = norm(to_part)
        if distance <= 0.0 or (ground_range > 0.0 and distance >= ground_range):
            continue
        along = dot(beam_F, to_part) / distance
        lobe = lobes.side_lobe if distance < lobes.side_lobe_range else lobes.main_lobe
        if along >= cos(lobe) and (nearest == 0.0 or distance < nearest):
            r, v = take3(part.r_I, 0), take3(part.v_I, 0)
            moving = rotate_z(c, s, (v[0] + spin * r[1], v[1] - spin * r[0], v[2]))
            nearest, closing = distance, dot(sub(v_F, moving), to_part) / distance
    return nearest, closing
