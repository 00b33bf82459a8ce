"""Several flights of one scenario side by side: a call flies all of them by some base cycles, in threads that
hold no lock.  Each flies as it would alone, bit for bit.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np

from edl6dof.fsw.onboard import FSW, ONBOARD
from edl6dof.scenario.records import Records
from edl6dof.scenario.truth import CASE
from edl6dof.sensors.registry import SENSORS
from edl6dof.sim.flight_state import NO_BRIEFS, NO_TICKS, Snapshot
from edl6dof.sim.functions import functions_of
from edl6dof.sim.loop import fly_each
from edl6dof.sim.outcome import FLYING
from edl6dof.vehicle.plant import OUTPUTS, PEAKS, STATE, WORKSPACE

#: Outcome code of a flight that was halted, or has not begun.
HALTED = -1


class Start(NamedTuple):
    """Start of a flight: the bytes of its records, without the zeros at their ends; images not yet taken are
    millions of zeros.
    """

    cycle: int
    case: np.ndarray
    onboard: np.ndarray
    plant: np.ndarray
    peaks: np.ndarray
    sensors: np.ndarray
    fsw: np.ndarray

    @classmethod
    def of(cls, records: Records, snapshot: Snapshot) -> Start:
        """Start from a snapshot of a flight."""
        whole = records.case, records.onboard, *snapshot[1:]
        return cls(snapshot.cycle, *map(_packed, whole))


def _packed(record: np.ndarray) -> np.ndarray:
    content = record.view(np.uint8)
    used = np.flatnonzero(content)
    return content[: used[-1] + 1 if len(used) else 0].copy()


class Fleet:
    """Flights of one scenario.

    Attributes:
        tables: the arrays that all cases read, ``TABLES``, shape (1,).
        cases, onboards, plants, outputs, peaks, sensors, memories: records of each flight, shape (count,).
        cycles: base cycle that each is at, shape (count,).
        outcomes: outcome code of each, or ``HALTED``, shape (count,).
        close: call it to end the threads.
    """

    def __init__(self, count: int, tables: np.ndarray, steps: int, workers: int = 1):
        """``steps``: integration steps in a base cycle; ``workers``: threads."""
        self.tables, self._steps = tables, steps
        self.cases, self.onboards = np.zeros(count, CASE), np.zeros(count, ONBOARD)
        self.plants, self.outputs, self.peaks = (np.zeros(count, d) for d in (STATE, OUTPUTS, PEAKS))
        self.sensors, self.memories = np.zeros(count, SENSORS), np.zeros(count, FSW)
        self.cycles = np.zeros(count, np.int64)
        self.outcomes = np.full(count, HALTED, np.int64)
        self._works = np.zeros(count, WORKSPACE)
        self._current = np.zeros(count, np.int64)
        self._functions: list[Any] = []  # those of all flights that have begun, once a flight begins
        edges = np.linspace(0, count, min(workers, count) + 1).astype(int)
        self._mine, *self._others = (self._share(a, b) for a, b in zip(edges[:-1], edges[1:], strict=True))
        # a thread for each share: after an interruption its next work still waits for the one before
        self._threads = [ThreadPoolExecutor(1, "edl6dof-fleet") for _ in self._others]
        self.close = weakref.finalize(self, _close, self._threads)  # a fleet that is dropped ends its threads

    def _share(self, first: int, end: int) -> Callable[[int], object]:
        """Function that flies the flights ``first .. end - 1`` by some base cycles."""
        some, steps, functions = slice(first, end), self._steps, self._functions
        records = (
            *(self.cases[some], self.onboards[some], self.tables, self.plants[some], self.outputs[some]),
            *(self.peaks[some], self._works[some], self.sensors[some], self.memories[some]),
            *(self.cycles[some], self.outcomes[some], self._current[some]),
        )

        def fly(count: int) -> None:
            if functions:
                fly_each(functions[0], *records, count, steps, NO_TICKS, NO_BRIEFS)

        return fly

    @property
    def flights(self) -> tuple[np.ndarray, ...]:
        """All records that change in flight: arrays with an element for each flight."""
        return (
            *(self.cases, self.onboards, self.plants, self.outputs, self.peaks, self.sensors, self.memories),
            *(self.cycles, self.outcomes, self._works, self._current),
        )

    def __len__(self) -> int:
        return len(self.cycles)

    def put(self, index: int, start: Start) -> None:
        """Begin flight ``index`` at ``start``."""
        places = self.cases, self.onboards, self.plants, self.peaks, self.sensors, self.memories
        for place, packed in zip(places, start[1:], strict=True):
            content = place[index : index + 1].view(np.uint8)
            content[: len(packed)] = packed
            rest = content[len(packed) :]
            if rest.any():  # pages that were never written to are left so: they take no memory
                rest[:] = 0
        self.cycles[index], self.outcomes[index], self._current[index] = start.cycle, FLYING, 0
        self._choose_functions(index)

    def restore(self, flights: Sequence[np.ndarray]) -> None:
        """Continue all flights from the :attr:`flights` of another fleet."""
        for mine, saved in zip(self.flights, flights, strict=True):
            mine[:] = saved
        begun = self.onboards.view(np.uint8).reshape(len(self), -1).any(axis=1)
        if begun.any():
            self._choose_functions(int(begun.argmax()))

    def _choose_functions(self, index: int) -> None:
        """Take the functions that the cases and the flight computer of one flight choose."""
        self._functions[:] = [functions_of(self.cases, self.onboards[index])]

    def halt(self, which: np.ndarray) -> None:
        """Halt the flights for which ``which``, shape (count,), bool, is true."""
        self.outcomes[which & (self.outcomes == FLYING)] = HALTED

    def advance(self, cycles: int) -> None:
        """Fly some base cycles of every flight that still flies; this thread flies a share of the flights.

        Raises:
            RuntimeError: the threads have been closed.
        """
        if not self.close.alive:
            raise RuntimeError("its threads have been closed")
        others = [
            thread.submit(share, cycles) for thread, share in zip(self._threads, self._others, strict=True)
        ]
        try:
            self._mine(cycles)
        finally:
            for other in others:
                other.result()


def _close(threads: list[ThreadPoolExecutor]) -> None:
    for thread in threads:
        thread.shutdown(wait=False)
