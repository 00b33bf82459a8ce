"""Tables of a calibration: parameters, figures, slopes and correlations."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from textwrap import wrap

from rich.console import Console
from rich.table import Table

from edl6dof.calibration.findings import Findings, remarks
from edl6dof.calibration.fit import Fit
from edl6dof.manifest import listed
from edl6dof.report.numbers import significant
from edl6dof.report.terminal import open_table, print_whole

#: Letters of a line of a figure's name beside many columns.
_LABEL = 24


def show(found: Findings, target: Path) -> None:
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
    table = open_table("", "", "prior>", "posterior>", "shift (sigma)>", "told by figures>")
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
