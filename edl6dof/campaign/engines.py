"""What flies the cases of a campaign: threads of this process, or the workers of a Dask cluster.  Rows are the same from each."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Protocol

from edl6dof.campaign.executor import Pilot, available_cores
from edl6dof.campaign.origin import source_hash
from edl6dof.campaign.plan import Plan, parse_plan
from edl6dof.campaign.rows import Row

if TYPE_CHECKING:
    from distributed import Client

Range = tuple[int, int]

#: Cases in one task of a cluster.
_TASK = 10

#: Tasks sent ahead for each thread of the cluster.
_AHEAD = 3


class Engine(Protocol):
    """Flies ranges of cases."""

    def rows(self, plan: Plan, ranges: Iterable[Range]) -> Iterator[list[Row]]:
        """Rows of each range, in order; ranges are read only a little ahead."""


class Threads:
    """Threads of this process."""

    def __init__(self, workers: int | None = None):
        self.workers = workers or available_cores()

    def __str__(self) -> str:
        return f"{self.workers} thread{'s' if self.workers > 1 else ''}"

    def rows(self, plan: Plan, ranges: Iterable[Range]) -> Iterator[list[Row]]:
        """Rows of each range."""
        pending: deque[Range] = deque()

        def cases() -> Iterator[Any]:
            for first, last in ranges:
                pending.append((first, last))
                yield from plan.cases(first, last)

        found: list[Row] = []
        for row in Pilot(plan.loaded).rows(cases(), self.workers):
            found.append(row)
            if len(found) == pending[0][1] - pending[0][0]:
                pending.popleft()
                yield found
                found = []


class Dask:
    """Workers of a Dask cluster; one that dies loses nothing, its cases go to another."""

    def __init__(self, client: Client):
        self.client = client

    def __str__(self) -> str:
        return f"Dask, {len(self.client.nthreads())} workers at {self.client.scheduler.address}"

    def rows(self, plan: Plan, ranges: Iterable[Range]) -> Iterator[list[Row]]:
        """Rows of each range."""
        text = self.client.scatter(plan.text, broadcast=True, hash=True)
        ahead = _AHEAD * max(sum(self.client.nthreads().values()), 1)
        waiting: deque[tuple[Any, bool]] = deque()
        found: list[Row] = []
        for first, last in ranges:
            for start in range(first, last, _TASK):
                stop = min(start + _TASK, last)
                waiting.append((self.client.submit(fly_range, text, source_hash(), start, stop, pure=False, retries=3), stop == last))
            while len(waiting) >= ahead:
                yield from self._next(waiting, found)
        while waiting:
            yield from self._next(waiting, found)

    def _next(self, waiting: deque[tuple[Any, bool]], found: list[Row]) -> Iterator[list[Row]]:
        future, ends_range = waiting.popleft()
        found += future.result()
        if ends_range:
            yield list(found)
            found.clear()


@contextmanager
def dask_engine(address: str | None, workers: int | None) -> Iterator[Dask]:
    """Engine on an existing scheduler, or on a cluster of worker processes started here, reachable from this machine only.

    Raises:
        ImportError: Dask is not installed.
        OSError: no scheduler answers.
    """
    from distributed import Client, LocalCluster

    if address is not None:
        with Client(address, timeout="20s", set_as_default=False) as client:
            yield Dask(client)
        return
    options = {"host": "127.0.0.1", "dashboard_address": None, "processes": True, "threads_per_worker": 1}
    with LocalCluster(n_workers=workers or available_cores(), **options) as cluster, Client(cluster, set_as_default=False) as client:
        yield Dask(client)


def fly_range(plan_text: str, source: str, first: int, last: int) -> list[Row]:
    """Fly cases on a worker, which keeps the plan and its pilot for the tasks to come.

    Raises:
        OSError: the worker runs other sources than the program that sent the cases.
    """
    if source != source_hash():
        raise OSError("a worker of the cluster runs other sources of edl6dof than this program; install the same on all machines")
    plan, pilot = _prepared(plan_text)
    return pilot.fly(list(plan.cases(first, last)))


@lru_cache(maxsize=2)
def _prepared(plan_text: str) -> tuple[Plan, Pilot]:
    plan = parse_plan(plan_text, "(campaign)")
    return plan, Pilot(plan.loaded)
