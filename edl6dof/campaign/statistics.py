"""Statistics of a campaign: success probability with its interval, and ellipses."""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import sqrt

import numpy as np
from scipy.special import ndtri


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
