"""The first flight ever: a second process compiles the flight software, this one all else.

numba compiles on one core.  The halves are independent, since the loop calls the flight software lazily, and
the flight finds both in the cache of machine code.  Of families each compiles what the scenario names; what a
flight calls beyond that is compiled then.
"""

from __future__ import annotations

import os
import subprocess
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numba
from pydantic import BaseModel

from edl6dof import jit
from edl6dof.child import python
from edl6dof.config.plugin_scan import VARIABLE
from edl6dof.dispatch import NOTHING
from edl6dof.fsw.cycle import run
from edl6dof.fsw.onboard import FSW, ONBOARD
from edl6dof.interface.sensed import SENSED
from edl6dof.lazy_calls import compile_named, names
from edl6dof.scenario.case import CASE
from edl6dof.scenario.records import TABLES
from edl6dof.sensors.registry import SENSORS, sense
from edl6dof.sim.loop import fly
from edl6dof.vehicle.plant import OUTPUTS, STATE

# what it leaves is not worth a search for garbage
_COMMAND = (
    "import gc; from edl6dof.plugins import activate; activate([]); "
    "from edl6dof.sim.compile_ahead import compile_flight_software as work; work(sys.argv[1:]); gc.freeze()"
)


def is_compiled() -> bool:
    """Whether loop and flight software are compiled."""
    return jit.is_cached(fly) and jit.is_cached(run)


@contextmanager
def flight_software_beside(scenario: BaseModel) -> Iterator[Collection[str] | None]:
    """Compile the flight software beside what the block does; hands out the members of families to compile
    the loop with, ``None`` where there is no need.

    There is none when loop and flight software are compiled already.  With one core only, or without a cache
    that another process can fill, the flight compiles everything itself; so it does with whatever the other
    process did not manage.
    """
    if is_compiled() or _cores() < 2:
        yield None
        return
    members = sorted(names().intersection(_words(scenario)))
    other = subprocess.Popen(
        python(_COMMAND, *members),
        stdin=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env={**os.environ, VARIABLE: os.pathsep.join(jit.outside_sources)},
    )
    try:
        yield members
    except BaseException:
        other.terminate()
        raise
    finally:
        other.wait()


def compile_loop(members: Collection[str], *arguments: Any) -> None:
    """Compile the loop for its arguments, and of the plant's families these members."""
    fly.compile(tuple(map(numba.typeof, arguments)))
    compile_named(members)


def compile_flight_software(members: Sequence[str]) -> None:
    """Compile the flight software's cycle, and of its families these members; then the sensors among them,
    which both processes do, from either end.
    """
    onboard, sensed, memory = (numba.from_dtype(layout) for layout in (ONBOARD, SENSED, FSW))
    run.compile(NOTHING(onboard, sensed, numba.int64, memory))
    compile_named(members)
    sense.compile(tuple(map(numba.from_dtype, (CASE, TABLES, STATE, OUTPUTS, SENSORS))))
    compile_named(members[::-1])


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
