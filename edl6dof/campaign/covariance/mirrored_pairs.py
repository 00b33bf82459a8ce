"""Fly a campaign's dispersions in mirrored pairs, and form the covariance of an event and its budget."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from edl6dof.campaign.covariance.estimate import Pairs, Spread, principal
from edl6dof.campaign.covariance.event_figures import EventFigures, figures_of
from edl6dof.campaign.covariance.sources import Source, cases, sources
from edl6dof.campaign.covariance.two_level_design import design
from edl6dof.campaign.design.plan import Plan


@dataclass(frozen=True)
class Covariance:
    """Covariance of the figures of an event.

    Attributes:
        event: the figures.
        pairs: what the flights gave.
        apart: sources whose parts are told apart, in the order of their columns.
        together: lists whose items change at random, and are part of the rest.
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
        """Directions of the ellipse of the position in the space of the figures, long axis first, shape
        (figures, 2).
        """
        size = len(self.event.position)
        directions = np.zeros((len(self.event.all), size))
        directions[:size] = principal(self.pairs.covariance[:size, :size])
        return directions

    @property
    def budget(self) -> np.ndarray:
        """Variance that each source apart gives to each figure, shape (sources, figures); what chance alone
        would give is taken off.
        """
        squared = self._slopes**2 - self.pairs.slope_error**2
        return np.stack([part.sum(axis=0) for part in self._by_source(squared)])

    @property
    def contributions(self) -> list[tuple[str, np.ndarray]]:
        """Each source apart with the standard deviation that it gives to every figure, signed where it is one
        parameter; by its share in the position, or in all figures where none is told.
        """
        shares = self.budget / np.maximum(self.spread.deviation**2, np.finfo(float).tiny)
        if size := len(self.event.position):
            shares = self.budget[:, :size]
        parts = self._by_source(self._slopes)
        values = [part[0] if len(part) == 1 else np.sqrt((part**2).sum(axis=0)) for part in parts]
        return [(self.apart[k].name, values[k]) for k in np.argsort(-shares.sum(axis=1))]

    @property
    def rest(self) -> np.ndarray:
        """Standard deviation of every figure that no source apart gives, shape (figures,): at most all of it,
        though the parts told are below zero where chance alone would give more.
        """
        told = np.maximum(self.budget.sum(axis=0), 0.0)
        return np.sqrt(np.maximum(self.spread.deviation**2 - told, 0.0))

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
    """Fly at least so many pairs, as many more as the sources need to be told apart; ``progress`` is called
    with the flights done and the flights in all.

    Raises:
        ConfigError: the campaign has no covariance, or a flight does not come to the event.
    """
    found = sources(plan)
    apart, together = _told_apart(found, pairs)
    columns, more = (sum(source.width for source in some) for some in (apart, together))
    steps = design(columns, more, pairs, plan.campaign.seed if plan.campaign else 0)
    flown = cases(plan, [*apart, *together], np.vstack([steps, -steps]))
    figures = figures_of(plan, flown, event, workers, lambda done, _: progress(done, 2 * len(steps)))
    return Covariance(event, Pairs.of(steps, figures), apart, together)


def _told_apart(found: Sequence[Source], pairs: int) -> tuple[tuple[Source, ...], tuple[Source, ...]]:
    """All sources if there are pairs enough, else all but lists."""
    if sum(source.width for source in found) <= pairs:
        return tuple(found), ()
    single = tuple(source for source in found if not source.is_list)
    return single, tuple(source for source in found if source.is_list)
