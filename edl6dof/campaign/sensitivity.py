"""Sensitivity of a figure: shares of its variance from the dispersed flights of any campaign
(:func:`drivers`), and Sobol indices from flights that are designed for these indices (:func:`sobol_indices`).

Shares are designed for many inputs and few flights.  Figure and inputs are replaced by their normal scores,
so that outliers and the shapes of distributions have little effect.  Groups are added to the regression one
by one, each time the one that explains most of the remaining variance, as long as an F test finds it
significant among all groups tried.  The variance that they explain together is divided among them, less the
variance that their regressors explain by chance, so that the shares add up to the adjusted R2.  Their
intervals come from the bootstrap.  Interactions of inputs remain unexplained.

Sources: van der Waerden, Indag. Math. 14 (1952) 453 (scores); Sidak, J. Am. Stat. Assoc. 62 (1967) 626 (many
tests); Zuber and Strimmer, Stat. Appl. Genet. Mol. Biol. 10 (2011) 34 (the split, CAR scores: for inputs that
are independent it is that of Lindeman, Merenda and Gold, the Shapley value, and the first-order index of
Sobol); Efron, Ann. Stat. 7 (1979) 1 (bootstrap).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.special import betainc, betaincinv, ndtri

#: Probability of a false driver, in one figure or in all figures of a report.
CHANCE = 0.05
#: Smallest number of flights, and of rows of a design for indices; with fewer, ranks agree by chance.
FEWEST, FEWEST_ROWS = 20, 16
#: Flights for each regressor without which a group has no square effects.
_FLIGHTS_PER_TERM = 10
#: Bootstrap samples for the intervals, and the ends of these.
_REDRAWN, _ENDS = 400, (0.025, 0.975)
#: More flights than these are resampled in as many blocks.
_BLOCKS = 300
#: Least singular value of regressors, as a share of the largest, and least eigenvalue of a correlation.
_DEGENERATE = 1e-6


@dataclass(frozen=True)
class Driver:
    """A group of inputs that drives a figure.

    Attributes:
        share: of the variance of the figure's normal scores.
        low, high: ends of the 95 % interval of the share.
        effect: ``rises`` or ``falls`` with a single input, ``curved``, or empty for a group of several.
    """

    name: str
    share: float
    low: float
    high: float
    effect: str


@dataclass(frozen=True)
class Drivers:
    """Drivers found for a figure, the largest share first.

    Attributes:
        flights: number of flights that have the figure.
        least: share below which an input is not significant.
    """

    flights: int
    found: tuple[Driver, ...]
    least: float

    @property
    def explained(self) -> float:
        """Share of the variance that all drivers explain together: the adjusted R2."""
        return sum(driver.share for driver in self.found)


@dataclass(frozen=True)
class _Inputs:
    """Inputs of the flights that have a figure, shared by all figures of the same flights.

    Attributes:
        scores: normal scores of each group, shape (n, inputs of the group).
        regressors: regressors of all groups, orthonormal within each, shape (n, terms).
        columns: columns of the regressors of each group that is not constant, shape (terms of the group,).
        correlation: correlation of all regressors, shape (terms, terms).
    """

    scores: dict[str, np.ndarray]
    regressors: np.ndarray
    columns: dict[str, np.ndarray]
    correlation: np.ndarray

    @classmethod
    def of(cls, groups: Mapping[str, np.ndarray], usable: np.ndarray) -> _Inputs:
        scores = {name: _scores(values[usable]) for name, values in groups.items()}
        terms = {name: basis for name, values in scores.items() if (basis := _terms(values)).size}
        regressors = np.column_stack([np.empty((int(usable.sum()), 0)), *terms.values()])
        ends = np.cumsum([basis.shape[1] for basis in terms.values()], dtype=int)
        columns = {
            name: np.arange(end - basis.shape[1], end)
            for (name, basis), end in zip(terms.items(), ends, strict=True)
        }
        return cls(scores, regressors, columns, regressors.T @ regressors)


def drivers(
    groups: Mapping[str, np.ndarray], figures: Sequence[np.ndarray], chance: float = CHANCE
) -> list[Drivers]:
    """Find the groups of inputs that drive each of several figures.

    Args:
        groups: inputs that belong together, shape (n, inputs of the group), by name; each group independent
            of the others.
        figures: each of shape (n,), NaN where a flight has none.
        chance: probability that at least one group is named for at least one figure if no group has an
            effect.
    """
    level = _of_each(chance, len(figures))
    known: dict[bytes, _Inputs] = {}
    found = []
    for figure in figures:
        usable = np.isfinite(figure)
        target = _scores(figure[usable])
        if len(target) < FEWEST or np.ptp(target) == 0.0:
            found.append(Drivers(len(target), (), 1.0))
            continue
        if usable.tobytes() not in known:
            known[usable.tobytes()] = _Inputs.of(groups, usable)
        found.append(_drivers(known[usable.tobytes()], target, level))
    return found


def _drivers(inputs: _Inputs, target: np.ndarray, chance: float) -> Drivers:
    flights = len(target)
    names, least = _told_from_chance(inputs, target, chance)
    if not names:
        return Drivers(flights, (), least)
    groups = [inputs.regressors[:, inputs.columns[name]] for name in names]
    own, redrawn = _shares(groups, target)
    wider = np.sqrt(flights / max(flights - 1 - sum(basis.shape[1] for basis in groups), 1))
    low, high = np.clip(own + wider * (np.quantile(redrawn, _ENDS, axis=0) - own), 0.0, 1.0)
    found = [
        Driver(name, max(share, 0.0), start, end, _effect(inputs.scores[name], target))
        for name, share, start, end in zip(names, own.tolist(), low.tolist(), high.tolist(), strict=True)
    ]
    return Drivers(flights, tuple(sorted(found, key=lambda driver: -driver.share)), least)


def _of_each(chance: float, tries: int) -> float:
    """Significance level of each of some tests for a ``chance`` of any false result (Sidak)."""
    return float(-np.expm1(np.log1p(-chance) / max(tries, 1)))


def _scores(values: np.ndarray) -> np.ndarray:
    """Normal scores: the deviates of a normal sample at the ranks of the values."""
    ranks = np.apply_along_axis(_ranks, 0, values) if values.size else values
    return np.asarray(ndtri((ranks - 0.5) / len(values)))


def _ranks(values: np.ndarray) -> np.ndarray:
    """Rank of each value, from 1 on; equal values have their mean rank (scipy.stats loads too slowly)."""
    _, place, equal = np.unique(values, return_inverse=True, return_counts=True)
    return np.asarray((np.cumsum(equal) - 0.5 * (equal - 1))[place])


def _terms(scores: np.ndarray) -> np.ndarray:
    """Orthonormal regressors of a group, shape (n, terms): linear and, if flights suffice, quadratic."""
    enough = 2 * scores.shape[1] * _FLIGHTS_PER_TERM <= len(scores)
    columns = np.hstack([scores, scores**2]) if enough else scores
    vectors, values, _ = np.linalg.svd(columns - columns.mean(axis=0), full_matrices=False)
    return np.asarray(vectors[:, values > _DEGENERATE * np.sqrt(len(columns))])


def _told_from_chance(inputs: _Inputs, target: np.ndarray, chance: float) -> tuple[list[str], float]:
    """Significant groups in the order of their addition, and the least share that one more would need."""
    centred = target - target.mean()
    aim = centred @ inputs.regressors / np.linalg.norm(centred)
    # correlation of the regressors and, last, the figure: the part that the groups taken leave unexplained
    rest = np.block([[inputs.correlation, aim[:, None]], [aim, np.ones(1)]])
    left, free = dict(inputs.columns), len(target) - 1
    taken, least = [], 1.0
    while rest[-1, -1] > _DEGENERATE:
        tried = {name: own for name, own in left.items() if free > len(own)}
        if not tried:
            break
        level = _of_each(chance, len(tried))
        least = rest[-1, -1] * min(_critical(len(own), free - len(own), level) for own in tried.values())
        p_values = {
            name: _p_value(1.0 - _explained(rest, own) / rest[-1, -1], len(own), free - len(own))
            for name, own in tried.items()
        }
        best = min(p_values, key=lambda name: p_values[name])
        if p_values[best] > level:
            break
        taken.append(best)
        own = left.pop(best)
        free -= len(own)
        through = rest[:, own] @ _whitening(rest[np.ix_(own, own)])
        rest = rest - through @ through.T
    return taken, float(least)


def _explained(rest: np.ndarray, own: np.ndarray) -> float:
    """Return the share of the figure, the last row of ``rest``, that the regressors ``own`` explain."""
    return float(np.sum((rest[-1, own] @ _whitening(rest[np.ix_(own, own)])) ** 2))


def _whitening(covariance: np.ndarray) -> np.ndarray:
    """Uncorrelated combinations of variables with variance 1, shape (variables, combinations); constant ones
    are left out.
    """
    values, vectors = np.linalg.eigh(covariance)
    moving = values > _DEGENERATE
    return np.asarray(vectors[:, moving] / np.sqrt(values[moving]))


def _p_value(unexplained: float, terms: int, free: int) -> float:
    """Probability that regressors without effect leave as little unexplained (F test)."""
    return float(betainc(0.5 * free, 0.5 * terms, min(max(unexplained, 0.0), 1.0)))


def _critical(terms: int, free: int, level: float) -> float:
    """Return the adjusted share of the remaining variance above which regressors are significant."""
    unexplained = float(betaincinv(0.5 * free, 0.5 * terms, level))
    return 1.0 - unexplained - terms / free * unexplained


def _shares(groups: list[np.ndarray], target: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Shares of groups, shape (groups,), and those of bootstrap samples, shape (samples, groups)."""
    columns = np.column_stack([*groups, target, np.ones(len(target))])
    blocks = np.stack([rows.T @ rows for rows in np.array_split(columns, min(len(columns), _BLOCKS))])
    weights = _weights(len(blocks))
    sums = (weights @ blocks.reshape(len(blocks), -1)).reshape(-1, *blocks.shape[1:])
    mean = sums[:, :-1, -1] / sums[:, -1:, -1]
    covariance = sums[:, :-1, :-1] / sums[:, -1:, -1:] - mean[:, :, None] * mean[:, None, :]
    shares = _split(covariance, np.array([basis.shape[1] for basis in groups]), len(target))
    return shares[0], shares[1:]


@cache
def _weights(blocks: int) -> np.ndarray:
    """Return the weight of each block of flights: one row for the campaign, one for each resample."""
    evenly = np.full(blocks, 1.0 / blocks)
    drawn = np.random.default_rng(0).multinomial(blocks, evenly, size=_REDRAWN)
    return np.vstack([np.ones(blocks), drawn])


def _split(covariance: np.ndarray, counts: np.ndarray, flights: int) -> np.ndarray:
    """Adjusted shares of groups of ``counts`` regressors each, shape (samples, groups).

    ``covariance`` is that of regressors and figure, the figure last, shape (samples, terms + 1, terms + 1).
    """
    sigma = np.sqrt(np.maximum(np.einsum("sii->si", covariance), np.finfo(float).tiny))
    correlation = covariance / (sigma[:, :, None] * sigma[:, None, :])
    values, vectors = np.linalg.eigh(correlation[:, :-1, :-1])
    along = np.einsum("skj,sk->sj", vectors, correlation[:, :-1, -1])
    scores = np.einsum("sij,sj->si", vectors, along / np.sqrt(np.maximum(values, _DEGENERATE)))
    explained = np.add.reduceat(scores**2, np.cumsum(counts) - counts, axis=1)
    by_chance = (1.0 - explained.sum(axis=1)) / max(flights - 1 - counts.sum(), 1)
    return np.asarray(explained - counts * by_chance[:, None])


def _effect(scores: np.ndarray, target: np.ndarray) -> str:
    if scores.shape[1] > 1:
        return ""
    straight, square = (np.corrcoef(term, target)[0, 1] for term in (scores[:, 0], scores[:, 0] ** 2))
    if abs(square) > abs(straight):
        return "curved"
    return "rises" if straight > 0.0 else "falls"


@dataclass(frozen=True)
class Index:
    """Indices of a group, each with the ends of its 95 % interval: (value, low, high)."""

    name: str
    first: tuple[float, float, float]
    total: tuple[float, float, float]


def sobol_indices(a: np.ndarray, b: np.ndarray, swapped: Mapping[str, np.ndarray]) -> list[Index]:
    """Indices of each group, largest total first; empty if rows are too few or the figure is constant.

    The first-order index is the share of the variance that vanishes when a group of inputs is known.  The
    total index is the share that remains when all others are known; it exceeds the first-order index by the
    interactions of the group with others.

    Sources: Saltelli et al., Comput. Phys. Commun. 181 (2010) 259, table 2, b and f; Jansen, Comput. Phys.
    Commun. 117 (1999) 35; intervals by the bootstrap over rows, Archer et al., J. Stat. Comput. Simul. 58
    (1997) 99.

    Args:
        a: the figure of the flights of matrix A, shape (rows,); NaN where a flight has none.
        b: the figure of the flights of matrix B.
        swapped: the figure of the flights of A with one group taken from B, by the name of the group.
    """
    every = np.stack([a, b, *swapped.values()])
    every = every[:, np.isfinite(every).all(axis=0)]
    rows = every.shape[1]
    if rows < FEWEST_ROWS or np.ptp(every[:2]) == 0.0:
        return []
    picks = np.random.default_rng(0).integers(rows, size=(_REDRAWN, rows))
    values = _indices(every[:, None, :])[:, :, 0]
    low, high = np.quantile(_indices(every[:, picks]), _ENDS, axis=2)
    first, total = (
        [(float(value), float(start), float(end)) for value, start, end in zip(*kind, strict=True)]
        for kind in zip(values, low, high, strict=True)
    )
    found = [Index(*index) for index in zip(swapped, first, total, strict=True)]
    return sorted(found, key=lambda index: -index.total[0])


def _indices(figure: np.ndarray) -> np.ndarray:
    """First-order and total indices (2, groups, samples) from figures (2 + groups, samples, rows)."""
    spread = np.concatenate([figure[0], figure[1]], axis=-1)
    a, b, swapped = figure[0], figure[1] - spread.mean(axis=-1, keepdims=True), figure[2:]
    variance = np.maximum(spread.var(axis=-1), np.finfo(float).tiny)
    first = np.mean(b * (swapped - a), axis=-1) / variance
    total = 0.5 * np.mean((a - swapped) ** 2, axis=-1) / variance
    return np.stack([first, total])
