"""Weighted least squares of figures and priors, and what the solution is worth.

The residuals are those of the figures, (mean over neighbouring flights - published) / sqrt(sigma^2 +
spread^2), and those of the priors, (value - mean) / sigma: their sum of squares is minus twice the logarithm
of the posterior density where both are normal.  Parameters are counted in standard deviations of their
priors.

Source: Tarantola, Inverse Problem Theory (2005), eq. 3.37 (posterior), 3.53 (covariance of the linear case);
Backus and Gilbert (1970), resolution.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

#: Half the distance over which slopes are taken, in standard deviations of the prior: far above the noise of
#: a mean over neighbouring flights, and small against what bends.
STEP = 0.5
#: Evaluations of the residuals, slopes not counted: the means are noisy in their last digits, and more would
#: follow the noise.
MOST_EVALUATIONS = 8

#: Residuals of the figures (figures,) at parameters (parameters,) in standard deviations from their priors'
#: means.
Misfit = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Fit:
    """A solution, in standard deviations of the priors.

    Attributes:
        x: parameters, shape (parameters,).
        before: residuals of the figures at the priors' means, shape (figures,).
        after: the same at the solution.
        slopes: change of each residual with each parameter there, shape (figures, parameters).
        at_bound: whether a parameter stands at a bound, shape (parameters,).
    """

    x: np.ndarray
    before: np.ndarray
    after: np.ndarray
    slopes: np.ndarray
    at_bound: np.ndarray

    @property
    def covariance(self) -> np.ndarray:
        """Of the posterior, shape (parameters, parameters): (1 + J' J)^-1."""
        return np.linalg.inv(np.eye(len(self.x)) + self.slopes.T @ self.slopes)

    @property
    def deviation(self) -> np.ndarray:
        """Posterior standard deviation of each parameter over that of its prior, 0 to 1."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def correlation(self) -> np.ndarray:
        """Of the posterior, shape (parameters, parameters)."""
        return self.covariance / np.outer(self.deviation, self.deviation)

    @property
    def resolution(self) -> np.ndarray:
        """Share of each parameter that the figures tell and not its prior, 0 to 1: the diagonal of
        1 - covariance.
        """
        return 1.0 - np.diag(self.covariance)

    @property
    def told_apart(self) -> float:
        """How many parameters the figures can tell apart: the trace of the resolution matrix."""
        return float(np.sum(self.resolution))


def fit(misfit: Misfit, low: np.ndarray, high: np.ndarray) -> Fit:
    """Find the parameters of the largest posterior density.

    Args:
        misfit: residuals of the figures.
        low, high: bounds of the parameters, shape (parameters,), below and above zero.
    """
    count = len(low)

    def residuals(x: np.ndarray) -> np.ndarray:
        return np.concatenate([misfit(x), x])

    def jacobian(x: np.ndarray) -> np.ndarray:
        return np.concatenate([slopes(misfit, x, low, high), np.eye(count)])

    found = least_squares(
        residuals,
        np.zeros(count),
        jacobian,
        bounds=(low, high),
        max_nfev=MOST_EVALUATIONS,
        xtol=1e-2,
        ftol=1e-3,
    )
    return Fit(
        found.x,
        misfit(np.zeros(count)),
        found.fun[:-count],
        found.jac[:-count],
        (found.x - low < 1e-3) | (high - found.x < 1e-3),
    )


def slopes(misfit: Misfit, x: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Central differences of the residuals, one-sided at a bound; shape (figures, parameters)."""
    columns = []
    for k in range(len(x)):
        below, above = x.copy(), x.copy()
        below[k], above[k] = max(x[k] - STEP, low[k]), min(x[k] + STEP, high[k])
        columns.append((misfit(above) - misfit(below)) / (above[k] - below[k]))
    return np.stack(columns, axis=1)
