"""Maps of made-up ground for tests of hazard detection."""

import numpy as np
from numba import njit

from edl6dof.fsw.hazard.elevation_map import ELEVATION_MAP, MAP_CELLS, begin_map

CELL_M = 0.2
#: Middles of the cells, m north and east of the middle of the map.
NORTH, EAST = np.meshgrid(*2 * [(np.arange(MAP_CELLS) - MAP_CELLS / 2 + 0.5) * CELL_M], indexing="ij")


def empty_chart(cell_m=CELL_M, centre_L=(0.0, 0.0, 0.0)):
    """A map without points."""
    chart = np.zeros(1, ELEVATION_MAP)[0]
    begin_map(cell_m, centre_L, chart)
    return chart


def chart_of(heights, deviation=0.0, seed=3):
    """A map in which each cell has one point of an elevation, shape (256, 256), with errors."""
    chart = empty_chart()
    heights = heights + deviation * np.random.default_rng(seed).standard_normal(heights.shape)
    chart["mean"] = chart["highest"] = heights
    chart["weight"] = 1.0
    return chart


def rocks(abundance, seed, smallest=0.15, largest=3.0):
    """Place (north, east) and diameter, m, shape (n, 3), of rocks by Golombek's law over a little more than
    the map.
    """
    from scipy.integrate import quad

    rng, q = np.random.default_rng(seed), 1.79 + 0.152 / abundance
    diameters = np.geomspace(smallest, largest, 60)
    above = [
        quad(lambda x: 4.0 * q * abundance * np.exp(-q * x) / (np.pi * x * x), d, np.inf)[0]
        for d in diameters
    ]
    side = 0.5 * MAP_CELLS * CELL_M + largest
    count = rng.poisson(above[0] * (2.0 * side) ** 2)
    size = np.interp(np.log(rng.uniform(above[-1], above[0], count)), np.log(above[::-1]), diameters[::-1])
    return np.column_stack([rng.uniform(-side, side, (count, 2)), size])


def rocky(stones, north=NORTH, east=EAST):
    """Height (m) of half-ellipsoids half as high as wide, at places of an array's shape."""
    heights = np.zeros(north.size)
    raise_stones(np.array(stones, float), np.ravel(north), np.ravel(east), heights)
    return heights.reshape(north.shape)


@njit
def raise_stones(stones, north, east, heights):
    """Thousands of stones in a hundred thousand places, compiled."""
    for n, e, d in stones:
        for i in range(len(heights)):
            square = 1.0 - ((north[i] - n) ** 2 + (east[i] - e) ** 2) / (0.5 * d) ** 2
            if square > 0.0:
                heights[i] = max(heights[i], 0.5 * d * np.sqrt(square))


def new(dtype):
    """An empty record."""
    return np.zeros(1, dtype)[0]
