"""Curves against altitude: cubics between the rows of a uniform grid, with continuous slopes; and random
profiles.

Random profiles are seeded Gauss-Markov sequences made when a case is built.  Each case has its own profiles,
so a flight gives the same bits alone, in threads or on a cluster.
Source: slopes on a uniform grid (harmonic mean): Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5 (1984)
300-304.  Gauss-Markov sequence: Gelb, Applied Optimal Estimation (1974), section 3.8.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import exp
from edl6dof.spatial.random_numbers import Stream

#: Rows of the longest curve.
MAX_ROWS = 512


@kernel
def cubic(curve, row, t):
    """Cubic from ``row`` (t = 0) to the next row (t = 1)."""
    return curve[row, 0] + t * (curve[row, 1] + t * (curve[row, 2] + t * curve[row, 3]))


@kernel
def integral(curve, row, t):
    """Integral of :func:`cubic` from ``row`` up to ``t``, in rows."""
    c = curve[row]
    return t * (c[0] + t * (c[1] / 2.0 + t * (c[2] / 3.0 + t * (c[3] / 4.0))))


@kernel
def straight_beyond(curve, row, t):
    """Rise of a straight line with the end slope beyond the table; zero inside."""
    if t < 0.0:
        return t * curve[row, 1]
    if t > 1.0:
        return (t - 1.0) * (curve[row, 1] + 2.0 * curve[row, 2] + 3.0 * curve[row, 3])
    return 0.0


def cubic_coefficients(curve: np.ndarray, slope: np.ndarray) -> np.ndarray:
    """Coefficients (n-1, 4) for :func:`cubic` of the cubics through n rows with these slopes per row."""
    s0, s1, rise = slope[:-1], slope[1:], np.diff(curve)
    out = np.empty((len(rise), 4))
    out[:, 0], out[:, 1], out[:, 2], out[:, 3] = (
        curve[:-1],
        s0,
        3.0 * rise - 2.0 * s0 - s1,
        s0 + s1 - 2.0 * rise,
    )
    return out


def monotone_slopes(curve: np.ndarray, sloping_ends: bool) -> np.ndarray:
    """Slopes per row: harmonic mean of both rises, zero at extremes; at the ends the rise or zero."""
    rise = np.diff(curve)
    product = rise[:-1] * rise[1:]
    inner = np.zeros(len(curve) - 2)
    same = product > 0.0
    inner[same] = 2.0 * product[same] / (rise[:-1] + rise[1:])[same]
    start, end = (rise[0], rise[-1]) if sloping_ends else (0.0, 0.0)
    return np.concatenate([[start], inner, [end]])


#: Random streams of a case: the last of the three numbers (seed, case index, stream) that start a generator.
DENSITY_STREAM, GUST_STREAM, TEMPERATURE_STREAM, GROUND_STREAM, FAULT_STREAM = 1, 2, 3, 4, 5
#: Random stream of the first sensor of the family; those of the others follow.
SENSOR_STREAM = 100


def gauss_markov(rng: Stream, count: int, spacing: float) -> np.ndarray:
    """Standard normals with correlation exp(-distance); ``spacing`` of neighbours in correlation lengths."""
    out = rng.standard_normal(count)
    _correlate(out, exp(-spacing))
    return out


def central_slopes(profile: np.ndarray) -> np.ndarray:
    """Slopes per row (Catmull-Rom): half the rise between both neighbours, at an end half the one rise."""
    padded = np.concatenate([profile[:1], profile, profile[-1:]])
    return 0.5 * (padded[2:] - padded[:-2])


@kernel
def _correlate(normals, keep):
    """Turn independent normals into a sequence whose neighbours are correlated by ``keep``, in place."""
    renew = sqrt(1.0 - keep * keep)
    for k in range(1, len(normals)):
        normals[k] = keep * normals[k - 1] + renew * normals[k]
