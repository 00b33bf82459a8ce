"""Craters and rocks, scattered over the ground at random: their shapes, how they change the ground below
them, and their places.  Each has a place, a diameter and a character, 0 .. 1: the freshness of a crater.

A fresh crater is a bowl with a raised rim, a worn one a smooth hollow without rim; any mixture of the two is
as likely as any other [E].  Rocks are half-ellipsoids in the numbers of Golombek's law: those of diameter D
and more cover the share F(D) = k exp(-q D) of the ground, q = 1.79 + 0.152 / k per m; so 4 q k exp(-q D) /
(pi D^2) of them lie on a square metre per metre of diameter.

The number per area and diameter is ``amount * D**-(exponent + 1) * exp(-decay * D)``.  Diameters fall into
classes, each up to twice as large as the one before; the members of a class lie in square cells, as many in
each as a Poisson variable made of the cell's own bits.  A cell is so large that all members of a class that
reach one cell of the lattice lie in a block of two by two.  Members are drawn from the power law, and stay
with probability exp(-decay (D - smallest of the class)).

Sources: fresh craters, depth 0.2 and rim 0.04 of the diameter: Pike, in Impact and Explosion Cratering
(1977); ejecta thin with the cube of the distance: McGetchin et al., Earth Planet. Sci. Lett. 20, 226 (1973);
worn ones, a twentieth of the diameter deep: [E].  Rocks: Golombek and Rapp, J. Geophys. Res. 102(E2), 4117
(1997); height half the diameter: Golombek et al., J. Geophys. Res. 108(E12), 8086 (2003).  Thinning: Lewis
and Shedler, Naval Research Logistics 26, 403 (1979).
"""

from __future__ import annotations

from math import frexp, pi, sqrt
from typing import NamedTuple

import numpy as np

from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.spatial import arrays
from edl6dof.spatial.elementary import exp, pow
from edl6dof.spatial.random_numbers import Stream, random_bits, random_bits_at
from edl6dof.spatial.table_index import endless_cell

DEPTH, RIM = 0.2, 0.04
WORN_DEPTH = 0.05
#: Where a crater ends, in its radii.
EDGE = 2.0


@kernel
def crater_height(diameter, freshness, square):
    """Height (m) of a crater at the ``square`` (m2) of the distance from its middle; freshness 0 .. 1."""
    s = 4.0 * square / (diameter * diameter)  # of the distance in radii
    if s >= EDGE * EDGE:
        return 0.0
    worn = 1.0 - s / (EDGE * EDGE)
    if s < 1.0:
        fresh = RIM - DEPTH * (1.0 - s)
    else:
        last = 1.0 / (EDGE * EDGE * EDGE)
        fresh = RIM * (1.0 / (s * sqrt(s)) - last) / (1.0 - last)
    return diameter * (freshness * fresh - (1.0 - freshness) * WORN_DEPTH * worn * worn)


#: Height of a rock over its diameter.
HEIGHT = 0.5


def rock_law(abundance: float) -> tuple[float, float]:
    """Amount and decay (1/m) of the number amount exp(-decay D) / D^2 per m2 and m of diameter."""
    if abundance == 0.0:
        return 0.0, 0.0
    decay = 1.79 + 0.152 / abundance
    return 4.0 * decay * abundance / pi, decay


@kernel
def rock_height(diameter, square):
    """Height (m) of a rock above the ground at the ``square`` (m2) of the distance from its middle."""
    s = 4.0 * square / (diameter * diameter)
    return HEIGHT * diameter * sqrt(1.0 - s) if s < 1.0 else 0.0


@kernel
def with_member(population, height, diameter, character, square):
    """Height (m) of the ground ``height`` with a member: craters add up, of rocks the highest counts."""
    if population.stands:
        return max(height, rock_height(diameter, square))
    return height + crater_height(diameter, character, square)


MAX_CLASSES = 16
#: Most members that the cells of a class may hold on average.
CROWD = 8.0
POPULATION = record(
    ("n", "i8"),  # classes
    ("exponent", "f8"),
    ("decay", "f8"),  # per m
    ("reach", "f8"),  # distance from the middle of a member to its edge, in diameters
    ("stands", FLAG),  # 1: members stand on the ground (rocks); 0: they change its shape (craters)
    ("key", "i8", (MAX_CLASSES,)),
    ("smallest", "f8", (MAX_CLASSES,)),  # m
    ("largest", "f8", (MAX_CLASSES,)),  # m
    ("cell", "f8", (MAX_CLASSES,)),  # m: side of its cells
    ("mean", "f8", (MAX_CLASSES,)),  # mean number of members drawn in a cell
    ("empty", "f8", (MAX_CLASSES,)),  # probability that a cell is empty
    ("filled", "u8", (MAX_CLASSES,)),  # least random bits of a cell with a member
)
_32, _11 = np.uint64(32), np.uint64(11)
_LOW = np.uint64(0xFFFF_FFFF)


@kernel
def first_cell(population, k, place):
    """Lower of the two cells of class ``k`` with all members that reach the lattice cell from ``place`` (m)
    on.
    """
    return endless_cell((place - population.reach * population.largest[k]) / population.cell[k])


@kernel
def last_cell(population, k, place):
    """Last cell (northmost or eastmost) of class ``k`` with members that reach back to ``place`` (m)."""
    return endless_cell((place + population.reach * population.largest[k]) / population.cell[k])


@kernel
def cell_bits(population, k, i, j):
    """The random bits of the cell (``i`` north, ``j`` east) of class ``k``."""
    return random_bits_at(population.key[k], i, j)


@kernel
def drawn_in(population, k, bits):
    """Number of members drawn in the cell of class ``k`` with these random bits."""
    if bits < population.filled[k]:
        return 0
    share = float(bits >> _11) * 2.0**-53
    probability = population.empty[k]
    count = 0
    while share >= probability and count < 100:
        share -= probability
        count += 1
        probability *= population.mean[k] / count
    return count


@kernel
def member(population, k, bits, i, j, n):
    """Member ``n`` of those drawn in the cell (``i``, ``j``) of class ``k``: its place north and east (m),
    its diameter (m; 0: removed by thinning) and its character, 0 .. 1.
    """
    north, east = place_of_member(population, k, bits, i, j, n=n)
    diameter, character = size_of_member(population, k, bits, n)
    return north, east, diameter, character


@kernel
def place_of_member(population, k, bits, i, j, n):
    """Place north and east (m) of :func:`member`."""
    first, side = random_bits(bits, 2 * n + 1), population.cell[k]
    return (i + float(first & _LOW) * 2.0**-32) * side, (j + float(first >> _32) * 2.0**-32) * side


@kernel
def size_of_member(population, k, bits, n):
    """Diameter (m) and character of :func:`member`."""
    second = random_bits(bits, 2 * n + 2)
    b, low = population.exponent, population.smallest[k]
    span = 1.0 - pow(low / population.largest[k], b)
    diameter = low * pow(1.0 - span * float(second & _LOW) * 2.0**-32, -1.0 / b)
    character = float(second >> _32) * 2.0**-32
    if population.decay > 0.0:
        stays = exp(-population.decay * (diameter - low))
        if character >= stays:
            return 0.0, 0.0
        character /= stays
    return diameter, character


class Law(NamedTuple):
    """A population: amount, exponent and decay (per m) of its number per m2 and m of diameter; smallest and
    largest diameter (m); and distance from the middle of a member to its edge, in diameters.
    """

    amount: float
    exponent: float
    decay: float
    smallest: float
    largest: float
    reach: float
    stands: bool


def fill_population(record: np.void, law: Law, lattice: float, rng: Stream) -> None:
    """Divide a population into classes, for a lattice with cells of this side (m); ``rng`` draws its keys."""
    classes = _classes(law, lattice)
    record["n"] = len(classes["mean"])
    record["exponent"], record["decay"], record["reach"] = law.exponent, law.decay, law.reach
    record["stands"] = law.stands
    for name, values in classes.items():
        record[name][: len(values)] = values
    record["empty"][: record["n"]] = arrays.exp(-classes["mean"])
    # the 53 bits that the share is made of, and those below them
    record["filled"] = np.ceil(record["empty"] * 2.0**53).astype(np.uint64) << _11
    record["key"] = rng.keys(MAX_CLASSES)


def most_in_a_cell(law: Law, lattice: float) -> float:
    """Members that the fullest cells of a class hold on average."""
    return float(np.max(_classes(law, lattice)["mean"], initial=0.0))


def _doublings(ratio: float) -> int:
    """The least number of doublings of one that reach ``ratio``, to rounding."""
    share, doublings = frexp(ratio * (1.0 - 1e-9))
    return doublings - 1 if share == 0.5 else doublings


def _classes(law: Law, lattice: float) -> dict[str, np.ndarray]:
    """Smallest and largest diameter, side of the cells (m) and mean number in a cell, of each class."""
    count = max(1, _doublings(law.largest / law.smallest)) if law.amount > 0.0 else 0
    low = law.smallest * np.ldexp(1.0, np.arange(count))
    high = np.minimum(2.0 * low, law.largest)
    side = 2.0 * law.reach * high + lattice
    steep = law.amount / law.exponent * arrays.exp(-law.decay * low)
    mean = steep * (arrays.pow(low, -law.exponent) - arrays.pow(high, -law.exponent)) * side * side
    return {"smallest": low, "largest": high, "cell": side, "mean": mean}


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
    """List the members whose middles lie in a square (m, from its south-west corner) in the rows of
    ``found``: place north and east (m), diameter (m), character.  Returns the number of members; those beyond
    the last row are not written.
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
