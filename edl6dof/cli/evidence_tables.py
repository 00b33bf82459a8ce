"""Tables of figures over many flights: means, missions compared with published values, calibrations."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from math import isfinite
from pathlib import Path
from textwrap import wrap
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from edl6dof.calibration.findings import Findings, remarks
from edl6dof.calibration.fit import Fit
from edl6dof.campaign.ensemble import SPEED_STEP_M_S, SampleMean
from edl6dof.campaign.executor import Row
from edl6dof.config.wording import counted
from edl6dof.manifest import listed
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.missions.mission import Compared, inside, reached_goal
from edl6dof.missions.write import HEADS, OUTSIDE, causes, cells, failures, heading, outcome
from edl6dof.report.document import significant
from edl6dof.report.terminal import comparison, open_table, print_whole, published_table
from edl6dof.scenario.loaded import LoadedScenario


def plain_means(
    loaded: LoadedScenario, rows: Sequence[Row], found: Mapping[str, SampleMean]
) -> dict[str, Any]:
    """Return mean and spread of every figure, ready for JSON."""
    return {
        "scenario": loaded.scenario.name,
        "flights": len(rows),
        "within_limits": sum(bool(row["success"]) for row in rows),
        "figures": {name: one._asdict() for name, one in found.items()},
    }


def show_figures(loaded: LoadedScenario, rows: Sequence[Row], found: Mapping[str, SampleMean]) -> None:
    """Print mean and spread of every figure, those published first."""
    console = Console(highlight=False)
    beside = comparison(
        {name: s.mean for name, s in found.items()},
        loaded.scenario.published,
        {name: s.deviation for name, s in found.items()},
    )
    if beside:
        console.print(published_table(beside, "Comparison with the published flight", "mean and spread"))
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
    """Print the comparison of predicted with flown values, and the files of the folder."""
    console = Console(highlight=False, soft_wrap=True)
    console.print(_missions_table(missions))
    for mission in missions:
        for words in (*causes(mission), *failures(mission)):
            console.print(words, markup=False, soft_wrap=False)
    console.print(f"{target}: {listed(target)}", markup=False)
    console.print(Text(outcome(missions), style="bold green" if reached_goal(missions) else "bold red"))


def _missions_table(missions: Sequence[Compared]) -> Table:
    """Return a table of all missions, 80 columns wide; the mark of a value follows the name of its figure."""
    figure, *numbers, _, sigma, last = HEADS
    table = open_table("Predicted and flown", figure, *numbers, sigma, last)
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


#: Letters of a line of a figure's name beside many columns.
_LABEL = 24


def show_calibration(found: Findings, target: Path) -> None:
    """Print what was found, and the files of its folder."""
    console = Console(highlight=False, soft_wrap=True)
    letters = [chr(ord("a") + k) for k in range(len(found.fit.x))]
    console.print("[bold]Parameters[/]")
    for letter, path in zip(letters, found.calibration.params.parameters, strict=True):
        console.print(f"  {letter}   {path}", markup=False)  # never broken, as in a column of the table
    console.print(_parameters(found, letters))
    console.print(_figures(found))
    print_whole(_slopes(found, letters))
    print_whole(_correlations(found.fit, letters))
    for remark in remarks(found):
        console.print(remark, markup=False)
    console.print(f"{target}: {listed(target)}", markup=False)


def _parameters(found: Findings, letters: Sequence[str]) -> Table:
    table = open_table("", "", "prior>", "posterior>", "shift (sigma)>", "share from data>")
    for k, (path, prior) in enumerate(found.calibration.params.parameters.items()):
        cells = (
            f"{prior.mean:g} +- {prior.sigma:g}",
            f"{significant(found.values[path])} +- {significant(found.sigmas[path], 2)}",
            f"{found.fit.x[k]:+.2f}",
            f"{100 * found.fit.resolution[k]:.0f} %",
        )
        table.add_row(letters[k], *cells)
    return table


def _figures(found: Findings) -> Table:
    table = open_table("Figures", "figure", "unit", "published>", "before>", "after>", "sigma>", "in sigma>")
    for k, (figure, published) in enumerate(found.calibration.beside):
        numbers = (published.number, found.before[k], found.after[k])
        cells = (*(significant(value, 5) for value in numbers), significant(found.fit.sigma[k], 2))
        table.add_row(figure.meaning, figure.unit.label, *cells, f"{found.residuals[k]:+.1f}")
    return table


def _slopes(found: Findings, letters: Sequence[str]) -> Table:
    """Tabulate the slope of each figure with each parameter."""
    table = open_table(
        "Change of each figure with one prior sigma of",
        "figure",
        "unit",
        *(f"{letter}>" for letter in letters),
    )
    for (figure, _), row in zip(found.calibration.beside, found.fit.slopes, strict=True):
        meaning = "\n".join(wrap(figure.meaning, _LABEL))
        table.add_row(meaning, figure.unit.label, *(significant(value, 2) for value in row))
    return table


def _correlations(fitted: Fit, letters: Sequence[str]) -> Table:
    table = open_table("Correlations of the posterior", "", *(f"{letter}>" for letter in letters))
    for letter, row in zip(letters, fitted.correlation, strict=True):
        table.add_row(letter, *(f"{value:+.2f}" for value in row))
    return table
