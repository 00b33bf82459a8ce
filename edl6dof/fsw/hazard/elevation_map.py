"""A map of elevations from ranges and the pose in which each was taken.

Rows run north, columns east.  A cell holds the weighted mean of the points in it, the highest of those of the
sharpest instrument, and their weight: the inverse of the variance of the mean, in units of that of one such
point.  A cell without a point is unknown: its weight is zero.
"""

from __future__ import annotations

from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.spatial.table_index import cell
from edl6dof.spatial.vector import add, scale

#: Cells of the map along each side.
MAP_CELLS = 256
#: A hole is filled where so many of the eight cells around it are known, in so many rounds.
NEIGHBOURS_TO_FILL, FILL_ROUNDS = 3, 2

ELEVATION_MAP = record(
    ("cell", "f8"),  # m: side of a cell
    ("corner_L", "f8", (2,)),  # m: east and north of the landing site of the map's corner
    ("level", "f8"),  # m: up of the landing site from which the elevations count
    ("mean", "f4", (MAP_CELLS, MAP_CELLS)),  # m
    ("highest", "f4", (MAP_CELLS, MAP_CELLS)),  # m
    ("weight", "f4", (MAP_CELLS, MAP_CELLS)),
)


@kernel
def begin_map(side, centre_L, elevation_map):
    """Empty the map ``elevation_map`` (``ELEVATION_MAP``) and lay it around ``centre_L`` (east, north, up of
    the landing site, m), with cells of a ``side`` (m).
    """
    half = 0.5 * side * MAP_CELLS
    elevation_map.cell, elevation_map.level = side, centre_L[2]
    elevation_map.corner_L[0], elevation_map.corner_L[1] = centre_L[0] - half, centre_L[1] - half
    for i in range(MAP_CELLS):
        for j in range(MAP_CELLS):
            elevation_map.mean[i, j] = elevation_map.highest[i, j] = elevation_map.weight[i, j] = 0.0


@kernel
def cell_of(elevation_map, east, north):
    """Row and column of the cell of a point, or of the nearest cell; and whether the map holds it."""
    i, up = cell((north - elevation_map.corner_L[1]) / elevation_map.cell, MAP_CELLS)
    j, right = cell((east - elevation_map.corner_L[0]) / elevation_map.cell, MAP_CELLS)
    return i, j, 0.0 <= up < 1.0 and 0.0 <= right < 1.0


@kernel
def middle_of(elevation_map, i, j):
    """East and north of the landing site (m) of the middle of a cell."""
    return elevation_map.corner_L[0] + (j + 0.5) * elevation_map.cell, elevation_map.corner_L[1] + (
        i + 0.5
    ) * elevation_map.cell


@kernel
def add_point(point_L, weight, elevation_map):
    """Add a point (east, north, up of the site, m) of a ``weight``; from 1 on it may be the highest, too."""
    i, j, held = cell_of(elevation_map, point_L[0], point_L[1])
    if not held:
        return
    z, before = point_L[2] - elevation_map.level, elevation_map.weight[i, j]
    if weight >= 1.0:
        elevation_map.highest[i, j] = max(elevation_map.highest[i, j], z) if before >= 1.0 else z
    elevation_map.weight[i, j] = before + weight
    elevation_map.mean[i, j] += (z - elevation_map.mean[i, j]) * weight / (before + weight)
    if before + weight < 1.0:
        elevation_map.highest[i, j] = elevation_map.mean[i, j]


@kernel
def add_range(distance, direction_B, eye_L, axes_L, weight, elevation_map):
    """Add the point at ``distance`` (m, none where not positive) along the unit vector ``direction_B``.

    Args:
        eye_L: place of the eye, east, north, up of the landing site, m.
        axes_L: unit axes x, y, z of B, each as east, north, up.
        weight: of the point, see above.
        elevation_map: ``ELEVATION_MAP``, updated.
    """
    if distance <= 0.0:
        return
    x, y, z = axes_L
    along = add(scale(direction_B[0], x), add(scale(direction_B[1], y), scale(direction_B[2], z)))
    add_point(add(eye_L, scale(distance, along)), weight, elevation_map)


@kernel
def fill_holes(weight, elevation_map):
    """Give cells of less than ``weight`` the mean of enough better known ones around, at that weight."""
    for _ in range(FILL_ROUNDS):
        for i in range(1, MAP_CELLS - 1):
            for j in range(1, MAP_CELLS - 1):
                if elevation_map.weight[i, j] < weight:
                    _fill(i, j, weight, elevation_map)
        # what this round has filled counts as known from now on
        for i in range(1, MAP_CELLS - 1):
            for j in range(1, MAP_CELLS - 1):
                elevation_map.weight[i, j] = abs(elevation_map.weight[i, j])


@kernel
def _fill(i, j, weight, elevation_map):
    total, count = 0.0, 0
    for di in range(-1, 2):
        for dj in range(-1, 2):
            if elevation_map.weight[i + di, j + dj] >= weight:
                total += elevation_map.mean[i + di, j + dj]
                count += 1
    if count >= NEIGHBOURS_TO_FILL:
        elevation_map.mean[i, j] = elevation_map.highest[i, j] = total / count
        elevation_map.weight[i, j] = -weight
