"""The probability that a requirement is violated, by flights of a subset simulation in a folder of their own.

The flights of each step of the simulation are a part of the folder.  The simulation is a function of its
seed and of the margins of the flights, so it is resumed by repeating it with the margins of the parts.  The
margin of a flight is the distance of its figure from the limit, negative outside; a flight without the
figure has the margin minus infinity.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import count
from math import nan
from pathlib import Path
from shlex import quote
from typing import Any

import numpy as np

from edl6dof.campaign.assurance import Requirement
from edl6dof.campaign.design.case import scenario_of
from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.executor import CaseRunner, Row, table_of
from edl6dof.campaign.identity import compared, identity
from edl6dof.campaign.parts import Parts
from edl6dof.campaign.store import Info, Store, file_of
from edl6dof.campaign.subset import (
    Estimate,
    Level,
    Points,
    Population,
    Region,
    estimate,
    joined,
    regions,
    simulate,
)
from edl6dof.config.dump import json_text
from edl6dof.config.errors import ConfigError, refusal
from edl6dof.config.wording import unknown
from edl6dof.durable import write_atomic
from edl6dof.manifest import sha256
from edl6dof.sim.flight import resolved_text
from edl6dof.spatial.arrays import normal_share

#: Called with the number of flights so far.
Progress = Callable[[int], None]
#: Worst failures whose scenario is written.
_WORST = 3


@dataclass(frozen=True)
class RareStore(Store):
    """Folder of a subset simulation."""

    _info = file_of("rare.json")
    _plan = file_of("rare.yaml")
    _files = re.compile(r"rare\.(?:json|yaml|html|pdf)|made\.json|case\d+\.yaml")


@dataclass(frozen=True)
class Request:
    """A subset simulation.

    Attributes:
        plan: campaign whose dispersions are varied.
        requirement: requirement whose violation is the failure.
        size: flights of each level of a population, in the mean over the populations.
        populations: number of populations.
    """

    plan: Plan
    requirement: Requirement
    size: int
    populations: int

    @property
    def text(self) -> str:
        """The plan as YAML, and the other values in a comment."""
        requirement = self.requirement.model_dump(exclude={"share", "confidence"})
        values = {"requirement": requirement, "size": self.size, "populations": self.populations}
        return f"{self.plan.text}# rare: {' '.join(json_text(values).split())}\n"

    @property
    def info(self) -> Info:
        """Content of ``rare.json``."""
        own = {"plan": sha256(self.text.encode())}
        return Info(until=None, identity=identity(self.plan).model_copy(update=own))

    def value(self, row: Row) -> float:
        """Figure of a flight; NaN if the flight did not reach it."""
        found = row.get(self.requirement.figure)
        return nan if found is None else float(found)

    def margins(self, rows: list[Row]) -> np.ndarray:
        """Margin of each flight, in the unit of the figure, shape (flights,)."""
        return self.requirement.margins(np.array(list(map(self.value, rows))))


@dataclass(frozen=True, repr=False)
class RareFailure:
    """Result of a subset simulation.

    Attributes:
        request: the simulation.
        populations: last points of each population.
        rows: rows of the flights of these last points, by number.
        flights: number of flights of all levels.
        folder: folder with the flights.
    """

    request: Request
    populations: tuple[Population, ...]
    rows: dict[int, Row]
    flights: int
    folder: Path

    @property
    def estimate(self) -> Estimate:
        """Probability of the failure, with its interval."""
        return estimate(self.populations, self.request.requirement.confidence)

    @property
    def levels(self) -> tuple[Level, ...]:
        """Levels of all populations, the failure itself not included."""
        return self.populations[0].levels

    @property
    def failures(self) -> list[Row]:
        """Rows of the failures at the last level, each once, the worst first."""
        worst: dict[int, float] = {}
        for one in self.populations:
            worst |= dict(zip(one.points.numbers[one.failed].tolist(), one.margins[one.failed], strict=True))
        return [self.rows[number] for number in sorted(worst, key=lambda number: (worst[number], number))]

    @property
    def without_figure(self) -> Counter[str]:
        """Outcomes of the failures that ended before they reached the figure, with their number."""
        short = [row for row in self.failures if np.isnan(self.request.value(row))]
        return Counter(str(row["cause"] or row["outcome"]) for row in short)

    @property
    def regions(self) -> dict[str, Region]:
        """Failures in each input, the input that differs most first; empty without failures."""
        found = [one for one in self.populations if one.probability > 0.0]
        if not found:
            return {}
        scores = [self.request.plan.scores(one.points.deviates[one.failed]) for one in found]
        names = self.request.plan.numbers
        pairs = zip(names, regions(scores, [one.probability for one in found]), strict=True)
        return dict(sorted(pairs, key=lambda pair: -pair[1].difference))

    @property
    def worst(self) -> list[dict[str, Any]]:
        """Worst failures that could fly: number, value (NaN if not reached), and the command that flies the
        case again.
        """
        rows = [row for row in self.failures if row["end_s"] > 0.0][:_WORST]
        files = [quote(str(self.folder / case_file(row["case"]))) for row in rows]
        return [
            {"case": row["case"], "value": self.request.value(row), "command": f"edl6dof fly {file}"}
            for row, file in zip(rows, files, strict=True)
        ]

    @property
    def data(self) -> dict[str, Any]:
        """Everything, ready for JSON."""
        requirement = self.request.requirement
        return {
            "campaign": self.request.plan.name,
            "requirement": requirement.model_dump(),
            **self.estimate._asdict(),
            "flights": self.flights,
            "levels": [level._asdict() for level in self.levels],
            "populations": [{"probability": one.probability} for one in self.populations],
            "regions": {name: region._asdict() for name, region in self.regions.items()},
            "failures_without_figure": dict(self.without_figure),
            "worst": self.worst,
        }

    def __repr__(self) -> str:
        return f"<RareFailure {self.request.requirement.id}: {self.estimate.probability:.2e}>"


def case_file(number: int) -> str:
    """Name of the scenario file of a case."""
    return f"case{number}.yaml"


def chosen(requirements: list[Requirement], name: str) -> Requirement:
    """Return the requirement of a name.

    Raises:
        ConfigError: there is none.
    """
    for one in requirements:
        if one.id == name:
            return one
    raise refusal("--requirement", unknown("requirement", name, [one.id for one in requirements]))


def check(request: Request) -> None:
    """Refuse a plan whose flights do not follow from independent numbers."""
    plan = request.plan
    if plan.sweep is not None or plan.fault_matrix is not None:
        raise refusal(plan.name, "a probability is that of one flight: leave out sweep and fault_matrix")
    if not plan.numbers:
        raise refusal(plan.name, "has no dispersions in a campaign: section; try edl6dof rare tianwen1_mc")


def fly(
    request: Request,
    store: RareStore,
    *,
    workers: int | None = None,
    resume: bool = False,
    force: bool = False,
    progress: Progress | None = None,
) -> RareFailure:
    """Fly a subset simulation into its folder, or the missing flights of one.

    Raises:
        ConfigError: the plan is not possible, or the folder has other content.
    """
    check(request)
    with store.lock(make=not resume):
        if resume:
            _check_same(request, store)
            store.tidy()
        else:
            store.begin(request.text, request.info, force)
        flown = _Flown(request, store.parts, workers, progress)
        found = simulate(
            flown.margins,
            inputs=len(request.plan.numbers),
            size=request.size,
            populations=request.populations,
            seed=request.plan.campaign.seed if request.plan.campaign is not None else 0,
        )
        last = {number for one in found for number in one.points.numbers.tolist()}
        rows = {number: row for number, row in flown.rows.items() if number in last}
        result = RareFailure(request, tuple(found), rows, len(flown.rows), store.folder)
        _write_worst(result)
    return result


def _check_same(request: Request, store: RareStore) -> None:
    """Refuse to resume a folder that was begun by another request or another program."""
    text, recorded = store.plan_text, store.info.identity
    differences = compared(recorded, request.info.identity)
    if text != request.text or differences:
        words = f"was begun with other values, another program or other files ({'; '.join(differences)})"
        raise refusal(store.folder, f"{words}; restore them or begin anew with --force")


class _Flown:
    """Margins of points by flights, those of earlier processes included."""

    def __init__(self, request: Request, parts: Parts, workers: int | None, progress: Progress | None):
        self.request, self.parts, self.workers, self.progress = request, parts, workers, progress
        self.runner = CaseRunner(request.plan.loaded)
        self.rows: dict[int, Row] = {}
        self.step = count()

    def margins(self, points: Points) -> np.ndarray:
        """Return the margin of each point; fly those of a step that has no part yet."""
        index, numbers = next(self.step), points.numbers.tolist()
        rows = self._kept(index, numbers)
        if rows is None:
            unit = normal_share(points.deviates)
            cases = self.request.plan.cases_of(unit, points.profiles, points.numbers)
            rows = []
            for row in self.runner.rows(cases, self.workers):
                rows.append(row)
                if self.progress is not None:
                    self.progress(len(self.rows) + len(rows))
            self.parts.write(index, table_of(rows))
        self.rows |= zip(numbers, rows, strict=True)
        return self.request.margins(rows)

    def _kept(self, index: int, numbers: list[int]) -> list[Row] | None:
        """Rows of an earlier process; ``None`` if they are missing, damaged, or those of other cases."""
        if self.parts.path(index).exists():
            with suppress(ConfigError):
                rows = self.parts.read(index).read().to_pylist()
                return rows if [row["case"] for row in rows] == numbers else None
        return None


def _write_worst(found: RareFailure) -> None:
    """Write the scenarios of the worst failures."""
    points = joined([one.points for one in found.populations])
    for item in found.worst:
        row = np.flatnonzero(points.numbers == item["case"])[:1]
        one = points.only(row)
        (case,) = found.request.plan.cases_of(normal_share(one.deviates), one.profiles, one.numbers)
        own = replace(case, belief={**case.belief, "name": f"{found.request.plan.name}_case{case.index}"})
        text = resolved_text(scenario_of(found.request.plan.loaded, own))
        write_atomic(found.folder / case_file(case.index), text.encode())
