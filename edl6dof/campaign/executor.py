"""Fly cases in threads, a row of the results table for each: the compiled loop releases Python's lock, so
every core flies.

>>> table_of(fly_rows(edl6dof.load("tianwen1"), [Case(0, truth={"vehicle.mass.entry_kg": 1300.0})]))

Rows come in the order of the cases, with the same bits whatever the number of workers.
"""

from __future__ import annotations

import json
import os
import re
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import chain, islice, repeat
from threading import local
from typing import Any, TypeVar

import numpy as np
import pyarrow as pa

from edl6dof.campaign.design.case import BELIEF, TRUTH, Case, NotApplied, Variant, Variants
from edl6dof.config.errors import ConfigError
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.sim.flight import Flight, fly, log_rows
from edl6dof.telemetry.channels import BRIEF, TICK

Row = dict[str, Any]
#: Further columns of a row from its flight, which must not be kept: the next case reuses its telemetry.
Collect = Callable[[Flight], Mapping[str, Any]]
#: Called with the number of cases done and the row of the last one.
Progress = Callable[[int, Row], None]

#: Cases that a thread takes at a time, and batches begun ahead of the awaited one for each worker.
_BATCH, _AHEAD = 4, 2
#: Errors of a single case; it becomes a row, and the others fly on.
_UNFLYABLE = (ConfigError, NotApplied, ValueError, ArithmeticError, np.linalg.LinAlgError)
#: Where the numbers of a message start; they are left out of a cause, so that equal causes count together.
_NUMBERS = re.compile(r"[\[(]|\b\d")


def _flown_row(case: Case, changes: Mapping[str, Any], flight: Flight, collect: Collect | None) -> Row:
    """Row of a flown case: its changes, the end and the figures of the flight, columns of ``collect``."""
    row: Row = {"case": case.index, **case.label, **{path: _plain(value) for path, value in changes.items()}}
    row.update(success=flight.success, cause=flight.cause, outcome=flight.outcome, end_s=flight.time_s)
    for more in (flight.figures, collect(flight) if collect is not None else {}):
        if twice := row.keys() & more.keys():
            raise ValueError(f"column given twice: {', '.join(sorted(twice))}")
        row.update(more)
    return row


def _plain(value: Any) -> Any:
    """Return numbers, texts and lists of numbers unchanged; whole sections and lists of models, such as
    faults, as JSON text without defaults.
    """
    if type(value) is float:
        return value
    items = value if isinstance(value, list | tuple) and value else [value]
    if isinstance(value, str) or all(isinstance(item, int | float | None) for item in items):
        return value
    return json.dumps(value, default=lambda model: model.model_dump(mode="json", exclude_defaults=True))


def _failed_row(case: Case, reason: str) -> Row:
    """Row of a case that could not fly."""
    row: Row = {"case": case.index, **case.label}
    row |= {TRUTH + path: _plain(value) for path, value in case.truth.items()}
    row |= {BELIEF + path: _plain(value) for path, value in case.belief.items()}
    if case.profile is not None:
        row["profile"] = case.profile
    words = f"could not fly: {reason.replace('Value error, ', '')}"
    cause = _NUMBERS.split(words)[0].rstrip(" :(")
    return row | {"success": False, "cause": cause, "outcome": words, "end_s": 0.0}


def table_of(rows: Iterable[Row]) -> pa.Table:
    """Rows as a table; columns in the order of first appearance, null where a row lacks a column."""
    rows = list(rows)
    names = list(dict.fromkeys(name for row in rows for name in row))
    return pa.table({name: _column([row.get(name) for row in rows]) for name in names})


def _column(values: list[Any]) -> pa.Array:
    """Make a column; integers mixed with floats become floats, other mixed types become text."""
    kinds = {type(value) for value in values if value is not None}
    if kinds == {int, float}:
        values = [None if value is None else float(value) for value in values]
    elif len(kinds) > 1:
        values = [None if value is None else str(value) for value in values]
    return pa.array(values)


Item = TypeVar("Item")
Result = TypeVar("Result")


def fly_rows(
    loaded: LoadedScenario,
    cases: Iterable[Case],
    *,
    workers: int | None = None,
    collect: Collect | None = None,
    progress: Progress | None = None,
) -> Iterator[Row]:
    """Fly cases and yield their rows, in the order of the cases; only a few cases are in memory at a time.

    Args:
        loaded: the scenario that the cases change.
        cases: read as they are needed.
        workers: number of threads; by default the number of cores that the process may use.
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
    """Apply ``work`` to items in threads and yield the results in order.  Items are read a little ahead, and
    no thread is left running when the caller stops.
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
    """Number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _batches(cases: Iterable[Case], workers: int) -> Iterator[list[Case]]:
    """Yield batches of cases for threads: first single cases, so that few cases keep all workers busy."""
    cases = iter(cases)
    for count in chain(repeat(1, _BATCH * workers), repeat(_BATCH)):
        if not (some := list(islice(cases, count))):
            return
        yield some


class CaseRunner:
    """Flies cases of one scenario, each in the calling thread; every thread has a telemetry buffer of its
    own.

    A flight records the telemetry channels that its figures need, or all channels if there is a ``collect``.
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
        """Fly a few cases; one that cannot fly becomes a row with the reason.

        All cases are prepared before the first one flies: a flight empties the processor's caches of what
        preparing needs, and preparing each case after a flight takes half as long again.
        """
        prepared = [self.prepared(case) for case in cases]
        return [self._flown(case, ready) for case, ready in zip(cases, prepared, strict=True)]

    def prepared(self, case: Case) -> tuple[Variant, dict[str, Any]] | str:
        """Return what flies, with the changes as columns of the row; or why the case cannot fly."""
        try:
            variant = self.variants.build(case)
            return variant, variant.applied(case)
        except _UNFLYABLE as error:
            return " ".join(str(error).split())

    def _flown(self, case: Case, ready: tuple[Variant, dict[str, Any]] | str) -> Row:
        if isinstance(ready, str):
            return _failed_row(case, ready)
        variant, changes = ready
        try:
            flight = fly(variant.loaded, parts=variant.parts, log=self._log(log_rows(variant.loaded)))
        except _UNFLYABLE as error:
            return _failed_row(case, " ".join(str(error).split()))
        return _flown_row(case, changes, flight, self.collect)

    def _log(self, rows: int) -> np.ndarray:
        """Telemetry rows of this thread, used again: fresh memory for each flight costs 3 % of its time."""
        if getattr(self._buffers, "log", None) is None or len(self._buffers.log) < rows:
            self._buffers.log = np.zeros(rows, BRIEF if self.collect is None else TICK)
        return self._buffers.log
