"""The exact Euclidean distance transform: how far each cell is from the nearest hazard.

Two passes of lower envelopes of parabolas, in time proportional to the number of cells.  Source: Felzenszwalb
and Huttenlocher, "Distance transforms of sampled functions", Theory of Computing 8 (2012), 415-428.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.fsw.hazard.elevation_map import MAP_CELLS
from edl6dof.kernels import kernel
from edl6dof.records import record, whole

#: Square of a distance that no two cells have.
_FAR = 1e9

ENVELOPE = record(
    ("given", "f8", (MAP_CELLS,)),  # the sampled function
    ("apex", whole(0, MAP_CELLS - 1), (MAP_CELLS,)),  # where each parabola of the envelope stands
    ("begins", "f8", (MAP_CELLS + 1,)),  # from where on it is the lowest
    ("squared", "f4", (MAP_CELLS, MAP_CELLS)),  # distance along the columns, squared
)


@kernel
def along_columns(hazard, work):
    """Squared distance (cells) to the nearest hazard of the same column."""
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
    """Parabolas of the lower envelope of those that stand on the ``n`` values given; returns how many."""
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
    """Where the parabola on ``q`` begins to lie below the one on ``p``."""
    return ((work.given[q] + q * q) - (work.given[p] + p * p)) / (2.0 * (q - p))


@kernel
def clearances(hazard, cell, work, out):
    """Distance (m) of the middle of each cell from that of the nearest hazard.

    Args:
        hazard: flags of the cells, 0 where there is none, shape (``MAP_CELLS``, ``MAP_CELLS``).
        cell: side of a cell, m.
        work: ``ENVELOPE`` record, scratch.
        out: distances, written, of the same shape; of a map without hazards larger than any.
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
