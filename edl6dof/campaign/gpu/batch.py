"""Flights side by side in the memory of a GPU, each an element of arrays of records.

They are flown some base cycles at a time, so that they can be interrupted, and come back one by one with the
rows of telemetry that their figures need: what is made of a flight is made by the code that makes it of any
other.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator
from typing import Any

import numpy as np
from numba import cuda

from edl6dof.campaign.design.variants import Variant
from edl6dof.campaign.gpu.entry import CROWDED
from edl6dof.campaign.gpu.layouts import LAUNCH_S, Layout, launch_rows
from edl6dof.fsw.onboard import ONBOARD
from edl6dof.metrics.telling_rows import TELLING
from edl6dof.scenario.records import TABLES
from edl6dof.sim.figures import telling_of
from edl6dof.sim.flown import Flown
from edl6dof.sim.outcome import FLYING
from edl6dof.sim.underway import beginning, last_cycle
from edl6dof.telemetry.channels import BRIEF, TICK
from edl6dof.vehicle.plant import OUTPUTS, WORKSPACE

#: Threads of a block: few, so that few flights still use all processors of the GPU.
THREADS = 32
#: Flights that go to the GPU and come back together: one copy of some costs little more than that of one.
TOGETHER = 64
#: Records that come back; a flight changes nothing in its case.
_CHANGED = ("plant", "outputs", "peaks", "work", "sensors", "fsw")


class Size:
    """Memory on the GPU that a batch takes as variants join it, in bytes."""

    def __init__(self, layout: Layout):
        self._layout, self._rows, self._count = layout, 0, 0
        self._shared: dict[Hashable, int] = {}

    def add(self, variant: Variant) -> int:
        """Memory with one more variant."""
        parts = variant.parts
        self._shared |= {_place(parts.tables): TABLES.itemsize, _content(parts.onboard): ONBOARD.itemsize}
        self._rows, self._count = max(self._rows, self._layout.rows(variant)), self._count + 1
        return self._count * self._layout.size(self._rows) + sum(self._shared.values())


class Batch:
    """Flights from their start to their end."""

    def __init__(self, variants: list[Variant], layout: Layout):
        self._variants, self._layout, count = variants, layout, len(variants)
        self._onboards, told = _distinct((one.parts.onboard for one in variants), _content)
        self._tables, read = _distinct((one.parts.tables for one in variants), _place)
        needs = (_needs(one) for one in variants) if layout.thinned else [np.zeros(1, TELLING)] * count
        self._needs, whose = _distinct(needs, _content)
        self._own = {name: cuda.device_array(count, kind) for name, kind in layout.own.items()}
        for some in _portions(count):
            started = [_start(one, layout) for one in variants[some]]
            for name, array in self._own.items():
                array[some].copy_to_device(_joined([records[name] for records in started]))
        rows = max(map(layout.rows, variants))
        self._log = cuda.device_array((count, rows), layout.log)
        none = cuda.device_array((count, 0), BRIEF if layout.log == TICK else TICK)
        self._logs = (self._log, none) if layout.log == TICK else (none, self._log)
        self._keep = cuda.device_array((count, rows if layout.thinned else 0), np.int8)
        self._which = cuda.to_device(told), cuda.to_device(read), cuda.to_device(whose)
        self._cycles, self._rows, self._outcomes = (
            cuda.to_device(np.full(count, value, np.int64)) for value in (0, 0, FLYING)
        )

    def fly(self, kernel: Any) -> Iterator[Flown | None]:
        """Fly all to their end with the compiled entry; hands out what they leave, in their order: nothing,
        where there was too little room for the rows that the figures of one need.
        """
        first = self._variants[0].loaded.scenario
        cycles = round(LAUNCH_S * first.flight_software.rates.base_hz)
        blocks = -(-len(self._variants) // THREADS)
        room = max(launch_rows(one, LAUNCH_S) for one in self._variants)
        case, *changing = self._own.values()
        told, read, whose = self._which
        for _ in range(-(-(max(last_cycle(one.loaded) for one in self._variants) + 1) // cycles)):
            kernel[blocks, THREADS](
                *(case, self._onboards, told, self._tables, read, *changing),
                *(self._cycles, self._outcomes, self._rows, cycles, first.steps_per_cycle, *self._logs),
                *(self._needs, whose, self._keep, room),
            )
            outcomes = self._outcomes.copy_to_host()
            if not np.any(outcomes == FLYING):
                break
        for some in _portions(len(self._variants)):
            yield from self._left(some, outcomes[some])

    def _left(self, some: slice, outcomes: np.ndarray) -> Iterator[Flown | None]:
        """What some flights leave."""
        at, rows = (array[some].copy_to_host() for array in (self._cycles, self._rows))
        own = {name: self._own[name][some].copy_to_host() for name in _CHANGED}
        for i, variant in enumerate(self._variants[some]):
            if outcomes[i] == CROWDED:
                yield None
                continue
            log = self._log[some.start + i][: rows[i]].copy_to_host()
            case, tables, onboard = variant.parts
            changed = {name: records[i : i + 1] for name, records in own.items()}
            yield Flown(
                variant.loaded, case, tables, onboard, **changed,
                log=log, code=int(outcomes[i]), cycle=int(at[i]),
            )  # fmt: skip


def _portions(count: int) -> Iterator[slice]:
    for first in range(0, count, TOGETHER):
        yield slice(first, min(first + TOGETHER, count))


def _joined(records: list[np.ndarray]) -> np.ndarray:
    """Records of one layout as one array; to join them as records would take fifty times as long."""
    return np.ndarray(len(records), records[0].dtype, np.concatenate([one.view(np.uint8) for one in records]))


def _start(variant: Variant, layout: Layout) -> dict[str, np.ndarray]:
    """The records that a flight begins with."""
    case, _, onboard = variant.parts
    kinds = layout.own["sensors"], layout.own["fsw"]
    _, plant, peaks, sensors, fsw = beginning(variant.loaded, case, onboard, *kinds)
    return {
        "case": case, "plant": plant, "outputs": np.zeros(1, OUTPUTS), "peaks": peaks,
        "work": np.zeros(1, WORKSPACE), "sensors": sensors, "fsw": fsw,
    }  # fmt: skip


def _needs(variant: Variant) -> np.ndarray:
    """What the figures of a flight need of its telemetry."""
    needs = telling_of(variant.loaded.scenario)
    assert needs is not None
    return needs


def _distinct(records: Iterable[np.ndarray], key: Callable[[np.ndarray], Hashable]) -> tuple[Any, np.ndarray]:
    """Records that differ, on the GPU, and for each record which of them is its like."""
    found: dict[Hashable, np.ndarray] = {}
    keys = [(found.setdefault(key(one), one), key(one))[1] for one in records]
    order = {one: i for i, one in enumerate(found)}
    return cuda.to_device(np.concatenate(list(found.values()))), np.array([order[one] for one in keys])


def _place(record: np.ndarray) -> Hashable:
    """Tables that cases share are one object."""
    return id(record)


def _content(record: np.ndarray) -> Hashable:
    """What the flight computer believes is copied for each case, and mostly the same."""
    return record.tobytes()
