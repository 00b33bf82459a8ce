"""Imagers (landing camera, lidar, stereo cameras): misalignment, line of sight, the ground in view, and the
parts of the vehicle that hide it.

The true directions of an imager are turned by a small rotation from those that the flight computer assumes.
Places on the ground are those of the landing area: metres north and east of the site, and metres above its
elevation.  They are straight over the hundred metres that an imager sees at once; the curvature of the planet
makes less than a tenth of a millimetre there.

Parts that have left the vehicle hide the ground as discs as large as their drag areas: the drag area of a
backshell or of a canopy is about the area of its silhouette (drag coefficients of 1.0 to 1.2, and 0.62 of a
nominal area of which an open canopy shows 0.6).  A canopy that left with a part hangs above it at the length
of its lines.
"""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

from edl6dof.config.base import Hardware, param
from edl6dof.config.dtype import in_si
from edl6dof.environment.terrain import ground, place_of
from edl6dof.interface.capacities import MAX_PARTS
from edl6dof.kernels import kernel
from edl6dof.records import record, whole
from edl6dof.sensors.ray_ground import LEVEL, clear_tile, lay_tile, point_motion
from edl6dof.spatial.elementary import atan2
from edl6dof.spatial.frames import fixed_to_ned, geodetic, rotate_z
from edl6dof.spatial.quaternion import from_frame, multiply, normalise, to_frame
from edl6dof.spatial.random_numbers import Stream
from edl6dof.spatial.vector import add, cross, dot, norm, put3, scale, sub, take3, unit
from edl6dof.vehicle.mass import CONFIG_CAPSULE
from edl6dof.vehicle.parachutes.parachute import RELEASED
from edl6dof.vehicle.plant import POSITION, take_attitude
from edl6dof.vehicle.surroundings import planet_rotation


@kernel
def imager_attitude(plant, turn):
    """Attitude in I of the axes of an imager that is turned relative to B by ``turn`` (rad, B, small)."""
    y = plant.y
    q = take_attitude(y)
    return normalise(multiply(q, (1.0, 0.5 * turn[0], 0.5 * turn[1], 0.5 * turn[2])))


@kernel
def imager_pose(case, tables, plant, outputs, position, turn):
    """Place and axes over the ground of an imager at ``position`` (m, B) that is turned relative to B by
    ``turn`` (rad, B, small).

    Returns:
        origin: m north and east of the site, and above it.
        axes: of the imager (those of B but for the turn), each in m north, east and up for a metre along it.
        height: m above the ground below.
    """
    planet, areoid = case.planet, plant.inputs.areoid
    c, s = planet_rotation(planet, plant.t)
    r, _ = point_motion(case, plant, outputs, position, (c, s))
    vertical = geodetic(planet.equatorial_radius, planet.flattening, r)
    lat, lon = atan2(vertical[0], vertical[1]), atan2(vertical[2], vertical[3])
    north, east = place_of(case.terrain, lat, lon)
    above = vertical[4] - dot(take3(areoid, 0), r) - areoid[3]
    height = above - ground(case.terrain, tables.terrain, lat, lon)[0]
    # half way down, where a metre is as long as on the mean of a ray
    stretch = places_per_metre(case.terrain, planet, vertical[0], vertical[1], vertical[4] - 0.5 * height)
    q = imager_attitude(plant, turn)
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
def ground_direction(axes, look_B):
    """Direction of B in m north, east and up for a metre along it."""
    x, y, z = axes
    return (
        look_B[0] * x[0] + look_B[1] * y[0] + look_B[2] * z[0],
        look_B[0] * x[1] + look_B[1] * y[1] + look_B[2] * z[1],
        look_B[0] * x[2] + look_B[1] * y[2] + look_B[2] * z[2],
    )


@kernel
def reciprocal_axes(axes):
    """Vectors whose products with a displacement (m north, east and up) are its components along the axes:
    places are slightly skewed relative to the axes where the areoid is no sphere.
    """
    x, y, z = axes
    inverse = 1.0 / dot(x, cross(y, z))
    return scale(inverse, cross(y, z)), scale(inverse, cross(z, x)), scale(inverse, cross(x, y))


@kernel
def places_per_metre(terrain, planet, sin_lat, cos_lat, altitude):
    """Return the change of the map coordinates north and east for a displacement of one metre north and of
    one metre east, at an ``altitude`` (m above the ellipsoid) and the latitude of ``sin_lat`` and
    ``cos_lat``.

    Map coordinates of the terrain are the differences of latitude and longitude from the site, times the
    lengths of a radian at the site. A metre of map coordinates is therefore a metre at the site; elsewhere,
    and higher up, the two lengths differ.
    """
    e2 = planet.flattening * (2.0 - planet.flattening)
    root = sqrt(1.0 - e2 * sin_lat * sin_lat)
    prime = planet.equatorial_radius / root
    meridian = prime * (1.0 - e2) / (root * root)
    return terrain.metres_north / (meridian + altitude), terrain.metres_east / ((prime + altitude) * cos_lat)


class ImagerParams(Hardware):
    """Parameters that all imagers have."""

    misalignment_deg: float = param(
        0.02,
        "error of its direction about each axis, drawn for each case",
        status="estimate",
        ge=0.0,
        le=10.0,
    )


#: Errors of an imager in this case: misalignment, a small rotation in B (rad); constant error of its ranges
#: (m); key of its noise.
IMAGER_UNIT = record(("turn", "f8", (3,)), ("bias", "f8"), ("key", "i8"))


def draw_imager(params: ImagerParams, rng: Stream, unit: np.void) -> None:
    """Draw the misalignment of an imager in this case, and the key of its noise."""
    unit["turn"] = in_si(params)["misalignment"] * rng.standard_normal(3)
    unit["key"] = rng.keys()


@kernel
def view_range(params, plant):
    """Distance (m) up to which an imager sees: 0 behind the heat shield."""
    return params.longest if plant.shape != CONFIG_CAPSULE else 0.0


@kernel
def lay_tile_in_view(case, tables, origin, axes, height, reach, tile):
    """Fill the tile with the ground in view, up to ``reach`` (m) from the pose of :func:`imager_pose`."""
    ahead = axes[0]
    way = height / max(-ahead[2], LEVEL)
    if way <= reach:
        lay_tile(case, tables, origin[0] + way * ahead[0], origin[1] + way * ahead[1], tile)
    else:
        clear_tile(tile)


#: Largest number of discs: one for each part, and one for the canopy above it.
_MOST = 2 * MAX_PARTS
DISCS = record(
    ("n", whole(0, _MOST)),
    ("to", "f8", (_MOST, 3)),  # m: from the imager to the middle, along its own axes
    ("radius", "f8", (_MOST,)),  # m
)


@kernel
def find_discs(case, plant, outputs, position, turn, discs):
    """List the discs of the parts that have left the vehicle, for an imager as in :func:`imager_pose`."""
    y, spin, chute = plant.y, case.planet.rotation_rate, plant.parachute
    q = take_attitude(y)
    place = add(take3(y, POSITION), from_frame(q, sub(position, take3(outputs.centre, 0))))
    axes = imager_attitude(plant, turn)
    discs.n = 0
    for k in range(case.vehicle.n_parts):
        part, r, v = plant.debris[k], take3(plant.debris[k].r_I, 0), take3(plant.debris[k].v_I, 0)
        if part.active == 0:
            continue
        own, to_part = part.drag_area, sub(r, place)
        if plant.canopy == RELEASED and k == case.suspension[chute].carrier:
            own = min(own, case.vehicle.parts[k].drag_area)
            above = unit((-v[0] - spin * r[1], -v[1] + spin * r[0], -v[2]))
            middle = add(to_part, scale(case.vehicle.parachutes[chute].line_length, above))
            _note(axes, middle, part.drag_area - own, discs)
        _note(axes, to_part, own, discs)


@kernel
def _note(axes, to_middle, area, discs):
    """Add a disc of this area (m2) at a place (m, I, from the imager) for an imager of this attitude."""
    if area > 0.0:
        put3(discs.to[discs.n], 0, to_frame(axes, to_middle))
        discs.radius[discs.n] = sqrt(area / pi)
        discs.n += 1


@kernel
def is_hidden(discs, direction):
    """Test whether a disc lies along ``direction``, a unit vector of the imager's own axes."""
    for k in range(discs.n):
        to = take3(discs.to[k], 0)
        distance, radius = norm(to), discs.radius[k]
        if distance <= radius:
            return True
        share = radius / distance
        if dot(to, direction) >= distance * sqrt(1.0 - share * share):
            return True
    return False
