"""Uncertainties that are constant but unknown (epistemic), separated from those that are random from flight
to flight (aleatory), by the flights of one campaign.

A requirement on the share of flights is one on the random uncertainties: the vehicle that is built has fixed,
unknown values of the constants.  A regression on the constants predicts the margin of each flight from the
*other* flights (cross-validation), and its error is the random part.  Two results follow for the worst tenth
of the values of the constants, those with the smallest predicted margins:

* the flights in that tenth, with their failures: independent flights, each chosen without its own result.
  If the share of successes falls with the predicted margin, the confidence bound of their share is one for
  nine tenths of the values of the constants, whatever else is wrong with the regression;
* all flights, with the constants moved to the edge of that tenth: each has the margin predicted there plus
  its own error.  That is an estimate from all flights, and assumes that the random part does not depend on
  the constants.

Sources: Hanson and Beard, NASA/TP-2010-216447 (the two kinds of uncertainty); Stone, J. R. Stat. Soc. B 36
(1974) 111 (cross-validation); Duan, J. Am. Stat. Assoc. 78 (1983) 605 (a distribution from errors of a
regression).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np

#: Part of the values of the constants that is called the worst.
_WORST = 0.1
#: Flights for each term of the regression, and groups of flights that are predicted from the others.
_FLIGHTS_PER_TERM, _GROUPS = 20, 5


@dataclass(frozen=True)
class Separation:
    """Failures of a requirement where the constants are at their worst.

    Attributes:
        explained: share of the variance of the figure that the constants explain.
        flights: number of flights in the worst tenth of the values of the constants.
        failures: number of failures among these.
        moved_failures: number of failures among all flights with the constants at the edge of that tenth.
    """

    explained: float
    flights: int
    failures: int
    moved_failures: int


def flights_to_separate(constants: int) -> int:
    """Least number of flights that separates this number of constants."""
    return _FLIGHTS_PER_TERM * constants


def separate(constants: np.ndarray, margins: np.ndarray) -> Separation | None:
    """Separate the constants from the random uncertainties.

    Args:
        constants: value of each constant in each flight, shape (n, constants).
        margins: distance of the figure from its limit, shape (n,), negative outside; -inf for a failure
            without a figure.

    Returns:
        The separation; ``None`` if the flights with a figure are too few.
    """
    has = np.isfinite(margins)
    if np.sum(has) < flights_to_separate(constants.shape[1]) or not np.ptp(margins[has]):
        return None
    predicted = _predicted(_terms(constants, int(np.sum(has))), margins, has)
    # the worst tenth of each group: one with good results makes the predictions of all others better
    groups = [np.arange(first, len(margins), _GROUPS) for first in range(_GROUPS)]
    chosen = [rows[np.argsort(predicted[rows])[: ceil(_WORST * len(rows))]] for rows in groups]
    worst = np.concatenate(chosen)
    # the errors of the predictions spread them, but are not correlated with the margins
    (own, both), (_, spread) = np.cov(margins[has], predicted[has])
    kept = max(both, 0.0) / spread
    centred = predicted - predicted.mean()
    moved = margins - kept * centred + np.sqrt(kept) * np.quantile(centred, _WORST)
    failures, moved_failures = (int(np.sum(each < 0.0)) for each in (margins[worst], moved))
    return Separation(max(float(both / own), 0.0), len(worst), failures, moved_failures)


def _terms(constants: np.ndarray, flights: int) -> np.ndarray:
    """Regressors, shape (n, terms): a constant term, linear and, if flights suffice, quadratic terms."""
    spread = np.std(constants, axis=0)
    scores = (constants - constants.mean(axis=0)) / np.where(spread > 0.0, spread, 1.0)
    quadratic = 2 * flights_to_separate(constants.shape[1]) <= flights
    return np.hstack([np.ones((len(scores), 1)), scores, *([scores**2] if quadratic else [])])


def _predicted(terms: np.ndarray, margins: np.ndarray, has: np.ndarray) -> np.ndarray:
    """Margin of each flight, shape (n,), predicted by a regression on the other groups of flights."""
    predicted, group = np.empty(len(margins)), np.arange(len(margins)) % _GROUPS
    for own in range(_GROUPS):
        others = has & (group != own)
        factors = np.linalg.lstsq(terms[others], margins[others], rcond=None)[0]
        predicted[group == own] = terms[group == own] @ factors
    return predicted
