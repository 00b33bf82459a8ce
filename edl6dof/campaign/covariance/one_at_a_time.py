"""Each source stepped alone about one flight: how steep and how bent the response to it is there.

Slope and bend are the central first and second difference over one standard deviation.  Where the bend is not
small beside the slope the response is not linear: a bank reversal comes sooner in one of the flights, or lift
is at its limit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from edl6dof.campaign.covariance.event_figures import EventFigures, figures_of
from edl6dof.campaign.covariance.sources import Source, cases, sources
from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.executor import Progress


@dataclass(frozen=True)
class Alone:
    """Response to each deviate of some sources.

    Attributes:
        found: the sources, none of which is a list.
        slopes: half the difference of the flights above and below, shape (deviates, figures).
        bends: half their sum less the flight between them.
    """

    found: tuple[Source, ...]
    slopes: np.ndarray
    bends: np.ndarray

    @classmethod
    def of(cls, found: Sequence[Source], flights: np.ndarray) -> Alone:
        """``flights`` has shape (1 + 2 deviates, figures): the mean, then all above, then all below."""
        middle = flights[0]
        above, below = np.split(flights[1:], 2)
        return cls(tuple(found), 0.5 * (above - below), 0.5 * (above + below) - middle)


def fly_alone(
    plan: Plan, event: EventFigures, workers: int | None = None, progress: Progress | None = None
) -> Alone:
    """Fly every source that is no list one standard deviation up and down, all through the same random
    profiles.

    Raises:
        ConfigError: the campaign has no covariance, or a flight does not come to the event.
    """
    found = [source for source in sources(plan) if not source.is_list]
    one = np.eye(sum(source.width for source in found))
    steps = np.vstack([np.zeros_like(one[:1]), one, -one])
    flown = cases(plan, found, steps, own_profiles=False)
    return Alone.of(found, figures_of(plan, flown, event, workers, progress))
