"""The engine of a campaign that flies on a GPU: cases are prepared and rows are made here."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from numba import cuda

from edl6dof.campaign.design.case import Case
from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.engines import Range, by_range
from edl6dof.campaign.executor import CaseRunner, Ready
from edl6dof.campaign.fault_response import collected
from edl6dof.campaign.gpu.batch import Batch, Size
from edl6dof.campaign.gpu.device import entry
from edl6dof.campaign.gpu.layouts import LEAN, WHOLE_LOG, Layout, layout_of
from edl6dof.campaign.rows import Row, failed_row, flown_row
from edl6dof.sim.flight import flight_of

#: Share of the free memory of the GPU that a batch may take.
SHARE = 0.8
#: Most flights of a batch: as many as the largest GPU holds at a time at 255 registers a thread, and what
#: they fly with takes some gigabytes of the memory of the processor.
MOST = 32_768

#: Cases, each with what flies, or why it cannot.
Prepared = list[tuple[Case, Ready | str]]


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
        """Rows of each range."""
        runner = CaseRunner(plan.loaded, collected(plan))
        return by_range(plan, ranges, lambda cases: self.fly(runner, cases))

    def fly(self, runner: CaseRunner, cases: Iterable[Case]) -> Iterator[Row]:
        """Fly cases and hand out their rows, in the order of the cases."""
        for some, layout in _batches(runner, cases, self._memory):
            yield from self._together(runner, some, layout)

    def _together(self, runner: CaseRunner, some: Prepared, layout: Layout) -> Iterator[Row]:
        """Rows of a batch, whose memory on the GPU is free afterwards."""
        ready = [one.variant for _, one in some if isinstance(one, Ready)]
        flown = Batch(ready, layout).fly(self._kernel) if ready else iter(())
        for case, one in some:
            if isinstance(one, str):
                yield failed_row(case, one)
                continue
            left = next(flown) or next(Batch([one.variant], WHOLE_LOG).fly(self._kernel))
            assert left is not None
            yield flown_row(case, one.changes, flight_of(left), runner.collect)


def _batches(runner: CaseRunner, cases: Iterable[Case], memory: int) -> Iterator[tuple[Prepared, Layout]]:
    """Cases, prepared, of one layout as many together as the memory holds and ``MOST`` allows."""
    some, layout, size = Prepared(), LEAN, None
    for case in cases:
        ready = runner.prepared(case)
        if isinstance(ready, Ready):
            own = layout_of(ready.variant, runner.collect is not None)
            full = len(some) >= MOST or own is not layout
            if size is None or full or size.add(ready.variant) > memory:
                if size is not None:
                    yield some, layout
                    some = []
                layout, size = own, Size(own)
                size.add(ready.variant)
        some.append((case, ready))
    if some:
        yield some, layout


def gpu_engine(device: str) -> Gpu:
    """Engine on the GPU of this machine, which is called ``device``."""
    free, _ = cuda.current_context().get_memory_info()
    return Gpu(device, entry(), int(SHARE * free))
