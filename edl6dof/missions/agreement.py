"""Statistics of flown values and the dispersed flights that predict them.

If the flights and the published uncertainties are right, a flown value is one more random draw: the
percentile at which it lies (the probability integral transform) is uniform, and a central interval of 68 %
contains 68 % of the flown values.  Values of one flight are correlated; the Mahalanobis distance takes that
into account.
Sources: Gneiting, Balabdaoui and Raftery, J. R. Stat. Soc. B 69 (2007) 243 (calibration); Gneiting and
Raftery, J. Am. Stat. Assoc. 102 (2007) 359, equation 21 (score).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import nan
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc, ndtr

from edl6dof.campaign.statistics import Proportion

#: Probabilities of the central intervals that are tested, and the one that decides.
LEVELS = (0.5, 0.68, 0.95)
DECIDES = 0.68
#: Flights per value that the covariance matrix of the values is estimated from, at least.
FLIGHTS_PER_VALUE = 5


def percentile(values: np.ndarray, flown: float, sigma: float) -> float:
    """Share (0 to 1) of predicted measurements below the flown value.

    Args:
        values: the figure in each dispersed flight, shape (n,).
        flown: published value.
        sigma: standard deviation of the error of the published value, which every flight is given too.
    """
    if not len(values):
        return nan
    if sigma > 0.0:
        return float(ndtr((flown - values) / sigma).mean())
    return float((values < flown).mean() + 0.5 * (values == flown).mean())


def score(values: np.ndarray, flown: float) -> float:
    """Continuous ranked probability score (unit of the figure): 0 is best; for one flight the difference."""
    if not len(values):
        return nan
    spread = np.abs(values[:, None] - values[None, :]).mean()
    return float(np.abs(values - flown).mean() - 0.5 * spread)


def coverage(percentiles: Sequence[float], level: float) -> Proportion:
    """Number of flown values in the central interval of probability ``level``; ``nan`` lies outside."""
    return Proportion.of([abs(2.0 * place - 1.0) <= level for place in percentiles])


def is_calibrated(percentiles: Sequence[float]) -> bool:
    """Return True if the share of values in the central 68 % is not significantly different from 68 %."""
    found = coverage(percentiles, DECIDES)
    low, high = found.interval
    return found.trials > 0 and low <= DECIDES <= high


def covariances(values: np.ndarray) -> np.ndarray:
    """Covariance of each pair of figures, shape (k, k), over the flights that reached both; NaN for fewer
    than two.

    Args:
        values: figures of the dispersed flights, shape (n, k); NaN where a flight did not reach one.
    """
    k = values.shape[1]
    found = np.full((k, k), nan)
    for i, j in np.ndindex(k, k):
        both = values[np.isfinite(values[:, [i, j]]).all(axis=1)]
        if len(both) > 1:
            found[i, j] = np.cov(both[:, i], both[:, j])[0, 1]
    return found


class Distance(NamedTuple):
    """Mahalanobis distance of the flown values of one mission from the mean of its flights."""

    squared: float
    values: int  # number of flown values
    farther: float  # probability of a larger distance, from the chi-squared distribution


def distance(values: np.ndarray, flown: np.ndarray, sigma: np.ndarray) -> Distance | None:
    """Mahalanobis distance; ``None`` without values, or with too few flights that reached all of them.

    Args:
        values: figures of the dispersed flights, shape (n, k); NaN where a flight did not reach one.
        flown: published values, shape (k,).
        sigma: standard deviations of the errors of the published values, shape (k,); 0 where unknown.
    """
    values = values[np.isfinite(values).all(axis=1)]
    n, k = values.shape
    if k == 0 or n < max(FLIGHTS_PER_VALUE * k, 2):
        return None
    off = flown - values.mean(axis=0)
    covariance = np.atleast_2d(np.cov(values.T)) + np.diag(sigma**2)
    squared = float(off @ np.linalg.pinv(covariance, hermitian=True) @ off)
    return Distance(squared, k, float(chdtrc(k, squared)))
