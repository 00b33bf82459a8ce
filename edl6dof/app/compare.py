"""``edl6dof compare``."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console
from rich.markup import escape

from edl6dof.app.report import write_page
from edl6dof.post.files import refuse_existing_file
from edl6dof.post.report.document import Cell, Table, Text
from edl6dof.post.run import Run
from edl6dof.post.tables import open_table


def run_compare(first: Path, second: Path, out: Path | None, force: bool) -> int:
    """Print the tables of two runs and write the page with their plots."""
    from edl6dof.post.review.overlay import comparison_report

    one, two = Run(first), Run(second)
    target = out or second / f"compared-with-{first.resolve().name}.html"
    refuse_existing_file(target, force)
    report = comparison_report(one, two)
    console = Console(highlight=False, soft_wrap=True)
    for section in report.sections[:4]:
        for block in section.blocks:
            if isinstance(block, Table):
                rows = [[cell.text if isinstance(cell, Cell) else cell for cell in row] for row in block.rows]
                table = open_table(section.title, *block.columns)
                for row in rows:
                    table.add_row(*map(escape, row))
                console.print(table)
            elif isinstance(block, Text):
                console.print(block.words, markup=False)
    write_page(report, target, force)
    console.print(str(target), markup=False)
    return 0
