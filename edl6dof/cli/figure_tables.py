"""Figures of many flights: mean and spread of a scenario, and missions beside what was published."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from math import isfinite
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from edl6dof.campaign.executor import Row
from edl6dof.campaign.neighbours import SPEED_STEP_M_S, SampleMean
from edl6dof.config.wording import counted
from edl6dof.manifest import listed
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.missions.mission import Compared, inside, reached_goal
from edl6dof.missions.write import HEADS, OUTSIDE, causes, cells, failures, heading, outcome
from edl6dof.report.numbers import significant
from edl6dof.report.terminal import comparison, open_table, published_table
from edl6dof.scenario.loaded import LoadedScenario


def plain(loaded: LoadedScenario, rows: Sequence[Row], found: Mapping[str, SampleMean]) -> dict[str, Any]:
    """Return mean and spread of every figure, ready for JSON."""
    return {
        "scenario": loaded.scenario.name,
        "flights": len(rows),
        "within_limits": sum(bool(row["success"]) for row in rows),
        "figures": {
            name: {
                "mean": s.mean,
                "deviation": s.deviation if isfinite(s.deviation) else None,
                "flights": s.flights,
            }
            for name, s in found.items()
        },
    }


def show(loaded: LoadedScenario, rows: Sequence[Row], found: Mapping[str, SampleMean]) -> None:
    """Print mean and spread of every figure, those published first."""
    console = Console(highlight=False)
    beside = comparison(
        {name: s.mean for name, s in found.items()},
        loaded.scenario.published,
        {name: s.deviation for name, s in found.items()},
    )
    if beside:
        console.print(published_table(beside, "Beside the published flight", "mean and spread"))
    table = open_table("Other figures", "figure", "unit", "mean>", "spread>", "flights>")
    for name, s in found.items():
        if name not in loaded.scenario.published:
            figure = figure_of_merit(name)
            spread = significant(s.deviation, 2) if isfinite(s.deviation) else "-"
            table.add_row(figure.meaning, figure.unit.label, significant(s.mean), spread, str(s.flights))
    console.print(table)
    good = sum(bool(row["success"]) for row in rows)
    console.print(
        f"{loaded.scenario.name}: {counted(len(rows), 'flight')} that differ by {SPEED_STEP_M_S:g} m/s in "
        f"entry speed and by their random profiles; {good} within limits"
    )


def show_missions(missions: Sequence[Compared], target: Path) -> None:
    """Print predicted values beside flown ones, and the files of the folder."""
    console = Console(highlight=False, soft_wrap=True)
    console.print(_table(missions))
    for mission in missions:
        for words in (*causes(mission), *failures(mission)):
            console.print(words, markup=False, soft_wrap=False)
    console.print(f"{target}: {listed(target)}", markup=False)
    console.print(Text(outcome(missions), style="bold green" if reached_goal(missions) else "bold red"))


def _table(missions: Sequence[Compared]) -> Table:
    """All missions in one table, each under a line of its own, in 80 columns without broken words: the mark
    of a value stands behind the name of its figure.
    """
    figure, *numbers, _, sigma, last = HEADS
    table = open_table("Predicted beside flown", figure, *numbers, sigma, last)
    table.collapse_padding, table.show_edge = True, False
    for mission in missions:
        share = inside(mission.predicted)
        style = "bold" if share.successes == share.trials else "bold yellow"
        table.add_section()
        table.add_row(*(Text(words, style=style) for words in _narrow(heading(mission))))
        for one in mission.predicted:
            *told, remark = _narrow(cells(one))
            marked = "bold red" if OUTSIDE in remark else ""
            table.add_row(*map(Text, told), Text(remark, style=marked))
    for column in (table.columns[0], table.columns[-1]):
        column.min_width = max(len(word) for cell in column.cells for word in re.split("[ _]", str(cell)))
    return table


def _narrow(row: Sequence[str]) -> tuple[str, ...]:
    """A row of the table of missions with the mark behind the figure."""
    figure, *numbers, mark, sigma, remark = row
    return (f"{figure} {mark}".strip(), *(number.replace("+-", "±") for number in numbers), sigma, remark)
