"""Safe ground by the probability that slope and roughness are within their limits, given the errors of range.

The elevation of each cell c is assumed normal, with independent errors of range, of standard deviation s /
sqrt(w_c) at the weight w_c of the cell, and the relief b between the points of a cell. Then

    p = Phi((tan(limit) - rise) / s_rise) * prod over the cells of the footprint Phi((limit - |h_c|) / s_c)

with h_c the height over the plane and s_c^2 = s^2 / w_c + b^2. The rise of a plane of least squares over
independent errors has s_rise = s / (m sqrt(sum x^2)), m the side of a cell and x the columns from the middle;
the half-plane of rises below the limit in the measured direction contains the disc of all gentler planes, so
the first factor is an upper bound, which is sharp for s_rise far below the limit, here about 0.1 deg. The
error of the plane itself in h_c is that of a mean over hundreds of cells and is left out.

Source: Tomita and Ho, "Real-time stochastic terrain mapping and processing for autonomous safe landing",
arXiv 2409.09309 (2024), for a Gaussian map; this product replaces their bounds.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.fsw.hazard.elevation_map import (
    MAP_CELLS,
    SAFE,
    TOO_ROUGH,
    TOO_STEEP,
    UNKNOWN,
    UNSEEN,
    chord,
    fit_row,
)
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.elementary import erfc, tan


class ProbabilisticParams(Params):
    """Slope and roughness within limits, with a probability."""

    slope_limit_deg: float = param(
        8.0, "largest slope under the footprint", status="recalled", source="Chang'e-3", gt=0.0, lt=45.0
    )
    roughness_limit_m: float = param(
        0.22,
        "largest distance of a cell of the footprint from its plane: below that of a rock of half a metre",
        status="estimate", gt=0.0, le=5.0,
    )  # fmt: skip
    relief_between_m: float = param(
        0.02, "standard deviation of relief between points of a cell", status="estimate", ge=0.0, le=1.0
    )
    least_probability: float = param(
        0.95, "least probability at which a spot counts as safe", status="estimate", gt=0.0, lt=1.0
    )


#: Coefficients a, b, ...: the probability that a standard normal lies above ``x`` >= 0 is half the inverse of
#: the 16th power of 1 + x (a + x (b + ...)), within 1.5e-7: Abramowitz and Stegun, Handbook of Mathematical
#: Functions (1964), 26.2.19.
_HASTINGS = np.array(
    (0.0498673470, 0.0211410061, 0.0032776263, 0.0000380036, 0.0000488906, 0.0000053830), np.float32
)
_NONE, _HALF, _ALL = np.float32(0.0), np.float32(0.5), np.float32(1.0)


@kernel
def below(x):
    """Probability that a standard normal lies below ``x``."""
    return 0.5 * erfc(-x * sqrt(0.5))


@kernel
def spread_of_rise(radius_m, cell, deviation):
    """Standard deviation of the rise (tangent) of the plane of a footprint by the errors of its cells, of
    standard deviation ``deviation`` (m).
    """
    radius, second = radius_m / cell, 0.0
    reach = chord(radius, 0)
    for row in range(-reach, reach + 1):
        second += row * row * (2 * chord(radius, row) + 1)
    return deviation / (cell * sqrt(second))


@kernel
def sharpness(elevation_map, deviation, between, out):
    """Write the inverse of the standard deviation of the elevation of each known cell (1/m) into ``out``."""
    for i in range(MAP_CELLS):
        for j in range(MAP_CELLS):
            weight = max(elevation_map.weight[i, j], 1e-6)
            out[i, j] = 1.0 / sqrt(deviation * deviation / weight + between * between)


@kernel
def below_fast(x):
    """:func:`below` in single precision, within 3e-7; a negative ``x`` counts as zero."""
    x = x if x > _NONE else _NONE
    a, b, c, d, e, f = _HASTINGS
    root = _ALL + x * (a + x * (b + x * (c + x * (d + x * (e + x * f)))))
    fourth = root * root * root * root
    return _ALL - _HALF / (fourth * fourth * fourth * fourth)


@kernel
def keep_row(elevation_map, sharp, radius, i, first, last, planes):
    """Write the probability that no cell of the footprint is farther off its plane than ``planes.limit`` (m,
    up or down) into ``planes.kept``, for the columns from ``first`` up to ``last`` of row ``i``; an upper
    bound where a cell is farther. ``sharp``: inverse of the standard deviation of each cell (1/m).
    """
    reach = chord(radius, 0)
    level, limit, kept = planes.level[first:last], planes.limit[first:last], planes.kept[first:last]
    rise_east, rise_north = planes.rise_east[first:last], planes.rise_north[first:last]
    for j in range(last - first):
        kept[j] = _ALL
    for row in range(-reach, reach + 1):
        half, north = chord(radius, row), np.float32(row)
        for column in range(-half, half + 1):
            east, top = np.float32(column), elevation_map.highest[i + row, first + column : last + column]
            sure = sharp[i + row, first + column : last + column]
            for j in range(last - first):
                off = abs(top[j] - level[j] - rise_east[j] * east - rise_north[j] * north)
                kept[j] *= below_fast((limit[j] - off) * sure[j])


@kernel
def classify_by_probability(
    elevation_map, footprint, radius_m, steepest, roughest, deviation, between, least, out
):
    """Classify a cell as safe where the probability that slope and roughness are within their limits is at
    least ``least``; for other cells this probability is an upper bound.

    Args:
        elevation_map: ``ELEVATION_MAP`` record.
        footprint: ``FOOTPRINT`` record of the map; its ``planes`` are workspace.
        radius_m: radius of the footprint, m.
        steepest, roughest: limits of slope (tangent) and roughness (m).
        deviation: standard deviation of the elevation of one point of weight 1, m.
        between: standard deviation of the relief between the points of a cell, m.
        least: probability from which a cell is safe.
        out: ``SAFETY_MAP`` record, classes and probabilities written; its clearances, computed later, are
            workspace.
    """
    radius, planes, sharp = radius_m / elevation_map.cell, footprint.planes, out.clearance
    sharpness(elevation_map, max(deviation, 1e-9), between, sharp)
    spread = max(
        spread_of_rise(radius_m, elevation_map.cell, sqrt(deviation * deviation + between * between)), 1e-9
    )
    sharpest = max(between, 1e-9)
    for i in range(MAP_CELLS):
        first, last = MAP_CELLS, 0
        for j in range(MAP_CELLS):
            rise, rough = footprint.slope[i, j], footprint.roughness[i, j]
            out.cell_class[i, j], out.probability[i, j], planes.limit[j] = UNSEEN, 0.0, 0.0
            if rise >= UNKNOWN:
                continue
            probability = below((steepest - rise) / spread)
            out.cell_class[i, j] = TOO_STEEP
            if probability >= least:
                # the farthest cell alone excludes most footprints
                farthest = below((roughest - rough) / sharpest)
                out.cell_class[i, j] = SAFE if probability * farthest >= least else TOO_ROUGH
                probability *= 1.0 if out.cell_class[i, j] == SAFE else farthest
            out.probability[i, j] = probability
            if out.cell_class[i, j] == SAFE:
                planes.limit[j] = roughest * sqrt(1.0 + rise * rise)
                first, last = min(first, j), j + 1
        if first < last:
            fit_row(elevation_map, radius, i, planes)
            keep_row(elevation_map, sharp, radius, i, first, last=last, planes=planes)
        for j in range(first, last):
            if out.cell_class[i, j] == SAFE:
                out.probability[i, j] *= planes.kept[j]
                out.cell_class[i, j] = SAFE if out.probability[i, j] >= least else TOO_ROUGH


@kernel
def classify(params, elevation_map, footprint, radius, deviation, out):
    """Classify every cell of ``elevation_map``; arguments: :mod:`edl6dof.fsw.hazard.registry`."""
    classify_by_probability(
        elevation_map, footprint, radius_m=radius, steepest=tan(params.slope_limit),
        roughest=params.roughness_limit, deviation=deviation, between=params.relief_between,
        least=params.least_probability, out=out,
    )  # fmt: skip


MEMBER = Member(
    "lidar_probabilistic", ProbabilisticParams, {"classify": classify}, "Tomita and Ho, arXiv 2409.09309"
)
