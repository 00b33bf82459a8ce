"""Flights side by side in the memory of a GPU, each an element of arrays of records.

They are flown some base cycles at a time, so that they can be interrupted, and come back one by one with
their telemetry: what is made of a flight is made by the code that makes it of any other.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator
from typing import Any

import numpy as np
from numba import cuda

from edl6dof.campaign.design.variants import Variant
from edl6dof.fsw.onboard import FSW, ONBOARD
from edl6dof.scenario.case import CASE
from edl6dof.scenario.records import TABLES
from edl6dof.sensors.registry import SENSORS
from edl6dof.sim.flown import Flown
from edl6dof.sim.outcome import FLYING
from edl6dof.sim.underway import beginning, last_cycle, log_rows
from edl6dof.telemetry.channels import BRIEF, TICK
from edl6dof.vehicle.plant import OUTPUTS, PEAKS, STATE, WORKSPACE

#: Flight time of one launch.
LAUNCH_S = 10.0
#: Threads of a block: few, so that few flights still use all processors of the GPU.
THREADS = 32
#: What each flight has of its own, in the order of the arguments of the loop.
OWN = {
    "case": CASE, "plant": STATE, "outputs": OUTPUTS, "peaks": PEAKS,
    "work": WORKSPACE, "sensors": SENSORS, "fsw": FSW,
}  # fmt: skip


class Size:
    """Memory on the GPU that a batch takes as variants join it, in bytes."""

    def __init__(self, log: np.dtype):
        """``log``: rows of telemetry, ``TICK`` or ``BRIEF``."""
        self._row, self._rows, self._count = log.itemsize, 0, 0
        self._shared: dict[Hashable, int] = {}

    def add(self, variant: Variant) -> int:
        """Memory with one more variant."""
        parts = variant.parts
        self._shared |= {_place(parts.tables): TABLES.itemsize, _content(parts.onboard): ONBOARD.itemsize}
        self._rows, self._count = max(self._rows, log_rows(variant.loaded)), self._count + 1
        own = sum(layout.itemsize for layout in OWN.values())
        return self._count * (own + self._rows * self._row) + sum(self._shared.values())


class Batch:
    """Flights from their start to their end."""

    def __init__(self, variants: list[Variant], log: np.dtype):
        """``log``: rows of telemetry, ``TICK`` or ``BRIEF``."""
        self._variants, count = variants, len(variants)
        self._onboards, told = _distinct((one.parts.onboard for one in variants), _content)
        self._tables, read = _distinct((one.parts.tables for one in variants), _place)
        self._own = {name: cuda.device_array(count, layout) for name, layout in OWN.items()}
        for i, variant in enumerate(variants):
            for name, record in _start(variant).items():
                self._own[name][i : i + 1].copy_to_device(record)
        shape = count, max(log_rows(one.loaded) for one in variants)
        self._log = cuda.device_array(shape, log)
        none = cuda.device_array((count, 0), BRIEF if log == TICK else TICK)
        self._logs = (self._log, none) if log == TICK else (none, self._log)
        self._which = cuda.to_device(told), cuda.to_device(read)
        self._cycles, self._rows, self._outcomes = (
            cuda.to_device(np.full(count, value, np.int64)) for value in (0, 0, FLYING)
        )

    def fly(self, kernel: Any) -> Iterator[Flown]:
        """Fly all to their end with the compiled entry; hands out what they leave, in their order."""
        first = self._variants[0].loaded.scenario
        cycles = round(LAUNCH_S * first.flight_software.rates.base_hz)
        blocks = -(-len(self._variants) // THREADS)
        case, *changing = self._own.values()
        told, read = self._which
        for _ in range(-(-(max(last_cycle(one.loaded) for one in self._variants) + 1) // cycles)):
            kernel[blocks, THREADS](
                *(case, self._onboards, told, self._tables, read, *changing),
                *(self._cycles, self._outcomes, self._rows, cycles, first.steps_per_cycle, *self._logs),
            )
            outcomes = self._outcomes.copy_to_host()
            if not np.any(outcomes == FLYING):
                break
        at, rows = self._cycles.copy_to_host(), self._rows.copy_to_host()
        for i, variant in enumerate(self._variants):
            own = {name: array[i : i + 1].copy_to_host() for name, array in self._own.items()}
            log = self._log[i][: rows[i]].copy_to_host()
            parts = variant.parts
            yield Flown(
                variant.loaded, own["case"], parts.tables, parts.onboard, own["plant"], own["outputs"],
                own["peaks"], own["work"], own["sensors"], own["fsw"], log, int(outcomes[i]), int(at[i]),
            )  # fmt: skip


def _start(variant: Variant) -> dict[str, np.ndarray]:
    """The records that a flight begins with."""
    case, _, onboard = variant.parts
    _, plant, peaks, sensors, fsw = beginning(variant.loaded, case, onboard)
    return {
        "case": case, "plant": plant, "outputs": np.zeros(1, OUTPUTS), "peaks": peaks,
        "work": np.zeros(1, WORKSPACE), "sensors": sensors, "fsw": fsw,
    }  # fmt: skip


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
