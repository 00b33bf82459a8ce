"""Engines that fly the cases of a campaign: threads of this process, or workers of a Dask cluster.  Both give
the same rows.
"""

from __future__ import annotations

import logging
import time
from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from functools import lru_cache
from itertools import chain
from typing import TYPE_CHECKING

from edl6dof.campaign.design.plan import Plan, parse_plan
from edl6dof.campaign.executor import CaseRunner, Row, available_cores
from edl6dof.campaign.fault_response import collected
from edl6dof.campaign.identity import changed_files, compared, differences_from, identity
from edl6dof.campaign.store import Identity
from edl6dof.config.errors import refusal

if TYPE_CHECKING:
    from distributed import Client, Future

Range = tuple[int, int]

#: Cases in one task of a cluster, and tasks sent ahead for each of its threads.
_TASK, _AHEAD = 10, 3
#: Longest time (s) without any worker, and until a scheduler answers; time between looks for workers.
PATIENCE_S, ANSWER_S, LOOK_S = 60.0, 20.0, 2.0


class Threads:
    """Threads of this process."""

    def __init__(self, workers: int | None = None):
        self.workers = workers or available_cores()

    def __str__(self) -> str:
        return f"{self.workers} thread{'s' if self.workers > 1 else ''}"

    def rows(self, plan: Plan, ranges: Iterable[Range]) -> Iterator[Row]:
        """Fly the cases of all ranges and yield their rows in order; ranges are read only a little ahead."""
        cases = chain.from_iterable(plan.cases(*some) for some in ranges)
        return CaseRunner(plan.loaded, collected(plan)).rows(cases, self.workers)


class Dask:
    """Workers of a Dask cluster.  Cases of a worker that dies go to another; workers may join at any time."""

    def __init__(self, client: Client):
        self.client = client

    def __str__(self) -> str:
        scheduler = self.client.scheduler
        address = "a closed scheduler" if scheduler is None else scheduler.address
        return f"Dask, {len(self.client.nthreads())} workers at {address}"

    def rows(self, plan: Plan, ranges: Iterable[Range]) -> Iterator[Row]:
        """Fly the cases of all ranges and yield their rows in order.

        Raises:
            OSError: no worker is left and none has joined for a while, or one runs another program.
        """
        # the plan is a task of its own: copies of its text in every task would stay in memory
        order = self.client.submit(_ordered, plan.text, identity(plan), pure=False)
        waiting: deque[Future] = deque()
        for first, last in ranges:
            for start in range(first, last, _TASK):
                stop = min(start + _TASK, last)
                waiting.append(self.client.submit(fly_range, order, start, stop, pure=False))
            ahead = _AHEAD * max(sum(self.client.nthreads().values()), 1)
            while len(waiting) >= ahead:
                yield from self._result(waiting.popleft())
        while waiting:
            yield from self._result(waiting.popleft())

    def _result(self, future: Future) -> list[Row]:
        """Rows of a task; a task whose rows were lost with a worker is flown again by another worker."""
        from distributed import CancelledError, KilledWorker

        seen = time.monotonic()
        while True:
            try:
                return future.result(timeout=LOOK_S)
            except (TimeoutError, UnboundLocalError):  # the latter from distributed, whose wait was cancelled
                if future.status == "error":
                    raise
            except KilledWorker as error:
                words = "the workers that flew some cases died one after the other"
                raise OSError(f"{words}: {' '.join(str(error).split())}") from None
            except CancelledError as error:
                words = "the scheduler of the cluster is gone"
                raise OSError(f"{words} ({' '.join(str(error).split())})") from None
            if self.client.nthreads():
                seen = time.monotonic()
            elif time.monotonic() - seen > PATIENCE_S:
                raise OSError(f"no worker of the cluster has been there for {PATIENCE_S:.0f} s")


#: Flies ranges of cases.
Engine = Threads | Dask


@contextmanager
def dask_engine(address: str | None, workers: int | None) -> Iterator[Dask]:
    """Engine on an existing scheduler, or on a new cluster of worker processes that only this machine can
    reach.

    Raises:
        ConfigError: Dask is not installed.
        OSError: no scheduler answers.
    """
    try:
        import dask
        from distributed import Client, LocalCluster
    except ImportError:
        raise refusal("--engine", "Dask is not installed; try: pip install 'edl6dof[dask]'") from None
    # errors of these modules are reported by this function, in one line
    for name in ("distributed.batched", "distributed.client", "distributed.nanny", "asyncio"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    if address is not None:
        with Client(address, timeout=ANSWER_S, set_as_default=False) as client:
            yield Dask(client)
        return
    options = {"host": "127.0.0.1", "dashboard_address": None, "processes": True, "threads_per_worker": 1}
    with (
        # the profiler of a worker keeps a call tree for each second of an hour, half a gigabyte in all
        dask.config.set({"distributed.worker.profile.enabled": False}),
        LocalCluster(n_workers=workers or available_cores(), **options) as cluster,
        Client(cluster, set_as_default=False) as client,
    ):
        yield Dask(client)


def _ordered(plan_text: str, ordered: Identity) -> tuple[str, Identity]:
    """Return the text of a plan and the identity of its campaign, to every worker that needs them."""
    return plan_text, ordered


def fly_range(order: tuple[str, Identity], first: int, last: int) -> list[Row]:
    """Fly cases on a worker, which keeps the plan and its runner for later tasks; ``order``: of
    :func:`_ordered`.

    Raises:
        OSError: the worker runs another program than the sender of the cases, or has other tables.
    """
    plan_text, ordered = order
    _require_same(differences_from(ordered, plan_text))
    plan, runner, present = _prepared(plan_text)
    _require_same(compared(ordered, present))
    rows = runner.fly(list(plan.cases(first, last)))
    _require_same([f"file {name}: changed meanwhile" for name in changed_files(ordered)])
    return rows


def _require_same(found: list[str]) -> None:
    if found:
        raise OSError(f"worker {_worker()} is no copy of this program: {'; '.join(found)}")


def _worker() -> str:
    from distributed import get_worker

    return get_worker().address


@lru_cache(maxsize=2)
def _prepared(plan_text: str) -> tuple[Plan, CaseRunner, Identity]:
    plan = parse_plan(plan_text, "(campaign)")
    return plan, CaseRunner(plan.loaded, collected(plan)), identity(plan)
