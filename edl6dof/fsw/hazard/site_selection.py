"""Site selection: search for the best safe cell in rings around the point below, and the record of the chosen
points, which guidance and the mission read.

The cost of a spot is its distance plus its missing clearance and the propellant to reach it, both expressed
in metres. Rings of growing distance are searched until none farther out can cost less. Rejected spots are
stored with the reason, at most one for each footprint.

The clearance of a cell is its distance from the nearest hazard, by the exact Euclidean distance transform:
two passes of lower envelopes of parabolas, in time proportional to the number of cells.  Source: Felzenszwalb
and Huttenlocher, "Distance transforms of sampled functions", Theory of Computing 8 (2012), 415-428.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.config.base import Params, param
from edl6dof.fsw.hazard.elevation_map import CELL_CLASSES, MAP_CELLS, SAFE, TOO_ROUGH, cell_of, middle_of
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record, whole

#: Square of a distance (cells) beyond that of any two cells.
_FAR = 1e9

ENVELOPE = record(
    ("given", "f8", (MAP_CELLS,)),  # the sampled function
    ("apex", whole(0, MAP_CELLS - 1), (MAP_CELLS,)),  # column of the apex of each parabola of the envelope
    ("begins", "f8", (MAP_CELLS + 1,)),  # column from which each parabola is the lowest
    ("squared", "f4", (MAP_CELLS, MAP_CELLS)),  # distance along the columns, squared
)


@kernel
def along_columns(hazard, work):
    """Write the squared distance (cells) of each cell to the nearest hazard of its column."""
    for j in range(MAP_CELLS):
        last = -(10**5)
        for i in range(MAP_CELLS):
            if hazard[i, j] != 0:
                last = i
            work.squared[i, j] = min(float((i - last) * (i - last)), _FAR)
        last = 10**5
        for i in range(MAP_CELLS - 1, -1, -1):
            if hazard[i, j] != 0:
                last = i
            work.squared[i, j] = min(float((last - i) * (last - i)), float(work.squared[i, j]))


@kernel
def lower_envelope(n, work):
    """Find the lower envelope of the parabolas on the ``n`` sampled values; returns the number of its
    parabolas.
    """
    count = 0
    work.apex[0], work.begins[0], work.begins[1] = 0, -_FAR, _FAR
    for q in range(1, n):
        at = _crossing(q, work.apex[count], work)
        while at <= work.begins[count]:
            count -= 1
            at = _crossing(q, work.apex[count], work)
        count += 1
        work.apex[count], work.begins[count], work.begins[count + 1] = q, at, _FAR
    return count + 1


@kernel
def _crossing(q, p, work):
    """Column from which the parabola on ``q`` is below that on ``p``."""
    return ((work.given[q] + q * q) - (work.given[p] + p * p)) / (2.0 * (q - p))


@kernel
def clearances(hazard, cell, work, out):
    """Write the distance (m) of the centre of each cell from that of the nearest hazard.

    Args:
        hazard: flags of the cells, 0 where there is none, shape (``MAP_CELLS``, ``MAP_CELLS``).
        cell: side of a cell, m.
        work: ``ENVELOPE`` record, workspace.
        out: distances, written, of the same shape; without hazards larger than any on the map.
    """
    along_columns(hazard, work)
    for i in range(MAP_CELLS):
        for j in range(MAP_CELLS):
            work.given[j] = work.squared[i, j]
        lower_envelope(MAP_CELLS, work)
        k = 0
        for j in range(MAP_CELLS):
            while work.begins[k + 1] < j:
                k += 1
            off = j - work.apex[k]
            out[i, j] = cell * sqrt(off * off + work.given[work.apex[k]])


#: The landing points that hazard detection has chosen.
LANDING_POINT = record(
    ("coarse_known", FLAG),  # coarse hazard avoidance has chosen
    ("coarse_L", "f8", (2,)),  # m, L: east and north of the landing site, above which powered descent ends
    ("fine_known", FLAG),  # hazard avoidance has chosen the spot to land on
    ("fine_L", "f8", (2,)),  # m, L: east and north of the landing site, where the lander is to stand
)

#: Most rejected spots that are stored.
MAX_REJECTED = 64


class ChoiceParams(Params):
    """The cost of a spot."""

    clearance_m: float = param(
        2.0,
        "distance from the nearest unsafe cell beyond which a larger distance has no value",
        status="design",
        ge=0.0,
    )
    clearance_worth: float = param(
        50.0, "cost (m) of a metre of missing clearance", status="design", ge=0.0, le=1e4
    )
    propellant_worth_m: float = param(
        5.0, "cost (m) of a kilogram of propellant", status="design", ge=0.0, le=1e4
    )


#: A rejected spot.
REJECTED = record(
    ("spot_L", "f8", (2,)),  # m: east and north of the landing site
    ("cell_class", whole(0, len(CELL_CLASSES) - 1)),
)

CHOICE = record(
    ("found", FLAG),  # a safe spot was found
    ("spot_L", "f8", (2,)),  # m: east and north of the landing site
    ("clearance", "f8"),  # m
    ("cost", "f8"),  # m
    ("n_rejected", whole(0, MAX_REJECTED)),
    ("rejected", REJECTED, (MAX_REJECTED,)),
)


@kernel
def cost_of(params, distance, clearance, speed, time, flow):
    """Cost (m) of a spot at a ``distance`` with a ``clearance`` (m); ``speed``: of the flight to the spot,
    m/s; ``time``: of the descent without it, s; ``flow``: of propellant in hover, kg/s.
    """
    lacks = max(params.clearance - clearance, 0.0)
    propellant = flow * max(distance / speed - time, 0.0)
    return distance + params.clearance_worth * lacks + params.propellant_worth * propellant


@kernel
def pass_over(spot_L, cell_class, apart, out):
    """Store a rejected spot, unless one is stored within the distance ``apart`` (m)."""
    n = out.n_rejected
    if n == MAX_REJECTED:
        return
    for k in range(n):
        east, north = out.rejected[k].spot_L[0] - spot_L[0], out.rejected[k].spot_L[1] - spot_L[1]
        if east * east + north * north < apart * apart:
            return
    out.rejected[n].spot_L[0], out.rejected[n].spot_L[1] = spot_L
    out.rejected[n].cell_class = cell_class
    out.n_rejected = n + 1


@kernel
def choose_spot(params, elevation_map, safety_map, here_L, apart, speed, time, flow, out):
    """Search the safe spot of least cost around ``here_L`` (east, north of the landing site, m).

    Args:
        params: choice parameters.
        elevation_map, safety_map: ``ELEVATION_MAP`` and ``SAFETY_MAP`` records.
        here_L: the point below.
        apart: least distance between stored rejected spots, m.
        speed, time, flow: as for :func:`cost_of`.
        out: ``CHOICE`` record, written; the spot is unchanged if none is safe.
    """
    row, column, _ = cell_of(elevation_map, here_L[0], here_L[1])
    out.found, out.cost, out.n_rejected = 0, 1e9, 0
    for ring in range(MAP_CELLS):
        if ring * elevation_map.cell > out.cost:
            return
        for i in range(max(row - ring, 0), min(row + ring, MAP_CELLS - 1) + 1):
            # between the first and the last row of the ring only the two end columns
            step = 1 if abs(i - row) == ring else max(2 * ring, 1)
            for j in range(column - ring, column + ring + 1, step):
                if j < 0 or j >= MAP_CELLS:
                    continue
                spot_L = middle_of(elevation_map, i, j)
                if safety_map.cell_class[i, j] != SAFE:
                    pass_over(spot_L, safety_map.cell_class[i, j], apart, out)
                    continue
                east, north = spot_L[0] - here_L[0], spot_L[1] - here_L[1]
                distance, clearance = sqrt(east * east + north * north), float(safety_map.clearance[i, j])
                cost = cost_of(params, distance, clearance, speed, time, flow=flow)
                if cost < out.cost:
                    out.found, out.cost, out.clearance = 1, cost, clearance
                    out.spot_L[0], out.spot_L[1] = spot_L


@kernel
def least_bad(elevation_map, footprint, safety_map, here_L, out):
    """Choose a spot where none is safe: the least roughness of the cells that are not too steep, of several
    the nearest; the point below if no cell is known.
    """
    out.spot_L[0], out.spot_L[1] = here_L
    out.clearance, least = 0.0, 1e9
    for i in range(MAP_CELLS):
        for j in range(MAP_CELLS):
            if safety_map.cell_class[i, j] != TOO_ROUGH:
                continue
            spot_L = middle_of(elevation_map, i, j)
            east, north = spot_L[0] - here_L[0], spot_L[1] - here_L[1]
            # a metre of way for a millimetre of roughness
            cost = footprint.roughness[i, j] + 1e-3 * sqrt(east * east + north * north)
            if cost < least:
                least = cost
                out.spot_L[0], out.spot_L[1] = spot_L
