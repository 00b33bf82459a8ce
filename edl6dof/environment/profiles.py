"""Random profiles against altitude: seeded Gauss-Markov sequences made when a case is built, read smoothly in
flight.

A case carries its own profiles, so a flight gives the same bits alone, in threads or on a cluster.

Source: Gauss-Markov sequence, Gelb, Applied Optimal Estimation (1974), section 3.8.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import exp
from edl6dof.spatial.random_numbers import Stream

#: Random streams of a case: the last of the three numbers (seed, case index, stream) that start a generator.
DENSITY_STREAM, GUST_STREAM, TEMPERATURE_STREAM, GROUND_STREAM = 1, 2, 3, 4
#: Of the first sensor of the family; the others follow.
SENSOR_STREAM = 100


def gauss_markov(rng: Stream, count: int, spacing: float) -> np.ndarray:
    """Standard normals with correlation exp(-distance); ``spacing``: distance of neighbours in correlation
    lengths.
    """
    out = rng.standard_normal(count)
    _correlate(out, exp(-spacing))
    return out


def central_slopes(profile: np.ndarray) -> np.ndarray:
    """Slopes per row of a profile: half the rise between its two neighbours (Catmull-Rom), at an end half of
    the one rise.
    """
    padded = np.concatenate([profile[:1], profile, profile[-1:]])
    return 0.5 * (padded[2:] - padded[:-2])


@kernel
def _correlate(normals, keep):
    """Turn independent normals into a sequence whose neighbours are correlated by ``keep``, in place."""
    renew = sqrt(1.0 - keep * keep)
    for k in range(1, len(normals)):
        normals[k] = keep * normals[k - 1] + renew * normals[k]
