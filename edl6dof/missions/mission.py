"""A mission: its campaign, what is published of it, and where it is found."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import nan

from edl6dof.calibration.section import CalibrationFile
from edl6dof.campaign.design.plan import Plan, plan_of
from edl6dof.campaign.executor import CaseRunner
from edl6dof.campaign.rows import Row
from edl6dof.config.document.document import Document
from edl6dof.config.document.locate import find_shipped, shipped_names
from edl6dof.config.document.source import parse_document, read_document, resolve_scenario
from edl6dof.config.errors import ConfigError
from edl6dof.config.validate import validate
from edl6dof.metrics.published import Beside, PublishedFigure, published_figures
from edl6dof.scenario.loading import CALIBRATION

PUBLISHED, CAMPAIGN = "published", "campaign"
#: Where the mark of a published figure stands: on a plain number, or on that of the mapping in its place.
_KEYS = ("", ".value", ".magnitude", ".at_most", ".at_least")


@dataclass(frozen=True)
class Mission:
    """A real flight and the flights that predict it.

    Attributes:
        plan: the dispersed flights.
        beside: what is published, in the order of the file.
        status: mark of each published figure by its name, such as ``published`` or ``recalled``.
        fitted: published figures that the scenario was calibrated on, so that it does not predict them.
    """

    plan: Plan
    beside: tuple[Beside, ...]
    status: dict[str, str]
    fitted: frozenset[str]

    @property
    def name(self) -> str:
        """Name of the scenario."""
        return self.plan.name

    def fly(self, workers: int | None, progress: Callable[[int, int], None]) -> list[Row]:
        """A row for each dispersed flight, the same whatever the number of ``workers``."""
        rows = []
        for row in CaseRunner(self.plan.loaded).rows(self.plan.cases(), workers):
            rows.append(row)
            progress(len(rows), self.plan.count)
        return rows


def shipped_missions() -> list[str]:
    """Names of the shipped scenarios that are missions, sorted."""
    return [name for name in shipped_names("scenarios") if _is_mission(name)]


def _is_mission(name: str) -> bool:
    """Return whether a shipped file disperses what is published of a flight; a variant that only inherits
    both is another flight than the published one.
    """
    path = find_shipped("scenarios", name)
    if path is None or CAMPAIGN not in parse_document(path.read_text(encoding="utf-8"), name).data:
        return False
    return _says(read_document(path), PUBLISHED)


def _says(document: Document, section: str) -> bool:
    """Return whether a section is there and says something: what is published may have been taken back."""
    value = document.data.get(section)
    return any(one is not None for one in value.values()) if isinstance(value, dict) else bool(value)


def load_mission(name: str, flights: int | None = None) -> Mission:
    """Read and check a mission: nothing flies before all of it is right.

    Args:
        name: file, or name of a shipped scenario.
        flights: dispersed flights; as many as its campaign says if not given.

    Raises:
        ConfigError: every problem, with file and line; nothing is published in it, or nothing dispersed.
    """
    document = read_document(resolve_scenario(name))
    missing = [key for key in (PUBLISHED, CAMPAIGN) if not _says(document, key)]
    if missing:
        known = ", ".join(shipped_missions())
        words = f"is no mission: it has no {' and no '.join(f'{key}:' for key in missing)} section"
        raise ConfigError([document.problem((), f"{words} (shipped missions: {known})")])
    beside = document.copy()
    plan = plan_of(document, cases=flights)
    figures = tuple(published_figures(plan.loaded.scenario.published))
    return Mission(plan, figures, _status(beside, figures), _fitted(beside, figures))


def _status(document: Document, figures: Sequence[Beside]) -> dict[str, str]:
    """Mark of each figure by its name."""
    found = {}
    for figure, _ in figures:
        places = (f"{PUBLISHED}.{figure.name}{key}" for key in _KEYS)
        found[figure.name] = next((document.status[p] for p in places if p in document.status), "")
    return found


def _fitted(document: Document, figures: Sequence[Beside]) -> frozenset[str]:
    """Published figures that the scenario's calibration explains."""
    section = document.data.get(CALIBRATION)
    if section is None:
        return frozenset()
    own = Document({CALIBRATION: section}, dict(document.marks), files=document.files)
    named = validate(CalibrationFile, own).calibration.figures
    return frozenset(named or (b.figure.name for b in figures if b.published.explainable))


def figure_values(rows: Sequence[Row], name: str, published: PublishedFigure) -> list[float]:
    """A figure of every flight as it stands beside the published one, ``nan`` where it was not reached."""
    values = (row.get(name) for row in rows)
    return [nan if value is None else published.of(float(value)) for value in values]
