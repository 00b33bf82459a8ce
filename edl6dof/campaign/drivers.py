"""What drives a figure: groups of inputs told from chance, and the share of its variance that each explains.

Made for many inputs and few flights.  Figure and inputs enter by their normal scores, so that a few odd
flights and the shapes of distributions do not decide.  Groups are taken up one after the other, each time
that which explains most of what is left, as long as an F test tells it from chance among all that were
tried.  What those taken up explain together is split among them, each share less what its regressors explain
by chance alone, so that the shares add up to the adjusted R2.  Their intervals are by the bootstrap.

What only two inputs together do (their interaction) is explained by none and remains.

Sources: van der Waerden, Indag. Math. 14 (1952) 453 (scores); Sidak, J. Am. Stat. Assoc. 62 (1967) 626 (many
tests); Zuber and Strimmer, Stat. Appl. Genet. Mol. Biol. 10 (2011) 34 (the split, CAR scores: for inputs that
are independent it is that of Lindeman, Merenda and Gold, the Shapley value, and the first-order index of
Sobol); Efron, Ann. Stat. 7 (1979) 1 (bootstrap).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.special import betainc, betaincinv
from scipy.stats import norm, rankdata

#: Chance that inputs that do nothing are called a driver, of a figure or of all figures of a report.
CHANCE = 0.05

#: Flights of fewer than which nothing is told: ranks of a handful agree by chance.
FEWEST = 20

#: Flights for each regressor without which a group keeps to straight effects.
_FLIGHTS_PER_TERM = 10

#: Campaigns drawn again from the flights for the intervals; their ends.
_REDRAWN, _ENDS = 400, (0.025, 0.975)

#: Flights are drawn again one by one, of more than these in as many blocks.
_BLOCKS = 300

#: Least singular value of regressors, as a share of the largest, and least eigenvalue of a correlation.
_DEGENERATE = 1e-6


@dataclass(frozen=True)
class Driver:
    """A group of inputs that drives a figure.

    Attributes:
        name: of the group.
        share: of the variance of the figure's normal scores.
        low: lower end of the 95 % interval of the share.
        high: upper end.
        effect: ``rises`` or ``falls`` with a single input, ``curved``, or empty for a group of several.
    """

    name: str
    share: float
    low: float
    high: float
    effect: str


@dataclass(frozen=True)
class Drivers:
    """What is told of a figure.

    Attributes:
        flights: that have the figure.
        found: drivers, the largest share first.
        least: share below which an input cannot be told from chance.
    """

    flights: int
    found: tuple[Driver, ...]
    least: float

    @property
    def explained(self) -> float:
        """Share of the variance that all drivers explain together: the adjusted R2."""
        return sum(driver.share for driver in self.found)


def drivers(groups: Mapping[str, np.ndarray], figure: np.ndarray, chance: float = CHANCE) -> Drivers:
    """The groups of inputs that drive a figure.

    Args:
        groups: inputs that belong together, shape (n, inputs of the group), by name; each group independent
            of the others.
        figure: shape (n,), NaN where a flight has none.
        chance: probability that any group is named where none does anything.
    """
    usable = np.isfinite(figure)
    inputs = {name: columns[usable] for name, columns in groups.items()}
    target = _scores(figure[usable])
    flights = len(target)
    if flights < FEWEST or np.ptp(target) == 0.0:
        return Drivers(flights, (), 1.0)
    terms = {name: basis for name, columns in inputs.items() if (basis := _terms(columns)).size}
    names, least = _told_from_chance(terms, target, chance)
    if not names:
        return Drivers(flights, (), least)
    own, redrawn = _shares([terms[name] for name in names], target)
    wider = np.sqrt(flights / max(flights - 1 - sum(terms[name].shape[1] for name in names), 1))
    low, high = np.clip(own + wider * (np.quantile(redrawn, _ENDS, axis=0) - own), 0.0, 1.0)
    found = [
        Driver(name, max(float(own[k]), 0.0), float(low[k]), float(high[k]), _effect(inputs[name], target))
        for k, name in enumerate(names)
    ]
    return Drivers(flights, tuple(sorted(found, key=lambda driver: -driver.share)), least)


def _scores(values: np.ndarray) -> np.ndarray:
    """Normal scores: the deviates that a sample of the normal distribution has at the ranks of the values."""
    return np.asarray(norm.ppf((rankdata(values, axis=0) - 0.5) / len(values)))


def _terms(columns: np.ndarray) -> np.ndarray:
    """Orthonormal regressors of a group, shape (n, terms): straight and, if flights suffice, square."""
    scores = _scores(columns)
    few = 2 * scores.shape[1] * _FLIGHTS_PER_TERM <= len(scores)
    return _orthonormal(np.hstack([scores, scores**2]) if few else scores)


def _orthonormal(columns: np.ndarray) -> np.ndarray:
    """A basis of what the columns do besides a constant."""
    vectors, values, _ = np.linalg.svd(columns - columns.mean(axis=0), full_matrices=False)
    return np.asarray(vectors[:, values > _DEGENERATE * np.sqrt(len(columns))])


def _told_from_chance(
    terms: Mapping[str, np.ndarray], target: np.ndarray, chance: float
) -> tuple[list[str], float]:
    """Groups taken up, in their order, and the least share that one more would have to explain."""
    columns = np.column_stack([*terms.values(), target - target.mean()])
    columns /= np.linalg.norm(columns, axis=0)
    correlation = columns.T @ columns
    ends = np.cumsum([basis.shape[1] for basis in terms.values()])
    left = {
        name: np.arange(end - basis.shape[1], end)
        for (name, basis), end in zip(terms.items(), ends, strict=True)
    }
    taken, known, unexplained, least = [], np.empty(0, int), 1.0, 1.0
    while unexplained > _DEGENERATE:
        free = {name: len(target) - 1 - len(known) - len(own) for name, own in left.items()}
        after = {
            name: 1.0 - _explained(correlation, np.append(known, own))
            for name, own in left.items()
            if free[name] > 0
        }
        if not after:
            break
        level = -np.expm1(np.log1p(-chance) / len(after))  # Sidak: for each of them
        least = unexplained * min(_critical(len(left[name]), free[name], level) for name in after)
        p_values = {
            name: _p_value(rest / unexplained, len(left[name]), free[name]) for name, rest in after.items()
        }
        best = min(p_values, key=lambda name: p_values[name])
        if p_values[best] > level:
            break
        taken.append(best)
        known, unexplained = np.append(known, left.pop(best)), after[best]
    return taken, float(least)


def _explained(correlation: np.ndarray, columns: np.ndarray) -> float:
    """R2 of the figure, the last row, on some regressors."""
    own, aim = correlation[np.ix_(columns, columns)], correlation[columns, -1]
    return float(aim @ np.linalg.pinv(own, rcond=_DEGENERATE, hermitian=True) @ aim)


def _p_value(unexplained: float, terms: int, free: int) -> float:
    """Probability that regressors which do nothing leave as little unexplained: the F test, by the beta
    distribution of that share.
    """
    return float(betainc(0.5 * free, 0.5 * terms, min(max(unexplained, 0.0), 1.0)))


def _critical(terms: int, free: int, level: float) -> float:
    """Share of the rest that regressors must explain to be told from chance, less what chance explains."""
    unexplained = float(betaincinv(0.5 * free, 0.5 * terms, level))
    return 1.0 - unexplained - terms / free * unexplained


def _shares(groups: list[np.ndarray], target: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Shares of groups, shape (groups,), and those of campaigns drawn again, shape (drawn, groups)."""
    columns = np.column_stack([*groups, target, np.ones(len(target))])
    blocks = np.stack([rows.T @ rows for rows in np.array_split(columns, min(len(columns), _BLOCKS))])
    evenly = np.full(len(blocks), 1.0 / len(blocks))
    drawn = np.random.default_rng(0).multinomial(len(blocks), evenly, size=_REDRAWN)
    weights = np.vstack([np.ones(len(blocks)), drawn])
    sums = (weights @ blocks.reshape(len(blocks), -1)).reshape(-1, *blocks.shape[1:])
    mean = sums[:, :-1, -1] / sums[:, -1:, -1]
    covariance = sums[:, :-1, :-1] / sums[:, -1:, -1:] - mean[:, :, None] * mean[:, None, :]
    shares = _split(covariance, np.array([basis.shape[1] for basis in groups]), len(target))
    return shares[0], shares[1:]


def _split(covariance: np.ndarray, counts: np.ndarray, flights: int) -> np.ndarray:
    """Adjusted shares of groups of ``counts`` regressors each, shape (samples, groups).

    ``covariance`` is that of regressors and figure, the figure last, shape (samples, terms + 1, terms + 1).
    """
    sigma = np.sqrt(np.maximum(np.einsum("sii->si", covariance), np.finfo(float).tiny))
    correlation = covariance / (sigma[:, :, None] * sigma[:, None, :])
    values, vectors = np.linalg.eigh(correlation[:, :-1, :-1])
    root = 1.0 / np.sqrt(np.maximum(values, _DEGENERATE))
    scores = np.einsum("sij,sj,skj,sk->si", vectors, root, vectors, correlation[:, :-1, -1], optimize=True)
    explained = np.add.reduceat(scores**2, np.cumsum(counts) - counts, axis=1)
    by_chance = (1.0 - explained.sum(axis=1)) / max(flights - 1 - counts.sum(), 1)
    return np.asarray(explained - counts * by_chance[:, None])


def _effect(columns: np.ndarray, target: np.ndarray) -> str:
    if columns.shape[1] > 1:
        return ""
    scores = _scores(columns[:, 0])
    straight, square = (np.corrcoef(term, target)[0, 1] for term in (scores, scores**2))
    if abs(square) > abs(straight):
        return "curved"
    return "rises" if straight > 0.0 else "falls"
