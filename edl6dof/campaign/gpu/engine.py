"""The engine of a campaign that flies on a GPU: cases are prepared and rows are made on the processor."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import closing, nullcontext
from itertools import islice
from typing import Any, NamedTuple

from numba import cuda

from edl6dof.campaign.design.case import Case
from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.engines import Range, by_range
from edl6dof.campaign.executor import CaseRunner, available_cores
from edl6dof.campaign.fault_response import collected
from edl6dof.campaign.gpu.batch import TOGETHER, Batch, Size
from edl6dof.campaign.gpu.crew import Alone, Crew, Helpers, awaited
from edl6dof.campaign.gpu.device import entry
from edl6dof.campaign.gpu.host import Left, Start
from edl6dof.campaign.rows import Row

#: Share of the free memory of the GPU that a batch may take.
SHARE = 0.8
#: Most flights of a batch: as many as the largest GPU holds at a time at 255 registers a thread, and what
#: they fly with takes some gigabytes of the memory of the processor.
MOST = 32_768
#: Cases from which on it pays to start helpers, which take some seconds to begin.
MANY = 2000
#: Portions of cases that helpers may be ahead, so that they are at work while the GPU flies.
AHEAD = 256


class Portion(NamedTuple):
    """Some cases, and what begins of each: nothing of one that cannot fly."""

    number: int
    cases: list[Case]
    starts: list[Start | None]


class Gpu:
    """A GPU of this machine."""

    def __init__(self, device: str, kernel: Any, memory: int):
        """
        Args:
            device: what it is called.
            kernel: the entry, compiled for it.
            memory: bytes that the flights of a batch may take.
        """
        self.device: str | None = device
        self._kernel, self._memory = kernel, memory

    def __str__(self) -> str:
        return f"GPU ({self.device})"

    def rows(self, plan: Plan, ranges: Iterable[Range]) -> Iterator[list[Row]]:
        """Rows of each range.

        Raises:
            OSError: a process that prepares cases has died.
        """
        count = available_cores() - 1
        helped = plan.count >= MANY and count > 0
        with closing(Helpers(plan, count)) if helped else nullcontext() as helpers:
            crew = helpers or Alone(CaseRunner(plan.loaded, collected(plan)))
            ahead = AHEAD if helped else 1
            yield from by_range(plan, ranges, lambda cases: self.fly(crew, cases, ahead))

    def fly(self, crew: Crew, cases: Iterable[Case], ahead: int = 1) -> Iterator[Row]:
        """Fly cases and hand out their rows, in the order of the cases; so many portions are begun ahead."""
        waiting: deque[Any] = deque()
        for some in _batches(_portions(crew, cases, ahead), self._memory):
            left = self._flown(crew, some)
            for portion in some:
                own = [None if start is None else next(left) for start in portion.starts]
                waiting.append(crew.rows(portion.number, portion.cases, own))
                while len(waiting) >= ahead:
                    yield from awaited(waiting.popleft())
        while waiting:
            yield from awaited(waiting.popleft())

    def _flown(self, crew: Crew, some: list[Portion]) -> Iterator[Left]:
        """What the flights of a batch leave, in order; its memory on the GPU is free afterwards."""
        begun = [
            (portion.number, case, start)
            for portion in some
            for case, start in zip(portion.cases, portion.starts, strict=True)
            if start is not None
        ]
        if not begun:
            return
        flown = Batch([start for _, _, start in begun], crew.nominal).fly(self._kernel)
        for (number, case, _), left in zip(begun, flown, strict=True):
            if left is None:
                whole = awaited(crew.again(number, case))
                left = next(Batch([whole], crew.nominal).fly(self._kernel))
            assert left is not None
            yield left


def _portions(crew: Crew, cases: Iterable[Case], ahead: int) -> Iterator[Portion]:
    """Cases, prepared."""
    cases, number = iter(cases), 0
    waiting: deque[tuple[int, list[Case], Any]] = deque()
    while some := list(islice(cases, TOGETHER)):
        waiting.append((number, some, crew.prepare(number, some)))
        number += 1
        if len(waiting) >= ahead:
            first, prepared, future = waiting.popleft()
            yield Portion(first, prepared, awaited(future))
    for first, prepared, future in waiting:
        yield Portion(first, prepared, awaited(future))


def _batches(portions: Iterable[Portion], memory: int) -> Iterator[list[Portion]]:
    """Portions whose flights have one layout, as many together as the memory holds and ``MOST`` allows; one
    that is too large is cut.
    """
    some: list[Portion] = []
    first, size, count = None, Size(), 0
    for portion in portions:
        cases, starts = list[Case](), list[Start | None]()
        for case, start in zip(portion.cases, portion.starts, strict=True):
            if start is not None:
                other = first is not None and start.layout.name != first.layout.name
                if first is not None and (size.add(start) > memory or count >= MOST or other):
                    yield [*some, Portion(portion.number, cases, starts)]
                    some, cases, starts, first = [], [], [], None
                if first is None:
                    first, size, count = start, Size(), 0
                    size.add(start)
                count += 1
            cases.append(case)
            starts.append(start)
        some.append(Portion(portion.number, cases, starts))
    if some:
        yield some


def gpu_engine(device: str) -> Gpu:
    """Engine on the GPU of this machine, which is called ``device``."""
    free, _ = cuda.current_context().get_memory_info()
    return Gpu(device, entry(), int(SHARE * free))
