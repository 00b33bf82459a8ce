"""Distributions of a dispersed parameter that a campaign file may name after ``kind:``.

Each turns numbers in 0..1 into values by its inverse distribution function, so that every sampling plan
(random, Latin hypercube, Sobol) serves every distribution.  Sources: Johnson, Kotz and Balakrishnan 1994 and
1995 for all but the last, Devroye 1986 for discrete values.
"""

from __future__ import annotations

from typing import Any, Literal, Self

import numpy as np
from pydantic import model_validator

from edl6dof.config.base import REQUIRED, Params, param, stated
from edl6dof.registry import Member
from edl6dof.spatial import arrays
from edl6dof.spatial.arrays import normal_quantile, normal_share

#: Numbers in 0..1 are kept this far from 0 and 1, where a normal deviate is infinite: beyond 7 sigma.
_EDGE = 1e-12
_BOOK = "Johnson, Kotz and Balakrishnan, Continuous Univariate Distributions"


class DistributionParams(Params):
    """Base of the parameters of a distribution; the field ``kind`` has the name of the distribution."""

    def values(self, unit: np.ndarray, nominal: Any) -> np.ndarray:
        """Map numbers in 0..1, shape (n,), to values in the parameter's unit.

        Raises:
            ValueError: nothing can be drawn about this nominal value.
        """
        raise NotImplementedError


def deviates(unit: np.ndarray) -> np.ndarray:
    """Map numbers in 0..1 to standard normal deviates, finite at both ends."""
    return normal_quantile(_inside(unit))


def _inside(unit: np.ndarray) -> np.ndarray:
    return np.clip(unit, _EDGE, 1.0 - _EDGE)


class Spread(DistributionParams):
    """Width of a normal distribution, given in one of three ways."""

    sigma: float | None = param(None, "standard deviation, in the parameter's unit", gt=0.0)
    three_sigma: float | None = param(None, "three standard deviations, in the parameter's unit", gt=0.0)
    three_sigma_pct: float | None = param(None, "three standard deviations over the nominal value", gt=0.0)

    @model_validator(mode="after")
    def _one_width(self) -> Self:
        if sum(width is not None for width in (self.sigma, self.three_sigma, self.three_sigma_pct)) != 1:
            raise ValueError("must give exactly one of sigma, three_sigma, three_sigma_pct")
        return self

    def deviation(self, nominal: float) -> float:
        """Standard deviation about a nominal value."""
        if self.sigma is not None:
            return self.sigma
        if self.three_sigma is not None:
            return self.three_sigma / 3.0
        return abs(nominal) * stated(self.three_sigma_pct) / 300.0


class Normal(Spread):
    """Normal distribution."""

    kind: Literal["normal"] = param(REQUIRED, "normal")
    mean: float | None = param(None, "mean; the nominal value if not given")

    def values(self, unit: np.ndarray, nominal: float) -> np.ndarray:
        """Map numbers in 0..1 to values."""
        mean = nominal if self.mean is None else self.mean
        return mean + self.deviation(nominal) * deviates(unit)


NORMAL = Member("normal", Normal, {}, f"{_BOOK} 1 (1994), chapter 13")


class TruncatedNormal(Spread):
    """Normal distribution without the values outside two bounds."""

    kind: Literal["truncated_normal"] = param(REQUIRED, "normal, cut off")
    mean: float | None = param(None, "mean before the cut; the nominal value if not given")
    low: float | None = param(None, "lowest value")
    high: float | None = param(None, "highest value")

    @model_validator(mode="after")
    def _bounds(self) -> Self:
        if self.low is None and self.high is None:
            raise ValueError("must give low, high or both; without bounds it is kind normal")
        if self.low is not None and self.high is not None and self.low >= self.high:
            raise ValueError(f"low must be below high (got {self.low:g} and {self.high:g})")
        return self

    def values(self, unit: np.ndarray, nominal: float) -> np.ndarray:
        """Map numbers in 0..1 to values."""
        mean, sigma = nominal if self.mean is None else self.mean, self.deviation(nominal)
        low, high = (
            (bound - mean) / sigma if bound is not None else end
            for bound, end in ((self.low, -np.inf), (self.high, np.inf))
        )
        # shares near 1 lose digits: an upper tail is drawn as the lower tail of the mirror image
        side = -1.0 if low > 0.0 else 1.0
        below, above = sorted((side * low, side * high))
        first, last = normal_share(below), normal_share(above)
        if not last - first > 1e-9:
            raise ValueError("low and high leave nothing of the distribution")
        share = _inside(unit if side > 0.0 else 1.0 - unit)
        values = mean + sigma * side * normal_quantile(first + share * (last - first))
        return np.clip(values, self.low, self.high)  # the last bit may be outside


TRUNCATED_NORMAL = Member("truncated_normal", TruncatedNormal, {}, f"{_BOOK} 1 (1994), section 13.10.1")


class Uniform(DistributionParams):
    """Every value between two bounds is equally likely."""

    kind: Literal["uniform"] = param(REQUIRED, "uniform")
    low: float | None = param(None, "lowest value")
    high: float | None = param(None, "highest value")
    half_width: float | None = param(
        None, "instead of low and high: greatest distance from the nominal value", gt=0.0
    )

    @model_validator(mode="after")
    def _bounds(self) -> Self:
        given = (self.low is not None, self.high is not None, self.half_width is not None)
        if given not in ((True, True, False), (False, False, True)):
            raise ValueError("must give low and high, or half_width")
        if self.low is not None and self.high is not None and self.low >= self.high:
            raise ValueError(f"low must be below high (got {self.low:g} and {self.high:g})")
        return self

    def values(self, unit: np.ndarray, nominal: float) -> np.ndarray:
        """Map numbers in 0..1 to values."""
        if self.half_width is None:
            low, high = stated(self.low), stated(self.high)
        else:
            low, high = nominal - self.half_width, nominal + self.half_width
        return low + unit * (high - low)


UNIFORM = Member("uniform", Uniform, {}, f"{_BOOK} 2 (1995), chapter 26")


class LogNormal(DistributionParams):
    """Normal distribution of the logarithm: a factor up is as likely as the same factor down."""

    kind: Literal["log_normal"] = param(REQUIRED, "log-normal")
    median: float | None = param(None, "median; the nominal value if not given", gt=0.0)
    sigma_ln: float = param(REQUIRED, "standard deviation of the natural logarithm", gt=0.0, le=5.0)

    def values(self, unit: np.ndarray, nominal: float) -> np.ndarray:
        """Map numbers in 0..1 to values."""
        median = nominal if self.median is None else self.median
        if not median > 0.0:
            raise ValueError(f"needs a positive median (the nominal value is {median:g})")
        return median * arrays.exp(self.sigma_ln * deviates(unit))


LOG_NORMAL = Member("log_normal", LogNormal, {}, f"{_BOOK} 1 (1994), chapter 14")


class Discrete(DistributionParams):
    """One of several values: numbers, or names such as that of a guidance law."""

    kind: Literal["discrete"] = param(REQUIRED, "one of several values")
    choices: list[Any] = param(REQUIRED, "the values", min_length=1)
    weights: list[float] | None = param(
        None, "relative probability of each choice; equal if not given", min_length=1
    )

    @model_validator(mode="after")
    def _weights_fit(self) -> Self:
        weights = self.weights
        if weights is not None and (
            len(weights) != len(self.choices) or min(weights) < 0.0 or not sum(weights) > 0.0
        ):
            raise ValueError(f"weights must be {len(self.choices)} numbers, none negative and not all zero")
        return self

    def values(self, unit: np.ndarray, nominal: Any) -> np.ndarray:
        """Map numbers in 0..1 to values."""
        weights = np.ones(len(self.choices)) if self.weights is None else np.asarray(self.weights)
        steps = np.cumsum(weights) / np.sum(weights)
        chosen = np.minimum(np.searchsorted(steps, unit, side="right"), len(self.choices) - 1)
        found = np.empty(len(unit), object)
        found[:] = [self.choices[index] for index in chosen]
        return found


DISCRETE = Member(
    "discrete", Discrete, {}, "Devroye, Non-Uniform Random Variate Generation (1986), section III.2.1"
)
