"""Fly a campaign's dispersions in mirrored pairs, and form the covariance of an event and its budget."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from edl6dof.campaign.covariance.estimate import Pairs, Spread, principal
from edl6dof.campaign.covariance.events import EventFigures
from edl6dof.campaign.covariance.signs import design
from edl6dof.campaign.covariance.sources import Source, cases, sources
from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.executor import Progress, fly_rows
from edl6dof.campaign.rows import Row
from edl6dof.config.document.overrides import with_values
from edl6dof.config.errors import refusal
from edl6dof.scenario.schema import Scenario, check_document


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
        ends = np.cumsum([source.width for source in self.apart])
        squared = self.pairs.slopes[: ends[-1]] ** 2 - self.pairs.slope_error**2
        return np.stack([part.sum(axis=0) for part in np.split(squared, ends[:-1])])


def fly_covariance(
    plan: Plan, event: EventFigures, pairs: int, workers: int | None = None, progress: Progress | None = None
) -> Covariance:
    """Fly at least so many pairs, as many more as the sources need to be told apart.

    Raises:
        ConfigError: the campaign has no covariance, or a flight does not come to the event.
    """
    found = sources(plan)
    apart, together = _told_apart(found, pairs)
    widths = [sum(source.width for source in some) for some in (apart, together)]
    steps = design(*widths, pairs, plan.campaign.seed if plan.campaign else 0)
    flown = cases(plan, [*apart, *together], np.vstack([steps, -steps]))
    rows = list(fly_rows(plan.loaded, flown, workers=workers, progress=progress))
    return Covariance(event, Pairs.of(steps, _figures(rows, event.all, plan.name)), apart, together)


def ending_at_deployment(plan: Plan) -> Plan:
    """The same flights, ended when the parachute is deployed."""
    document = with_values(plan.loaded.document, {"mission.goal": "deployment"}, Scenario)
    return replace(plan, loaded=check_document(document))


def _told_apart(found: Sequence[Source], pairs: int) -> tuple[tuple[Source, ...], tuple[Source, ...]]:
    """All sources if there are pairs enough, else all but lists."""
    if sum(source.width for source in found) <= pairs:
        return tuple(found), ()
    single = tuple(source for source in found if not source.is_list)
    return single, tuple(source for source in found if source.is_list)


def _figures(rows: Sequence[Row], names: Sequence[str], name: str) -> np.ndarray:
    """Figures of all flights, shape (flights, figures)."""
    values = np.array([[row.get(figure, np.nan) for figure in names] for row in rows], dtype=float)
    if (short := ~np.isfinite(values).all(axis=1)).any():
        first = int(np.argmax(short))
        raise refusal(
            name,
            f"{short.sum()} of {len(rows)} flights do not come to the event; one: {rows[first]['outcome']}",
        )
    return values
