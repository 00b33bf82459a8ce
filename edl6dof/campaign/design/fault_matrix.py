"""The ``fault_matrix:`` section of a scenario file: what fails, how, and when; each cell is flown.

    fault_matrix:
      groups:
        - {kind: stuck_on, component: thruster, names: [D1, D2], moments: [{name: 60 s, at: {time_s: 60.0}}]}

With a campaign section, every cell is flown on all of its vehicles; without one on the nominal vehicle.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from math import comb
from typing import Any

from pydantic import ValidationError

from edl6dof.campaign.design.dispersions import Locator
from edl6dof.campaign.design.sections import FaultMatrixParams
from edl6dof.config.wording import counted
from edl6dof.vehicle.faults.fault import FaultParams, fault_problems

#: Between the names of components that fail together.
AND = " + "

#: More cells, or flights in all of them, are a slip of the pen.
_MOST_CELLS, _MOST_FLIGHTS = 100_000, 10_000_000


@dataclass(frozen=True)
class Cell:
    """Faults of one cell as under ``faults:``, and the columns that name it in every row."""

    faults: tuple[dict[str, Any], ...]
    label: dict[str, str]


def cells(matrix: FaultMatrixParams) -> Iterator[Cell]:
    """Every cell: for each group its moments, at each of them its components."""
    for group in matrix.groups:
        for moment in group.moments:
            at = moment.at.model_dump(exclude_none=True)
            for names in combinations(group.names, matrix.together):
                faults = tuple({group.component: name, "kind": group.kind, "at": at} for name in names)
                yield Cell(faults, {"component": AND.join(names), "kind": group.kind, "moment": moment.name})


def check_matrix(matrix: FaultMatrixParams, vehicles: int, locator: Locator) -> None:
    """Problems of the faults, found before anything flies; they go to the locator.  ``vehicles``: on which
    each cell is flown.
    """
    scenario = locator.loaded.scenario
    number = sum(len(group.moments) * comb(len(group.names), matrix.together) for group in matrix.groups)
    if number > _MOST_CELLS or number * vehicles > _MOST_FLIGHTS:
        words = f"makes {number:,} cells on {counted(vehicles, 'vehicle')}"
        most = f"at most {_MOST_CELLS:,} cells and {_MOST_FLIGHTS:,} flights"
        locator.refuse(("fault_matrix",), f"{words}; {most}")
    if scenario.faults or locator.loaded.truth.faults:
        locator.refuse(("fault_matrix",), "the scenario has faults of its own, which would join every cell")
    for index, group in enumerate(matrix.groups):
        place = ("fault_matrix", "groups", index)
        if len(group.names) < matrix.together:
            locator.refuse(place, f"names {len(group.names)} of the {matrix.together} that fail together")
        for k, moment in enumerate(group.moments):
            for name in group.names if k == 0 else group.names[:1]:
                data = {group.component: name, "kind": group.kind, "at": moment.at.model_dump()}
                for message in _problems(data, locator):
                    locator.refuse(place, message)


def _problems(data: dict[str, Any], locator: Locator) -> list[str]:
    scenario = locator.loaded.scenario
    try:
        fault = FaultParams.model_validate(data)
    except ValidationError as error:
        return [item["msg"] for item in error.errors(include_url=False)]
    return list(fault_problems([fault], scenario.components, scenario.phase_names).values())
