"""Square tile of ground for ray tracing: heights on a lattice, with a bilinear surface between them.

A ray walks from cell to cell of the lattice below its highest node, and meets the surface of a cell where a
quadratic in the distance along it has its first root: exact, whatever stands on the ground. Source of the
walk: Amanatides and Woo, A fast voxel traversal algorithm for ray tracing, Eurographics 1987; of the bilinear
surface: Ramsey, Potter and Hansen, Ray bilinear patch intersections, Journal of Graphics Tools 9(3), 2004.
"""

from __future__ import annotations

from math import copysign, sqrt

import numpy as np

from edl6dof.environment.landing_area.raster import RASTER_WORK, lay_raster
from edl6dof.kernels import kernel
from edl6dof.spatial.table_index import cell

#: Nodes along each side.
TILE_NODES = 512

#: Ground by place: m north, east and above the site.
GROUND_TILE = np.dtype(
    [
        ("heights", "f4", (TILE_NODES, TILE_NODES)),  # m, by place to the north and to the east
        ("north", "f8"),  # m: of the first node
        ("east", "f8"),
        ("cell", "f8"),  # m: from node to node
        ("top", "f8"),  # m: the highest node
        ("work", RASTER_WORK),
    ],
    align=True,
)

#: How much the sine of a ray's dip must be at least; flatter ones are taken to meet no ground.
LEVEL = 0.05
#: Way (m) to a line of the lattice for a ray along it.
_NEVER = 1e30


@kernel
def lay_tile(case, tables, north, east, tile):
    """Lay a tile of the ground around a place (m north and east of the site)."""
    tile.cell = case.terrain.landing_area.cell
    half = 0.5 * (TILE_NODES - 1) * tile.cell
    tile.north, tile.east = lay_raster(
        case.terrain,
        grid=tables.terrain,
        north=north - half,
        east=east - half,
        heights=tile.heights,
        work=tile.work,
    )
    top = tile.heights[0, 0]
    for i in range(TILE_NODES):
        for j in range(TILE_NODES):
            top = max(top, tile.heights[i, j])
    tile.top = top


@kernel
def clear_tile(tile):
    """Leave no ground for rays to meet."""
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
    """Side to which a ray crosses the lines of the lattice, way to the first one and from one to the next.

    Args:
        share: place in the cell, 0 .. 1.
        speed: cells for each metre along the ray.
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
