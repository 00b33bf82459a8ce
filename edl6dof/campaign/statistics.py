"""Statistics of a campaign: success probability with its interval, quantiles, ellipses, what drives what."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import binomtest, spearmanr, zscore


@dataclass(frozen=True)
class Proportion:
    """Successes among trials, with the Wilson score interval.

    Source: Wilson, J. Am. Stat. Assoc. 22 (1927) 209; it keeps its coverage near 0 and 1, where the normal
    interval fails.
    """

    successes: int
    trials: int
    confidence: float = 0.95

    @property
    def value(self) -> float:
        """Share of successes."""
        return self.successes / self.trials if self.trials else float("nan")

    @property
    def interval(self) -> tuple[float, float]:
        """Lower and upper end; all of 0..1 without trials."""
        if not self.trials:
            return 0.0, 1.0
        found = binomtest(self.successes, self.trials).proportion_ci(self.confidence, method="wilson")
        return float(found.low), float(found.high)

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
        """Whether flying may stop."""
        return proportion.trials > 0 and proportion.half_width <= self.half_width


def ellipse(
    east: np.ndarray, north: np.ndarray, sigmas: float, points: int = 181
) -> tuple[np.ndarray, np.ndarray]:
    """Closed curve at ``sigmas`` standard deviations of the normal distribution with the points' mean and
    covariance.
    """
    curve = contour(np.cov(np.stack([east, north])), sigmas, points)
    return curve[0] + east.mean(), curve[1] + north.mean()


def contour(covariance: np.ndarray, sigmas: float, points: int = 181) -> np.ndarray:
    """Closed curve at ``sigmas`` standard deviations about zero of a normal distribution, shape (2, points);
    ``covariance`` has shape (2, 2).
    """
    values, vectors = np.linalg.eigh(covariance)
    angle = np.linspace(0.0, 2.0 * np.pi, points)
    return vectors @ (
        np.sqrt(np.maximum(values, 0.0))[:, None] * sigmas * np.stack([np.cos(angle), np.sin(angle)])
    )


@dataclass(frozen=True)
class Driver:
    """How much one input drives a figure: rank correlation, and standardised regression coefficient."""

    name: str
    rank_correlation: float
    regression: float


def drivers(inputs: dict[str, np.ndarray], figure: np.ndarray) -> tuple[list[Driver], float]:
    """Inputs by the size of their effect on a figure, and the share of its variance that the regression
    explains.

    Spearman's rank correlation finds every monotonic effect; the standardised regression coefficients add up
    in squares to the explained share (R2) when the inputs are independent, and then equal first-order Sobol
    indices of a linear model.
    """
    usable = np.isfinite(figure)
    columns = (
        {name: values[usable] for name, values in inputs.items() if np.ptp(values[usable]) > 0.0}
        if usable.any()
        else {}
    )
    target = figure[usable]
    if len(target) <= len(columns) + 1 or not columns or np.ptp(target) == 0.0:
        return [], float("nan")
    scaled, aim = zscore(np.stack(list(columns.values()), axis=1)), zscore(target)
    coefficients, *_ = np.linalg.lstsq(scaled, aim, rcond=None)
    explained = 1.0 - float(np.var(aim - scaled @ coefficients))
    found = [
        Driver(name, float(spearmanr(values, target).statistic), float(coefficient))
        for (name, values), coefficient in zip(columns.items(), coefficients, strict=True)
    ]
    return sorted(
        found, key=lambda driver: -max(abs(driver.rank_correlation), abs(driver.regression))
    ), explained


def quantiles(values: np.ndarray, at: Sequence[float] = (0.0013, 0.01, 0.5, 0.99, 0.9987)) -> list[float]:
    """Quantiles of the finite values; NaN when there are none."""
    finite = values[np.isfinite(values)]
    return [float(q) for q in np.quantile(finite, at)] if len(finite) else [float("nan")] * len(at)
