"""Progress on standard error, where that is a terminal."""

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
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.text import Text

from edl6dof.sim.flight import Progress as FlightProgress


@contextmanager
def flight_progress(talk: bool) -> Iterator[FlightProgress | None]:
    """Show time, phase, altitude and Mach number of a flight; yield the function to call with them."""
    console = Console(stderr=True)
    if not (talk and console.is_terminal):
        yield None
        return
    columns = (
        TextColumn("{task.fields[phase]:<22}"),
        BarColumn(bar_width=16),
        TextColumn("t = {task.completed:5.0f} s"),
        TextColumn("{task.fields[altitude]:6.1f} km altitude"),
        TextColumn("Mach {task.fields[mach]:4.1f}"),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("fly", total=None, phase="", altitude=0.0, mach=0.0)

        def report(t: float, limit: float, phase: str, altitude: float, mach: float) -> None:
            bar.update(task, completed=t, phase=phase, altitude=altitude / 1e3, mach=mach)

        yield report


class _Rate(ProgressColumn):
    """Runs per second since the start of the first run."""

    def render(self, task: Task) -> Text:
        return Text(f"{task.completed / task.elapsed:6.1f}/s" if task.elapsed else "")


@contextmanager
def count_runs(
    name: str, quiet: bool = False, rate: ProgressColumn | None = None
) -> Iterator[Callable[..., None]]:
    """Count runs, with rate and time left.

    Yields a function to call with the numbers of runs done and in total, and the words of a ``rate`` column.
    """
    console = Console(stderr=True)
    columns = (TextColumn("{task.description}", markup=False), BarColumn(bar_width=24), MofNCompleteColumn())
    with Progress(
        *(*columns, rate or _Rate(), TimeRemainingColumn()),
        console=console,
        transient=True,
        disable=quiet or not console.is_terminal,
    ) as progress:
        task = progress.add_task(name, total=None, words="")
        yield lambda done, total, words="": progress.update(task, completed=done, total=total, words=words)
