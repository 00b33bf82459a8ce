"""The ground as a raster: heights at the nodes of the lattice, each crater and rock painted once."""

from __future__ import annotations

from edl6dof.environment.landing_area.fractal import fractal_row
from edl6dof.environment.landing_area.population import (
    cell_bits,
    drawn_in,
    first_cell,
    last_cell,
    member,
    with_member,
)
from edl6dof.environment.landing_area.relief import share_at
from edl6dof.environment.terrain import geodetic_of, regional
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.spatial.table_index import endless_cell

#: Spacing, in nodes, at which the ground coarser than the landing area is evaluated; linear interpolation
#: between errs by a few millimetres.
_APART = 8
#: Most nodes of a row.
LONGEST = 512

#: Scratch of a raster: heights (m) of the fractal relief of a row, and, every ``_APART`` nodes of two rows,
#: of the ground coarser than the landing area.
RASTER_WORK = record(
    ("fractal", "f8", (LONGEST,)),
    ("south", "f8", (LONGEST // _APART + 1,)),
    ("north", "f8", (LONGEST // _APART + 1,)),
)


@kernel
def lay_raster(terrain, grid, north, east, heights, work):
    """Write the heights of the ground into ``heights`` (f4, m above the site's elevation): at the nodes of
    the lattice, rows from the south, columns from the west, at most ``LONGEST``; ``work``: ``RASTER_WORK``
    record.

    Returns:
        The place (m north and east of the site) of the first node: the nearest to ``north`` and ``east``.
    """
    area = terrain.landing_area
    rows, columns = heights.shape
    i, j = endless_cell(north / area.cell + 0.5), endless_cell(east / area.cell + 0.5)
    heights[:] = 0.0
    _paint(area, area.rocks, i, j, heights)
    _paint(area, area.craters, i, j, heights)
    _lay_regional(terrain, grid, i, j, count=columns, heights=work.north)
    for first in range(0, rows, _APART):
        for k in range(work.north.shape[0]):
            work.south[k] = work.north[k]
        _lay_regional(terrain, grid, i=i + first + _APART, j=j, count=columns, heights=work.north)
        for row in range(first, min(first + _APART, rows)):
            _finish_row(
                area, grid.tiles, i=i + row, j=j, up=(row - first) / _APART, heights=heights[row], work=work
            )
    return i * area.cell, j * area.cell


@kernel
def _finish_row(area, tiles, i, j, up, heights, work):
    """Add relief and coarser ground to the craters and rocks of a row, at the share ``up`` between the rows
    ``south`` and ``north`` of ``work``.
    """
    count, north, south = heights.shape[0], work.north, work.south
    fractal_row(area, tiles, i, j, work.fractal[:count])
    whole = _share_of_node(area, i, j) == 1.0 and _share_of_node(area, i, j + count) == 1.0
    for k in range((count + _APART - 1) // _APART):
        first = k * _APART
        start, end = south[k] + up * (north[k] - south[k]), south[k + 1] + up * (north[k + 1] - south[k + 1])
        part, fractal = heights[first : first + _APART], work.fractal[first : first + _APART]
        for c in range(part.shape[0]):
            share = 1.0 if whole else _share_of_node(area, i, j + first + c)
            part[c] = start + c / _APART * (end - start) + share * (fractal[c] + float(part[c]))


@kernel
def _share_of_node(area, i, j):
    """Share of the relief at a node: 1, fading to 0 at the edge of the area."""
    return share_at(area, i * area.cell, j * area.cell)


@kernel
def _lay_regional(terrain, grid, i, j, count, heights):
    """Write heights (m above the site's elevation) of the ground coarser than the landing area, at every
    ``_APART``th of ``count`` nodes of a row from the node (``i``, ``j``) on, and at the one beyond.
    """
    step = terrain.landing_area.cell
    for k in range((count + _APART - 1) // _APART + 1):
        lat, lon = geodetic_of(terrain, i * step, (j + k * _APART) * step)
        heights[k] = regional(terrain, grid, lat, lon)[0] - terrain.site_elevation


@kernel
def _paint(area, population, i, j, heights):
    """Paint the members of a population onto ``heights``, whose first node is (``i``, ``j``)."""
    step = area.cell
    rows, columns = heights.shape
    for k in range(population.n):
        for a in range(first_cell(population, k, i * step), last_cell(population, k, (i + rows) * step) + 1):
            low, high = first_cell(population, k, j * step), last_cell(population, k, (j + columns) * step)
            for b in range(low, high + 1):
                bits = cell_bits(population, k, a, b)
                for n in range(drawn_in(population, k, bits)):
                    north, east, diameter, character = member(population, k, bits, i=a, j=b, n=n)
                    first, last = nodes_within(north, population.reach * diameter, step, i, rows)
                    left, right = nodes_within(east, population.reach * diameter, step, j, columns)
                    for row in range(first, last):
                        y2 = ((i + row) * step - north) ** 2
                        for column in range(left, right):
                            square = y2 + ((j + column) * step - east) ** 2
                            heights[row, column] = with_member(
                                population, heights[row, column], diameter, character, square
                            )


@kernel
def nodes_within(middle, reach, step, first, count):
    """Range of indices from node ``first`` on, of ``count``, less than ``reach`` (m) from ``middle`` (m)."""
    low, high = endless_cell((middle - reach) / step), endless_cell((middle + reach) / step)
    return max(low + 1 - first, 0), min(high + 1 - first, count)
