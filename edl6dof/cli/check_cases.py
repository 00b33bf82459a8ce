"""``edl6dof verify``: check cases in a table, and the golden flights."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path

from rich.console import Console
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from edl6dof.cli.exit_status import refuse
from edl6dof.config.wording import counted, did_you_mean
from edl6dof.runs.files import atomic_file, refuse_existing_file
from edl6dof.verify.case import Report, Result
from edl6dof.verify.check import CASES, draw, run_case
from edl6dof.verify.golden import difference, golden_names, read_golden, traced


def run_cases(names: Sequence[str], as_json: bool, plots: Path | None, force: bool = False) -> int:
    """Run the named check cases, or all, and print the table; returns the exit status."""
    if unknown := [name for name in names if name not in CASES]:
        hint = did_you_mean(unknown[0], CASES)
        return refuse(f"{unknown[0]}: no such check case{hint} (cases: {', '.join(CASES)})")
    if plots is not None:
        try:
            plots.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            return refuse(f"{plots}: cannot be written: {error.strerror or error}")
        for name in names or CASES:
            refuse_existing_file(plots / f"{name}.png", force, plots)
    begin = time.perf_counter()
    reports = _run(names or list(CASES), quiet=as_json)
    seconds = time.perf_counter() - begin
    drawn = _draw(reports, plots, force) if plots is not None else []
    passed = all(report.passed for report in reports)
    if as_json:
        cases = [report.as_dict() for report in reports]
        print(json.dumps({"passed": passed, "seconds": round(seconds, 2), "cases": cases}, indent=1))
    else:
        _show(reports, seconds, drawn)
    return 0 if passed else 1


def _run(names: Sequence[str], quiet: bool) -> list[Report]:
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


def _show(reports: Sequence[Report], seconds: float, drawn: Sequence[Path]) -> None:
    console = Console(highlight=False)
    for report in reports:
        console.print(Text.assemble((report.name, "bold cyan"), f"  {report.note}" if report.note else ""))
        for (verifies, source), results in groupby(
            report.results, key=lambda one: (one.verifies, one.source)
        ):
            console.print(Padding(Text.assemble(verifies, (f"  [{source}]", "dim")), (0, 0, 0, 2)))
            console.print(Padding(_comparisons(list(results)), (0, 0, 1, 4)))
    if drawn:
        console.print(f"{drawn[0].parent}: {', '.join(path.name for path in drawn)}", markup=False)
    for report in reports:
        if report.skipped:
            console.print(f"skipped: {report.name}: {report.note}", markup=False)
    console.print(_summary_line(reports, seconds))


def _comparisons(results: Sequence[Result]) -> Table:
    """Rows of one model against one source, in columns of fixed width; a repeated reason is left out."""
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
    """Fly golden flights, or some of them, and print what differs first in each; returns the exit status."""
    known = golden_names()
    if unknown := [name for name in names if name not in known]:
        hint = did_you_mean(unknown[0], known)
        return refuse(f"{unknown[0]}: no golden flight{hint} (flights: {', '.join(known)})")
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
