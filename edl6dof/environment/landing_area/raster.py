"""The ground as a raster: heights at the nodes of the lattice, each crater and rock painted once."""

from __future__ import annotations

from edl6dof.environment.landing_area.feature import with_member
from edl6dof.environment.landing_area.plane import geodetic_of
from edl6dof.environment.landing_area.population import cell_bits, drawn_in, first_cell, last_cell, member
from edl6dof.environment.landing_area.surface import node_height
from edl6dof.environment.terrain import regional
from edl6dof.jit import kernel
from edl6dof.spatial.lookups import endless_cell

#: Nodes between which what is coarser than the landing area is drawn as a straight line: off it by a
#: few millimetres where that bends.
_APART = 8


@kernel
def lay_raster(terrain, grid, north, east, heights):
    """Lay the ground into ``heights`` (f4, m above the site's elevation): at the nodes of the lattice, rows
    from the south, columns from the west.

    Returns:
        The place (m north and east of the site) of the first node: the nearest to ``north`` and ``east``.
    """
    area = terrain.landing_area
    i, j = endless_cell(north / area.cell + 0.5), endless_cell(east / area.cell + 0.5)
    heights[:] = 0.0
    _paint(area, area.rocks, i, j, heights)
    _paint(area, area.craters, i, j, heights)
    for row in range(heights.shape[0]):
        _finish_row(terrain, grid, i + row, j, heights[row])
    return i * area.cell, j * area.cell


@kernel
def _finish_row(terrain, grid, i, j, heights):
    """Put the ground under the craters and rocks of a row that begins at the node (``i``, ``j``)."""
    area, count = terrain.landing_area, heights.shape[0]
    start = _regional(terrain, grid, i, j)
    for first in range(0, count, _APART):
        end = _regional(terrain, grid, i, j + first + _APART)
        for column in range(first, min(first + _APART, count)):
            relief = node_height(area, grid.tiles, i, j + column, float(heights[column]), 0.0)
            heights[column] = start + (column - first) / _APART * (end - start) + relief
        start = end


@kernel
def _regional(terrain, grid, i, j):
    """Height (m) above the site's elevation of what is coarser than the landing area, at a node."""
    step = terrain.landing_area.cell
    lat, lon = geodetic_of(terrain, i * step, j * step)
    return regional(terrain, grid, lat, lon)[0] - terrain.site_elevation


@kernel
def _paint(area, population, i, j, heights):
    """Give the nodes what the members of a population that reach them are; ``heights`` begins at the node
    (``i``, ``j``).
    """
    step = area.cell
    rows, columns = heights.shape
    for k in range(population.n):
        for a in range(first_cell(population, k, i * step), last_cell(population, k, (i + rows) * step) + 1):
            low, high = first_cell(population, k, j * step), last_cell(population, k, (j + columns) * step)
            for b in range(low, high + 1):
                bits = cell_bits(population, k, a, b)
                for n in range(drawn_in(population, k, bits)):
                    north, east, diameter, character = member(population, k, bits, a, b, n)
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
    """Range of indices, among ``count`` nodes from node ``first`` on, that lie less than ``reach`` (m) from
    ``middle`` (m).
    """
    low, high = endless_cell((middle - reach) / step), endless_cell((middle + reach) / step)
    return max(low + 1 - first, 0), min(high + 1 - first, count)
