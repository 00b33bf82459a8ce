"""Site selection: the spiral search for the best safe cell outwards from the point below, and the record of
the points chosen, which guidance and the mission read.

The cost of a spot is its distance, and its missing clearance and its propellant expressed in metres of
distance.  Rings of growing distance are searched until none farther out can cost less.  Spots that the search
passed over are remembered with the reason, one for each footprint.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.config.base import Params, param
from edl6dof.fsw.hazard.elevation_map import MAP_CELLS, cell_of, middle_of
from edl6dof.fsw.hazard.safety import CELL_CLASSES, SAFE, TOO_ROUGH
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record, whole

#: The points to land at that hazard detection has chosen.
LANDING_POINT = record(
    ("coarse_known", FLAG),  # coarse hazard avoidance has chosen
    ("coarse_L", "f8", (2,)),  # m, L: east and north of the landing site, above which powered descent ends
    ("fine_known", FLAG),  # hazard avoidance has chosen the spot to land on
    ("fine_L", "f8", (2,)),  # m, L: east and north of the landing site, where the lander is to stand
)

#: Most spots that are remembered as passed over.
MAX_REJECTED = 64


class ChoiceParams(Params):
    """The cost of a spot."""

    clearance_m: float = param(
        2.0, "distance from the nearest unsafe spot beyond which more brings nothing", status="design", ge=0.0
    )
    clearance_worth: float = param(
        50.0, "way (m) that a metre of clearance is worth", status="design", ge=0.0, le=1e4
    )
    propellant_worth_m: float = param(
        5.0, "way (m) that a kilogram of propellant is worth", status="design", ge=0.0, le=1e4
    )


#: A spot that the search passed over.
REJECTED = record(
    ("spot_L", "f8", (2,)),  # m: east and north of the landing site
    ("cell_class", whole(0, len(CELL_CLASSES) - 1)),
)

CHOICE = record(
    ("found", FLAG),  # whether there was a safe spot
    ("spot_L", "f8", (2,)),  # m: east and north of the landing site
    ("clearance", "f8"),  # m
    ("cost", "f8"),  # m
    ("n_rejected", whole(0, MAX_REJECTED)),
    ("rejected", REJECTED, (MAX_REJECTED,)),
)


@kernel
def cost_of(params, distance, clearance, speed, time, flow):
    """Cost of a spot, m.

    Args:
        params: choice parameters.
        distance: of the spot, m.
        clearance: of the spot, m.
        speed: with which it is flown to, m/s.
        time: that the descent takes anyway, s.
        flow: of propellant in hover, kg/s.
    """
    lacks = max(params.clearance - clearance, 0.0)
    propellant = flow * max(distance / speed - time, 0.0)
    return distance + params.clearance_worth * lacks + params.propellant_worth * propellant


@kernel
def pass_over(spot_L, cell_class, apart, out):
    """Remember a spot that is not safe, unless one so near to it is remembered already (m)."""
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
        elevation_map: ``ELEVATION_MAP`` record: where the map lies.
        safety_map: ``SAFETY_MAP`` record.
        here_L: the point below.
        apart: distance by which spots that are passed over and remembered differ, m.
        speed, time, flow: as of :func:`cost_of`.
        out: ``CHOICE`` record, written; the spot is where it was if none is safe.
    """
    row, column, _ = cell_of(elevation_map, here_L[0], here_L[1])
    out.found, out.cost, out.n_rejected = 0, 1e9, 0
    for ring in range(MAP_CELLS):
        if ring * elevation_map.cell > out.cost:
            return
        for i in range(max(row - ring, 0), min(row + ring, MAP_CELLS - 1) + 1):
            # of the rows between the first and the last, the two ends
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
    """Where no spot is safe: that of the least roughness among those that are not too steep, of several the
    nearest; where none is known, the point below.
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
