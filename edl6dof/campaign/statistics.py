"""Statistics of a campaign: success probability with its interval, ellipses, and quantiles with their bounds,
as far as its flights can bound them.

>>> flights_needed(0.99), flights_needed(0.9987)
(368, 2836)
>>> quantile(np.arange(1.0, 101.0), 0.95)
Quantile(share=0.95, value=95.05, low=90.0, high=100.0)
>>> quantile(np.arange(1.0, 101.0), 0.99) is None
True
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from math import ceil, log, sqrt
from typing import Self

import numpy as np
from scipy.special import bdtr, ndtri


@dataclass(frozen=True)
class Proportion:
    """Successes among trials, with the Wilson score interval.

    Source: Wilson, J. Am. Stat. Assoc. 22 (1927) 209; it keeps its coverage near 0 and 1, where the normal
    interval fails.
    """

    successes: int
    trials: int
    confidence: float = 0.95

    @classmethod
    def of(cls, kept: Sequence[bool]) -> Self:
        """The share of those that are true."""
        return cls(sum(map(bool, kept)), len(kept))

    @property
    def value(self) -> float:
        """Share of successes."""
        return self.successes / self.trials if self.trials else float("nan")

    @property
    def interval(self) -> tuple[float, float]:
        """Lower and upper end; all of 0..1 without trials."""
        if not self.trials:
            return 0.0, 1.0
        n, z = self.trials, float(ndtri(0.5 * (1.0 + self.confidence)))
        middle = self.successes + 0.5 * z**2
        half = z * sqrt(self.successes * (n - self.successes) / n + 0.25 * z**2)
        low, high = (middle - half) / (n + z**2), (middle + half) / (n + z**2)
        return 0.0 if self.successes == 0 else low, 1.0 if self.successes == n else high

    @property
    def half_width(self) -> float:
        """Half the length of the interval."""
        low, high = self.interval
        return (high - low) / 2.0

    def __str__(self) -> str:
        low, high = self.interval
        return f"{100 * self.value:.2f} % ({100 * low:.2f} .. {100 * high:.2f} %)"


@dataclass(frozen=True)
class Until:
    """Stop when the interval of the success probability is narrow enough."""

    half_width: float

    @classmethod
    def parse(cls, text: str) -> Until:
        """Read ``p_success +- 0.5%``.

        Raises:
            ValueError: it has another form.
        """
        match = re.fullmatch(r"\s*p_success\s*(?:\+-|\+/-|±)\s*([0-9.]+(?:[eE][-+]?\d+)?)\s*(%?)\s*", text)
        try:
            width = float(match[1]) / (100.0 if match[2] else 1.0) if match else 0.0
        except ValueError:
            width = 0.0
        if not 0.0 < width < 0.5:
            raise ValueError(f"must have the form 'p_success +- 0.5%' (got {text!r})")
        return cls(width)

    def reached(self, proportion: Proportion) -> bool:
        """Return whether flying may stop."""
        return proportion.trials > 0 and proportion.half_width <= self.half_width


def ellipse(
    east: np.ndarray, north: np.ndarray, sigmas: float, points: int = 181
) -> tuple[np.ndarray, np.ndarray]:
    """Curve at ``sigmas`` standard deviations of the normal distribution fitted to the points."""
    curve = contour(np.cov(np.stack([east, north])), sigmas, points)
    return curve[0] + east.mean(), curve[1] + north.mean()


def contour(covariance: np.ndarray, sigmas: float, points: int = 181) -> np.ndarray:
    """Curve (2, points) at ``sigmas`` deviations about zero of a normal ``covariance`` (2, 2)."""
    values, vectors = np.linalg.eigh(covariance)
    angle = np.linspace(0.0, 2.0 * np.pi, points)
    return vectors @ (
        np.sqrt(np.maximum(values, 0.0))[:, None] * sigmas * np.stack([np.cos(angle), np.sin(angle)])
    )


#: Probability that both bounds hold.
CONFIDENCE = 0.95
#: Shares of the quantiles of a report: the median, and pairs out to three sigma of a normal distribution.
SHARES = (0.0013, 0.01, 0.05, 0.5, 0.95, 0.99, 0.9987)


@dataclass(frozen=True)
class Quantile:
    """Quantile: the value below which a ``share`` of all flights lies, with its bounds at 95 % confidence."""

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
        flown: True for the next flown value above in place of an interpolated one; infinite ones are then
            flights that failed, and the largest.

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
    """Quantiles of :data:`SHARES` that this number of flights gives a confidence interval for."""
    return tuple(share for share in SHARES if flights_needed(share) <= flights)


def percent(share: float) -> str:
    """A share in words: ``99.87 %``."""
    return f"{100.0 * share:g} %"
