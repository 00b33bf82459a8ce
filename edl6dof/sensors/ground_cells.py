"""The ground that each cell of an image shows: where the looks along its corners meet it, how large and how
steep it is there.

Looks meet the ground without what is generated on it, which is low at the heights that images are taken from;
that then gives the heights of the corners.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from edl6dof.environment.terrain import geodetic_of, ground, regional
from edl6dof.interface.capacities import CAMERA_CELLS
from edl6dof.interface.eyes import look
from edl6dof.kernels import kernel
from edl6dof.records import FLAG
from edl6dof.sensors.patch import LEVEL
from edl6dof.sensors.sight import along
from edl6dof.spatial.vector import cross, put3, sub, take3

CORNERS = CAMERA_CELLS + 1
#: Looks at the ground on the way to where a corner meets it, at most: each leaves an error smaller than the
#: one before by the slope of the ground times the tangent of the ray's angle to the vertical.
_LOOKS = 5
#: Change of the way (m) below which there is none more.
_CLOSE = 1e-6

GROUND_CELLS = np.dtype(
    [
        ("place", "f8", (CORNERS, CORNERS, 3)),  # m north, east and above the site, of each corner
        ("met", FLAG, (CORNERS, CORNERS)),  # whether it shows ground
    ],
    align=True,
)


@kernel
def lay_cells(case, tables, origin, axes, height, tangent, reach, cells):
    """Find the ground that the corners show, up to ``reach`` (m); origin, axes and height are those of
    :func:`~edl6dof.sensors.sight.sight`.
    """
    terrain = case.terrain
    for i in range(CORNERS):
        for j in range(CORNERS):
            ray = along(axes, look(tangent, CAMERA_CELLS, i - 0.5, j - 0.5))
            cells.met[i, j] = 0
            if not (height > 0.0 and ray[2] < -LEVEL):
                continue
            way = -height / ray[2]
            for _ in range(_LOOKS):
                lat, lon = geodetic_of(terrain, origin[0] + way * ray[0], origin[1] + way * ray[1])
                level = regional(terrain, tables.terrain, lat, lon)[0] - terrain.site_elevation
                before, way = way, (level - origin[2]) / ray[2]
                if abs(way - before) < _CLOSE:
                    break
            if 0.0 < way <= reach:
                y, x = origin[0] + way * ray[0], origin[1] + way * ray[1]
                lat, lon = geodetic_of(terrain, y, x)
                level = ground(terrain, tables.terrain, lat, lon)[0] - terrain.site_elevation
                put3(cells.place[i, j], 0, (y, x, level))
                cells.met[i, j] = 1


@kernel
def shows_ground(cells, i, j):
    """Whether all of the cell (``i``, ``j``) shows ground."""
    return cells.met[i, j] + cells.met[i, j + 1] + cells.met[i + 1, j] + cells.met[i + 1, j + 1] == 4


@kernel
def extent(cells, i, j):
    """Area (m2, seen from above) of a cell on the ground, and the tangent of its slope."""
    normal = cross(
        sub(take3(cells.place[i + 1, j + 1], 0), take3(cells.place[i, j], 0)),
        sub(take3(cells.place[i + 1, j], 0), take3(cells.place[i, j + 1], 0)),
    )
    return 0.5 * abs(normal[2]), sqrt(normal[0] * normal[0] + normal[1] * normal[1]) / abs(normal[2])


@kernel
def middle(cells, i, j):
    """Middle of a cell on the ground: m north, east and above the site."""
    place = cells.place
    return (
        0.25 * (place[i, j, 0] + place[i, j + 1, 0] + place[i + 1, j, 0] + place[i + 1, j + 1, 0]),
        0.25 * (place[i, j, 1] + place[i, j + 1, 1] + place[i + 1, j, 1] + place[i + 1, j + 1, 1]),
        0.25 * (place[i, j, 2] + place[i, j + 1, 2] + place[i + 1, j, 2] + place[i + 1, j + 1, 2]),
    )


@kernel
def span(cells, i, j, k):
    """Least and most of coordinate ``k`` among the corners of a cell."""
    a, b = cells.place[i, j, k], cells.place[i, j + 1, k]
    c, d = cells.place[i + 1, j, k], cells.place[i + 1, j + 1, k]
    return min(min(a, b), min(c, d)), max(max(a, b), max(c, d))
