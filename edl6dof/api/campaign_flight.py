"""A plan flown into the folder of a campaign: from its first case, or what is missing of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass

from edl6dof.campaign import run
from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.engines import Engine, Threads, dask_engine
from edl6dof.campaign.statistics import Until
from edl6dof.campaign.storage.store import Store
from edl6dof.config.errors import refusal

#: What may fly a campaign.
ENGINES = ("threads", "dask")

#: As many threads, or processes, at most.
MOST_WORKERS = 1024

#: Makes what is told how a campaign of so many cases stands.
Watch = Callable[[int], AbstractContextManager[run.Report | None]]


@dataclass(frozen=True)
class EngineChoice:
    """What flies, one of :data:`ENGINES`; how many workers, and the address of a scheduler."""

    name: str = "threads"
    workers: int | None = None
    cluster: str | None = None

    def check(self) -> None:
        """See that there is such an engine, with so many workers.

        Raises:
            ConfigError: there is not.
        """
        if self.name not in ENGINES:
            raise refusal("--engine", f"must be threads or dask (got {self.name!r})")
        if self.cluster is not None and self.name != "dask":
            raise refusal("--cluster", "needs --engine dask")
        if self.workers is not None and not 1 <= self.workers <= MOST_WORKERS:
            raise refusal("--workers", f"must be 1 .. {MOST_WORKERS} (got {self.workers})")

    @contextmanager
    def start(self) -> Iterator[Engine]:
        """The engine, as long as the block lasts."""
        if self.name == "threads":
            yield Threads(self.workers)
            return
        try:
            with dask_engine(self.cluster, self.workers) as engine:
                yield engine
        except ImportError:
            raise refusal("--engine", "Dask is not installed; try: pip install 'edl6dof[dask]'") from None


def unwatched(total: int) -> AbstractContextManager[None]:
    """Tell nobody."""
    return nullcontext()


def check_until(until: str | None, plan: Plan | None = None) -> None:
    """See that a campaign can stop early so.

    Raises:
        ConfigError: it cannot.
    """
    if until is None:
        return
    try:
        Until.parse(until)
    except ValueError as error:
        raise refusal("--until", str(error)) from None
    if plan is not None and plan.swaps is not None:
        raise refusal("--until", "sobol_indices flies its whole design: its flights are not independent")


def fly_new(
    plan: Plan,
    store: Store,
    engine: EngineChoice,
    until: str | None = None,
    force: bool = False,
    watch: Watch = unwatched,
) -> None:
    """Fly a plan from its first case.

    Raises:
        ConfigError: there is something in the folder that the plan must not replace.
        OSError: something cannot be written, or the engine has failed.
    """
    with store.lock(make=True):
        store.check_new(force)
        with engine.start() as started:  # before anything is replaced: it may not be there
            run.begin(plan, store, until, force)
            _fly(plan, store, started, watch)


def go_on(store: Store, engine: EngineChoice, watch: Watch = unwatched) -> Plan:
    """Fly what is missing of the plan of a folder; returns the plan.

    Raises:
        ConfigError: the folder holds none, or one of another program, or is damaged.
        OSError: something cannot be written, or the engine has failed.
    """
    with store.lock():
        plan = run.resumed_plan(store)
        store.tidy()
        if not store.complete:
            with engine.start() as started:
                _fly(plan, store, started, watch)
        return plan


def _fly(plan: Plan, store: Store, engine: Engine, watch: Watch) -> None:
    with watch(plan.count) as report:
        _warm_up(plan)
        run.fly(plan, store, engine, report)


def _warm_up(plan: Plan) -> None:
    """Compile before anything flies in parallel: two processes that compile would do the work twice."""
    from edl6dof.sim.compile_ahead import is_compiled

    if not is_compiled():
        from edl6dof.campaign.executor import CaseRunner

        CaseRunner(plan.loaded).fly(list(plan.cases(0, 1)))
