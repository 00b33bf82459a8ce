"""Predicted beside flown: mean and spread of a figure over dispersed flights, and how many standard
deviations the flown value lies from them.

The standard deviation is that of one flight, as the real one was one draw, with that of the flown value where
it is published.  A figure counts as predicted within three of them: the statistic that the authors of POST2
give of Mars 2020, about nine in ten.  How many flights lie below the flown value is told beside it, whatever
their distribution.  A value that was planned, that the scenario commands, or that repeats another is
shown and not counted.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from math import isfinite, nan
from typing import NamedTuple

import numpy as np

from edl6dof.campaign.rows import Row
from edl6dof.campaign.statistics import Proportion
from edl6dof.metrics.figures import FigureOfMerit
from edl6dof.metrics.published import PublishedFigure
from edl6dof.missions.mission import Mission, figure_values

#: Standard deviations within which a flown value is predicted, and the share of them that is to be.
WITHIN, GOAL = 3.0, 0.9


class Predicted(NamedTuple):
    """A figure of a mission: what dispersed flights make of it, and what is published.

    Attributes:
        figure: its declaration.
        published: flown value or requirement.
        status: mark of the published value.
        fitted: whether the scenario was calibrated on it.
        mean, deviation: over the flights that reached it.
        flights: how many did.
        below: share of them below the flown value; of a requirement, that keep it.
    """

    figure: FigureOfMerit
    published: PublishedFigure
    status: str
    fitted: bool
    mean: float
    deviation: float
    flights: int
    below: float

    @property
    def counted(self) -> bool:
        """True if it is a flown value that the flights can predict."""
        return self.published.counted

    @property
    def sigmas(self) -> float:
        """Predicted less flown in standard deviations; ``nan`` where no flight reached the figure."""
        return self.published.away(self.mean, self.deviation) if self.flights else nan

    @property
    def inside(self) -> bool:
        """True if the flown value is predicted; one that no flight reached is not."""
        return bool(abs(self.sigmas) <= WITHIN)


class Compared(NamedTuple):
    """A mission beside its flight.

    Attributes:
        name: of the mission.
        flights: dispersed flights flown.
        successes: how many of them ended within all limits.
        causes: why the others did not, and how many of them.
        predicted: every published figure.
    """

    name: str
    flights: int
    successes: int
    causes: dict[str, int]
    predicted: tuple[Predicted, ...]

    @property
    def counted(self) -> list[Predicted]:
        """Figures with a flown value that counts."""
        return [one for one in self.predicted if one.counted]


def compare(mission: Mission, rows: Sequence[Row]) -> Compared:
    """Compare the rows of a mission's flights with each published figure."""
    causes = Counter(row["cause"] for row in rows if row["cause"])
    found = []
    for figure, published in mission.beside:
        values = np.array(figure_values(rows, figure.name, published))
        values = values[np.isfinite(values)]
        found.append(
            Predicted(
                figure,
                published,
                mission.status[figure.name],
                figure.name in mission.fitted,
                float(values.mean()) if len(values) else nan,
                float(values.std(ddof=1)) if len(values) > 1 else 0.0 if len(values) else nan,
                len(values),
                _share(values, published),
            )
        )
    successes = sum(bool(row["success"]) for row in rows)
    return Compared(mission.name, len(rows), successes, dict(causes.most_common()), tuple(found))


def _share(values: np.ndarray, published: PublishedFigure) -> float:
    if not len(values):
        return nan
    if published.required:
        return float(np.mean([bool(published.kept(float(value))) for value in values]))
    return float(np.mean(values < published.number))


def inside(predicted: Sequence[Predicted]) -> Proportion:
    """How many of the flown values that count are predicted."""
    counted = [one for one in predicted if one.counted]
    return Proportion(sum(one.inside for one in counted), len(counted))


def reached_goal(missions: Sequence[Compared]) -> bool:
    """Return whether the share of predicted flown values of all missions together is what it is to be."""
    share = inside([one for mission in missions for one in mission.predicted]).value
    return isfinite(share) and share >= GOAL
