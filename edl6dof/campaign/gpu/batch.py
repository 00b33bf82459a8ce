"""Flights side by side in the memory of a GPU, each an element of arrays of records.

They are flown some base cycles at a time, so that they can be interrupted, and come back one by one with the
rows of telemetry that their figures need: what is made of a flight is made by the code that makes it of any
other.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from typing import Any

import numpy as np
from numba import cuda

from edl6dof.campaign.gpu.entry import CROWDED
from edl6dof.campaign.gpu.host import Left, Start
from edl6dof.campaign.gpu.layouts import LAUNCH_S
from edl6dof.fsw.onboard import ONBOARD
from edl6dof.metrics.telling_rows import TELLING
from edl6dof.scenario.records import TABLES, Records
from edl6dof.sim.outcome import FLYING
from edl6dof.telemetry.channels import BRIEF, TICK

#: Threads of a block: few, so that few flights still use all processors of the GPU.
THREADS = 32
#: Flights that go to the GPU and come back together: one copy of some costs little more than that of one.
TOGETHER = 64
#: Records that come back; a flight changes nothing in its case.
_CHANGED = ("plant", "outputs", "peaks", "work", "sensors", "fsw")


class Size:
    """Memory on the GPU that a batch takes as flights join it, in bytes."""

    def __init__(self) -> None:
        self._rows, self._count = 0, 0
        self._shared: dict[Hashable, int] = {}

    def add(self, start: Start) -> int:
        """Memory with one more flight."""
        self._shared |= {id(start.tables): TABLES.itemsize, start.onboard: ONBOARD.itemsize}
        self._rows, self._count = max(self._rows, start.rows), self._count + 1
        return self._count * start.layout.size(self._rows) + sum(self._shared.values())


class Batch:
    """Flights from their start to their end."""

    def __init__(self, starts: Sequence[Start], nominal: Records):
        """``starts``: all of one layout; ``nominal``: records of the nominal case."""
        self._starts, count, layout = starts, len(starts), starts[0].layout
        self._layout = layout
        believed = [one.onboard or nominal.onboard.tobytes() for one in starts]
        self._onboards, told = _distinct(believed, ONBOARD)
        tables = [nominal.tables if one.tables is None else one.tables for one in starts]
        self._tables, read = _shared(tables)
        self._needs, whose = _distinct([one.needs or bytes(TELLING.itemsize) for one in starts], TELLING)
        self._own = {name: cuda.device_array(count, kind) for name, kind in layout.own.items()}
        for some in _portions(count):
            for name, array in self._own.items():
                joined = b"".join(one.own[name] for one in starts[some])
                array[some].copy_to_device(np.frombuffer(joined, layout.own[name]))
        rows = max(one.rows for one in starts)
        self._log = cuda.device_array((count, rows), layout.log)
        none = cuda.device_array((count, 0), BRIEF if layout.log == TICK else TICK)
        self._logs = (self._log, none) if layout.log == TICK else (none, self._log)
        self._keep = cuda.device_array((count, rows if layout.thinned else 0), np.int8)
        self._which = cuda.to_device(told), cuda.to_device(read), cuda.to_device(whose)
        self._cycles, self._rows, self._outcomes = (
            cuda.to_device(np.full(count, value, np.int64)) for value in (0, 0, FLYING)
        )

    def fly(self, kernel: Any) -> Iterator[Left | None]:
        """Fly all to their end with the compiled entry; hands out what they leave, in their order: nothing,
        where there was too little room for the rows that the figures of one need.
        """
        starts = self._starts
        cycles = round(LAUNCH_S * starts[0].base_hz)
        blocks = -(-len(starts) // THREADS)
        room = max(one.launch_rows for one in starts)
        case, *changing = self._own.values()
        told, read, whose = self._which
        for _ in range(-(-(max(one.last_cycle for one in starts) + 1) // cycles)):
            kernel[blocks, THREADS](
                *(case, self._onboards, told, self._tables, read, *changing),
                *(self._cycles, self._outcomes, self._rows, cycles, starts[0].steps, *self._logs),
                *(self._needs, whose, self._keep, room),
            )
            outcomes = self._outcomes.copy_to_host()
            if not np.any(outcomes == FLYING):
                break
        for some in _portions(len(starts)):
            yield from self._left(some, outcomes[some])

    def _left(self, some: slice, outcomes: np.ndarray) -> Iterator[Left | None]:
        """What some flights leave."""
        at, rows = (array[some].copy_to_host() for array in (self._cycles, self._rows))
        own = {name: self._own[name][some].copy_to_host() for name in _CHANGED}
        for i, code in enumerate(outcomes.tolist()):
            if code == CROWDED:
                yield None
                continue
            records = {name: array[i : i + 1].tobytes() for name, array in own.items()}
            log = self._log[some.start + i][: rows[i]].copy_to_host().tobytes()
            yield Left(records, log, code, int(at[i]))


def _portions(count: int) -> Iterator[slice]:
    for first in range(0, count, TOGETHER):
        yield slice(first, min(first + TOGETHER, count))


def _distinct(records: Sequence[bytes], kind: np.dtype) -> tuple[Any, np.ndarray]:
    """Records that differ, on the GPU, and for each record which of them is its like."""
    order: dict[bytes, int] = {}
    which = np.array([order.setdefault(one, len(order)) for one in records])
    return cuda.to_device(np.frombuffer(b"".join(order), kind)), which


def _shared(tables: Sequence[np.ndarray]) -> tuple[Any, np.ndarray]:
    """Tables that differ, on the GPU, and for each which of them is its own; those that cases share are one
    object.
    """
    order = {id(one): one for one in tables}
    which = np.array([list(order).index(id(one)) for one in tables])
    return cuda.to_device(np.concatenate(list(order.values()))), which
