"""What lies where: the rocks and craters around a place, as they are."""

from __future__ import annotations

from edl6dof.environment.landing_area.population import cell_bits, drawn_in, first_cell, last_cell, member
from edl6dof.jit import kernel


@kernel
def within(population, north, east, radius, smallest):
    """Members of a population of at least ``smallest`` (m) whose middles lie within ``radius`` (m) of a place
    (m north and east of the site): how many, and the largest diameter (m), 0 for none.
    """
    count, largest = 0, 0.0
    for k in range(population.n):
        if population.largest[k] < smallest:
            continue
        for a in range(
            first_cell(population, k, north - radius), last_cell(population, k, north + radius) + 1
        ):
            for b in range(
                first_cell(population, k, east - radius), last_cell(population, k, east + radius) + 1
            ):
                bits = cell_bits(population, k, a, b)
                for n in range(drawn_in(population, k, bits)):
                    y, x, diameter, _ = member(population, k, bits, i=a, j=b, n=n)
                    if diameter >= smallest and (y - north) ** 2 + (x - east) ** 2 <= radius * radius:
                        count += 1
                        largest = max(largest, diameter)
    return count, largest


@kernel
def list_within(population, south, west, side, found):
    """The members whose middles lie in a square (m, from its south-west corner) into the rows of ``found``:
    place north and east (m), diameter (m), character; returns how many there are, of which those beyond the
    rows are not written.
    """
    count = 0
    for k in range(population.n):
        for a in range(first_cell(population, k, south), last_cell(population, k, south + side) + 1):
            for b in range(first_cell(population, k, west), last_cell(population, k, west + side) + 1):
                bits = cell_bits(population, k, a, b)
                for n in range(drawn_in(population, k, bits)):
                    y, x, diameter, character = member(population, k, bits, i=a, j=b, n=n)
                    inside = south <= y < south + side and west <= x < west + side
                    if diameter > 0.0 and inside:
                        if count < found.shape[0]:
                            found[count, 0], found[count, 1] = y, x
                            found[count, 2], found[count, 3] = diameter, character
                        count += 1
    return count
