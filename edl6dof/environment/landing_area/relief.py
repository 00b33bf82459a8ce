"""Relief of the landing area: its parameters and record, its height at the nodes of the lattice, and the
surface between them.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from edl6dof.config.base import Params, group, param
from edl6dof.config.dtype import extended
from edl6dof.environment.landing_area.dtm import DtmParams
from edl6dof.environment.landing_area.fractal import COARSE_CELLS, NODES, fractal_at, unit_slope
from edl6dof.environment.landing_area.population import (
    CROWD,
    EDGE,
    POPULATION,
    Law,
    cell_bits,
    drawn_in,
    fill_population,
    first_cell,
    most_in_a_cell,
    place_of_member,
    rock_law,
    size_of_member,
    with_member,
)
from edl6dof.environment.profiles import GROUND_STREAM
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import pow, tan
from edl6dof.spatial.random_numbers import Stream
from edl6dof.spatial.table_index import endless_cell
from edl6dof.spatial.vector import clamp

NO_RELIEF, GENERATED = range(2)
#: Diameter (m) that the density of craters is given for.
CRATER_DIAMETER = 10.0
#: Distance (m) over which the relief fades at the edge of the area.
FADE = 100.0


class LandingAreaParams(Params):
    """Relief around the site that is finer than the map: none, or generated for each case."""

    model: Literal["none", "generated"] = param(
        "none", "generated: fractal relief, craters and rocks, different in each case"
    )
    extent_m: float = param(
        20e3, "distance from the site, north and east, to the edge of the relief", gt=FADE, le=100e3
    )
    cell_m: float = param(0.1, "distance of the nodes of its lattice", ge=0.05, le=1.0)
    hurst: float = param(
        0.75,
        "Hurst exponent: height differences grow with distance to this power",
        status="estimate",
        ge=0.3,
        le=0.95,
    )
    rms_slope_deg: float = param(
        1.5, "RMS slope of the fractal relief over slope_baseline_m", status="estimate", ge=0.0, le=20.0
    )
    slope_baseline_m: float = param(5.0, "distance over which rms_slope_deg is taken", ge=0.5, le=100.0)
    crater_density_per_km2: float = param(
        20.0, "craters larger than 10 m", status="estimate", ge=0.0, le=500.0
    )
    crater_exponent: float = param(
        2.0,
        "the number of craters above a diameter falls with this power of it (2: equilibrium, 3: production)",
        status="recalled",
        source="lunar equilibrium: Trask, JPL TR 32-800 (1966)",
        ge=1.5,
        le=3.5,
    )
    smallest_crater_m: float = param(2.0, "smallest diameter of craters", ge=1.0, le=100.0)
    largest_crater_m: float = param(200.0, "largest diameter of craters", ge=1.0, le=1000.0)
    rock_abundance: float = param(
        0.04,
        "share of the ground that rocks of all sizes cover",
        status="published",
        source="Zhurong's landing site: abstract of Golombek's law applied to Utopia Planitia",
        ge=0.0,
        le=0.4,
    )
    smallest_rock_m: float = param(0.2, "smallest diameter of rocks", ge=0.05, le=1.0)
    largest_rock_m: float = param(5.0, "largest diameter of rocks", ge=1.0, le=20.0)

    dtm: DtmParams = group(DtmParams, "digital terrain model in place of the map", record=False)


#: ``roughness``: factor of the tiles; ``level`` m: taken off, so that the
#: fractal relief is 0 at the site; ``offset``, ``turn``: how the tiles lie in this case.
LANDING_AREA = extended(
    LandingAreaParams,
    roughness="f8",
    level="f8",
    offset=np.dtype(("i8", (4,))),
    turn="i8",
    craters=POPULATION,
    rocks=POPULATION,
)


def fill_landing_area(
    record: np.void, params: LandingAreaParams, tiles: np.void, seed: int, case: int
) -> None:
    """Generate relief, craters and rocks for (``seed``, ``case``) in a record that has the parameters."""
    if params.model == "none":
        return
    rng = Stream(seed, case, GROUND_STREAM)
    record["offset"] = rng.integers(NODES * COARSE_CELLS, 4)
    record["turn"] = rng.integers(8)
    slope = tan(np.radians(params.rms_slope_deg))
    record["roughness"] = (
        slope * params.cell_m / unit_slope(params.hurst, params.slope_baseline_m / params.cell_m)
    )
    record["level"] = fractal_at(record, tiles, 0, 0)
    for name, law in _laws(params).items():
        fill_population(record[name], law, params.cell_m, rng)


def landing_area_problems(params: LandingAreaParams) -> dict[str, str]:
    """Messages about parameters that contradict each other, by key."""
    found = {}
    for name, law in _laws(params).items():
        one = name.removesuffix("s")
        if law.largest <= law.smallest:
            found[f"smallest_{one}_m"] = (
                f"must be below largest_{one}_m {law.largest:g} (got {law.smallest:g})"
            )
        elif (most := most_in_a_cell(law, params.cell_m)) > CROWD:
            found[f"smallest_{one}_m"] = (
                f"so many {name} of that size that {most:.0f} reach one place, at most {CROWD:g} are "
                f"allowed: raise it (got {law.smallest:g})"
            )
    return found


def _laws(params: LandingAreaParams) -> dict[str, Law]:
    """The populations of a landing area by the names of their records."""
    exponent = params.crater_exponent
    craters = params.crater_density_per_km2 * 1e-6 * pow(CRATER_DIAMETER, exponent) * exponent
    amount, decay = rock_law(params.rock_abundance)
    return {
        "craters": Law(
            craters,
            exponent,
            0.0,
            params.smallest_crater_m,
            params.largest_crater_m,
            0.5 * EDGE,
            stands=False,
        ),
        "rocks": Law(amount, 1.0, decay, params.smallest_rock_m, params.largest_rock_m, 0.5, stands=True),
    }


@kernel
def relief(area, tiles, north, east):
    """Interpolate the ground bilinearly at ``north``, ``east`` (m from the site); return its height (m) over
    the terrain map and its slopes towards north and east (m/m).
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
    """Heights (m) of the corners of the cell whose south-west node is (``i``, ``j``): sw, se, nw, ne.

    The height of a node does not depend on which cell it is a corner of: all members that reach it are added
    in the same order from each cell.
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
    """Height (m) of the node (``i``, ``j``): fractal relief plus heights ``craters`` and ``rocks`` (m)."""
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
