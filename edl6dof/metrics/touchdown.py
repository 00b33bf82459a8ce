"""State at first ground contact and the ground under the landing gear, from the located event and not from a
row of telemetry.
"""

from __future__ import annotations

from math import isfinite, pi, sqrt

import numpy as np

from edl6dof.config.units import DEG
from edl6dof.environment.landing_area.population import HEIGHT, within
from edl6dof.environment.landing_area.relief import GENERATED
from edl6dof.environment.terrain import place_of
from edl6dof.fsw.control.attitude_error import decoupled_error, goal_attitude
from edl6dof.kernels import kernel
from edl6dof.metrics.figures import from_si
from edl6dof.spatial.elementary import acos, atan, atan2, cos, hypot, sin
from edl6dof.spatial.frames import fixed_to_ned, geodetic, ned_to_fixed, rotate_z, to_local
from edl6dof.spatial.quaternion import axes, from_frame
from edl6dof.spatial.table_index import endless_cell
from edl6dof.spatial.vector import clamp, dot, norm, sub, take3
from edl6dof.vehicle.landing_gear import contact_point, ground_at_offset, north_east_of
from edl6dof.vehicle.plant import POSITION, RATE, VELOCITY, take_attitude
from edl6dof.vehicle.surroundings import planet_rotation


def touchdown_state(cases: np.ndarray, plants: np.ndarray) -> dict[str, float]:
    """Velocity, attitude errors, rates and place at first contact; empty when there was none.

    Attitude errors are those of S1: roll to the local geographic frame (y of B south), pitch and yaw of the
    thrust axis from the vertical, as a rotation vector in B.

    Args:
        cases: the truth of the flight, shape (1,).
        plants: its plant, shape (1,).
    """
    if not isfinite(plants["touchdown_time"][0]):
        return {}
    return from_si("contact", _contact(cases, plants))


@kernel
def _contact(cases, plants):
    """The figures of contact in their order, SI."""
    case, plant = cases[0], plants[0]
    t, y, planet = plant.touchdown_time, plant.touchdown, case.planet
    spin = planet.rotation_rate
    c, s = cos(spin * t), sin(spin * t)
    r, v, w = take3(y, POSITION), take3(y, VELOCITY), take3(y, RATE)
    q = take_attitude(y)
    r_F = rotate_z(c, s, r)
    sl, cl, so, co, _ = geodetic(planet.equatorial_radius, planet.flattening, r_F)
    north, east, down = fixed_to_ned(
        sl, cl, so, co, rotate_z(c, s, (v[0] + spin * r[1], v[1] - spin * r[0], v[2]))
    )
    north_I = rotate_z(c, -s, ned_to_fixed(sl, cl, so, co, (1.0, 0.0, 0.0)))
    east_I = rotate_z(c, -s, ned_to_fixed(sl, cl, so, co, (0.0, 1.0, 0.0)))
    up_I = rotate_z(c, -s, ned_to_fixed(sl, cl, so, co, (0.0, 0.0, -1.0)))
    error = decoupled_error(q, goal_attitude(north_I, east_I, up_I, up_I))
    forward, _, _ = axes(q)
    site = to_local(case.site, r_F)
    return (
        t, down, hypot(north, east),
        error[0], error[1], error[2], acos(clamp(-dot(forward, up_I), -1.0, 1.0)),
        w[0], w[1], w[2], norm(w),
        atan2(hypot(plant.inputs.ground_slope[0], plant.inputs.ground_slope[1]), 1.0),
        atan2(sl, cl), atan2(so, co),
        site[0], site[1], hypot(site[0], site[1]),
    )  # fmt: skip


#: Radius (m) of the footprint.
FOOTPRINT = sqrt(12.6 / pi)
#: Smallest diameter (m) of rocks that are counted: they are half as high.
COUNTED = 0.5


def touchdown_terrain_figures(
    cases: np.ndarray, tables: np.ndarray, plants: np.ndarray, outputs: np.ndarray
) -> dict[str, float]:
    """Figures of the ground under a vehicle that has met it; empty where the landing area is not generated,
    or the vehicle has no legs out.  All arguments have shape (1,).
    """
    case, plant = cases[0], plants[0]
    generated = case["terrain"]["landing_area"]["model"] == GENERATED
    gear = case["vehicle"]["landing_gear"]
    if not (generated and isfinite(plant["touchdown_time"]) and plant["legs"] and gear["n_footpads"] >= 3):
        return {}
    slope, values = _footing(cases, tables, plants, outputs)
    figures = {"touchdown_slope_deg": slope * (1.0 / DEG), **from_si("footing", values)}
    if gear["n_underside"] == 0:
        del figures["ground_under_belly_m"], figures["belly_clearance_m"]
    return figures


@kernel
def _footing(cases, tables, plants, outputs):
    case, plant, out = cases[0], plants[0], outputs[0]
    terrain, rotation = case.terrain, planet_rotation(case.planet, plant.t)
    q = take_attitude(plant.y)
    north, east = place_of(terrain, out.latitude, out.longitude)
    rocks, _ = within(terrain.landing_area.rocks, north, east, FOOTPRINT, COUNTED)
    _, largest = within(terrain.landing_area.rocks, north, east, FOOTPRINT, 0.0)
    plane = plane_of_footpads(case, tables[0], out, q, rotation)
    reach, clearance = under_belly(case, tables=tables[0], outputs=out, q=q, rotation=rotation, plane=plane)
    return atan(hypot(plane[1], plane[2])), (float(rocks), largest, HEIGHT * largest, reach, clearance)


@kernel
def plane_of_footpads(case, tables, outputs, q, rotation):
    """The plane nearest to the ground under the footpads, by least squares: elevation (m) below the centre of
    mass, and rise per metre towards north and east.
    """
    gear, n = case.vehicle.landing_gear, float(case.vehicle.landing_gear.n_footpads)
    sy = sx = sz = syy = syx = sxx = syz = sxz = 0.0
    for k in range(gear.n_footpads):
        arm = sub(contact_point(gear, k), take3(outputs.centre, 0))
        y, x = north_east_of(outputs, q, rotation, arm)
        z = ground_at_offset(case, tables, outputs, y, x)[0]
        sy, sx, sz = sy + y, sx + x, sz + z
        syy, syx, sxx = syy + y * y, syx + y * x, sxx + x * x
        syz, sxz = syz + y * z, sxz + x * z
    yy, yx, xx = syy - sy * sy / n, syx - sy * sx / n, sxx - sx * sx / n
    yz, xz = syz - sy * sz / n, sxz - sx * sz / n
    inverse = 1.0 / (yy * xx - yx * yx)
    north, east = (xx * yz - yx * xz) * inverse, (yy * xz - yx * yz) * inverse
    return (sz - north * sy - east * sx) / n, north, east


@kernel
def under_belly(case, tables, outputs, q, rotation, plane):
    """Below the underside, at the nodes of the lattice and along its edge: how far the ground rises above the
    ``plane`` of the footpads at most, and how much is left between it and the underside at least, m.
    """
    gear, out, step = case.vehicle.landing_gear, outputs, case.terrain.landing_area.cell
    lowest, radius = -1e9, 0.0
    for k in range(gear.n_underside):
        point = gear.underside[k]
        lowest, radius = max(lowest, point[0]), max(radius, hypot(point[1], point[2]))
    centre = take3(out.centre, 0)
    middle = _in_N(out, q, rotation, (lowest - centre[0], -centre[1], -centre[2]))
    along = _in_N(out, q, rotation, (1.0, 0.0, 0.0))
    reach, clearance = -1e9, 1e9
    north, east = place_of(case.terrain, out.latitude, out.longitude)
    first, left = (
        endless_cell((north + middle[0] - radius) / step),
        endless_cell((east + middle[1] - radius) / step),
    )
    count = endless_cell(2.0 * radius / step) + 2
    for i in range(first, first + count):
        for j in range(left, left + count):
            y, x = i * step - north, j * step - east
            if (y - middle[0]) ** 2 + (x - middle[1]) ** 2 <= radius * radius:
                rise, left_over = _below(case, tables, out, plane, middle, along=along, y=y, x=x)
                reach, clearance = max(reach, rise), min(clearance, left_over)
    around = endless_cell(2.0 * pi * radius / step) + 1
    for k in range(around):
        angle = 2.0 * pi * k / around
        y, x = middle[0] + radius * cos(angle), middle[1] + radius * sin(angle)
        rise, left_over = _below(case, tables, out, plane, middle, along=along, y=y, x=x)
        reach, clearance = max(reach, rise), min(clearance, left_over)
    return reach, clearance


@kernel
def _below(case, tables, out, plane, middle, along, y, x):
    """At a place (m north and east of the centre of mass): how far the ground rises above the ``plane`` of
    the footpads, and what is left between it and the underside, m.
    """
    elevation = ground_at_offset(case, tables, out, y, x)[0]
    down = middle[2] - dot(along, (y - middle[0], x - middle[1], 0.0)) / along[2]
    rise = elevation - plane[0] - plane[1] * y - plane[2] * x
    return rise, out.height - down - (elevation - out.elevation)


@kernel
def _in_N(outputs, q, rotation, v_B):
    """A vector of B in north, east, down."""
    out, v_F = outputs, rotate_z(rotation[0], rotation[1], from_frame(q, v_B))
    return fixed_to_ned(out.sin_lat, out.cos_lat, out.sin_lon, out.cos_lon, v_F)
