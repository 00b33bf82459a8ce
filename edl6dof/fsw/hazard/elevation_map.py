"""A map of elevations from ranges and the pose at each measurement; and, at every cell, slope and roughness
of the ground under a lander there.

Rows run north, columns east. A cell stores the weighted mean of its points, the highest point of the most
accurate instrument, and the weight: the inverse of the variance of the mean, in units of that of one point of
this instrument. A cell without a point is unknown: its weight is zero.

The footprint is a disc, as the lander's azimuth at touchdown is free: its legs stand somewhere on the rim.
The plane is the least-squares fit to the cell means of the disc; as its second moments are constant, level
and rises follow from three running sums, updated by the cells that enter and leave the disc. The roughness is
the largest distance of a cell from the plane, normal to it: of a rock under the lander, or of a hole under a
leg. Source of the two measures: Johnson, Klumpp, Collier and Wolf, "Lidar-based hazard avoidance for safe
landing on Mars", J. Guidance 25(6) 2002 (there with a robust plane in place of least squares).
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from edl6dof.kernels import kernel
from edl6dof.records import record, whole
from edl6dof.spatial.table_index import cell
from edl6dof.spatial.vector import add, scale

#: Cells of the map along each side.
MAP_CELLS = 256
#: Known cells of the eight neighbours from which a hole is filled, and number of passes.
NEIGHBOURS_TO_FILL, FILL_ROUNDS = 3, 2

ELEVATION_MAP = record(
    ("cell", "f8"),  # m: side of a cell
    ("corner_L", "f8", (2,)),  # m: east and north of the landing site of the map's corner
    ("level", "f8"),  # m: reference of the elevations, up of the landing site
    ("mean", "f4", (MAP_CELLS, MAP_CELLS)),  # m: weighted mean of the points
    ("highest", "f4", (MAP_CELLS, MAP_CELLS)),  # m: highest point
    ("weight", "f4", (MAP_CELLS, MAP_CELLS)),
)


@kernel
def begin_map(side, centre_L, elevation_map):
    """Clear ``elevation_map`` (``ELEVATION_MAP``) and place it around ``centre_L`` (east, north, up of the
    landing site, m), with cells of a ``side`` (m).
    """
    half = 0.5 * side * MAP_CELLS
    elevation_map.cell, elevation_map.level = side, centre_L[2]
    elevation_map.corner_L[0], elevation_map.corner_L[1] = centre_L[0] - half, centre_L[1] - half
    for i in range(MAP_CELLS):
        for j in range(MAP_CELLS):
            elevation_map.mean[i, j] = elevation_map.highest[i, j] = elevation_map.weight[i, j] = 0.0


@kernel
def cell_of(elevation_map, east, north):
    """Row and column of the cell of a point (m, east, north of the site), or of the nearest cell; and whether
    the point is on the map.
    """
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
    """Add a point (east, north, up of the site, m); only points of ``weight`` 1 or more update the highest
    one.
    """
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
    """Add the point at ``distance`` (m; none if not positive) along the unit vector ``direction_B``.

    Args:
        eye_L: position of the sensor, east, north, up of the landing site, m.
        axes_L: unit axes x, y, z of B, each as east, north, up.
        weight: weight of the point, see the module.
        elevation_map: ``ELEVATION_MAP``, updated.
    """
    if distance <= 0.0:
        return
    x, y, z = axes_L
    along = add(scale(direction_B[0], x), add(scale(direction_B[1], y), scale(direction_B[2], z)))
    add_point(add(eye_L, scale(distance, along)), weight, elevation_map)


@kernel
def fill_holes(weight, elevation_map):
    """Fill cells of less than ``weight`` with the mean of neighbours of at least that weight, and set their
    weight to it.
    """
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


#: Largest radius of a footprint, cells.
MAX_RADIUS = 32
#: Slope and roughness where a cell of the footprint is unknown; larger than any real value.
UNKNOWN = np.float32(1e3)

_ROW = MAP_CELLS + 2 * MAX_RADIUS + 2

#: Planes of the footprints of a row of cells, and the running sums for them.
PLANES = record(
    ("known", "f8", (_ROW,)),
    ("sum", "f8", (_ROW,)),
    ("east_sum", "f8", (_ROW,)),
    ("north_sum", "f8", (_ROW,)),
    ("level", "f4", (MAP_CELLS,)),  # m
    ("rise_east", "f4", (MAP_CELLS,)),  # rise per cell eastwards, m
    ("rise_north", "f4", (MAP_CELLS,)),  # rise per cell northwards, m
    ("farthest", "f4", (MAP_CELLS,)),  # m: largest distance of a cell from the plane, up or down
    ("whole", "f4", (MAP_CELLS,)),  # 1: all cells of the footprint are known; else 0
    ("limit", "f4", (MAP_CELLS,)),  # m: largest admissible vertical distance of a cell from the plane
    ("kept", "f4", (MAP_CELLS,)),  # probability that no cell is farther
)

FOOTPRINT = record(
    ("slope", "f4", (MAP_CELLS, MAP_CELLS)),  # tangent of the slope of the plane
    ("roughness", "f4", (MAP_CELLS, MAP_CELLS)),  # m: largest distance of a cell from the plane
    ("planes", PLANES),
)

#: Classes of a cell.
SAFE, UNSEEN, TOO_STEEP, TOO_ROUGH = range(4)
CELL_CLASSES = ("safe", "edge", "slope", "rock")

SAFETY_MAP = record(
    ("cell_class", whole(SAFE, TOO_ROUGH, kind="i1"), (MAP_CELLS, MAP_CELLS)),  # index in CELL_CLASSES
    ("probability", "f4", (MAP_CELLS, MAP_CELLS)),  # that slope and roughness are within limits
    ("clearance", "f4", (MAP_CELLS, MAP_CELLS)),  # m: distance from the nearest cell that is not safe
)


@kernel
def chord(radius, row):
    """Half chord (cells) of a disc of ``radius`` cells in the row ``row`` cells off its middle; its reach for
    row 0.
    """
    return cell(sqrt(radius * radius - row * row), MAX_RADIUS + 1)[0]


@kernel
def add_cells(elevation_map, i, row, sign, shift, planes):
    """Add the cells of map row ``i``, which is ``row`` rows off the middle of the footprints, to the running
    sums ``shift`` columns farther on, where they enter (``sign`` 1) or leave (-1) the footprint.
    """
    first, end = shift, shift + MAP_CELLS
    mean, weight = elevation_map.mean[i], elevation_map.weight[i]
    known, total = planes.known[first:end], planes.sum[first:end]
    east, north = planes.east_sum[first:end], planes.north_sum[first:end]
    for c in range(MAP_CELLS):
        z = sign * float(mean[c])
        known[c] += sign if weight[c] > 0.0 else 0.0
        total[c] += z
        east[c] += c * z
        north[c] += row * z


@kernel
def fit_row(elevation_map, radius, i, planes):
    """Fit the planes of the footprints around all cells of row ``i``, which must be within the map."""
    reach = chord(radius, 0)
    for c in range(_ROW):
        planes.known[c] = planes.sum[c] = planes.east_sum[c] = planes.north_sum[c] = 0.0
    cells, second = 0, 0.0
    for row in range(-reach, reach + 1):
        half = chord(radius, row)
        cells += 2 * half + 1
        second += row * row * (2 * half + 1)
        add_cells(elevation_map, i=i + row, row=row, sign=-1.0, shift=reach + half + 1, planes=planes)
        add_cells(elevation_map, i=i + row, row=row, sign=1.0, shift=reach - half, planes=planes)
    known = total = east = north = 0.0
    for c in range(MAP_CELLS + reach):
        known += planes.known[c]
        total += planes.sum[c]
        east += planes.east_sum[c]
        north += planes.north_sum[c]
        j = c - reach
        if j < 0:
            continue
        planes.level[j] = total / cells
        planes.rise_east[j] = (east - j * total) / second
        planes.rise_north[j] = north / second
        planes.whole[j] = 1.0 if known > cells - 0.5 else 0.0


@kernel
def stray_row(elevation_map, radius, i, planes):
    """Write the largest distance (m, up or down) of the cells of each footprint around row ``i`` from its
    plane.
    """
    reach = chord(radius, 0)
    first, last = reach, MAP_CELLS - reach
    # views that begin at the first column: an index that is never negative keeps the innermost loop short
    level, farthest = planes.level[first:last], planes.farthest[first:last]
    rise_east, rise_north = planes.rise_east[first:last], planes.rise_north[first:last]
    for j in range(last - first):
        farthest[j] = 0.0
    for row in range(-reach, reach + 1):
        half, north = chord(radius, row), np.float32(row)
        for column in range(-half, half + 1):
            east, top = np.float32(column), elevation_map.highest[i + row, first + column : last + column]
            for j in range(last - first):
                off = abs(top[j] - level[j] - rise_east[j] * east - rise_north[j] * north)
                farthest[j] = off if off > farthest[j] else farthest[j]


@kernel
def assess(elevation_map, radius_m, out):
    """Compute slope and roughness of the footprint around every cell of a map without holes.

    Args:
        elevation_map: ``ELEVATION_MAP`` record.
        radius_m: radius of the footprint, m; limited to ``MAX_RADIUS`` cells.
        out: ``FOOTPRINT`` record, written: ``UNKNOWN`` where a cell of the footprint is unknown.
    """
    radius = min(radius_m / elevation_map.cell, float(MAX_RADIUS))
    reach = chord(radius, 0)
    planes, side = out.planes, np.float32(elevation_map.cell)
    for i in range(MAP_CELLS):
        for j in range(MAP_CELLS):
            out.slope[i, j] = out.roughness[i, j] = UNKNOWN
    for i in range(reach, MAP_CELLS - reach):
        fit_row(elevation_map, radius, i, planes)
        stray_row(elevation_map, radius, i, planes)
        for j in range(reach, MAP_CELLS - reach):
            if planes.whole[j] > 0.0:
                east, north = planes.rise_east[j] / side, planes.rise_north[j] / side
                steep = east * east + north * north
                out.slope[i, j] = sqrt(steep)
                out.roughness[i, j] = planes.farthest[j] / sqrt(1.0 + steep)
