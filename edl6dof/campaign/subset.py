"""The probability of a rare failure by subset simulation, for any function of the inputs of a case.

The failure is divided into levels, each with about a fifth of the probability of the one before.  The points
of a level that are beyond the next threshold start Markov chains inside the next level: a step mixes a point
with a new random one (preconditioned Crank-Nicolson) and is kept if the result is still beyond the
threshold.  Several populations do so independently; the interval of the probability follows from their
spread, and contains all errors of a population: few points, and chains that are correlated.

Sources: Au and Beck, Probabilistic Engineering Mechanics 16 (2001) 263; adaptive steps: Papaioannou, Betz,
Zwirglmaier and Straub, Probabilistic Engineering Mechanics 41 (2015) 89; the step: Cotter, Roberts, Stuart
and White, Statistical Science 28 (2013) 424; the interval of the mean of a log-normal distribution (Cox's
method with Student's t): Olsson, Journal of Statistics Education 13 (2005) 1.

>>> first, *_ = simulate(lambda points: 3.0 - points.deviates[:, 0], inputs=1, size=500, populations=4, seed=1)
>>> abs(log(first.probability / 1.35e-3)) < 1.0
True
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from itertools import count
from math import exp, log, prod, sqrt
from typing import NamedTuple

import numpy as np
from scipy.stats import t as student

from edl6dof.spatial.random_numbers import Stream

#: Share of the points that form the next level; share of the steps that should be kept; first step size.
SHARE, KEPT, FIRST_STEP = 0.2, 0.3, 0.6
#: A population that is beyond this probability without a failure stops.
LEAST = 1e-9
#: Third number of the seed; the generators of the sampling plans have 3 (:mod:`.sampling`).
_STREAM = 4


class Points(NamedTuple):
    """Points of the inputs, an item for each point in every array.

    Attributes:
        numbers: number of each point, unique in all populations, shape (n,).
        profiles: number of its random profiles: that of the point for which they were drawn, shape (n,).
        deviates: standard normal deviates, shape (n, inputs).
    """

    numbers: np.ndarray
    profiles: np.ndarray
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
        levels: its levels, the failure itself not included.
        points, margins: points of the last level.
    """

    levels: tuple[Level, ...]
    points: Points
    margins: np.ndarray

    @property
    def failed(self) -> np.ndarray:
        """True for points that are failures."""
        return self.margins < 0.0

    @property
    def probability(self) -> float:
        """Estimate of the probability of the failure; 0 if no failure was found."""
        return prod(level.share for level in self.levels) * float(np.mean(self.failed))


def simulate(margins: Margins, *, inputs: int, size: int, populations: int, seed: int) -> list[Population]:
    """Run independent populations.

    Args:
        margins: margins of points; all populations ask together, so that a call has many points.
        inputs: number of inputs.
        size: points of each level of a population.
        populations: number of populations.
        seed: seed of the random numbers.
    """
    runs = {k: _population(k, populations, size, inputs, seed) for k in range(populations)}
    waiting, done = {k: next(run) for k, run in runs.items()}, {}
    while waiting:
        found = margins(joined(list(waiting.values())))
        ends = np.cumsum([len(points.numbers) for points in waiting.values()])[:-1]
        for k, own in zip(list(waiting), np.split(found, ends), strict=True):
            try:
                waiting[k] = runs[k].send(own)
            except StopIteration as end:
                done[k] = end.value
                del waiting[k]
    return [done[k] for k in range(populations)]


def _population(
    k: int, populations: int, size: int, inputs: int, seed: int
) -> Generator[Points, np.ndarray, Population]:
    """Yield points of which the margins are needed; return the result."""
    random, numbers = Stream(seed, k, _STREAM), count(k, populations)
    first = _next(numbers, size)
    points, step = Points(first, first, random.standard_normal((size, inputs))), FIRST_STEP
    margins = yield points
    levels: list[Level] = []
    while (below := threshold(margins)) is not None and prod(level.share for level in levels) > LEAST:
        inside = np.flatnonzero(margins < below)
        inside = inside[np.argsort(random.uniform(len(inside)), kind="stable")]
        chain, held = points.only(inside), margins[inside]
        states, values, kept, tried = [chain], [held], 0, 0
        for moving in _moving(len(inside), size):
            old, before = chain.only(slice(moving)), held[:moving]
            new = _next(numbers, moving)
            profiles = np.where(random.uniform(moving) < 0.5, new, old.profiles)
            noise = random.standard_normal((moving, inputs))
            proposed = Points(new, profiles, sqrt(1.0 - step * step) * old.deviates + step * noise)
            found = yield proposed
            good = found < below
            chain = Points(
                *(np.where(good if a.ndim == 1 else good[:, None], a, b) for a, b in zip(proposed, old))
            )
            held = np.where(good, found, before)
            states.append(chain)
            values.append(held)
            kept, tried = kept + int(good.sum()), tried + moving
            step = min(max(step * (1.0 + int(good.sum()) / moving - KEPT), 0.02), 1.0)
        levels.append(Level(below, len(inside) / len(margins), kept / tried))
        points, margins = joined(states), np.concatenate(values)
    return Population(tuple(levels), points, margins)


def _next(numbers: count[int], many: int) -> np.ndarray:
    return np.fromiter(numbers, np.int64, many)


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
    if not inside.any():
        return None
    below = float(values[inside][np.argmin(np.abs(np.log(shares[inside] / SHARE)))])
    return below if below > 0.0 else None


class Estimate(NamedTuple):
    """A probability with the bounds of its interval; the bounds are ``None`` if a population has found no
    failure.
    """

    probability: float
    low: float | None
    high: float | None


def estimate(probabilities: Sequence[float], confidence: float) -> Estimate:
    """Return the mean of the probabilities of populations, and the interval from their spread."""
    mean = float(np.mean(probabilities))
    if min(probabilities) == 0.0:
        return Estimate(mean, None, None)
    logs, size = np.log(probabilities), len(probabilities)
    variance = float(np.var(logs, ddof=1))
    error = sqrt(variance / size + variance**2 / (2.0 * (size - 1)))
    middle = float(np.mean(logs)) + 0.5 * variance
    half = float(student.ppf(0.5 + 0.5 * confidence, size - 1)) * error
    return Estimate(mean, exp(middle - half), min(exp(middle + half), 1.0))


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
    weights = np.concatenate([np.full(len(own), share / len(own)) for own, share in zip(scores, shares)])
    every = np.concatenate(scores)
    means = weights @ every
    spreads = np.sqrt(weights @ (every - means) ** 2)
    apart = np.array([own.mean(axis=0) for own in scores])
    difference = 0.5 * (means**2 + spreads**2 - 1.0) - np.log(np.maximum(spreads, 1e-12))
    columns = (means, spreads, apart.min(axis=0), apart.max(axis=0), difference)
    return [Region(*map(float, row)) for row in zip(*columns, strict=True)]
