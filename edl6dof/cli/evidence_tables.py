"""Results of the commands that compare the simulator with references and papers."""

from __future__ import annotations

import json
import re
import sys
import time
from collections.abc import Mapping, Sequence
from itertools import groupby
from math import isfinite
from pathlib import Path
from textwrap import wrap

from rich.console import Console
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from edl6dof.calibration.findings import Findings, remarks
from edl6dof.calibration.fit import Fit
from edl6dof.campaign.ensemble import SPEED_STEP_M_S, SampleMean
from edl6dof.campaign.executor import Row
from edl6dof.cli.group import refuse
from edl6dof.config.dump import json_text
from edl6dof.config.wording import counted, unknown
from edl6dof.manifest import listed
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.missions.agreement import is_calibrated
from edl6dof.missions.bands import in_bands
from edl6dof.missions.mission import Compared, percentiles
from edl6dof.missions.write import HEADS, OUTSIDE, causes, cells, distances, failures, heading, outcome
from edl6dof.report.document import significant
from edl6dof.report.terminal import comparison, open_table, print_whole, published_table
from edl6dof.runs.files import atomic_file, refuse_existing_file
from edl6dof.scenario.schema import Scenario
from edl6dof.verify.case import Report, Result
from edl6dof.verify.check import CASES, draw, run_case
from edl6dof.verify.golden import difference, golden_names, read_golden, traced


def show_figures(
    scenario: Scenario, rows: Sequence[Row], found: Mapping[str, SampleMean], as_json: bool
) -> None:
    """Print mean and spread of every figure, those published first."""
    good = sum(bool(row["success"]) for row in rows)
    if as_json:
        figures = {name: one._asdict() for name, one in found.items()}
        counts = {"flights": len(rows), "within_limits": good}
        print(json_text({"scenario": scenario.name, **counts, "figures": figures}), end="")
        return
    console = Console(highlight=False)
    means = {name: one.mean for name, one in found.items()}
    if beside := comparison(means, scenario.published, {name: one.deviation for name, one in found.items()}):
        console.print(published_table(beside, "Comparison with the published flight", "mean and spread"))
    table = open_table("Other figures", "figure", "unit", "mean>", "spread>", "flights>")
    for name, s in found.items():
        if name not in scenario.published:
            figure = figure_of_merit(name)
            spread = significant(s.deviation, 2) if isfinite(s.deviation) else "-"
            table.add_row(figure.meaning, figure.unit.label, significant(s.mean), spread, str(s.flights))
    console.print(table)
    console.print(
        f"{scenario.name}: {counted(len(rows), 'flight')} that differ by {SPEED_STEP_M_S:g} m/s in "
        f"entry speed and by their random profiles; {good} within limits"
    )


def show_missions(missions: Sequence[Compared], target: Path) -> None:
    """Print the comparison of predicted with flown values, and the files of the folder."""
    console = Console(highlight=False, soft_wrap=True)
    console.print(_missions_table(missions))
    for words in distances(missions):
        console.print(words, markup=False, soft_wrap=False)
    for mission in missions:
        for words in (*in_bands(mission.name, mission.bands), *causes(mission), *failures(mission)):
            console.print(words, markup=False, soft_wrap=False)
    print(f"{target}: {listed(target)}")
    console.print(
        Text(outcome(missions), style="bold green" if is_calibrated(percentiles(missions)) else "bold red")
    )


def _missions_table(missions: Sequence[Compared]) -> Table:
    """Return a table of all missions, 80 columns wide; the mark of a value follows the name of its figure."""
    table = open_table("Predicted and flown", *_narrow(HEADS))
    table.collapse_padding, table.show_edge = True, False
    for mission in missions:
        table.add_section()
        table.add_row(*(Text(words, style="bold") for words in _narrow(heading(mission))))
        for one in mission.predicted:
            *told, remark = _narrow(cells(one))
            marked = "bold red" if OUTSIDE in remark else ""
            table.add_row(*map(Text, told), Text(remark, style=marked))
    for column in (table.columns[0], table.columns[-1]):
        column.min_width = max(len(word) for cell in column.cells for word in re.split("[ _]", str(cell)))
    return table


def _narrow(row: Sequence[str]) -> tuple[str, ...]:
    """A row of the table of missions with the mark behind the figure, reconstructed values in the column of
    flown ones, and without the percentile.
    """
    figure, predicted, flown, reconstructed, planned, mark, sigma, _, remark = row
    numbers = predicted, flown or reconstructed, planned
    return (f"{figure} {mark}".strip(), *(number.replace("+-", "±") for number in numbers), sigma, remark)


def show_calibration(found: Findings, target: Path) -> None:
    """Print the findings of a calibration, and the files of its folder."""
    console = Console(highlight=False, soft_wrap=True)
    letters = [chr(ord("a") + k) for k in range(len(found.fit.x))]
    console.print("[bold]Parameters[/]")
    for letter, path in zip(letters, found.calibration.params.parameters, strict=True):
        print(f"  {letter}   {path}")  # a column of the table would break it
    console.print(_parameters(found, letters))
    console.print(_figures(found))
    print_whole(_slopes(found, letters))
    print_whole(_correlations(found.fit, letters))
    for remark in remarks(found):
        print(remark)
    print(f"{target}: {listed(target)}")


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
    for k, (figure, published) in enumerate(found.calibration.compared):
        numbers = (published.number, found.before[k], found.after[k])
        cells = (*(significant(value, 5) for value in numbers), significant(found.fit.sigma[k], 2))
        table.add_row(figure.meaning, figure.unit.label, *cells, f"{found.residuals[k]:+.1f}")
    return table


def _slopes(found: Findings, letters: Sequence[str]) -> Table:
    """Tabulate the slope of each figure with each parameter."""
    heads = ("figure", "unit", *(f"{letter}>" for letter in letters))
    table = open_table("Change of each figure with one prior sigma of", *heads)
    for (figure, _), row in zip(found.calibration.compared, found.fit.slopes, strict=True):
        meaning = "\n".join(wrap(figure.meaning, 24))
        table.add_row(meaning, figure.unit.label, *(significant(value, 2) for value in row))
    return table


def _correlations(fitted: Fit, letters: Sequence[str]) -> Table:
    table = open_table("Correlations of the posterior", "", *(f"{letter}>" for letter in letters))
    for letter, row in zip(letters, fitted.correlation, strict=True):
        table.add_row(letter, *(f"{value:+.2f}" for value in row))
    return table


def run_cases(names: Sequence[str], as_json: bool, plots: Path | None, force: bool = False) -> int:
    """Run the named check cases, or all, and print the table; return the exit status."""
    for name in names:
        if name not in CASES:
            return refuse(unknown("check case", name, CASES))
    if plots is not None:
        try:
            plots.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            return refuse(f"{plots}: cannot be written: {error.strerror or error}")
        for name in names or CASES:
            refuse_existing_file(plots / f"{name}.png", force, plots)
    begin = time.perf_counter()
    reports = _checked(names or list(CASES), quiet=as_json)
    seconds = time.perf_counter() - begin
    drawn = _draw(reports, plots, force) if plots is not None else []
    passed = all(report.passed for report in reports)
    if as_json:
        cases = [report.as_dict() for report in reports]
        print(json.dumps({"passed": passed, "seconds": round(seconds, 2), "cases": cases}, indent=1))
    else:
        _show_checks(reports, seconds, drawn)
    return 0 if passed else 1


def _checked(names: Sequence[str], quiet: bool) -> list[Report]:
    console, reports = Console(stderr=True, quiet=quiet or not sys.stderr.isatty()), []
    for number, name in enumerate(names, 1):
        console.print(f"{number}/{len(names)} {name}", end="\r", highlight=False)
        reports.append(run_case(name))
        console.print(" " * 40, end="\r")
    return reports


def _draw(reports: Sequence[Report], folder: Path, force: bool) -> list[Path]:
    drawn = []
    for report in reports:
        if report.history is not None:
            drawn.append(folder / f"{report.name}.png")
            with atomic_file(drawn[-1], force, folder) as partial:
                draw(report.history, partial)
    return drawn


def _show_checks(reports: Sequence[Report], seconds: float, drawn: Sequence[Path]) -> None:
    console = Console(highlight=False)
    for report in reports:
        console.print(Text.assemble((report.name, "bold cyan"), f"  {report.note}" if report.note else ""))
        for (verifies, source), results in groupby(
            report.results, key=lambda one: (one.verifies, one.source)
        ):
            console.print(Padding(Text.assemble(verifies, (f"  [{source}]", "dim")), (0, 0, 0, 2)))
            console.print(Padding(_comparisons(list(results)), (0, 0, 1, 4)))
    if drawn:
        print(f"{drawn[0].parent}: {', '.join(path.name for path in drawn)}")
    for report in reports:
        if report.skipped:
            print(f"skipped: {report.name}: {report.note}")
    console.print(_summary_line(reports, seconds))


def _comparisons(results: Sequence[Result]) -> Table:
    """Rows of one model compared with one source, in columns of fixed width; no reason is repeated."""
    table = Table(box=None, pad_edge=False, show_header=False)
    for width in (25, 7, 1, 5, 5, 4):
        table.add_column(width=width)
    table.columns[1].justify = table.columns[3].justify = "right"
    table.add_column(style="dim")
    reason = ""
    for result in results:
        mark = Text("ok", style="green") if result.passed else Text("FAIL", style="bold red")
        unit = "" if result.unit == "-" else result.unit
        why, reason = "" if result.why == reason else result.why, result.why
        numbers = f"{result.error:.1e}", "<" if result.passed else ">", f"{result.tolerance:.0e}"
        table.add_row(result.quantity, *numbers, unit, mark, why)
    return table


def _summary_line(reports: Sequence[Report], seconds: float) -> Text:
    failed = [report.name for report in reports if not report.passed]
    count = sum(len(report.results) for report in reports)
    compared = counted(count, "comparison")
    if failed:
        return Text(f"FAILED: {', '.join(failed)}; {compared} in {seconds:.1f} s", style="bold red")
    ran = counted(sum(not report.skipped for report in reports), "case")
    return Text(f"all within tolerance: {compared} in {ran}, {seconds:.1f} s", style="bold green")


def fly_golden(names: Sequence[str], as_json: bool) -> int:
    """Fly golden flights and print the first difference of each; return the exit status."""
    known = golden_names()
    for name in names:
        if name not in known:
            return refuse(unknown("golden flight", name, known))
    golden, found = read_golden(), {}
    for name in names or known:
        found[name] = difference(golden[name], traced(name))
        if not as_json:
            print(f"{name:<24} {found[name] or 'identical'}", flush=True)
    same = not any(found.values())
    if as_json:
        print(json.dumps({"identical": same, "flights": found}, indent=1))
    else:
        alike = sum(not text for text in found.values())
        print(f"{alike} of {len(found)} identical to the last bit")
    return 0 if same else 1
