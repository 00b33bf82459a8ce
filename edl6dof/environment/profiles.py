"""Random profiles against altitude: seeded Gauss-Markov sequences made when a case is built, read smoothly in flight.

A case carries its own profiles, so a flight gives the same bits alone, in threads or on a cluster.

Source: Gauss-Markov sequence, Gelb, Applied Optimal Estimation (1974), section 3.8; Philox, Salmon et al., SC11 (2011).
"""

from __future__ import annotations

from math import exp, sqrt

import numpy as np

from edl6dof.jit import kernel

#: Random streams of a case: the last of the three numbers (seed, case index, stream) that start a generator.
DENSITY_STREAM, GUST_STREAM = 1, 2


def stream(seed: int, case: int, source: int) -> np.random.Generator:
    """The generator that belongs to (seed, case index, source)."""
    return np.random.Generator(np.random.Philox(np.random.SeedSequence((seed, case, source))))


def gauss_markov(rng: np.random.Generator, count: int, spacing: float) -> np.ndarray:
    """Standard normals with correlation exp(-distance); ``spacing``: distance of neighbours in correlation lengths."""
    out = rng.standard_normal(count)
    _correlate(out, exp(-spacing))
    return out


@kernel
def _correlate(normals, keep):
    """Turn independent normals into a sequence whose neighbours are correlated by ``keep``, in place."""
    renew = sqrt(1.0 - keep * keep)
    for k in range(1, len(normals)):
        normals[k] = keep * normals[k - 1] + renew * normals[k]


@kernel
def smooth(profile, rows, row, t):
    """Catmull-Rom cubic through ``profile`` between ``row`` and the next (t in 0..1): continuous slope, exact at the rows."""
    p1 = profile[row]
    p2 = profile[row + 1]
    p0 = profile[max(row - 1, 0)]
    p3 = profile[min(row + 2, rows - 1)]
    s1 = 0.5 * (p2 - p0)
    s2 = 0.5 * (p3 - p1)
    rise = p2 - p1
    return p1 + t * (s1 + t * (3.0 * rise - 2.0 * s1 - s2 + t * (s1 + s2 - 2.0 * rise)))
