"""Fly cases in threads: the compiled loop holds no lock, so every core flies.

>>> table = fly_cases(edl6dof.load("tianwen1"), [Case(0, truth={"vehicle.mass.entry_kg": 1300.0})])

Rows come in the order of the cases, with the same bits whatever the number of workers.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import chain, islice, repeat
from threading import local
from typing import Any, NamedTuple, TypeVar

import numpy as np
import pyarrow as pa

from edl6dof.campaign.design.case import Case
from edl6dof.campaign.design.variants import NotApplied, Variant, Variants
from edl6dof.campaign.rows import Collect, Row, failed_row, flown_row, table_of
from edl6dof.config.errors import ConfigError
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.sim.flight import fly, log_rows
from edl6dof.telemetry.channels import BRIEF, TICK

#: Called with the number of cases done and the row of the last one.
Progress = Callable[[int, Row], None]

#: Cases that a thread takes at a time.
_BATCH = 4

#: Batches begun ahead of the one whose rows are waited for, for each worker.
_AHEAD = 2

Item = TypeVar("Item")
Result = TypeVar("Result")

#: What may be wrong with a single case; it becomes a row, and the others fly on.
_UNFLYABLE = (ConfigError, NotApplied, ValueError, ArithmeticError, np.linalg.LinAlgError)


def fly_cases(
    loaded: LoadedScenario,
    cases: Iterable[Case],
    *,
    workers: int | None = None,
    collect: Collect | None = None,
    progress: Progress | None = None,
) -> pa.Table:
    """Fly cases and return their table; see :func:`fly_rows`."""
    return table_of(fly_rows(loaded, cases, workers=workers, collect=collect, progress=progress))


def fly_rows(
    loaded: LoadedScenario,
    cases: Iterable[Case],
    *,
    workers: int | None = None,
    collect: Collect | None = None,
    progress: Progress | None = None,
) -> Iterator[Row]:
    """Fly cases and yield their rows, in the order of the cases; only a few cases are held at a time.

    Args:
        loaded: the scenario that the cases change.
        cases: read as they are needed.
        workers: threads; as many as the process may use cores if not given.
        collect: returns more columns of a flight; runs in the worker threads, and must not keep the flight.
        progress: called after each row, in the caller's thread.
    """
    for done, row in enumerate(CaseRunner(loaded, collect).rows(cases, workers), start=1):
        if progress is not None:
            progress(done, row)
        yield row


def in_threads(
    work: Callable[[Item], Result], items: Iterable[Item], workers: int | None = None
) -> Iterator[Result]:
    """``map`` over threads: results in order, items read only a little ahead, nothing left running when the
    caller stops.
    """
    count = workers or available_cores()
    waiting: deque[Future[Result]] = deque()
    pool = ThreadPoolExecutor(count, thread_name_prefix="edl6dof")
    try:
        for item in items:
            waiting.append(pool.submit(work, item))
            if len(waiting) >= count * _AHEAD:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def available_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _batches(cases: Iterable[Case], workers: int) -> Iterator[list[Case]]:
    """Cases in the portions that threads take: first single ones, so that a few cases keep all workers
    busy.
    """
    cases = iter(cases)
    for count in chain(repeat(1, _BATCH * workers), repeat(_BATCH)):
        if not (some := list(islice(cases, count))):
            return
        yield some


class Ready(NamedTuple):
    """A case that may fly, with the changes that are truly in it, as columns of its row."""

    variant: Variant
    changes: dict[str, Any]


def _reason(error: Exception) -> str:
    return " ".join(str(error).split())


class CaseRunner:
    """Flies cases of one scenario, each in the calling thread; every thread has a telemetry buffer of its
    own.

    A flight records what its figures need; all channels when ``collect`` may want to see them.
    """

    def __init__(self, loaded: LoadedScenario, collect: Collect | None = None):
        self.variants = Variants(loaded)
        self.collect = collect
        self._buffers = local()

    def rows(self, cases: Iterable[Case], workers: int | None = None) -> Iterator[Row]:
        """Fly cases in threads and yield their rows, in the order of the cases."""
        workers = workers or available_cores()
        for rows in in_threads(self.fly, _batches(cases, workers), workers):
            yield from rows

    def fly(self, cases: Sequence[Case]) -> list[Row]:
        """Fly a few cases; one that cannot fly becomes a row that says why.

        All are prepared before the first flies: a flight leaves nothing in the processor's caches of what
        preparing needs, and preparing each case after a flight takes half as long again.
        """
        prepared = [self.prepared(case) for case in cases]
        return [self._flown(case, ready) for case, ready in zip(cases, prepared, strict=True)]

    def prepared(self, case: Case) -> Ready | str:
        """Return what flies, or why it cannot."""
        try:
            variant = self.variants.build(case)
            return Ready(variant, variant.applied(case))
        except _UNFLYABLE as error:
            return _reason(error)

    def _flown(self, case: Case, ready: Ready | str) -> Row:
        if isinstance(ready, str):
            return failed_row(case, ready)
        loaded, parts = ready.variant.loaded, ready.variant.parts
        try:
            flight = fly(loaded, parts=parts, log=self._log(log_rows(loaded)))
        except _UNFLYABLE as error:
            return failed_row(case, _reason(error))
        return flown_row(case, ready.changes, flight, self.collect)

    def _log(self, rows: int) -> np.ndarray:
        """Telemetry rows that are used again: fresh pages for every flight would cost as much as 3 % of
        it.
        """
        if getattr(self._buffers, "log", None) is None or len(self._buffers.log) < rows:
            self._buffers.log = np.zeros(rows, BRIEF if self.collect is None else TICK)
        return self._buffers.log
