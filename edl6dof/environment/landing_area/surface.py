"""Height of the relief at the nodes of the lattice, and the surface between them."""

from __future__ import annotations

from edl6dof.environment.landing_area.features import with_member
from edl6dof.environment.landing_area.fractal import fractal_at
from edl6dof.environment.landing_area.params import FADE
from edl6dof.environment.landing_area.population import (
    cell_bits,
    drawn_in,
    first_cell,
    place_of_member,
    size_of_member,
)
from edl6dof.kernels import kernel
from edl6dof.spatial.table_index import endless_cell
from edl6dof.spatial.vector import clamp


@kernel
def relief(area, tiles, north, east):
    """Height (m) of the relief at a place (m from the site), and its rise per metre towards north and east:
    bilinear in its cell of the lattice.
    """
    if share_at(area, north, east) == 0.0:
        return 0.0, 0.0, 0.0
    step = area.cell
    i, j = endless_cell(north / step), endless_cell(east / step)
    sw, se, nw, ne = corners(area, tiles, i, j)
    u, t = north / step - i, east / step - j
    south, up = sw + t * (se - sw), nw + t * (ne - nw)
    east_rise = ((1.0 - u) * (se - sw) + u * (ne - nw)) / step
    return south + u * (up - south), (up - south) / step, east_rise


@kernel
def corners(area, tiles, i, j):
    """Heights (m) at the nodes (``i``, ``j``), (``i``, ``j`` + 1), (``i`` + 1, ``j``) and (``i`` + 1, ``j`` +
    1) of the lattice.

    What a node gets does not depend on which cell it is a corner of: all that reaches it is met in the same
    order from each.
    """
    sw, se, nw, ne = heights_at_corners(area, area.craters, i, j)
    rocks = heights_at_corners(area, area.rocks, i, j)
    return (
        node_height(area, tiles, i, j, craters=sw, rocks=rocks[0]),
        node_height(area, tiles, i, j=j + 1, craters=se, rocks=rocks[1]),
        node_height(area, tiles, i=i + 1, j=j, craters=nw, rocks=rocks[2]),
        node_height(area, tiles, i=i + 1, j=j + 1, craters=ne, rocks=rocks[3]),
    )


@kernel
def node_height(area, tiles, i, j, craters, rocks):
    """Height (m) of the node (``i``, ``j``) that craters and rocks give these heights."""
    share = share_at(area, i * area.cell, j * area.cell)
    return share * (fractal_at(area, tiles, i, j) + craters + rocks)


@kernel
def share_at(area, north, east):
    """Share of the relief left at a place (m from the site): 1, fading to 0 at the edge of the area."""
    return clamp((area.extent - max(abs(north), abs(east))) / FADE, 0.0, 1.0)


@kernel
def heights_at_corners(area, population, i, j):
    """Heights (m) of a population at the corners of a cell, in the order of :func:`corners`."""
    step = area.cell
    south, north, west, east = i * step, (i + 1) * step, j * step, (j + 1) * step
    sw = se = nw = ne = 0.0
    for k in range(population.n):
        row, column = first_cell(population, k, south), first_cell(population, k, west)
        farthest = (population.reach * population.largest[k]) ** 2
        for a in range(row, row + 2):
            for b in range(column, column + 2):
                bits = cell_bits(population, k, a, b)
                for n in range(drawn_in(population, k, bits)):
                    y, x = place_of_member(population, k, bits, i=a, j=b, n=n)
                    y2, x2, yy2, xx2 = (south - y) ** 2, (west - x) ** 2, (north - y) ** 2, (east - x) ** 2
                    if min(y2, yy2) + min(x2, xx2) >= farthest:
                        continue
                    diameter, character = size_of_member(population, k, bits, n)
                    if diameter == 0.0:
                        continue
                    sw = with_member(population, sw, diameter, character, y2 + x2)
                    se = with_member(population, se, diameter, character, y2 + xx2)
                    nw = with_member(population, nw, diameter, character, yy2 + x2)
                    ne = with_member(population, ne, diameter, character, yy2 + xx2)
    return sw, se, nw, ne
