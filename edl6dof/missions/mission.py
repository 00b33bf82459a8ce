"""A mission: a scenario with ``published`` values of a real flight and a file that disperses it
(``campaign``).

The comparison gives mean and standard deviation of a figure over dispersed flights, the difference of the
flown value in standard deviations, and the percentile of the flown value among the flights.  The standard
deviations combine that of a single flight, because the real flight was one random draw, with that of the
flown value if it is published.  :mod:`.agreement` describes the statistics of all values together.  A value
that was planned, that the scenario commands, that repeats another one, or whose source was not at hand is
shown but not counted.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import nan
from pathlib import Path
from typing import NamedTuple

import numpy as np

from edl6dof.calibration.problem import CalibrationFile
from edl6dof.campaign.design.plan import Plan, plan_of
from edl6dof.campaign.executor import Row, fly_rows
from edl6dof.config.document.document import Document
from edl6dof.config.document.locate import find_shipped, shipped_names
from edl6dof.config.document.source import parse_document, read_document, resolve_scenario
from edl6dof.config.errors import ConfigError
from edl6dof.config.validate import validate
from edl6dof.metrics.figures import FigureOfMerit
from edl6dof.metrics.published import COUNTED, PublishedFigure, PublishedPair, published_figures
from edl6dof.missions.agreement import Distance, distance, percentile, score
from edl6dof.missions.bands import Band, bands
from edl6dof.missions.flown import Trajectory, read_trajectory, trajectory_of
from edl6dof.scenario.loading import CALIBRATION

PUBLISHED, CAMPAIGN = "published", "campaign"
#: Where the mark of a published figure stands: on a plain number, or on that of the mapping in its place.
_KEYS = ("", ".value", ".magnitude", ".at_most", ".at_least")


@dataclass(frozen=True)
class Mission:
    """A real flight and the flights that predict it."""

    plan: Plan  # the dispersed flights
    compared: tuple[PublishedPair, ...]  # published values, in the order of the file
    status: dict[str, str]  # mark of each published figure by its name, such as ``published`` or ``recalled``
    #: published figures that were used to calibrate the scenario, which it therefore does not predict
    fitted: frozenset[str]
    flown: Trajectory | None = None  # of the real flight, if known

    @property
    def name(self) -> str:
        """Name of the scenario."""
        return self.plan.name

    def fly(self, workers: int | None, progress: Callable[[int, int], None]) -> list[Row]:
        """Fly the mission; return a row for each dispersed flight, the same for any number of ``workers``."""

        def counted(done: int, row: Row) -> None:
            progress(done, self.plan.count)

        cases, collect = self.plan.cases(), self.flown.of if self.flown else None
        return list(fly_rows(self.plan.loaded, cases, workers=workers, collect=collect, progress=counted))


def shipped_missions() -> list[str]:
    """Names of the shipped scenarios that are missions, sorted."""
    return [name for name in shipped_names("scenarios") if _is_mission(name)]


def _is_mission(name: str) -> bool:
    """Return whether a shipped file has both sections, ``published`` and ``campaign``; a variant that
    inherits its campaign is another flight than the published one.
    """
    path = find_shipped("scenarios", name)
    if path is None or CAMPAIGN not in parse_document(path.read_text(encoding="utf-8"), name).data:
        return False
    return _says(read_document(path), PUBLISHED)


def _says(document: Document, section: str) -> bool:
    """Return whether a section has a value; an extending file may have set published values to null."""
    value = document.data.get(section)
    return any(one is not None for one in value.values()) if isinstance(value, dict) else bool(value)


def load_mission(name: str, flights: int | None = None, flown: Path | None = None) -> Mission:
    """Read and check a mission.

    Args:
        name: file, or name of a shipped scenario.
        flights: number of dispersed flights, by default that of its campaign.
        flown: csv of the trajectory of the real flight, by default the one that the mission names.

    Raises:
        ConfigError: every problem, with file and line; a section is missing.
    """
    document = read_document(resolve_scenario(name))
    missing = [key for key in (PUBLISHED, CAMPAIGN) if not _says(document, key)]
    if missing:
        known = ", ".join(shipped_missions())
        words = f"is no mission: it has no {' and no '.join(f'{key}:' for key in missing)} section"
        raise ConfigError([document.problem((), f"{words} (shipped missions: {known})")])
    unread = document.copy()
    plan = plan_of(document, cases=flights)
    figures = tuple(published_figures(plan.loaded.scenario.published))
    trajectory = trajectory_of(unread) if flown is None else read_trajectory(flown)
    return Mission(plan, figures, _status(unread, figures), _fitted(unread, figures), trajectory)


def _status(document: Document, figures: Sequence[PublishedPair]) -> dict[str, str]:
    """Status mark of each published figure by its name."""
    found = {}
    for figure, _ in figures:
        places = (f"{PUBLISHED}.{figure.name}{key}" for key in _KEYS)
        found[figure.name] = next((document.status[p] for p in places if p in document.status), "")
    return found


def _fitted(document: Document, figures: Sequence[PublishedPair]) -> frozenset[str]:
    """Published figures on which the scenario was calibrated."""
    section = document.data.get(CALIBRATION)
    if section is None:
        return frozenset()
    own = Document({CALIBRATION: section}, dict(document.marks), files=document.files)
    named = validate(CalibrationFile, own).calibration.figures
    return frozenset(named or (b.figure.name for b in figures if b.published.explainable))


def figure_values(rows: Sequence[Row], name: str, published: PublishedFigure) -> list[float]:
    """Return a figure of every flight in the form in which it is published; ``nan`` if not reached."""
    values = (row.get(name) for row in rows)
    return [nan if value is None else published.of(float(value)) for value in values]


#: Status of a published value whose source was not at hand.
RECALLED = "recalled"
#: Standard deviations beyond which a flown value is marked.
WITHIN = 3.0


class Predicted(NamedTuple):
    """A figure of a mission, predicted by dispersed flights, and its published value."""

    figure: FigureOfMerit  # its declaration
    published: PublishedFigure  # flown value or requirement
    status: str  # mark of the published value
    fitted: bool  # whether the scenario was calibrated on it
    mean: float  # over the flights that reached it
    deviation: float  # standard deviation over them
    flights: int  # number of these flights
    share: float  # percentile of the flown value (0 to 1), or share of the flights that meet the requirement
    score: float  # continuous ranked probability score of the flown value; nan for a requirement

    @property
    def counted(self) -> bool:
        """True if the published value is a flown value that flights can predict, from a source at hand."""
        return not self.published.required and self.evidence in COUNTED

    @property
    def evidence(self) -> str:
        """Kind of evidence of the published value; a flown value quoted from memory is ``recalled``."""
        own = self.published.evidence
        return RECALLED if own in COUNTED and self.status == RECALLED else own

    @property
    def sigmas(self) -> float:
        """Predicted less flown in standard deviations; ``nan`` where no flight reached the figure."""
        return self.published.away(self.mean, self.deviation) if self.flights else nan

    @property
    def inside(self) -> bool:
        """True if the flown value lies within three sigma, which requires a flight that reached it."""
        return bool(abs(self.sigmas) <= WITHIN)


class Compared(NamedTuple):
    """Comparison of a mission with its real flight."""

    name: str  # name of the mission
    flights: int  # number of dispersed flights
    successes: int  # number of them within all limits
    causes: dict[str, int]  # causes of the other outcomes, with their numbers
    predicted: tuple[Predicted, ...]  # every published figure with its prediction
    distance: Distance | None  # of the flown values that count and were not fitted
    values: np.ndarray  # each published figure in each flight, shape (flights, figures); NaN if not reached
    bands: tuple[Band, ...]  # channels of the real flight over time, if its trajectory is known

    @property
    def counted(self) -> list[Predicted]:
        """Figures with a flown value that counts."""
        return [one for one in self.predicted if one.counted]


def compare(mission: Mission, rows: Sequence[Row]) -> Compared:
    """Compare the rows of a mission's flights with each published figure."""
    causes = Counter(row["cause"] for row in rows if row["cause"])
    table = np.array([figure_values(rows, one.figure.name, one.published) for one in mission.compared]).T
    found, independent = [], []
    for (figure, published), every in zip(mission.compared, table.T, strict=True):
        values = every[np.isfinite(every)]
        mean = float(values.mean()) if len(values) else nan
        deviation = float(values.std(ddof=1)) if len(values) > 1 else 0.0 * mean
        about = (figure, published, mission.status[figure.name], figure.name in mission.fitted)
        spread = (mean, deviation, len(values), _share(values, published))
        own = nan if published.required else score(values, published.number)
        found.append(Predicted(*about, *spread, own))
        if found[-1].counted and not found[-1].fitted and len(values):
            independent.append((every, published.number, published.sigma or 0.0))
    columns, flown, sigma = (
        map(np.array, zip(*independent, strict=True)) if independent else [np.empty((0, 0))] * 3
    )
    away = distance(columns.T, flown, sigma)
    successes = sum(bool(row["success"]) for row in rows)
    shown = tuple(found), away, table, bands(mission.flown, rows)
    return Compared(mission.name, len(rows), successes, dict(causes.most_common()), *shown)


def _share(values: np.ndarray, published: PublishedFigure) -> float:
    if not len(values):
        return nan
    if published.required:
        return float(np.mean([bool(published.kept(float(value))) for value in values]))
    return percentile(values, published.number, published.sigma or 0.0)


def percentiles(missions: Sequence[Compared], fitted: bool = False) -> list[float]:
    """Percentiles of the flown values that count, with or without those that scenarios were calibrated on."""
    return [one.share for mission in missions for one in mission.counted if fitted or not one.fitted]
