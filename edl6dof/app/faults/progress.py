"""A bar on stderr while the fault matrix flies."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from edl6dof.app.compiling import announce_compiling
from edl6dof.campaign.rows import Row


@contextmanager
def progress_bar(total: int, quiet: bool) -> Iterator[Callable[[int, Row], None] | None]:
    """A bar on stderr, if that is a terminal; a word before the first flight has to be compiled."""
    announce_compiling(not quiet)
    console = Console(stderr=True)
    if quiet or not console.is_terminal:
        yield None
        return
    columns = (
        TextColumn("{task.fields[last]:<40}"),
        BarColumn(bar_width=24),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("faults", total=total, last="")

        def report(done: int, row: Row) -> None:
            bar.update(task, completed=done, last=f"{row['component']} {row['kind']} {row['phase']}")

        yield report
