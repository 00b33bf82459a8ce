"""How far a series of flights is, for commands that have no more to say of each."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console

from edl6dof.app.compiling import announce_compiling


@contextmanager
def count_runs(name: str, quiet: bool) -> Iterator[Callable[[int, int], None]]:
    """A line on stderr that counts runs, if that is a terminal; a word before the first flight has to be
    compiled.  Yields what is to be called with the runs done and the runs in all.
    """
    announce_compiling(not quiet)
    console = Console(stderr=True)
    talk = console.is_terminal and not quiet

    def report(done: int, total: int) -> None:
        if talk:
            console.print(f"{name}: {done}/{total}", end="\r", highlight=False)

    yield report
    if talk:
        console.print(" " * 60, end="\r")
