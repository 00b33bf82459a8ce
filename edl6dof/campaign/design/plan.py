"""A campaign ready to fly: the scenario, and every case as a function of its number."""

from __future__ import annotations

from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np

from edl6dof.campaign.design.case import Case
from edl6dof.campaign.design.dispersions import (
    Cell,
    Draw,
    Locator,
    Target,
    cells,
    check_faults,
    check_matrix,
    check_values,
    dispersions,
    drawn,
)
from edl6dof.campaign.design.sampling import SaltelliDesign, saltelli_design, unit_numbers
from edl6dof.campaign.design.sections import CampaignFile, CampaignParams, FaultMatrixParams, SweepParams
from edl6dof.campaign.row_columns import BELIEF, MATRIX, ROW, TRUTH
from edl6dof.config.document.document import Document
from edl6dof.config.document.overrides import with_values
from edl6dof.config.document.source import Mark, parse_document, read_document, resolve_scenario
from edl6dof.config.dump import dump_resolved
from edl6dof.config.errors import ConfigError
from edl6dof.config.model_paths import value_at
from edl6dof.config.refused import judging
from edl6dof.config.validate import judged
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.loading import CAMPAIGN_SECTIONS, check_document, judged_scenario, truth_problem
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.flight import resolved_text

#: Cases that are drawn at a time when all values are checked in advance.
_CHECKED_AT_ONCE = 8192


@dataclass(frozen=True)
class Plan:
    """Everything that the cases of a campaign follow from.

    Attributes:
        loaded: the scenario that the cases change.
        campaign: number of cases, seed, sampling plan and faults; one nominal flight at each point of a sweep
            if ``None``.
        draws: the dispersions.
        axes: the parameters of the sweep, with their values.
    """

    loaded: LoadedScenario
    campaign: CampaignParams | None
    sweep: SweepParams | None = None
    draws: tuple[Draw, ...] = ()
    axes: tuple[tuple[Target, tuple[Any, ...]], ...] = ()
    fault_matrix: FaultMatrixParams | None = None
    _points: tuple[tuple[Cell | None, tuple[Any, ...]], ...] = field(default=((None, ()),), repr=False)

    @property
    def name(self) -> str:
        """Name of the scenario."""
        return self.loaded.scenario.name

    @property
    def per_point(self) -> int:
        """Cases at each point of the sweep, or in each cell of the fault matrix; else all cases."""
        cases = 1 if self.campaign is None else self.campaign.cases
        return cases * (self.saltelli.width if self.saltelli is not None else 1)

    @cached_property
    def saltelli(self) -> SaltelliDesign | None:
        """The design of Sobol indices, ``None`` if the campaign asks for none."""
        columns = [_column(target) for draw in self.draws for target in draw.targets]
        return saltelli_design(self.campaign, columns) if self.campaign is not None else None

    @property
    def count(self) -> int:
        """Number of cases."""
        return self.per_point * len(self._points)

    @property
    def columns(self) -> list[str]:
        """Columns of the results that were drawn or swept, in the order of the file."""
        dispersed = [target for draw in self.draws for target in draw.targets]
        return [_column(target) for target in (*dispersed, *(target for target, _ in self.axes))]

    @cached_property
    def text(self) -> str:
        """The whole plan as YAML, every default written out: enough to fly each case again, bit for bit."""
        file = CampaignFile(campaign=self.campaign, sweep=self.sweep, fault_matrix=self.fault_matrix)
        return resolved_text(self.loaded) + dump_resolved(file.model_dump(mode="json", exclude_none=True))

    def cases(self, first: int = 0, last: int | None = None) -> Iterator[Case]:
        """Cases ``first .. last - 1``."""
        last = self.count if last is None else min(last, self.count)
        while first < last:
            point, start = divmod(first, self.per_point)
            stop = min(start + last - first, self.per_point)
            yield from self._at_point(point, start, stop)
            first += stop - start

    def _at_point(self, point: int, start: int, stop: int) -> Iterator[Case]:
        cell, place = self._points[point]
        swept = list(zip((target for target, _ in self.axes), place, strict=True))
        values, profiles = (
            list(self.values(start, stop)),
            self.campaign is not None and self.campaign.profiles,
        )
        own = cell.faults if cell else [fault.model_dump(mode="json") for fault in self.loaded.truth.faults]
        for number, faults in enumerate(self._faults(start, stop), start):
            changes: dict[str, dict[str, Any]] = {"truth": {}, "belief": {}}
            for target, value in [*((target, every[number - start]) for target, every in values), *swept]:
                changes["truth" if target.of == "truth" else "belief"][target.path] = _plain(value)
            if cell or faults:
                changes["truth"]["faults"] = [*own, *faults]
            profile = number
            label: dict[str, Any] = {**cell.label} if cell else {}
            if self.saltelli is not None:
                profile = self.saltelli.profile(number)
                label |= {MATRIX: self.saltelli.matrix(number), ROW: number // self.saltelli.width}
            index = point * self.per_point + number
            yield Case(index, **changes, profile=profile if profiles else None, label=label)

    def values(self, start: int, stop: int) -> Iterator[tuple[Target, np.ndarray]]:
        """Values drawn for cases ``start .. stop - 1`` of a point."""
        if self.campaign is None:
            return
        if self.saltelli is not None:
            unit = self.saltelli.unit_numbers(start, stop)
        else:
            names = [name for draw in self.draws for name in draw.names]
            sampling, seed = self.campaign.sampling, self.campaign.seed
            unit = unit_numbers(sampling, seed, names, self.campaign.cases, start, stop)
        for draw, own in drawn(self.draws, unit):
            yield from zip(draw.targets, draw.values(own), strict=True)

    def _faults(self, start: int, stop: int) -> list[list[dict[str, Any]]]:
        """Drawn faults of each case; they are rare, so they are drawn independently of the sampling plan."""
        found: list[list[dict[str, Any]]] = [[] for _ in range(stop - start)]
        if self.campaign is None:
            return found
        for k, draw in enumerate(self.campaign.faults):
            names = [f"faults.{k}.{what}" for what in ("happens", "which", "later")]
            unit = unit_numbers("monte_carlo", self.campaign.seed, names, self.campaign.cases, start, stop)
            for offset in np.flatnonzero(unit[:, 0] < draw.chance):
                fault = deepcopy(draw.one_of[int(unit[offset, 1] * len(draw.one_of))])
                key = "plus_s" if fault["at"].get("phase") is not None else "time_s"
                fault["at"][key] = fault["at"].get(key, 0.0) + float(unit[offset, 2]) * draw.later_s
                found[offset].append(fault)
        return found


def _column(target: Target) -> str:
    """Column of the results that holds a dispersed or swept value."""
    return (TRUTH if target.of == "truth" else BELIEF) + target.path


def _plain(value: Any) -> Any:
    """Convert a numpy number to one of Python, for JSON and Arrow; leave any other value."""
    return value.item() if isinstance(value, np.generic) else value


def load_plan(
    name_or_path: str,
    sets: tuple[str, ...] = (),
    cases: int | None = None,
    seed: int | None = None,
    sampling: str | None = None,
) -> Plan:
    """Read and check a campaign file: nothing flies before all of it is right.

    Raises:
        ConfigError: every problem, with file and line.
    """
    return plan_of(read_document(resolve_scenario(name_or_path)), sets, cases, seed, sampling)


def parse_plan(text: str, file: str) -> Plan:
    """Read a plan from its ``text`` (:attr:`Plan.text`); ``file`` is the name shown in messages."""
    return plan_of(parse_document(text, file))


def plan_of(
    document: Document,
    sets: tuple[str, ...] = (),
    cases: int | None = None,
    seed: int | None = None,
    sampling: str | None = None,
) -> Plan:
    """Check a document that has a campaign or sweep section.

    Raises:
        ConfigError: every problem, with file and line.
    """
    own = {key: document.data[key] for key in CAMPAIGN_SECTIONS if document.data.get(key) is not None}
    if not own:
        words = "has no campaign: and no sweep: section; try edl6dof campaign tianwen1_mc"
        raise ConfigError([document.problem((), words)])
    marks = dict(document.marks)
    for key, value in (("cases", cases), ("seed", seed), ("sampling", sampling)):
        if value is not None and isinstance(section := own.get("campaign"), dict):
            own["campaign"] = {**section, key: value}
            marks["campaign", key] = Mark(f"--{key}")
    file, problems = judged(CampaignFile, Document(own, marks, files=document.files))
    places = Document({}, dict(document.marks), files=document.files)
    loaded, more = judged_scenario(document, sets)
    return _checked(loaded, file, Locator(loaded, places, [*problems, *more]))


def _checked(loaded: LoadedScenario, file: CampaignFile, locator: Locator) -> Plan:
    campaign, sweep, matrix = file.campaign, file.sweep, file.fault_matrix
    draws: list[Draw] = []
    axes: list[tuple[Target, tuple[Any, ...]]] = []
    values = [file, loaded.scenario, loaded.truth]
    with judging(values):
        draws += dispersions(campaign, locator) if campaign is not None else []
    with judging(values):
        axes += _swept(sweep, draws, locator) if sweep is not None else []
    with judging(values):
        if campaign is not None:
            check_faults(campaign, locator)
    with judging(values):
        if matrix is not None:
            check_matrix(matrix, campaign.cases if campaign is not None else 1, locator)
    with judging(values):
        if campaign is not None and campaign.sampling == "sobol_indices":
            place = ("campaign", "sampling")
            if sweep is not None or matrix is not None:
                locator.refuse(place, "sobol_indices is flown alone: without sweep or fault_matrix")
            if not draws and not locator.problems:
                locator.refuse(place, "sobol_indices has nothing to vary: nothing is dispersed")
    locator.finish()
    points = tuple(product(cells(matrix) if matrix else [None], product(*(values for _, values in axes))))
    pinned = _with_pins(loaded, draws, axes)
    plan = Plan(pinned, campaign, sweep, tuple(draws), tuple(axes), matrix, points)
    _check_draws(plan, locator)
    return plan


def _swept(
    sweep: SweepParams, draws: list[Draw], locator: Locator
) -> Iterator[tuple[Target, tuple[Any, ...]]]:
    for index, axis in enumerate(sweep.axes):
        place = ("sweep", "axes", index, "path")
        yield from ((target, tuple(axis.points)) for target in locator.targets(axis.of, axis.path, place))
        if any(target.path == axis.path for draw in draws for target in draw.targets):
            locator.refuse(place, f"{axis.path} is dispersed too")


def _with_pins(
    loaded: LoadedScenario, draws: list[Draw], axes: list[tuple[Target, tuple[Any, ...]]]
) -> LoadedScenario:
    """Write the true values of parameters of which only the belief is dispersed into ``truth``."""
    targets = [*(target for draw in draws for target in draw.targets), *(target for target, _ in axes)]
    believed = [target.path for target in targets if target.of == "belief" and not truth_problem(target.path)]
    if not believed:
        return loaded
    truth = {**loaded.scenario.truth, **{path: value_at(loaded.truth, path) for path in believed}}
    return check_document(with_values(loaded.document, {"truth": truth}, Scenario))


def _check_draws(plan: Plan, locator: Locator) -> None:
    """Check every value of every case against the bounds of its parameter, before the first flight."""
    refused: set[str] = set()
    for first in range(0, plan.per_point, _CHECKED_AT_ONCE):
        for target, values in plan.values(first, min(first + _CHECKED_AT_ONCE, plan.per_point)):
            if target.path not in refused and not check_values(target, values, first, locator):
                refused.add(target.path)
    for target, points in plan.axes:
        if all(isinstance(point, int | float) for point in points):
            check_values(target, np.asarray(points, dtype=float), 0, locator)
    locator.finish()
