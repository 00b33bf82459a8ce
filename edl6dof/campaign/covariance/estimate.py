"""Covariance from pairs of flights whose sources are stepped in opposite directions, all at once.

Flight j of a pair and its mirror image give y+ and y-.  Half their difference changes sign with the steps:
its mean square is what the sources give linearly, and a part of what is random.  Half their sum does not:
its covariance is the rest of what is random, and what the sources give in the second order.  The sum of both
is the covariance of y, without bias for a response that is linear in the sources with anything random beside
it; what is linear alone has no sampling error, as the columns of the design are orthogonal.  The response
to one step is averaged over the steps of all others and over what is random: a statistical linearisation,
which sees a bank reversal come sooner or later in some flights and not a jump in all.

Source: Gelb and Warren, AIAA J. 11 (1973) 689 (statistical linearisation); Box and Hunter,
Technometrics 3 (1961) 311 (design by mirror images).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Spread:
    """Spread of some quantities; each array has shape (quantities,).

    Attributes:
        mean: with what the second order of the sources shifts it by.
        mean_error: its standard error.
        deviation: standard deviation.
        error: standard error of the deviation.
        linear: standard deviation of what changes sign with the sources.
    """

    mean: np.ndarray
    mean_error: np.ndarray
    deviation: np.ndarray
    error: np.ndarray
    linear: np.ndarray


@dataclass(frozen=True)
class Pairs:
    """Figures of mirrored flights.

    Attributes:
        steps: of the first flight of each pair, -1 or 1, shape (pairs, deviates).
        odd: half the difference of both flights, shape (pairs, figures).
        even: half the sum.
    """

    steps: np.ndarray
    odd: np.ndarray
    even: np.ndarray

    @classmethod
    def of(cls, steps: np.ndarray, flights: np.ndarray) -> Pairs:
        """``flights`` has shape (2 pairs, figures): all first flights, then their mirror images."""
        first, second = np.split(flights, 2)
        return cls(steps, 0.5 * (first - second), 0.5 * (first + second))

    @property
    def covariance(self) -> np.ndarray:
        """Covariance of the figures, shape (figures, figures)."""
        return self.odd.T @ self.odd / len(self.odd) + np.atleast_2d(np.cov(self.even.T))

    @property
    def slopes(self) -> np.ndarray:
        """Change of each figure by one standard deviation of each deviate, shape (deviates, figures)."""
        return self.steps.T @ self.odd / len(self.odd)

    @property
    def slope_error(self) -> np.ndarray:
        """Standard error of every slope by what is random, shape (figures,)."""
        return self.even.std(axis=0, ddof=1) / np.sqrt(len(self.even))

    def spread(self, directions: np.ndarray) -> Spread:
        """Spread along some ``directions``, shape (figures, quantities)."""
        odd, even = self.odd @ directions, self.even @ directions
        pairs = len(odd)
        signed, rest = np.mean(odd**2, axis=0), even.var(axis=0, ddof=1)
        linear = np.maximum(signed - rest, 0.0)
        variance = signed + rest
        # of normal noise, half of whose variance each part holds
        error = np.sqrt((4.0 * linear * rest + 2.0 * rest**2) / pairs + 2.0 * rest**2 / (pairs - 1))
        deviation = np.sqrt(variance)
        return Spread(
            even.mean(axis=0),
            np.sqrt(rest / pairs),
            deviation,
            error / np.maximum(2.0 * deviation, np.finfo(float).tiny),
            np.sqrt(linear),
        )


def principal(covariance: np.ndarray) -> np.ndarray:
    """Directions of the long and the short axis of an ellipse as columns; ``covariance`` has shape (2, 2)."""
    return np.linalg.eigh(covariance)[1][:, ::-1]
