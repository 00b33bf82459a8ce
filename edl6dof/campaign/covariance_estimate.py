"""Covariance of the figures at an event from mirrored pairs of flights, its error budget, and its comparison
with a campaign.

In a pair, all sources are stepped at once, and in opposite directions in the two flights, whose results are
y+ and y-. The mean square of half their difference contains the linear effect of the sources and a part of
the random effect; the covariance of half their sum contains the rest of the random effect and the
second-order effect of the sources.  The sum of both is the covariance of y.  It is unbiased for a response
that is linear in the sources plus any random effect; the linear effect has no sampling error, because the
columns of the design are orthogonal.  The response to one step is averaged over all other steps and random
effects: this statistical linearisation sees a bank reversal occur earlier or later in some flights, not a
jump in all flights.  The first flights of all pairs are flown again with other random effects; half the mean
square of the change is the variance that these cause, at all values of the sources.

Source: Gelb and Warren, AIAA J. 11 (1973) 689 (statistical linearisation); Box and Hunter,
Technometrics 3 (1961) 311 (design by mirror images); Jansen, Comput. Phys. Commun. 117 (1999) 35 (total
effect of the random effects).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
from scipy.stats import kurtosis

from edl6dof.campaign.covariance_flights import EventFigures, Source, cases, design, figures_of, sources
from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.executor import Progress
from edl6dof.config.errors import refusal


@dataclass(frozen=True)
class Spread:
    """Spread of some quantities; each array has shape (quantities,).

    Attributes:
        mean: mean over the flights, with the second-order effect of the sources.
        mean_error, error: standard errors of ``mean`` and of ``deviation``, the standard deviation.
        linear: standard deviation caused by the linear effect of the sources.
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
        steps: steps of the sources in the first flight of each pair, -1 or 1, shape (pairs, deviates).
        odd, even: half the difference and half the sum of both flights, shape (pairs, figures).
        changes: change of the figures of the first flights by other random effects, shape (pairs, figures);
            no pairs without random effects.
    """

    steps: np.ndarray
    odd: np.ndarray
    even: np.ndarray
    changes: np.ndarray

    @classmethod
    def of(cls, steps: np.ndarray, flights: np.ndarray) -> Pairs:
        """Form pairs from ``flights``, shape (2 pairs, figures) or (3 pairs, figures): first flights, mirror
        images, and the first flights with other random effects.
        """
        first, second, *again = np.split(flights, len(flights) // len(steps))
        changes = again[0] - first if again else flights[:0]
        return cls(steps, 0.5 * (first - second), 0.5 * (first + second), changes)

    @property
    def random(self) -> np.ndarray:
        """Variance of each figure by the random effects, shape (figures,)."""
        return 0.5 * np.sum(self.changes**2, axis=0) / max(len(self.changes), 1)

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
        """Standard error of every slope by the random effects, shape (figures,)."""
        return self.even.std(axis=0, ddof=1) / np.sqrt(len(self.even))

    def spread(self, directions: np.ndarray) -> Spread:
        """Mean and standard deviations of linear combinations of the figures.

        Each column of ``directions``, shape (figures, combinations), holds the weights of one combination.
        """
        odd, even = self.odd @ directions, self.even @ directions
        pairs, mean = len(odd), even.mean(axis=0)
        signed, rest = np.mean(odd**2, axis=0), even.var(axis=0, ddof=1)
        linear, deviation = np.maximum(signed - rest, 0.0), np.sqrt(signed + rest)
        # of normal noise, half of whose variance is in each part
        error = np.sqrt((4.0 * linear * rest + 2.0 * rest**2) / pairs + 2.0 * rest**2 / (pairs - 1))
        error = error / np.maximum(2.0 * deviation, np.finfo(float).tiny)
        return Spread(mean, np.sqrt(rest / pairs), deviation, error, np.sqrt(linear))


def principal(covariance: np.ndarray) -> np.ndarray:
    """Directions of the long and the short axis of an ellipse as columns; ``covariance`` has shape (2, 2)."""
    return np.linalg.eigh(covariance)[1][:, ::-1]


@dataclass(frozen=True)
class Covariance:
    """Covariance of the figures of an event.

    Attributes:
        apart: sources whose contributions are separated, in the order of their columns.
        together: lists of parameters whose items vary at random and whose effect is part of ``rest``.
    """

    event: EventFigures
    pairs: Pairs
    apart: tuple[Source, ...]
    together: tuple[Source, ...]

    @property
    def spread(self) -> Spread:
        """Spread of every figure."""
        return self.pairs.spread(np.eye(len(self.event.all)))

    @property
    def axes(self) -> np.ndarray:
        """Unit vectors along the axes of the position's ellipse, long axis first, shape (figures, 2)."""
        size = len(self.event.position)
        directions = np.zeros((len(self.event.all), size))
        directions[:size] = principal(self.pairs.covariance[:size, :size])
        return directions

    @property
    def budget(self) -> np.ndarray:
        """Variance of each figure by each separated source, less that by chance, shape (sources, figures)."""
        squared = self._slopes**2 - self.pairs.slope_error**2
        return np.stack([part.sum(axis=0) for part in self._by_source(squared)])

    @property
    def contributions(self) -> list[tuple[str, np.ndarray]]:
        """Separated sources with the standard deviation that each causes in every figure, signed if the
        source is one parameter; sorted by the share in the position, or in all figures if there is none.
        """
        shares = self.budget / np.maximum(self.spread.deviation**2, np.finfo(float).tiny)
        if size := len(self.event.position):
            shares = self.budget[:, :size]
        parts = self._by_source(self._slopes)
        values = [part[0] if len(part) == 1 else np.sqrt((part**2).sum(axis=0)) for part in parts]
        return [(self.apart[k].name, values[k]) for k in np.argsort(-shares.sum(axis=1))]

    @property
    def rest(self) -> np.ndarray:
        """Standard deviation of every figure that neither a separated source nor the random effects cause,
        shape (figures,); a budget below zero, which chance can cause, counts as zero.
        """
        explained = np.maximum(self.budget.sum(axis=0), 0.0) + self.pairs.random
        return np.sqrt(np.maximum(self.spread.deviation**2 - explained, 0.0))

    @property
    def _slopes(self) -> np.ndarray:
        return self.pairs.slopes[: sum(source.width for source in self.apart)]

    def _by_source(self, rows: np.ndarray) -> list[np.ndarray]:
        return np.split(rows, np.cumsum([source.width for source in self.apart])[:-1])


def fly_covariance(
    plan: Plan,
    event: EventFigures,
    pairs: int,
    workers: int | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Covariance:
    """Fly at least the given number of ``pairs``, and more if the separation of the sources needs more.

    ``progress`` is called with the number of flights done and the total number.

    Raises:
        ConfigError: the campaign has no covariance, or a flight does not reach the event.
    """
    apart, together = tuple(sources(plan)), tuple[Source, ...]()
    if sum(source.width for source in apart) > pairs:  # too few pairs to separate the items of lists
        together = tuple(source for source in apart if source.is_list)
        apart = tuple(source for source in apart if not source.is_list)
    columns, more = (sum(source.width for source in some) for some in (apart, together))
    steps = design(columns, more, pairs, plan.campaign.seed if plan.campaign else 0)
    again = [steps] if plan.campaign and plan.campaign.profiles else []
    every = np.vstack([steps, -steps, *again])
    flown = cases(plan, [*apart, *together], every)
    figures = figures_of(plan, flown, event, workers, lambda done, _: progress(done, len(every)))
    return Covariance(event, Pairs.of(steps, figures), apart, together)


@dataclass(frozen=True)
class Alone:
    """Response of one flight to each deviate of the sources ``found`` (no lists), stepped one at a time.

    Slopes and bends, shape (deviates, figures), are the central first and second differences over one
    standard deviation.  If a bend is not small compared with the slope, the response is not linear: for
    example, a bank reversal occurs earlier in one of the flights, or lift is at its limit.
    """

    found: tuple[Source, ...]
    slopes: np.ndarray
    bends: np.ndarray

    @classmethod
    def of(cls, found: Sequence[Source], flights: np.ndarray) -> Alone:
        """Build from ``flights``, shape (1 + 2 deviates, figures): the flight at the means, those with one
        deviate stepped up, then those with one deviate stepped down.
        """
        middle = flights[0]
        above, below = np.split(flights[1:], 2)
        return cls(tuple(found), 0.5 * (above - below), 0.5 * (above + below) - middle)


def fly_alone(
    plan: Plan, event: EventFigures, workers: int | None = None, progress: Progress | None = None
) -> Alone:
    """Fly with each source but lists one standard deviation above and below its mean, one source at a time.
    All flights have the same random profiles.

    Raises:
        ConfigError: the campaign has no covariance, or a flight does not reach the event.
    """
    found = [source for source in sources(plan) if not source.is_list]
    one = np.eye(sum(source.width for source in found))
    steps = np.vstack([np.zeros_like(one[:1]), one, -one])
    flown = cases(plan, found, steps, own_profiles=False)
    return Alone.of(found, figures_of(plan, flown, event, workers, progress))


#: Shares of a normal distribution below one standard deviation under and over its mean.
_CORE = (0.158655, 0.841345)


@dataclass(frozen=True)
class Sampled:
    """Spread of some quantities over flights; each array has shape (quantities,).

    Attributes:
        error: standard error of the deviation, which the tails of the distribution widen.
        core: half the width of the middle 68 %: the deviation of a normal distribution.
    """

    mean: np.ndarray
    deviation: np.ndarray
    error: np.ndarray
    core: np.ndarray

    @classmethod
    def of(cls, values: np.ndarray) -> Sampled:
        """Estimate the spread from ``values``, shape (flights, quantities)."""
        deviation = values.std(axis=0, ddof=1)
        low, high = np.quantile(values, _CORE, axis=0)
        error = deviation * np.sqrt((kurtosis(values) + 2.0) / (4.0 * len(values)))
        return cls(values.mean(axis=0), deviation, error, 0.5 * (high - low))


def flown(table: pa.Table, event: EventFigures, place: object) -> np.ndarray:
    """Figures of the flights that reached the event, shape (flights, figures).

    Raises:
        ConfigError: fewer than ten flights reached the event.
    """
    if missing := [name for name in event.all if name not in table.column_names]:
        raise refusal(place, f"no flight of it has {', '.join(missing)}")
    values = np.stack([table[name].to_numpy(zero_copy_only=False) for name in event.all], axis=1)
    values = values[np.isfinite(values).all(axis=1)]
    if len(values) < 10:
        raise refusal(place, f"only {len(values)} of its flights came to the event")
    return values


def along_axes(values: np.ndarray, position: int) -> np.ndarray:
    """Return positions along the axes of their ellipse, long axis first, shape (flights, ``position``)."""
    place = values[:, :position]
    return place @ principal(np.cov(place.T)) if position else place
