"""The probability of a rare failure by subset simulation, for any function of the inputs of a case.

The failure is divided into levels, each with about a fifth of the probability of the one before.  The points
of a level that are beyond the next threshold start Markov chains inside the next level: a step mixes a point
with a new random one (preconditioned Crank-Nicolson) and is kept if the result is still beyond the
threshold.  The levels are common to several populations, each with the descendants of its own first points:
their spread is reported, and a population may die out.  Populations with levels of their own would make the
estimate less precise, because it would be the mean of a few skewed ones.

The variance of the probability follows from the first points of which the failures are descendants: a
population whose failures descend from few first points is as uncertain as a sample with so few failures.
This contains the correlation of the chains.  The variance between the populations is used if it is larger.

Sources: Au and Beck, Probabilistic Engineering Mechanics 16 (2001) 263; adaptive steps: Papaioannou, Betz,
Zwirglmaier and Straub, Probabilistic Engineering Mechanics 41 (2015) 89; the step: Cotter, Roberts, Stuart
and White, Statistical Science 28 (2013) 424; the variance from descent: Chan and Lai, Annals of Statistics
41 (2013) 2877, and Lee and Whiteley, Biometrika 105 (2018) 609.

>>> def margins(points):
...     return 3.0 - points.deviates[:, 0]
>>> found = simulate(margins, inputs=1, size=500, populations=4, seed=1)
>>> one = estimate(found, confidence=0.9)
>>> one.low < 1.35e-3 < one.high
True
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from itertools import count
from math import exp, prod, sqrt
from typing import NamedTuple, TypeVar

import numpy as np
from scipy.stats import t as student

from edl6dof.spatial.random_numbers import Stream

#: Share of the points that form the next level; share of the steps that should be kept; first step size.
SHARE, KEPT, FIRST_STEP = 0.2, 0.44, 0.6
#: Smallest step size.
LEAST_STEP = 0.02
#: The simulation stops without a failure if the levels are beyond this probability.
LEAST = 1e-9
#: Third number of the seed; the generators of the sampling plans have 3 (:mod:`.sampling`).
_STREAM = 4

Result = TypeVar("Result")


class Points(NamedTuple):
    """Points of the inputs, an item for each point in every array.

    Attributes:
        numbers: number of each point, unique in all populations, shape (n,).
        profiles: number of its random profiles: that of the point for which they were drawn, shape (n,).
        ancestors: number of the first point of its chains, shape (n,); modulo the number of populations, it
            is the number of its population.
        deviates: standard normal deviates, shape (n, inputs).
    """

    numbers: np.ndarray
    profiles: np.ndarray
    ancestors: np.ndarray
    deviates: np.ndarray

    def only(self, rows: np.ndarray | slice) -> Points:
        """Return some of the points."""
        return Points(*(column[rows] for column in self))


def joined(parts: Sequence[Points]) -> Points:
    """Return all points of several sets, one after the other."""
    return Points(*map(np.concatenate, zip(*parts, strict=True)))


#: Margins of points, shape (n,): negative for a failure, smaller for a worse point.
Margins = Callable[[Points], np.ndarray]


class Level(NamedTuple):
    """A threshold of the margin, the share of the points before that is below it, and the share of the steps
    of the new chains that were kept.
    """

    below: float
    share: float
    kept: float


@dataclass(frozen=True)
class Population:
    """Result of one population.

    Attributes:
        levels: levels of all populations, the failure itself not included.
        points, margins: points of the last level that descend from its first points.
        size: number of its first points, and of points of a level in the mean over the populations.
    """

    levels: tuple[Level, ...]
    points: Points
    margins: np.ndarray
    size: int

    @property
    def failed(self) -> np.ndarray:
        """True for points that are failures."""
        return self.margins < 0.0

    @property
    def probability(self) -> float:
        """Estimate of the probability of the failure; 0 if no failure was found."""
        return prod(level.share for level in self.levels) * int(np.sum(self.failed)) / self.size

    @property
    def variance(self) -> float:
        """Variance of the estimate over its square: one over the number of first points of which the failures
        descend, if each has as many; 0 without failures.
        """
        _, descendants = np.unique(self.points.ancestors[self.failed], return_counts=True)
        return float(np.sum((descendants / max(np.sum(descendants), 1)) ** 2))


def simulate(margins: Margins, *, inputs: int, size: int, populations: int, seed: int) -> list[Population]:
    """Run populations with common levels.

    Args:
        margins: margins of points; a call has the points of one step of all populations.
        inputs: number of inputs.
        size: first points of a population, and points of each level in the mean over the populations.
        populations: number of populations.
        seed: seed of the random numbers.
    """
    run = _Run(size * populations, inputs, seed).levels()
    asked = next(run)
    while True:
        try:
            asked = run.send(margins(asked))
        except StopIteration as end:
            levels, points, last = end.value
            break
    own = [points.ancestors % populations == k for k in range(populations)]
    return [Population(levels, points.only(np.flatnonzero(rows)), last[rows], size) for rows in own]


#: Yields points, is sent their margins, and returns a result.
Asking = Generator[Points, np.ndarray, Result]


class _Run:
    """All points, random numbers and step size; yields the points of which it needs the margins."""

    def __init__(self, size: int, inputs: int, seed: int):
        self.size, self.inputs = size, inputs
        self.random, self.numbers, self.step = Stream(seed, 0, _STREAM), count(), FIRST_STEP

    def levels(self) -> Asking[tuple[tuple[Level, ...], Points, np.ndarray]]:
        """Run the levels; return them with the points of the last one and their margins."""
        numbers = self._next(self.size)
        points = Points(numbers, numbers, numbers, self.random.standard_normal((self.size, self.inputs)))
        margins = yield points
        levels: list[Level] = []
        while (below := threshold(margins)) is not None and prod(one.share for one in levels) > LEAST:
            inside = np.flatnonzero(margins < below)
            inside = inside[np.argsort(self.random.uniform(len(inside)), kind="stable")]
            points, margins, kept = yield from self._chains(points.only(inside), margins[inside], below)
            levels.append(Level(below, len(inside) / self.size, kept))
        return tuple(levels), points, margins

    def _chains(
        self, last: Points, held: np.ndarray, below: float
    ) -> Asking[tuple[Points, np.ndarray, float]]:
        """Continue chains from points below a threshold until there are as many points as before; return all
        points, their margins and the share of steps that were kept.
        """
        chains, kept = [(last, held)], []
        for moving in _moving(len(held), self.size):
            last, held = last.only(slice(moving)), held[:moving]
            proposed = self._proposed(last)
            found = yield proposed
            good = found < below
            last = _chosen(good, proposed, last)
            held = np.where(good, found, held)
            chains.append((last, held))
            kept.append(good)
            self.step = min(max(self.step * (1.0 + float(np.mean(good)) - KEPT), LEAST_STEP), 1.0)
        points, margins = zip(*chains, strict=True)
        return joined(points), np.concatenate(margins), float(np.mean(np.concatenate(kept)))

    def _proposed(self, last: Points) -> Points:
        """Take one step from points; half of them with new random profiles."""
        many = len(last.numbers)
        numbers, fresh = self._next(many), self.random.uniform(many) < 0.5
        noise = self.random.standard_normal((many, self.inputs))
        deviates = sqrt(1.0 - self.step**2) * last.deviates + self.step * noise
        return Points(numbers, np.where(fresh, numbers, last.profiles), last.ancestors, deviates)

    def _next(self, many: int) -> np.ndarray:
        return np.fromiter(self.numbers, np.int64, many)


def _chosen(which: np.ndarray, points: Points, others: Points) -> Points:
    """Return the points where ``which`` is true, shape (n,), else the others."""
    numbers, profiles = (np.where(which, *pair) for pair in zip(points[:2], others[:2], strict=True))
    deviates = np.where(which[:, None], points.deviates, others.deviates)
    return Points(numbers, profiles, others.ancestors, deviates)


def _moving(chains: int, size: int) -> list[int]:
    """Number of chains that take each step, so that all chains together have ``size`` points."""
    return [some for some in [chains] * (size // chains - 1) + [size % chains] if some]


def threshold(margins: np.ndarray) -> float | None:
    """The value below which about a fifth of the margins is; ``None`` if the failures are as many, or if all
    margins are equal.

    The points of a plateau, a value that many points have, are all below the threshold or none is, so that
    the share of a level is that of a set.  Source: Walter, arXiv 1507.00919.
    """
    values, counts = np.unique(margins, return_counts=True)
    shares = (np.cumsum(counts) - counts) / len(margins)
    inside = shares > 0.0
    if not inside.any() or np.mean(margins < 0.0) >= SHARE:
        return None
    ratio = shares[inside] / SHARE
    below = float(values[inside][np.argmin(np.maximum(ratio, 1.0 / ratio))])
    return below if below > 0.0 else None


class Estimate(NamedTuple):
    """A probability with the bounds of its interval; the bounds are ``None`` if no failure was found."""

    probability: float
    low: float | None
    high: float | None


def estimate(populations: Sequence[Population], confidence: float) -> Estimate:
    """Return the mean of the probabilities of populations, and its interval.

    The estimate has about a log-normal distribution, with as many degrees of freedom as the failures have
    different first points.
    """
    each = np.array([one.probability for one in populations])
    mean = float(np.mean(each))
    if mean == 0.0:
        return Estimate(mean, None, None)
    within = float(np.sum(each**2 * [one.variance for one in populations]) / np.sum(each) ** 2)
    between = float(np.var(each, ddof=1)) / len(each) / mean**2
    variance = max(within, between)
    half = float(student.ppf(0.5 + 0.5 * confidence, 1.0 / variance)) * sqrt(variance)
    middle = mean * exp(0.5 * variance)  # of a log-normal distribution, half of the estimates are too small
    return Estimate(mean, middle * exp(-half), min(middle * exp(half), 1.0))


class Region(NamedTuple):
    """Failures in one input, in standard deviations of the input.

    Attributes:
        mean, spread: mean and standard deviation over all failures.
        lowest, highest: smallest and largest mean of a population.
        difference: Kullback-Leibler divergence of a normal distribution with this mean and spread from that
            of the input, nats.
    """

    mean: float
    spread: float
    lowest: float
    highest: float
    difference: float


def regions(scores: Sequence[np.ndarray], probabilities: Sequence[float]) -> list[Region]:
    """Describe the failures in every input; a population counts as much as its probability.

    Args:
        scores: for each population with failures, their scores in the inputs, shape (failures, inputs).
        probabilities: probability of each of these populations.
    """
    shares = np.asarray(probabilities) / np.sum(probabilities)
    weights = np.concatenate(
        [np.full(len(own), share / len(own)) for own, share in zip(scores, shares, strict=True)]
    )
    every = np.concatenate(scores)
    means = weights @ every
    spreads = np.sqrt(weights @ (every - means) ** 2)
    apart = np.array([own.mean(axis=0) for own in scores])
    difference = 0.5 * (means**2 + spreads**2 - 1.0) - np.log(np.maximum(spreads, 1e-12))
    columns = (means, spreads, apart.min(axis=0), apart.max(axis=0), difference)
    return [Region(*map(float, row)) for row in zip(*columns, strict=True)]
