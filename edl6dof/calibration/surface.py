"""Figures as a linear function of the parameters, with scatter, from a design of flights.

A figure answers its parameters with a slope and with scatter: another cycle of the flight software, another
pulse, another bank reversal.  Differences between two points follow the scatter; a regression over many, each
flown once, averages it, and its residuals say how far one flight lies from the surface.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

#: Flights for each coefficient of a regression, at the least.
FLIGHTS_PER_COEFFICIENT = 4


class TooFew(ValueError):
    """Too few flights of a design reached every figure."""


class Data(NamedTuple):
    """Published numbers and standard deviations, shape (figures,)."""

    number: np.ndarray
    sigma: np.ndarray


class Surface(NamedTuple):
    """The fitted function.

    Attributes:
        constant: figures where all parameters are zero, shape (figures,).
        slopes: change of each figure with each parameter, shape (figures, parameters).
        scatter: covariance of one flight about it, shape (figures, figures).
    """

    constant: np.ndarray
    slopes: np.ndarray
    scatter: np.ndarray


def least_flights(parameters: int) -> int:
    """Flights without which no surface is fitted."""
    return FLIGHTS_PER_COEFFICIENT * (parameters + 1)


def regression(points: np.ndarray, flown: np.ndarray) -> Surface:
    """Least squares over the flights that reached every figure.

    Args:
        points: parameters of each flight, shape (flights, parameters).
        flown: its figures, shape (flights, figures); ``nan`` where one was not reached.

    Raises:
        TooFew: fewer of them than :func:`least_flights`.
    """
    reached = np.isfinite(flown).all(axis=1)
    count, least = np.count_nonzero(reached), least_flights(points.shape[1])
    if count < least:
        raise TooFew(
            f"{count} of {len(points)} flights reached every figure to explain, and {least} are needed: name "
            "figures that are reached, or narrow the priors"
        )
    terms = np.column_stack([np.ones(count), points[reached]])
    coefficients = np.linalg.lstsq(terms, flown[reached])[0]
    residuals = flown[reached] - terms @ coefficients
    return Surface(coefficients[0], coefficients[1:].T, residuals.T @ residuals / (count - len(coefficients)))
