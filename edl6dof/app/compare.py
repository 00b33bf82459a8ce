"""``edl6dof compare``: two flights, or two campaigns."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.markup import escape

from edl6dof.api.reports import write_page
from edl6dof.config.errors import refusal
from edl6dof.report.document import Cell, Table, Text
from edl6dof.report.terminal import open_table
from edl6dof.runs.files import refuse_existing_file
from edl6dof.runs.run import Run

#: Differences of the scenarios that the terminal shows.
MOST = 20


def run_compare(first: Path, second: Path, out: Path | None, force: bool, as_json: bool = False) -> int:
    """Compare what lies in two folders; returns the exit status."""
    campaigns = [(folder / "campaign.json").is_file() for folder in (first, second)]
    if any(campaigns):
        if not all(campaigns):
            one, two = (second, first) if campaigns[1] else (first, second)
            raise refusal(two, f"is no campaign, and {one} is one; compare two flights, or two campaigns")
        if out is not None:
            raise refusal("--out", "is the page of two flights; a comparison of campaigns is printed")
        return _compare_campaigns(first, second, as_json)
    if as_json:
        raise refusal("--json", "is of two campaigns; two flights are compared in a page")
    return _compare_flights(first, second, out, force)


def _compare_campaigns(first: Path, second: Path, as_json: bool) -> int:
    """Print two campaigns on common random numbers."""
    from edl6dof.app.campaign_show import show_comparison
    from edl6dof.campaign.compare import compare
    from edl6dof.campaign.storage.store import Store

    result = compare(Store(first), Store(second))
    if as_json:
        print(json.dumps(result.data, indent=1))
    else:
        show_comparison(result)
    return 0


def _compare_flights(first: Path, second: Path, out: Path | None, force: bool) -> int:
    """Print the tables of two runs and write the page with their plots."""
    from edl6dof.report.flight.overlay import comparison_report

    one, two = Run(first), Run(second)
    target = out or second / f"compared-with-{first.resolve().name}.html"
    refuse_existing_file(target, force, second)
    report = comparison_report(one, two)
    console = Console(highlight=False, soft_wrap=True)
    for section in report.sections[:4]:
        for block in section.blocks:
            if isinstance(block, Text):
                console.print(block.words, markup=False)
            elif isinstance(block, Table):
                rows = [[cell.text if isinstance(cell, Cell) else cell for cell in row] for row in block.rows]
                if section.key == "differences":
                    _show_differences(console, section.title, block.columns[1:], rows)
                    continue
                table = open_table(section.title, *block.columns)
                for row in rows:
                    table.add_row(*map(escape, row))
                console.print(table)
    write_page(report, target, force, second)
    console.print(str(target), markup=False)
    return 0


def _show_differences(
    console: Console, title: str, names: Sequence[str], rows: Sequence[Sequence[str]]
) -> None:
    """A line for each parameter: its path is never broken, and two scenarios may differ in hundreds."""
    console.print(f"[bold]{title}[/]: parameter: {escape(names[0])} | {escape(names[1])}")
    for path, one, two in rows[:MOST]:
        console.print(f"  {path}: {one} | {two}", markup=False)
    if len(rows) > MOST:
        console.print(f"  and {len(rows) - MOST} more, listed in the page")
