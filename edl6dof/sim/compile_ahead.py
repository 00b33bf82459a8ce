"""The first flight ever: a second process compiles the flight software, this one all else.

numba compiles on one core.  Both halves are independent until the loop joins them, and it finds both in the
cache of machine code.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import numba
import numpy as np

from edl6dof import jit
from edl6dof.fsw.cycle import run
from edl6dof.fsw.onboard import FSW, ONBOARD
from edl6dof.interface.command import COMMAND
from edl6dof.interface.sensed import SENSED
from edl6dof.sensors.registry import SENSORS, sense
from edl6dof.sim.loop import fly, write_row
from edl6dof.sim.outcome import outcome_of
from edl6dof.telemetry.channels import BRIEF, TICK
from edl6dof.vehicle.actuate import actuate
from edl6dof.vehicle.motion.integrate import advance
from edl6dof.vehicle.motion.runge_kutta import retrace

# what it leaves is not worth a search for garbage
_COMMAND = (
    "import gc; from edl6dof.sim.compile_ahead import compile_flight_software as work; work(); gc.freeze()"
)


@contextmanager
def flight_software_beside() -> Iterator[bool]:
    """Compile the flight software beside what the block does; says whether there was need.

    There is none when the loop is compiled already.  With one core only, without a cache that another process
    can fill, or with members of a family from files outside the package, the loop compiles everything itself;
    so it does with whatever the other process did not manage.
    """
    if jit.is_cached(fly) or jit.is_cached(run) or jit.outside_sources or _cores() < 2:
        yield False
        return
    other = subprocess.Popen(
        [sys.executable, "-c", _COMMAND], stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        yield True
    except BaseException:
        other.terminate()
        raise
    finally:
        other.wait()


def compile_plant(*records: np.ndarray) -> None:
    """Compile the plant for its records (arrays of one), case, tables, state, outputs and workspace; and then
    the sensors and what writes a row of the log, so that both processes take the same time.
    """
    case, tables, plant, outputs, work = (numba.typeof(array[0]) for array in records)
    retrace.compile((case, tables, plant, outputs, work))
    advance.compile((case, tables, plant, outputs, work, numba.float64))
    actuate.compile((case, numba.from_dtype(COMMAND), plant))
    outcome_of.compile((case, plant, outputs))
    sensors, sensed, memory = (numba.from_dtype(layout) for layout in (SENSORS, SENSED, FSW))
    sense.compile((case, tables, plant, outputs, sensors))
    write_row.compile((case, plant, outputs, sensed, memory, *map(_log_of, (TICK, BRIEF)), numba.int64))


def compile_flight_software() -> None:
    """Compile the flight software's cycle into the cache."""
    onboard, sensed, memory = (numba.from_dtype(layout) for layout in (ONBOARD, SENSED, FSW))
    run.compile((onboard, sensed, numba.int64, memory))


def _log_of(row: np.dtype) -> numba.types.Array:
    return numba.typeof(np.zeros(0, row))


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
