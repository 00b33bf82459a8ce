"""How far a series of flights is, for commands that have no more to say of each."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    Task,
    TextColumn,
    TimeRemainingColumn,
)
from rich.text import Text

from edl6dof.app.compiling import announce_compiling


class _Rate(ProgressColumn):
    """Runs a second, since the first was asked for."""

    def render(self, task: Task) -> Text:
        return Text(f"{task.completed / task.elapsed:6.1f}/s" if task.elapsed else "")


@contextmanager
def count_runs(name: str, quiet: bool) -> Iterator[Callable[[int, int], None]]:
    """A line on stderr that counts runs, with rate and time left, if that is a terminal; a word before the
    first flight has to be compiled.  Yields what is to be called with the runs done and the runs in all.
    """
    announce_compiling(not quiet)
    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(bar_width=24),
        MofNCompleteColumn(),
        _Rate(),
        TimeRemainingColumn(),
    )
    with Progress(
        *columns, console=console, transient=True, disable=quiet or not console.is_terminal
    ) as progress:
        task = progress.add_task(name, total=None)
        yield lambda done, total: progress.update(task, completed=done, total=total)
