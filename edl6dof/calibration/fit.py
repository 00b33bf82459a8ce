"""Normal posterior of parameters from the figures of flights, and its quality.

A figure responds to a parameter with a slope and with scatter, because a thruster pulse or a bank reversal
may come at another time.  A difference between two points would mostly measure the scatter.  A regression
over many points, each flown once, averages it, and its residuals give the deviation of one flight from the
linear model.  The first design of flights is drawn from the prior and each further one from the posterior of
the one before, so that the model is fitted near the solution and over the width of its uncertainty.  The real
flight is one random draw, so the scatter adds to the uncertainty of the published figures.  If priors and
figures contradict each other by more than this, the published deviations are widened until they agree.
Parameters are in standard deviations of their priors.

Source: García-Fernández, Svensson, Morelande and Särkkä, Posterior linearization filter, IEEE Trans. Signal
Processing 63 (2015) 5561 (regression over the posterior, its residuals as noise); Tarantola, Inverse Problem
Theory (2005), eq. 3.37 (posterior); Backus and Gilbert (1970), resolution; Paule and Mandel, J. Research NBS
87 (1982) 377 (deviations that agree with the misfit).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq, lsq_linear
from scipy.stats import qmc


class TooFew(ValueError):
    """Too few flights of a design reached every figure."""


def least_flights(parameters: int) -> int:
    """Least number of flights for a regression: four for each of its coefficients."""
    return 4 * (parameters + 1)


class Data(NamedTuple):
    """Published values of the figures and their standard deviations, each of shape (figures,)."""

    number: np.ndarray
    sigma: np.ndarray


class Surface(NamedTuple):
    """Linear model of the figures in the parameters.

    Attributes:
        constant: figures where all parameters are zero, shape (figures,).
        slopes: change of each figure with each parameter, shape (figures, parameters).
        scatter: covariance of the figures of one flight about the model, shape (figures, figures).
    """

    constant: np.ndarray
    slopes: np.ndarray
    scatter: np.ndarray


def regression(points: np.ndarray, flown: np.ndarray) -> Surface:
    """Fit a linear model by least squares to the flights that reached every figure.

    Args:
        points: parameters of each flight, shape (flights, parameters).
        flown: figures of each flight, shape (flights, figures); ``nan`` where one was not reached.

    Raises:
        TooFew: fewer than :func:`least_flights` flights reached every figure.
    """
    reached = np.isfinite(flown).all(axis=1)
    count, least = np.count_nonzero(reached), least_flights(points.shape[1])
    if count < least:
        words = f"{count} of {len(points)} flights reached every figure to explain, and {least} are needed"
        raise TooFew(f"{words}: name figures that are reached, or narrow the priors")
    terms = np.column_stack([np.ones(count), points[reached]])
    coefficients = np.linalg.lstsq(terms, flown[reached])[0]
    residuals = flown[reached] - terms @ coefficients
    return Surface(coefficients[0], coefficients[1:].T, residuals.T @ residuals / (count - len(coefficients)))


#: Successive designs: the second is drawn at the first solution, the third shows how much that still moves.
DESIGNS = 3
#: Distance from a bound below which a parameter counts as at it, in standard deviations of its prior.
AT_BOUND = 1e-3


@dataclass(frozen=True)
class Fit:
    """A solution, in standard deviations of the priors.

    Attributes:
        x: parameters of the largest posterior density, shape (parameters,).
        covariance: covariance of the posterior, bounds ignored, shape (parameters, parameters).
        slopes: change of each figure with each parameter, shape (figures, parameters).
        sigma: standard deviation of each figure, of its published value and one flight, shape (figures,).
        squares: sum of squares of figures and priors; its expected value is the number of figures.
        widening: factor on the published standard deviations that reduces ``squares`` to the expected value,
            at least 1.
        moved: largest change of a parameter that the last design of flights made, in posterior standard
            deviations.
        at_bound: True for a parameter at a bound, shape (parameters,).
    """

    x: np.ndarray
    covariance: np.ndarray
    slopes: np.ndarray
    sigma: np.ndarray
    squares: float
    widening: float
    moved: float
    at_bound: np.ndarray

    @property
    def deviation(self) -> np.ndarray:
        """Posterior standard deviation of each parameter as a share of that of the prior, 0 to 1."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def correlation(self) -> np.ndarray:
        """Correlation matrix of the posterior, shape (parameters, parameters)."""
        return self.covariance / np.outer(self.deviation, self.deviation)

    @property
    def resolution(self) -> np.ndarray:
        """Share of each parameter that the figures determine: the diagonal of 1 - covariance."""
        return 1.0 - np.diag(self.covariance)

    @property
    def determined(self) -> float:
        """Number of parameters that the figures determine: the trace of the resolution matrix."""
        return float(np.sum(self.resolution))


def fit(
    fly: Callable[[np.ndarray], np.ndarray],
    data: Data,
    low: np.ndarray,
    high: np.ndarray,
    flights: int,
    seed: int,
) -> Fit:
    """Find the posterior of the parameters from several designs of flights.

    Args:
        fly: flies a design: figures (flights, figures) at parameters (flights, parameters); ``nan`` where a
            figure was not reached.
        data: published values to explain.
        low, high: bounds of the parameters, shape (parameters,), below and above zero.
        flights: number of flights of each design.
        seed: seed of the random designs.

    Raises:
        TooFew: too few flights of a design reached every figure.
    """
    x, covariance = np.zeros(len(low)), np.eye(len(low))
    for number in range(DESIGNS):
        engine = qmc.Halton(len(low), rng=np.random.default_rng((seed, number)))
        drawn = qmc.MultivariateNormalQMC(x, covariance, engine=engine).random(flights)
        points = np.clip(drawn, low, high)
        found = solve(regression(points, fly(points)), data, low, high, x)
        x, covariance = found.x, found.covariance
    return found


def solve(surface: Surface, data: Data, low: np.ndarray, high: np.ndarray, before: np.ndarray) -> Fit:
    """Compute the posterior for a fitted surface; ``before``: parameters about which its design was drawn."""
    gap, slopes = data.number - surface.constant, surface.slopes
    spread = slopes @ slopes.T + surface.scatter
    widening = _widening(gap, spread, data.sigma)
    root = np.linalg.cholesky(surface.scatter + np.diag((widening * data.sigma) ** 2))
    whitened = np.linalg.solve(root, slopes)
    rows = np.concatenate([whitened, np.eye(len(before))])
    wanted = np.concatenate([np.linalg.solve(root, gap), np.zeros(len(before))])
    x = lsq_linear(rows, wanted, (low, high), method="bvls").x
    covariance = np.linalg.inv(rows.T @ rows)
    return Fit(
        x=x,
        covariance=covariance,
        slopes=slopes,
        sigma=np.sqrt(data.sigma**2 + np.diag(surface.scatter)),
        squares=_squares(gap, spread, data.sigma),
        widening=widening,
        moved=float(np.max(np.abs(x - before) / np.sqrt(np.diag(covariance)))),
        at_bound=(x - low < AT_BOUND) | (high - x < AT_BOUND),
    )


def _squares(gap: np.ndarray, spread: np.ndarray, sigma: np.ndarray) -> float:
    """Least sum of squares of figures and priors for ``gap``, the published less the modelled figures at the
    means of the priors, with the covariance ``spread`` of the modelled figures and the published deviations
    ``sigma``.
    """
    return float(gap @ np.linalg.solve(spread + np.diag(sigma**2), gap))


def _widening(gap: np.ndarray, spread: np.ndarray, sigma: np.ndarray) -> float:
    """Factor on the published deviations, at least 1, that reduces the sum of squares to that expected."""

    def excess(factor: float) -> float:
        return _squares(gap, spread, factor * sigma) - len(gap)

    return 1.0 if excess(1.0) <= 0.0 else brentq(excess, 1.0, float(np.linalg.norm(gap / sigma)))
