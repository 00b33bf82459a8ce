"""Density of obstacles in a camera image: the ground that a cell shows, and the share that obstacles cover.

Lines of sight along the corners of a cell are intersected with the ground without generated rocks and
craters, which are low at the heights that images are taken from; the generated surface then gives the heights
of the corners.  Rocks, craters with steep walls, and steep ground are obstacles.  Obstacles smaller than the
camera can resolve do not count, nor does a crater wider than the cell: its walls show in the slope of the
cells that lie on them.
"""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

from edl6dof.environment.landing_area.features import crater_height
from edl6dof.environment.landing_area.params import GENERATED
from edl6dof.environment.landing_area.population import cell_bits, drawn_in, first_cell, last_cell, member
from edl6dof.environment.terrain import geodetic_of, ground, regional
from edl6dof.interface.capacities import CAMERA_CELLS
from edl6dof.interface.sensed import cell_direction
from edl6dof.kernels import kernel
from edl6dof.records import FLAG
from edl6dof.sensors.ground_tile import LEVEL
from edl6dof.sensors.imager import ground_direction
from edl6dof.spatial.vector import cross, dot, put3, sub, take3

CORNERS = CAMERA_CELLS + 1
#: Iterations of the intersection of a corner with the ground, at most: each leaves an error smaller than the
#: one before by the slope of the ground times the tangent of the ray's angle to the vertical.
_ITERATIONS = 5
#: Change of the distance (m) at which the iteration ends.
_CLOSE = 1e-6

GROUND_CELLS = np.dtype(
    [
        ("place", "f8", (CORNERS, CORNERS, 3)),  # m north, east and above the site, of each corner
        ("met", FLAG, (CORNERS, CORNERS)),  # it shows ground
    ],
    align=True,
)


@kernel
def lay_cells(case, tables, origin, axes, height, tangent, reach, cells):
    """Find the ground that the corners show, up to ``reach`` (m); origin, axes and height are those of
    :func:`~edl6dof.sensors.imager.imager_pose`.
    """
    terrain = case.terrain
    for i in range(CORNERS):
        for j in range(CORNERS):
            ray = ground_direction(axes, cell_direction(tangent, CAMERA_CELLS, i - 0.5, j - 0.5))
            cells.met[i, j] = 0
            if not (height > 0.0 and ray[2] < -LEVEL):
                continue
            way = -height / ray[2]
            for _ in range(_ITERATIONS):
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
    """Test whether all of the cell (``i``, ``j``) shows ground."""
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


#: Part of its radius, inwards from the rim, over which the wall of a crater is taken.
_WALL = 0.1


@kernel
def share_of_obstacles(area, view, cells, i, j, smallest, steepest):
    """Share of the ground of the cell (``i``, ``j``) that obstacles take.

    Args:
        area: ``LANDING_AREA`` record.
        view: of the imager: origin, :func:`~edl6dof.sensors.imager.reciprocal_axes`, tangent of half the
            field of view.
        cells: ``GROUND_CELLS`` record.
        smallest: diameter (m) of the smallest obstacle that can be made out.
        steepest: tangent of the slope from which on ground is an obstacle.
    """
    size, slope = extent(cells, i, j)
    if slope >= steepest:
        return 1.0
    if area.model != GENERATED:
        return 0.0
    rocks = covered(
        area.rocks, view, cells, i, j, smallest=smallest, largest=area.largest_rock, steepest=-1.0
    )
    craters = covered(
        area.craters, view, cells, i, j, smallest=smallest, largest=sqrt(size), steepest=steepest
    )
    return min((rocks + craters) / size, 1.0)


@kernel
def covered(population, view, cells, i, j, smallest, largest, steepest):
    """Area (m2) that members of a population take whose middle lies in the cell (``i``, ``j``), of diameters
    from ``smallest`` to ``largest`` (m), and with a wall as steep as ``steepest`` unless that is negative.
    """
    south, north = span(cells, i, j, 0)
    west, east = span(cells, i, j, 1)
    height, taken = middle(cells, i, j)[2], 0.0
    for k in range(population.n):
        if population.largest[k] < smallest or population.smallest[k] > largest:
            continue
        for a in range(first_cell(population, k, south), last_cell(population, k, north) + 1):
            for b in range(first_cell(population, k, west), last_cell(population, k, east) + 1):
                bits = cell_bits(population, k, a, b)
                for n in range(drawn_in(population, k, bits)):
                    y, x, diameter, character = member(population, k, bits, i=a, j=b, n=n)
                    if (
                        max(smallest, 1e-3) <= diameter <= largest
                        and wall(diameter, character) >= steepest
                        and shows_at(view, (y, x, height), i, j)
                    ):
                        taken += 0.25 * pi * diameter * diameter
    return taken


@kernel
def wall(diameter, freshness):
    """Tangent of the slope of a crater's wall below its rim."""
    rim = 0.25 * diameter * diameter
    inner = (1.0 - _WALL) ** 2 * rim
    rise = crater_height(diameter, freshness, rim) - crater_height(diameter, freshness, inner)
    return rise / (0.5 * _WALL * diameter)


@kernel
def shows_at(view, place, i, j):
    """Test whether a place on the ground is seen in the cell (``i``, ``j``)."""
    origin, parts, tangent = view
    to_place = sub(place, origin)
    depth = dot(to_place, parts[0])
    if depth <= 0.0:
        return False
    half = 0.5 * CAMERA_CELLS / (tangent * depth)
    column = half * dot(to_place, parts[1]) + 0.5 * CAMERA_CELLS
    row = half * dot(to_place, parts[2]) + 0.5 * CAMERA_CELLS
    return i <= row < i + 1 and j <= column < j + 1
