"""A Dask cluster started by hand, as the README says, in processes of its own."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from forked import Forked

from edl6dof import cli
from edl6dof.campaign import engines, identity


@contextmanager
def ended(started: Forked) -> Iterator[Forked]:
    """A process that does not outlive what is done with it."""
    try:
        yield started
    finally:
        started.kill()
        started.communicate(timeout=30)


@contextmanager
def scheduler(cwd: Path) -> Iterator[tuple[str, Forked]]:
    """Address of a scheduler on a free port; and its process."""
    words = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--no-show")
    with ended(Forked(*words, cwd=cwd, main=dask_scheduler)) as started:
        end = time.monotonic() + 60.0
        while not (found := re.search(r"tcp://127\.0\.0\.1:\d+", "".join(started.said()))):
            assert started.returncode is None and time.monotonic() < end, started.said()
            time.sleep(0.01)
        yield found[0], started


def worker(address: str, cwd: Path, main: Callable[[], None] | None = None):
    """A worker with one thread."""
    words = (address, "--nthreads", "1", "--no-nanny", "--no-dashboard", "--host", "127.0.0.1")
    return ended(Forked(*words, cwd=cwd, main=main or dask_worker))


def dask_scheduler() -> None:
    """``dask scheduler``."""
    from distributed.cli.dask_scheduler import main

    main()


def dask_worker() -> None:
    """``dask worker``."""
    from distributed.cli.dask_worker import main

    main()


def worker_with_another_numpy() -> None:
    """``dask worker`` on a machine whose numpy is another version."""
    identity.numpy = type("numpy", (), {"__name__": "numpy", "__version__": "0.7"})
    dask_worker()


def impatient_program() -> None:
    """The program, which waits for a cluster for seconds only."""
    engines.ANSWER_S, engines.PATIENCE_S, engines.LOOK_S = 1.0, 3.0, 0.5
    cli.main()
