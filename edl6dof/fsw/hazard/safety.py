"""Which cells of a map are safe to stand on: by limits of slope and roughness, or by the probability that
both are kept.

The probability takes the elevation of each cell as normal: independent errors of range, of standard deviation
s over the square root of the cell's weight, and the relief b that a cell hides between its points (Tomita and
Ho, arXiv 2409.09309, model both by a Gaussian map).  Then

    p = Phi((tan(limit) - rise) / s_rise) * prod over the cells of the footprint Phi((limit - |h_c|) / s_c)

with h_c the height over the plane and s_c^2 = s^2 / w_c + b^2.  The rise of a plane of least squares over
independent errors has s_rise = s / (m sqrt(sum x^2)), m the side of a cell and x the columns from the middle;
the half-plane in its direction holds the disc of gentler planes, so the first factor is an upper bound that
is sharp for s_rise far below the limit, here 0.1 deg beside degrees.  The error of the plane itself in h_c is
that of a mean over hundreds of cells and is left out.
"""

from __future__ import annotations

from math import erfc, exp, log, sqrt

import numpy as np

from edl6dof.fsw.hazard.footprint import UNKNOWN, chord, fit_row
from edl6dof.fsw.hazard.point_map import MAP_CELLS
from edl6dof.jit import kernel
from edl6dof.records import whole

#: Verdicts on a cell.
SAFE, UNSEEN, TOO_STEEP, TOO_ROUGH = range(4)
VERDICTS = ("safe", "edge", "slope", "rock")

#: Standard deviations within which a cell may keep a limit or not; farther off it does, or does not.
_DOUBT = 5.0
#: -log Phi at steps of ``_FINE`` standard deviations from -``_DOUBT`` to one beyond ``_DOUBT``: it is read
#: for every cell of every footprint.
_FINE = 0.01
_DOUBTS = np.array(
    [-log(0.5 * erfc(-(k * _FINE - _DOUBT) * sqrt(0.5))) for k in range(round(2.0 * _DOUBT / _FINE) + 2)]
)

JUDGED = np.dtype(
    [
        ("verdict", whole(SAFE, TOO_ROUGH, kind="i1"), (MAP_CELLS, MAP_CELLS)),  # of the list above
        ("probability", "f4", (MAP_CELLS, MAP_CELLS)),  # that both limits are kept
        ("clearance", "f4", (MAP_CELLS, MAP_CELLS)),  # m: distance from the nearest cell that is not safe
    ],
    align=True,
)


@kernel
def judge_by_limits(footprint, steepest, roughest, out):
    """Call a cell safe where slope (tangent) and roughness (m) keep their limits.

    Args:
        footprint: ``FOOTPRINT`` record.
        steepest: limit of the tangent of the slope.
        roughest: limit of the roughness, m.
        out: ``JUDGED`` record, verdicts and probabilities written.
    """
    for i in range(MAP_CELLS):
        for j in range(MAP_CELLS):
            verdict = SAFE
            if footprint.slope[i, j] >= UNKNOWN:
                verdict = UNSEEN
            elif footprint.slope[i, j] > steepest:
                verdict = TOO_STEEP
            elif footprint.roughness[i, j] > roughest:
                verdict = TOO_ROUGH
            out.verdict[i, j] = verdict
            out.probability[i, j] = 1.0 if verdict == SAFE else 0.0


@kernel
def below(x):
    """Probability that a standard normal lies below ``x``."""
    return 0.5 * erfc(-x * sqrt(0.5))


@kernel
def spread_of_rise(radius_m, cell, deviation):
    """Standard deviation of the rise of the plane of a footprint, by the errors of its cells (m)."""
    radius, second = radius_m / cell, 0.0
    reach = chord(radius, 0)
    for row in range(-reach, reach + 1):
        second += row * row * (2 * chord(radius, row) + 1)
    return deviation / (cell * sqrt(second))


@kernel
def sharpness(chart, deviation, between, out):
    """Write the inverse of the standard deviation of the elevation of each known cell (1/m) into ``out``."""
    for i in range(MAP_CELLS):
        for j in range(MAP_CELLS):
            weight = max(chart.weight[i, j], 1e-6)
            out[i, j] = 1.0 / sqrt(deviation * deviation / weight + between * between)


@kernel
def doubt_of(x):
    """-log Phi of ``x``, at most ``_DOUBT``; below -``_DOUBT`` that of it."""
    place = max(x + _DOUBT, 0.0) / _FINE
    k = int(place)
    return _DOUBTS[k] + (place - k) * (_DOUBTS[k + 1] - _DOUBTS[k])


@kernel
def keeps_clear(chart, sharp, radius, i, j, planes, roughest, least):
    """Probability that no cell of the footprint around (i, j) lies farther off its plane than ``roughest``
    (m, up or down); once it is seen to be less than ``least``, an upper bound of it.

    ``sharp`` is the inverse of the standard deviation of each cell (1/m).
    """
    reach, doubt, enough = chord(radius, 0), 0.0, -log(least)
    for row in range(-reach, reach + 1):
        half = chord(radius, row)
        level = planes.level[j] + planes.rise_north[j] * row
        for column in range(-half, half + 1):
            off = chart.highest[i + row, j + column] - level - planes.rise_east[j] * column
            x = (roughest - abs(off)) * sharp[i + row, j + column]
            if x < _DOUBT:
                doubt += doubt_of(x)
        if doubt > enough:
            break
    return exp(-doubt)


@kernel
def judge_by_probability(chart, footprint, radius_m, steepest, roughest, deviation, between, least, out):
    """Call a cell safe where the probability that slope and roughness keep their limits is large enough;
    where it is not, what is noted is an upper bound of it.

    Args:
        chart: ``ELEVATION_MAP`` record.
        footprint: ``FOOTPRINT`` record of it; its scratch is used again.
        radius_m: of the footprint, m.
        steepest, roughest: limits, as of :func:`judge_by_limits`.
        deviation: standard deviation of the elevation of one point of whole weight, m.
        between: standard deviation of the relief between the points of a cell, m.
        least: probability from which on a cell is safe.
        out: ``JUDGED`` record, verdicts and probabilities written; its clearances, which are worked out
            afterwards, are scratch.
    """
    radius, planes, sharp = radius_m / chart.cell, footprint.planes, out.clearance
    sharpness(chart, max(deviation, 1e-9), between, sharp)
    reach = chord(radius, 0)
    spread = max(spread_of_rise(radius_m, chart.cell, sqrt(deviation * deviation + between * between)), 1e-9)
    sharpest = max(between, 1e-9)
    for i in range(MAP_CELLS):
        if reach <= i < MAP_CELLS - reach:
            fit_row(chart, radius, i, planes)
        for j in range(MAP_CELLS):
            rise, rough = footprint.slope[i, j], footprint.roughness[i, j]
            out.verdict[i, j], out.probability[i, j] = UNSEEN, 0.0
            if rise >= UNKNOWN:
                continue
            probability = below((steepest - rise) / spread)
            out.verdict[i, j] = TOO_STEEP
            if probability >= least:
                # its farthest cell alone says enough of most footprints
                probability *= below((roughest - rough) / sharpest)
                out.verdict[i, j] = TOO_ROUGH
            if probability >= least:
                upward = roughest * sqrt(1.0 + rise * rise)
                probability = below((steepest - rise) / spread) * keeps_clear(
                    chart, sharp, radius, i, j, planes, upward, least
                )
                if probability >= least:
                    out.verdict[i, j] = SAFE
            out.probability[i, j] = probability
