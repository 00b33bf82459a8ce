"""Quantiles of a campaign with their bounds, as far as its flights can bound them.

>>> flights_needed(0.99), flights_needed(0.9987)
(368, 2836)
>>> quantile(np.arange(1.0, 101.0), 0.95)
Quantile(share=0.95, value=95.05, low=90.0, high=100.0)
>>> quantile(np.arange(1.0, 101.0), 0.99) is None
True
"""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass
from functools import cache
from math import ceil, log

import numpy as np
from scipy.special import bdtr

#: Probability that both bounds hold.
CONFIDENCE = 0.95

#: Shares whose quantiles are of interest: the median, and pairs further and further out, to three standard
#: deviations of a normal distribution, one-sided.
SHARES = (0.0013, 0.01, 0.05, 0.5, 0.95, 0.99, 0.9987)


@dataclass(frozen=True)
class Quantile:
    """The value below which a ``share`` of all flights stays, and between which bounds it lies at 95 %."""

    share: float
    value: float
    low: float
    high: float


def quantile(values: np.ndarray, share: float, flown: bool = False) -> Quantile | None:
    """A quantile of ``values``, shape (n,), NaN where a flight has none; ``None`` where too few to bound it.

    The bounds are two of the values themselves, whatever the distribution: the number of values below the
    quantile is binomial.  Of flights that are stratified (Latin hypercube, Sobol sequence) and not
    independent, the bounds hold on the safe side where the figure rises or falls with each input.

    Args:
        values: infinite ones are left out, unless ``flown``.
        share: of the flights that stay below.
        flown: whether the value, too, is to be one of those flown, the next above, so that none is
            interpolated away; infinite ones are then flights that failed, and the largest.

    Source: Wilks, Ann. Math. Stat. 12 (1941) 91; David and Nagaraja, Order Statistics, 3rd ed., 7.1.
    """
    ordered = np.sort(values[~np.isnan(values) if flown else np.isfinite(values)])
    if len(ordered) < flights_needed(share):
        return None
    low, high = _bounding(len(ordered), share)
    value = np.quantile(ordered, share, method="higher" if flown else "linear")
    return Quantile(share, float(value), float(ordered[low]), float(ordered[high]))


@cache
def _bounding(n: int, share: float) -> tuple[int, int]:
    """Places of the two among ``n`` ordered values that bound a quantile, from 0 on."""
    tail = 0.5 * (1.0 - CONFIDENCE)
    low, high = (
        bisect_left(range(n), chance, key=lambda below: bdtr(below, n, share))
        for chance in (tail, 1.0 - tail)
    )
    return low - 1, high


def flights_needed(share: float) -> int:
    """Flights of which the least and the largest bound a quantile."""
    return ceil(log(0.5 * (1.0 - CONFIDENCE)) / log(max(share, 1.0 - share)))


def bounded_shares(flights: int) -> tuple[float, ...]:
    """Those of :data:`SHARES` that a number of flights can bound."""
    return tuple(share for share in SHARES if flights_needed(share) <= flights)


def percent(share: float) -> str:
    """A share in words: ``99.87 %``."""
    return f"{100.0 * share:g} %"
