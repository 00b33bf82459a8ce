"""Height of the relief at the nodes of the lattice, and the surface between them."""

from __future__ import annotations

from edl6dof.dispatch import numbers, on_its_own
from edl6dof.environment.landing_area.craters import crater_height
from edl6dof.environment.landing_area.fractal import fractal_at
from edl6dof.environment.landing_area.params import FADE
from edl6dof.environment.landing_area.population import cell_bits, drawn_in, first_cell, member
from edl6dof.environment.landing_area.rocks import rock_height
from edl6dof.jit import kernel
from edl6dof.spatial.lookups import endless_cell
from edl6dof.spatial.vector import clamp


@on_its_own(numbers(3))
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
    sw, se, nw, ne = craters_at_corners(area, area.craters, i, j)
    rocks = rocks_at_corners(area, area.rocks, i, j)
    return (
        node_height(area, tiles, i, j, sw, rocks[0]),
        node_height(area, tiles, i, j + 1, se, rocks[1]),
        node_height(area, tiles, i + 1, j, nw, rocks[2]),
        node_height(area, tiles, i + 1, j + 1, ne, rocks[3]),
    )


@kernel
def node_height(area, tiles, i, j, craters, rocks):
    """Height (m) of the node (``i``, ``j``) that craters and rocks give these heights."""
    share = share_at(area, i * area.cell, j * area.cell)
    return share * (fractal_at(area, tiles, i, j) + craters + rocks)


@kernel
def share_at(area, north, east):
    """What is left of the relief at a place (m from the site): 1, and towards the edge of the area less."""
    return clamp((area.extent - max(abs(north), abs(east))) / FADE, 0.0, 1.0)


@kernel
def craters_at_corners(area, craters, i, j):
    """What craters add (m) at the corners of a cell of the lattice, in the order of :func:`corners`."""
    step = area.cell
    sw = se = nw = ne = 0.0
    for k in range(craters.n):
        row, column = first_cell(craters, k, i * step), first_cell(craters, k, j * step)
        for a in range(row, row + 2):
            for b in range(column, column + 2):
                bits = cell_bits(craters, k, a, b)
                for n in range(drawn_in(craters, k, bits)):
                    north, east, diameter, character = member(craters, k, bits, a, b, n)
                    y2, x2 = (i * step - north) ** 2, (j * step - east) ** 2
                    yy2, xx2 = ((i + 1) * step - north) ** 2, ((j + 1) * step - east) ** 2
                    sw += crater_height(diameter, character, y2 + x2)
                    se += crater_height(diameter, character, y2 + xx2)
                    nw += crater_height(diameter, character, yy2 + x2)
                    ne += crater_height(diameter, character, yy2 + xx2)
    return sw, se, nw, ne


@kernel
def rocks_at_corners(area, rocks, i, j):
    """Height (m) of the highest rock at the corners of a cell of the lattice, in the order of
    :func:`corners`.
    """
    step = area.cell
    sw = se = nw = ne = 0.0
    for k in range(rocks.n):
        row, column = first_cell(rocks, k, i * step), first_cell(rocks, k, j * step)
        for a in range(row, row + 2):
            for b in range(column, column + 2):
                bits = cell_bits(rocks, k, a, b)
                for n in range(drawn_in(rocks, k, bits)):
                    north, east, diameter, _ = member(rocks, k, bits, a, b, n)
                    if diameter == 0.0:
                        continue
                    y2, x2 = (i * step - north) ** 2, (j * step - east) ** 2
                    yy2, xx2 = ((i + 1) * step - north) ** 2, ((j + 1) * step - east) ** 2
                    sw = max(sw, rock_height(diameter, y2 + x2))
                    se = max(se, rock_height(diameter, y2 + xx2))
                    nw = max(nw, rock_height(diameter, yy2 + x2))
                    ne = max(ne, rock_height(diameter, yy2 + xx2))
    return sw, se, nw, ne
