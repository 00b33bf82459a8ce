"""Intersection of a ray with the ground, or with a nearer part that has left the vehicle.

The ground is the true one, or a square tile of it for many rays: heights on a lattice, with a bilinear
surface between them.  A ray walks from cell to cell of the lattice below its highest node, and meets the
surface of a cell where a quadratic in the distance along it has its first root: exact, with rocks on the
ground too.

Vectors of beams are in the planet-fixed frame F, except those of the parts, whose positions and velocities
are inertial; rays on a tile are in m north, east and up.

Sources: false lock of a landing radar on its jettisoned heat shield: Chen and Pollard, IEEE Aerospace
Conference (2014); walk: Amanatides and Woo, A fast voxel traversal algorithm for ray tracing, Eurographics
1987; bilinear surface: Ramsey, Potter and Hansen, Ray bilinear patch intersections, Journal of Graphics Tools
9(3), 2004.
"""

from __future__ import annotations

from math import copysign, sqrt

from edl6dof.environment.landing_area.raster import RASTER_WORK, lay_raster
from edl6dof.environment.terrain import ground
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.spatial.elementary import atan2, cos
from edl6dof.spatial.frames import geodetic, ned_to_fixed, rotate_z
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.table_index import cell
from edl6dof.spatial.vector import add, cross, dot, norm, scale, sub, take3
from edl6dof.vehicle.plant import POSITION, RATE, VELOCITY, take_attitude

#: Least sine of the dip of a ray; flatter ones are taken to meet no ground.
LEVEL = 0.05
#: Iterations of the intersection; the error left is below a millimetre.
_ITERATIONS = 3


@kernel
def point_motion(case, plant, outputs, position, rotation):
    """Position, and velocity over the turning planet, (F) of a point of the body at ``position`` (m, B)."""
    c, s = rotation
    y = plant.y
    q = take_attitude(y)
    arm = sub(position, take3(outputs.centre, 0))
    r = add(take3(y, POSITION), from_frame(q, arm))
    v = add(take3(y, VELOCITY), from_frame(q, cross(take3(y, RATE), arm)))
    spin = case.planet.rotation_rate
    relative = (v[0] + spin * r[1], v[1] - spin * r[0], v[2])
    return rotate_z(c, s, r), rotate_z(c, s, relative)


@kernel
def height_over_ground(case, tables, areoid, r_F):
    """Height (m) of a point above the ground, and the upward normals of ellipsoid and ground below it."""
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
    """Return the range (m) from ``r_F`` along the unit vector ``beam_F`` to the ground, and the cosine of the
    angle of incidence there; both are 0 if the beam misses the ground. The first step follows the slope of
    the beam, the next ones the secant method.
    """
    down = -dot(beam_F, up_F)
    if down < LEVEL or height <= 0.0:
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
    """Return the range (m) and closing speed (m/s) of the nearest separated part that the beam takes for the
    ground; range 0 if there is none. Such a part is nearer than the ground and in the main lobe, or close by
    and in a side lobe.
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


#: Nodes along each side.
TILE_NODES = 512

#: Ground by place: m north, east and above the site.
GROUND_TILE = record(
    ("heights", "f4", (TILE_NODES, TILE_NODES)),  # m, by place to the north and to the east
    ("north", "f8"),  # m: of the first node
    ("east", "f8"),
    ("cell", "f8"),  # m: from node to node
    ("top", "f8"),  # m: the highest node
    ("work", RASTER_WORK),
)

#: Distance (m) to the next line of the lattice for a ray parallel to the lines.
_NEVER = 1e30


@kernel
def lay_tile(case, tables, north, east, tile):
    """Fill a tile with the ground around a place (m north and east of the site)."""
    tile.cell = case.terrain.landing_area.cell
    half = 0.5 * (TILE_NODES - 1) * tile.cell
    tile.north, tile.east = lay_raster(
        case.terrain, tables.terrain, north - half, east - half, tile.heights, work=tile.work
    )
    top = tile.heights[0, 0]
    for i in range(TILE_NODES):
        for j in range(TILE_NODES):
            top = max(top, tile.heights[i, j])
    tile.top = top


@kernel
def clear_tile(tile):
    """Empty a tile, so that no ray meets ground."""
    tile.top = -_NEVER


@kernel
def trace_ray(tile, origin, ray, reach):
    """Distance (m) along a ray to the ground, and the cosine of its incidence there; both 0 where it leaves
    the tile or its ``reach`` (m) first.

    Args:
        tile: ``GROUND_TILE`` record.
        origin: where the ray begins: m north, east and above the site.
        ray: m north, east and up for each metre along it.
        reach: m.
    """
    if not ray[2] < -LEVEL:
        return 0.0, 0.0
    # from where it comes below the highest node; places counted in cells from the first node
    before = max((tile.top - origin[2]) / ray[2], 0.0)
    inverse, last = 1.0 / tile.cell, TILE_NODES - 1
    x, y, dz = ray[0] * inverse, ray[1] * inverse, ray[2]
    u = (origin[0] - tile.north) * inverse + before * x
    v = (origin[1] - tile.east) * inverse + before * y
    z = origin[2] + before * dz
    if not (0.0 <= u < last and 0.0 <= v < last and before <= reach):
        return 0.0, 0.0
    (i, from_i), (j, from_j) = cell(u, last), cell(v, last)
    step_i, next_i, pause_i = _lines(from_i, x)
    step_j, next_j, pause_j = _lines(from_j, y)
    entered = 0.0
    while 0 <= i < last and 0 <= j < last and before + entered <= reach:
        left = min(next_i, next_j)
        a, b = float(tile.heights[i, j]), float(tile.heights[i, j + 1])
        c, d = float(tile.heights[i + 1, j]), float(tile.heights[i + 1, j + 1])
        if z + left * dz <= max(max(a, b), max(c, d)):
            way = _meet((a, b, c, d), (u - i, v - j, z), (x, y, dz), (entered, left))
            if way >= 0.0:
                p, q = u - i + way * x, v - j + way * y
                north = ((c - a) * (1.0 - q) + (d - b) * q) * inverse
                east = ((b - a) * (1.0 - p) + (d - c) * p) * inverse
                falling = north * ray[0] + east * ray[1] - dz
                return before + way, falling / sqrt(1.0 + north * north + east * east)
        if next_i < next_j:
            i, next_i = i + step_i, next_i + pause_i
        else:
            j, next_j = j + step_j, next_j + pause_j
        entered = left
    return 0.0, 0.0


@kernel
def _lines(share, speed):
    """Step (1 or -1) of a ray from cell to cell along an axis of the lattice, and the distances (m) to the
    first line and between lines; ``share``: place in the first cell (0..1), ``speed``: cells per metre of the
    ray.
    """
    if speed > 0.0:
        return 1, (1.0 - share) / speed, 1.0 / speed
    if speed < 0.0:
        return -1, -share / speed, -1.0 / speed
    return 1, _NEVER, _NEVER


@kernel
def _meet(nodes, start, ray, span):
    """Way (m) along a ray to the surface of a cell; -1 if it does not meet it within the cell.

    Args:
        nodes: heights of the nodes of the cell (m): first, east, north, both.
        start: of the ray: cells north and east of the first node, height (m).
        ray: cells north and east, and metres up, for each metre along it.
        span: ways (m) at which the ray enters and leaves the cell.
    """
    (a, b, c, d), (p, q, z), (x, y, dz), (entered, left) = nodes, start, ray, span
    north, east, twist = c - a, b - a, d - c - b + a
    constant = z - a - north * p - east * q - twist * p * q
    linear = dz - north * x - east * y - twist * (p * y + q * x)
    square = -twist * x * y
    if constant + entered * (linear + entered * square) <= 0.0:
        return entered  # rounding at the line between two cells
    inside = linear * linear - 4.0 * square * constant
    if inside < 0.0:
        return -1.0
    both = -0.5 * (linear + copysign(sqrt(inside), linear))
    way = _NEVER
    for root in (both / square if square != 0.0 else _NEVER, constant / both if both != 0.0 else _NEVER):
        if entered <= root <= left and root < way:
            way = root
    if way < _NEVER:
        return way
    # rounding again: below the surface where it leaves the cell
    return left if constant + left * (linear + left * square) <= 0.0 else -1.0
