"""The first flight ever: a second process compiles the flight software, this one all else.

numba compiles on one core.  The halves are independent, since the loop is given the flight software as a
function, and both are kept in the same folder.  Of families each compiles what the scenario names; what a
flight carries beyond that is compiled when it begins.
"""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numba
from pydantic import BaseModel

from edl6dof.child import python
from edl6dof.config.plugin_files import VARIABLE
from edl6dof.fsw.functions import PLACES as OF_SOFTWARE
from edl6dof.kernels import cache
from edl6dof.sim.functions import FUNCTIONS, RUN
from edl6dof.sim.functions import PLACES as OF_PLANT
from edl6dof.sim.loop import fly

_COMMAND = (
    "from edl6dof.plugins import activate; activate([]); "
    "from edl6dof.sim.compile_ahead import compile_flight_software as work; work(sys.argv[1:])"
)


def _mark() -> Path | None:
    """File that says that loop and flight software of the present sources have been compiled."""
    place, sources = cache.folder(), "".join(cache.stamp(one.__code__.co_filename) for one in _BOTH)
    return None if place is None else place / f"{cache.hash_of(sources)[:24]}.mark"


_BOTH = [getattr(one, "py_func", one) for one in (fly, RUN.kernel)]


def is_compiled() -> bool:
    """True if loop and flight software are compiled."""
    mark = _mark()
    return mark is None or mark.exists()


@contextmanager
def compiling_flight_software(scenario: BaseModel) -> Iterator[Sequence[str] | None]:
    """Compile the flight software in parallel to the block; hands out the members of families to
    compile the loop with, ``None`` where loop and flight software are compiled already.

    With one core only, the flight compiles everything itself; so it does with whatever the other process did
    not manage.
    """
    mark = _mark()
    if mark is None or mark.exists():
        yield None
        return
    places = (*OF_SOFTWARE.values(), *OF_PLANT.values())
    members = {name for place in places for name in place.role.family.names}
    named = sorted(members.intersection(_words(scenario)))
    other = _software_process(named) if _cores() > 1 else None
    try:
        yield named
    except BaseException:
        if other is not None:
            other.terminate()
        raise
    finally:
        if other is not None:
            other.wait()
    with suppress(OSError):  # the disk is full
        mark.touch()


def _software_process(members: Sequence[str]) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        python(_COMMAND, *members),
        stdin=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env={**os.environ, VARIABLE: os.pathsep.join(cache.received)},
    )


def compile_loop(members: Sequence[str], *arguments: Any) -> None:
    """Compile the loop for its arguments, and of the plant's families these members."""
    cache.compiled(fly.called.compile, (FUNCTIONS, *map(numba.typeof, arguments)))
    for place in OF_PLANT.values():
        place.compile(members)


def compile_flight_software(members: Sequence[str]) -> None:
    """Compile the flight software's cycle, and of its families these members."""
    RUN.compile()
    for place in OF_SOFTWARE.values():
        place.compile(members)


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
