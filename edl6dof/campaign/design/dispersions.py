"""The dispersions of a campaign as a list of draws, and the cells of a fault matrix, checked before anything
flies.

    fault_matrix:
      groups:
        - {kind: stuck_on, component: thruster, names: [D1, D2], moments: [{name: 60 s, at: {time_s: 60.0}}]}

With a campaign section, every cell is flown on all of its vehicles; without one on the nominal vehicle.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from itertools import combinations
from math import comb
from typing import Any, get_args

import numpy as np
from pydantic import BaseModel

from edl6dof.campaign.design.distributions import DistributionParams, deviates
from edl6dof.campaign.design.sections import CampaignParams, Correlated, FaultGroup, FaultMatrixParams
from edl6dof.campaign.row_columns import Of
from edl6dof.config.base import stated
from edl6dof.config.document.document import Document
from edl6dof.config.document.overrides import ensure_path
from edl6dof.config.document.yamltree import Keys
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.config.model_paths import Slot, bounds, root_slot, value_at
from edl6dof.config.refused import REFUSED, NotKnown, steps
from edl6dof.config.validate import validate
from edl6dof.config.wording import counted, in_bounds
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.loading import truth_problem
from edl6dof.scenario.schema import Scenario
from edl6dof.spatial.arrays import cholesky, product
from edl6dof.vehicle.faults.fault import FaultParams, fault_problems


@dataclass(frozen=True)
class Target:
    """A parameter that differs from case to case.

    Attributes:
        of: truth, belief or both.
        path: dotted path, without wildcards.
        nominal: its value in the scenario.
        slot: its place in the parameter model.
        place: keys of its dispersion in the campaign file.
    """

    of: Of
    path: str
    nominal: Any
    slot: Slot
    place: Keys


@dataclass(frozen=True)
class Draw:
    """Parameters that are drawn together, from one number in 0..1 each."""

    targets: tuple[Target, ...]
    distribution: DistributionParams | Correlated

    @property
    def names(self) -> list[str]:
        """Names of the numbers in 0..1, one for each parameter."""
        return [f"{target.of}.{target.path}" for target in self.targets]

    def values(self, unit: np.ndarray) -> list[np.ndarray]:
        """Values of each parameter, shape (cases,), from numbers in 0..1, shape (cases, targets)."""
        if isinstance(self.distribution, DistributionParams):
            return [self.distribution.values(unit[:, 0], self.targets[0].nominal)]
        mean = np.array([target.nominal for target in self.targets], dtype=float)
        return list((mean + product(deviates(unit), cholesky(self.distribution.matrix).T)).T)

    def scores(self, deviates: np.ndarray) -> np.ndarray:
        """Normal scores of the parameters from independent standard normal deviates, shape (cases, targets);
        those of correlated parameters are correlated.
        """
        if isinstance(self.distribution, DistributionParams):
            return deviates
        matrix = self.distribution.matrix
        return product(deviates, cholesky(matrix).T) / np.sqrt(np.diag(matrix))


def drawn(draws: Sequence[Draw], columns: np.ndarray) -> Iterator[tuple[Draw, np.ndarray]]:
    """Yield each draw with its own columns, shape (cases, its targets), out of those of all draws."""
    ends = np.cumsum([len(draw.targets) for draw in draws])[:-1]
    return zip(draws, np.split(columns, ends, axis=1), strict=True) if draws else iter(())


class Locator:
    """Finds the parameters that the dotted paths of a campaign mean, and collects their problems.

    Args:
        loaded: the scenario.
        document: file of the campaign, for the places of problems.
        problems: problems of the scenario and of the campaign's own values.
    """

    def __init__(self, loaded: LoadedScenario, document: Document, problems: Iterable[Problem] = ()):
        self.loaded, self.document = loaded, document
        self.problems = list(problems)
        self._template = copy.deepcopy(loaded.document)

    def targets(self, of: Of, path: str, place: Keys) -> Iterator[Target]:
        """Yield every parameter that a path means; several if the path has a ``*``."""
        model = self.loaded.scenario if of == "belief" else self.loaded.truth
        try:
            if of == "truth" and (words := truth_problem(path)):
                raise ValueError(words)
            for found in _expanded(model, path):
                if _is_refused(model, found):
                    continue
                slot = root_slot(Scenario)
                for key in ensure_path(self._template, found, Scenario):
                    slot = stated(slot.child(key))
                yield Target(of, found, value_at(model, found), slot, place)
        except NotKnown:
            return
        except (ValueError, AttributeError, LookupError) as error:
            self.refuse(place, str(error))

    def refuse(self, place: Keys, message: str) -> None:
        """Record a problem at a place of the file."""
        self.problems.append(self.document.problem(place, message))

    def finish(self) -> None:
        """Raise a ``ConfigError`` if there were problems."""
        if self.problems:
            raise ConfigError(self.problems)


def _is_refused(model: BaseModel, path: str) -> bool:
    """Return whether the value at a path was refused, so that no distribution can be compared with it."""
    try:
        return value_at(model, path) is REFUSED
    except NotKnown:
        return True
    except (ValueError, AttributeError, LookupError):
        return False  # for the search of the path to explain


def _expanded(model: BaseModel, path: str) -> list[str]:
    """Dotted paths with every ``*`` replaced by the names, or else the numbers, of the list's items."""
    before, star, after = path.partition("*")
    if not star:
        return [path]
    parent = value_at(model, before.rstrip(".")) if before else model
    between_dots = before.endswith(".") and after[:1] in ("", ".")
    if not between_dots or not isinstance(parent, list | tuple):
        raise ValueError("* must stand for the items of a list, between dots")
    keys = [getattr(item, "name", None) or str(index) for index, item in enumerate(parent)]
    return [found for key in keys for found in _expanded(model, f"{before}{key}{after}")]


def dispersions(params: CampaignParams, locator: Locator) -> list[Draw]:
    """Return all draws of a campaign; report problems to the locator."""
    draws = [
        Draw((target,), distribution)
        for of in get_args(Of)
        for path, distribution in getattr(params, of).items()
        for target in locator.targets(of, path, ("campaign", of, path))
    ]
    for index, group in enumerate(params.correlated):
        place = ("campaign", "correlated", index)
        found = [
            list(locator.targets(group.of, path, (*place, "paths", k))) for k, path in enumerate(group.paths)
        ]
        if all(len(targets) == 1 for targets in found):
            draws.append(Draw(tuple(targets[0] for targets in found), group))
        elif all(found):
            locator.refuse(place, "a correlated group cannot hold wildcards")
    seen: set[str] = set()
    for target in (target for draw in draws for target in draw.targets):
        if target.path in seen:
            locator.refuse(target.place, f"{target.path} is dispersed twice")
        seen.add(target.path)
    for index, pattern in enumerate(params.constant):
        if not any(fnmatchcase(path, pattern) for path in seen) and not locator.problems:
            locator.refuse(("campaign", "constant", index), f"no dispersed parameter is called {pattern}")
    return [draw for draw in draws if _check_kind(draw, locator)]


def _check_kind(draw: Draw, locator: Locator) -> bool:
    """Return whether the distribution suits its parameters; report a problem to the locator."""
    for target in draw.targets:
        if getattr(draw.distribution, "choices", []):
            continue
        if target.slot.options and float not in target.slot.options:
            locator.refuse(target.place, f"{target.path} is not a number with a fraction: use kind discrete")
            return False
        if isinstance(target.nominal, bool) or not isinstance(target.nominal, int | float):
            locator.refuse(target.place, f"{target.path} has no nominal value in the scenario: set it there")
            return False
    try:
        draw.values(np.full((1, len(draw.targets)), 0.5))
    except ValueError as error:
        locator.refuse(draw.targets[0].place, str(error))
        return False
    return True


def check_values(target: Target, values: np.ndarray, first: int, locator: Locator) -> bool:
    """Return whether all drawn numbers are within the target's bounds; a violation goes to the locator."""
    if values.dtype == object:
        return True
    limits = bounds(target.slot)
    bad = ~np.isfinite(values)
    outside = {"gt": np.less_equal, "ge": np.less, "lt": np.greater_equal, "le": np.greater}
    for name in outside.keys() & limits.keys():
        bad |= outside[name](values, limits[name])
    if not bad.any():
        return True
    index = int(np.argmax(bad))
    worst = f"case {first + index} would get {values[index]:.6g}"
    advice = "use kind truncated_normal or a smaller width"
    locator.refuse(target.place, f"{target.path} must be {in_bounds(target.slot)}; {worst}: {advice}")
    return False


def _fault_problems(data: dict[str, Any], locator: Locator) -> Iterator[tuple[Keys, str]]:
    """Yield the problems of a fault written as under ``faults:``, as paths inside it and messages."""
    scenario = locator.loaded.scenario
    try:
        fault = validate(FaultParams, Document(data))
    except ConfigError as error:
        for problem in error.problems:
            yield steps(problem.path), problem.message
        return
    for key, message in fault_problems([fault], scenario.components, scenario.phase_names).items():
        yield tuple(key.split(".")[2:]), message


def check_faults(params: CampaignParams, locator: Locator) -> None:
    """Report the problems of the faults that may be drawn to the locator."""
    for k, draw in enumerate(params.faults):
        for j, data in enumerate(draw.one_of):
            for place, message in _fault_problems(data, locator):
                locator.refuse(("campaign", "faults", k, "one_of", j, *place), message)


#: Separator of the names of components that fail together.
AND = " + "
#: Largest numbers of cells, and of flights in all cells; larger ones are taken for an input error.
_MOST_CELLS, _MOST_FLIGHTS = 100_000, 10_000_000


@dataclass(frozen=True)
class Cell:
    """Faults of one cell, written as under ``faults:``, and the columns that identify the cell in a row."""

    faults: tuple[dict[str, Any], ...]
    label: dict[str, str]


def cells(matrix: FaultMatrixParams) -> Iterator[Cell]:
    """Yield the cells of a fault matrix: for each group its moments, for each moment its components."""
    for group in matrix.groups:
        sizes = group.settings.get(group.kind, {})
        size = ", ".join(f"{name}={value:g}" for name, value in sizes.items() if value != 0.0)
        for moment in group.moments:
            at = moment.at.model_dump(exclude_none=True)
            for names in combinations(group.names, matrix.together):
                faults = tuple(_fault(group, name, at) for name in names)
                label = {"component": AND.join(names), "kind": group.kind, "moment": moment.name}
                yield Cell(faults, {**label, "size": size} if size else label)


def _fault(group: FaultGroup, name: str, at: dict[str, Any]) -> dict[str, Any]:
    """Fault of a component of a group, as written under ``faults:``; ``at``: when it begins."""
    return {**group.settings, group.component: name, "kind": group.kind, "at": at}


def check_matrix(matrix: FaultMatrixParams, vehicles: int, locator: Locator) -> None:
    """Report the problems of a fault matrix, each cell flown on some ``vehicles``, to the locator."""
    number = sum(len(group.moments) * comb(len(group.names), matrix.together) for group in matrix.groups)
    if number > _MOST_CELLS or number * vehicles > _MOST_FLIGHTS:
        words = f"makes {number:,} cells on {counted(vehicles, 'vehicle')}"
        most = f"at most {_MOST_CELLS:,} cells and {_MOST_FLIGHTS:,} flights"
        locator.refuse(("fault_matrix",), f"{words}; {most}")
    if locator.loaded.scenario.faults or locator.loaded.truth.faults:
        locator.refuse(("fault_matrix",), "the scenario has faults of its own, which would join every cell")
    for index, group in enumerate(matrix.groups):
        place = ("fault_matrix", "groups", index)
        if len(group.names) < matrix.together:
            locator.refuse(place, f"names {len(group.names)} of the {matrix.together} that fail together")
        for k, moment in enumerate(group.moments):
            for name in group.names if k == 0 else group.names[:1]:
                for keys, message in _fault_problems(_fault(group, name, moment.at.model_dump()), locator):
                    own = keys and keys[0] in group.settings
                    locator.refuse((*place, "settings", *keys) if own else place, message)
