"""The first flight ever: a second process compiles the flight software, this one all else.

numba compiles on one core.  The halves are independent, since the loop is given the flight software as a
function, and the flight finds both in the cache of machine code.  Of families each compiles what the scenario
names; what a flight carries beyond that is compiled when it begins.
"""

from __future__ import annotations

import gc
import os
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numba
from filelock import FileLock
from pydantic import BaseModel

from edl6dof.child import python
from edl6dof.config.plugin_scan import VARIABLE
from edl6dof.fsw.cycle import run
from edl6dof.fsw.functions import CYCLE, compile_members
from edl6dof.fsw.functions import PLACES as OF_SOFTWARE
from edl6dof.kernels import cache, store
from edl6dof.kernels.functions import passed
from edl6dof.sim.functions import BUNDLE
from edl6dof.sim.functions import PLACES as OF_PLANT
from edl6dof.sim.loop import fly

_COMMAND = (
    "from edl6dof.plugins import activate; activate([]); "
    "from edl6dof.sim.compile_ahead import compile_flight_software as work; work(sys.argv[1:])"
)


def is_compiled() -> bool:
    """Whether loop and flight software are compiled."""
    mark = cache.flight_mark()
    return mark is None or mark.exists()


@contextmanager
def flight_software_beside(scenario: BaseModel) -> Iterator[Sequence[str] | None]:
    """Compile the flight software beside what the block does; hands out the members of families to
    compile the loop with, ``None`` where there is no need.

    There is none when loop and flight software are compiled already; while another process compiles them,
    this one waits.  With one core only, the flight compiles everything itself; so it does with whatever the
    other process did not manage.
    """
    mark = cache.flight_mark()
    if mark is None or mark.exists():
        yield None
        return
    with FileLock(f"{cache.root()}/{mark.stem}.lock"):
        store.take()
        if mark.exists():
            yield None
            return
        places = (*OF_SOFTWARE.values(), *OF_PLANT.values())
        members = {name for place in places for name in place.role.family.names}
        named = sorted(members.intersection(_words(scenario)))
        other = _software_process(named) if _cores() > 1 else None
        try:
            with _calm_collector():
                yield named
        except BaseException:
            if other is not None:
                other.terminate()
            raise
        finally:
            if other is not None:
                other.wait()
        store.take()
        mark.touch()
        store.keep()


def _software_process(members: Sequence[str]) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        python(_COMMAND, *members),
        stdin=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env={**os.environ, cache.BESIDE: "1", VARIABLE: os.pathsep.join(cache.received)},
    )


def compile_loop(members: Sequence[str], *arguments: Any) -> None:
    """Compile the loop for its arguments, and of the plant's families these members."""
    fly.compile((BUNDLE.type, *map(numba.typeof, arguments)))
    for place in OF_PLANT.values():
        place.compile(members)


def compile_flight_software(members: Sequence[str]) -> None:
    """Compile the flight software's cycle, and of its families these members."""
    with _calm_collector():
        passed(run).compile(CYCLE.signature)
        compile_members(members)


@contextmanager
def _calm_collector() -> Iterator[None]:
    """Collect garbage less often: numba keeps almost all that it makes, and to look for more took a twentieth
    of the first flight.
    """
    before = gc.get_threshold()
    gc.set_threshold(20_000, 20, 20)
    try:
        yield
    finally:
        gc.set_threshold(*before)


def _words(value: Any) -> Iterator[str]:
    """Every string in a scenario: whatever it chooses from a family is among them."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, BaseModel):
        yield from _words([field for _, field in value])
    elif isinstance(value, dict):
        yield from _words(list(value.values()))
    elif isinstance(value, list | tuple):
        for one in value:
            yield from _words(one)


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
