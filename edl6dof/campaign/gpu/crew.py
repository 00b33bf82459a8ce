"""Who prepares the cases of a campaign and makes its rows, beside the GPU that flies them: this process, or
several others, each a share of the cases; what they cost is the bound of a fast GPU.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from signal import SIG_IGN, SIGINT, signal
from typing import Any, Protocol

from edl6dof.campaign.design.case import Case
from edl6dof.campaign.design.plan import Plan, parse_plan
from edl6dof.campaign.executor import CaseRunner
from edl6dof.campaign.fault_response import collected
from edl6dof.campaign.gpu.host import Host, Left, Start
from edl6dof.campaign.rows import Row
from edl6dof.campaign.storage.identity import Identity, compared, identity
from edl6dof.scenario.records import Records


class Crew(Protocol):
    """Prepares portions of cases and makes their rows.

    Attributes:
        nominal: records of the case without changes.
    """

    nominal: Records

    def prepare(self, portion: int, cases: Sequence[Case]) -> Future[list[Start | None]]:
        """What begins of the cases of a portion."""

    def again(self, portion: int, case: Case) -> Future[Start]:
        """A case of a portion, to keep every row of its telemetry."""

    def rows(self, portion: int, cases: Sequence[Case], left: Sequence[Left | None]) -> Future[list[Row]]:
        """Rows of the cases of a portion from what they have left."""


class Alone:
    """This process."""

    def __init__(self, runner: CaseRunner):
        self._host = Host(runner)
        self.nominal = self._host.nominal

    def prepare(self, portion: int, cases: Sequence[Case]) -> Future[list[Start | None]]:
        """As of :class:`Crew`."""
        return _done(self._host.prepare(cases))

    def again(self, portion: int, case: Case) -> Future[Start]:
        """As of :class:`Crew`."""
        return _done(self._host.again(case))

    def rows(self, portion: int, cases: Sequence[Case], left: Sequence[Left | None]) -> Future[list[Row]]:
        """As of :class:`Crew`."""
        return _done(self._host.rows(cases, left))


class Helpers:
    """Processes of this machine; what a portion needs stays in the one that prepares it."""

    def __init__(self, plan: Plan, count: int):
        self.nominal = CaseRunner(plan.loaded).variants.nominal.records
        given, context = (plan.text, identity(plan)), get_context("spawn")
        self._pools = [ProcessPoolExecutor(1, context, _begin, given) for _ in range(count)]

    def prepare(self, portion: int, cases: Sequence[Case]) -> Future[list[Start | None]]:
        """As of :class:`Crew`."""
        return self._pool(portion).submit(_prepare, cases)

    def again(self, portion: int, case: Case) -> Future[Start]:
        """As of :class:`Crew`."""
        return self._pool(portion).submit(_again, case)

    def rows(self, portion: int, cases: Sequence[Case], left: Sequence[Left | None]) -> Future[list[Row]]:
        """As of :class:`Crew`."""
        return self._pool(portion).submit(_rows, cases, left)

    def close(self) -> None:
        """Let them go."""
        for pool in self._pools:
            pool.shutdown(wait=True, cancel_futures=True)

    def _pool(self, portion: int) -> ProcessPoolExecutor:
        return self._pools[portion % len(self._pools)]


def awaited(future: Future[Any]) -> Any:
    """Result of a future.

    Raises:
        OSError: the helper is no more.
    """
    try:
        return future.result()
    except BrokenProcessPool:
        raise OSError("a process that prepares cases has died") from None


def _done(result: Any) -> Future[Any]:
    future: Future[Any] = Future()
    future.set_result(result)
    return future


#: What a helper works with.
_host: list[Host] = []


def _begin(plan_text: str, ordered: Identity) -> None:
    signal(SIGINT, SIG_IGN)  # Ctrl-C is answered by the process that holds the GPU
    plan = parse_plan(plan_text, "(campaign)")
    if found := compared(ordered, identity(plan)):
        raise OSError(f"a file changed while the campaign began: {'; '.join(found)}")
    _host.append(Host(CaseRunner(plan.loaded, collected(plan))))


def _prepare(cases: Sequence[Case]) -> list[Start | None]:
    return _host[0].prepare(cases)


def _again(case: Case) -> Start:
    return _host[0].again(case)


def _rows(cases: Sequence[Case], left: Sequence[Left | None]) -> list[Row]:
    return _host[0].rows(cases, left)
