"""Share of the ground that obstacles take in a cell of an image: rocks, craters with walls too steep, and
ground too steep.

What is smaller than the camera can make out does not count.  A crater that is wider than the cell does not
count as one either: its walls show in the slope of the cells that lie on them.
"""

from __future__ import annotations

from math import pi, sqrt

from edl6dof.environment.landing_area.features import crater_height
from edl6dof.environment.landing_area.params import GENERATED
from edl6dof.environment.landing_area.population import cell_bits, drawn_in, first_cell, last_cell, member
from edl6dof.interface.capacities import CAMERA_CELLS
from edl6dof.kernels import kernel
from edl6dof.sensors.ground_cells import extent, middle, span
from edl6dof.spatial.vector import dot, sub

#: Part of its radius, inwards from the rim, over which the wall of a crater is taken.
_WALL = 0.1


@kernel
def share_of_obstacles(area, view, cells, i, j, smallest, steepest):
    """Share of the ground of the cell (``i``, ``j``) that obstacles take.

    Args:
        area: ``LANDING_AREA`` record.
        view: of the eye: origin, :func:`~edl6dof.sensors.sight.across` its axes, tangent of half the field of
            view.
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
    """Whether a place on the ground shows in the cell (``i``, ``j``)."""
    origin, parts, tangent = view
    to_place = sub(place, origin)
    depth = dot(to_place, parts[0])
    if depth <= 0.0:
        return False
    half = 0.5 * CAMERA_CELLS / (tangent * depth)
    column = half * dot(to_place, parts[1]) + 0.5 * CAMERA_CELLS
    row = half * dot(to_place, parts[2]) + 0.5 * CAMERA_CELLS
    return i <= row < i + 1 and j <= column < j + 1
