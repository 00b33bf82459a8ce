"""``edl6dof compare``."""

from __future__ import annotations

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


def run_compare(first: Path, second: Path, out: Path | None, force: bool) -> int:
    """Print the tables of two runs and write the page with their plots."""
    from edl6dof.report.flight.overlay import comparison_report

    if all((folder / "campaign.json").is_file() for folder in (first, second)):
        raise refusal(first, f"is a campaign; compare two by: edl6dof campaign --compare {first} {second}")
    one, two = Run(first), Run(second)
    target = out or second / f"compared-with-{first.resolve().name}.html"
    refuse_existing_file(target, force)
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
    write_page(report, target, force)
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
