"""The functions that are passed to the loop: the cycle of the flight software with the functions passed to
it, the sensors, and the kinds of fault; and their compilation before the first flight ever.

numba compiles on one core: a second process compiles the flight software, this one all else.  The halves are
independent, since the loop receives the flight software as a function; both are stored in the same folder.
Of each family only the members that the scenario names are compiled; a flight compiles others when it begins.
"""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numba import float64, types
from numba.extending import typeof_impl
from pydantic import BaseModel

from edl6dof.child import python
from edl6dof.config.plugin_files import VARIABLE
from edl6dof.fsw.cycle import run
from edl6dof.fsw.functions import CYCLE, SOFTWARE, software_functions
from edl6dof.fsw.functions import PLACES as OF_SOFTWARE
from edl6dof.fsw.onboard import FSW
from edl6dof.kernels import cache
from edl6dof.kernels.cache import SETTINGS
from edl6dof.kernels.functions import NOTHING, Given, kind_of, together
from edl6dof.registry import place
from edl6dof.scenario.records import TABLES
from edl6dof.scenario.truth import CASE
from edl6dof.sensors.registry import SENSORS, measure
from edl6dof.sim.loop import fly
from edl6dof.vehicle.faults.fault import FAULT, inflict_kind
from edl6dof.vehicle.plant import OUTPUTS, STATE

#: Arguments of the loop that are members of families of the plant.
PLACES = {
    "measure": place(
        *("measure", measure, (), NOTHING),
        *(kind_of(CASE, "sensors", "params"), kind_of(CASE, "sensors", "unit"), kind_of(CASE)),
        *(kind_of(TABLES), kind_of(STATE), kind_of(OUTPUTS), kind_of(SENSORS), kind_of(SENSORS, "sensed")),
    ),
    "inflict": place(
        *("inflict", inflict_kind, (), NOTHING),
        *(kind_of(FAULT), kind_of(CASE), float64, kind_of(FSW, "command"), kind_of(STATE)),
    ),
}
#: The cycle of the flight software as it is passed to the loop, and the type of all functions passed to it.
RUN = Given(run, CYCLE)
FUNCTIONS = together(CYCLE, SOFTWARE, *(one.type for one in PLACES.values()))


class Functions(tuple[Any, ...]):
    """Tuple of all functions that are passed to the compiled loop. It is a class because numba prints
    warnings for a plain tuple of functions.
    """


@typeof_impl.register(Functions)
def _(_given: Functions, _: Any) -> types.Type:
    return FUNCTIONS


def functions_of(cases: np.ndarray, onboard: Any) -> Any:
    """The functions of flights with these ``CASE`` records, an array of them, on one ``ONBOARD`` record."""
    params, faults = cases["sensors"]["params"], cases["faults"]
    sensors = _first(params["carried"], params["n_carried"])
    kinds = _first(faults["slots"]["params"]["kind"], faults["count"])
    plant = PLACES["measure"].function(sensors), PLACES["inflict"].function(kinds)
    functions = Functions((RUN, software_functions(onboard), *plant))
    if not SETTINGS.DISABLE_JIT:
        _compile(functions)
    return functions


def _compile(functions: Iterable[Any]) -> None:
    """Compile each function by itself: if the disk is full, a call survives one failure only."""
    for one in functions:
        if isinstance(one, Given):
            one.compile()
        else:
            _compile(one)


def _first(indices: np.ndarray, counts: np.ndarray) -> frozenset[int]:
    """Values in the first ``counts`` columns of each row."""
    return frozenset(map(int, indices[np.arange(indices.shape[1]) < counts[:, None]]))


_COMMAND = (
    "from edl6dof.plugins import activate; activate([]); "
    "from edl6dof.sim.functions import compile_flight_software as work; work(sys.argv[1:])"
)


_BOTH = [getattr(one, "py_func", one) for one in (fly, RUN.kernel)]


def _mark() -> Path | None:
    """File that exists once loop and flight software of the present sources have been compiled."""
    place, sources = cache.folder(), "".join(cache.stamp(one.__code__.co_filename) for one in _BOTH)
    return None if place is None else place / f"{cache.hash_of(sources)[:24]}.mark"


def is_compiled() -> bool:
    """True if loop and flight software are compiled."""
    mark = _mark()
    return mark is None or mark.exists()


@contextmanager
def compiling_flight_software(scenario: BaseModel) -> Iterator[Sequence[str] | None]:
    """Compile the flight software in another process while the block runs, if there is more than one core.
    Yields the members of families to compile with the loop; ``None`` if all is compiled already.
    """
    mark = _mark()
    if mark is None or mark.exists():
        yield None
        return
    places = (*OF_SOFTWARE.values(), *PLACES.values())
    members = {name for place in places for name in place.role.family.names}
    named = sorted(members.intersection(_words(scenario)))
    other = None
    if _cores() > 1:
        environment = {**os.environ, VARIABLE: os.pathsep.join(cache.received)}
        silent = subprocess.DEVNULL
        other = subprocess.Popen(python(_COMMAND, *named), stdin=silent, stderr=silent, env=environment)
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


def compile_loop(members: Sequence[str], *arguments: Any) -> None:
    """Compile the loop for its ``arguments``, and these members of the plant's families."""
    cache.compiled(fly.called.compile, (FUNCTIONS, *map(numba.typeof, arguments)))
    for one in PLACES.values():
        one.compile(members)


def compile_flight_software(members: Sequence[str]) -> None:
    """Compile the cycle of the flight software, and these members of its families."""
    RUN.compile()
    for one in OF_SOFTWARE.values():
        one.compile(members)


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
