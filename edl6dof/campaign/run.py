"""Fly a campaign into its folder: begin, go on, stop early, finish."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

import pyarrow as pa
import pyarrow.compute as pc

import edl6dof
from edl6dof.campaign.design.case import MATRIX, A, B
from edl6dof.campaign.design.plan import Plan, parse_plan
from edl6dof.campaign.engines import Engine
from edl6dof.campaign.fault_figures import fault_figures
from edl6dof.campaign.rows import table_of
from edl6dof.campaign.statistics import Proportion, Until
from edl6dof.campaign.storage.documents import Cause, Identity, Info, Summary
from edl6dof.campaign.storage.identity import changed_files, compared, differences, identity
from edl6dof.campaign.storage.parts import PART
from edl6dof.campaign.storage.store import Store
from edl6dof.config.errors import ConfigError, Problem


@dataclass
class Tally:
    """How a campaign stands."""

    total: int
    flown: int = 0
    successes: int = 0
    here: int = 0
    began: float = field(default_factory=time.perf_counter)

    @property
    def success(self) -> Proportion:
        """Share of successes so far."""
        return Proportion(self.successes, self.flown)

    @property
    def rate(self) -> float:
        """Flights per second since this process began, cases flown earlier left out."""
        return self.here / max(time.perf_counter() - self.began, 1e-9)


Report = Callable[[Tally], None]


def begin(plan: Plan, store: Store, until: str | None, force: bool = False) -> None:
    """Make the folder of a new campaign.

    Raises:
        ConfigError: there is something already; with ``force``, something that is no campaign's.
    """
    store.begin(plan.text, Info(until=until, identity=identity(plan)), force)


def resumed_plan(store: Store) -> Plan:
    """The plan of a campaign that was begun earlier.

    Raises:
        ConfigError: it was begun with other sources, plugins, versions or tables: rows of two programs would
            stand in one table.
    """
    recorded, text = store.info.identity, store.plan_text
    _require_same(store, differences(recorded, text))
    plan = parse_plan(text, str(store.folder / "campaign.yaml"))
    _require_same(store, compared(recorded, identity(plan)))
    return plan


def _require_same(store: Store, found: list[str]) -> None:
    if found:
        words = f"was begun with another program or other files ({'; '.join(found)})"
        raise _refused(store, f"{words}; restore them or begin anew with --force")


def _refused(store: Store, message: str) -> ConfigError:
    """The error of a campaign that does not go on; it names every difference, however many."""
    return ConfigError([Problem(str(store.folder), 0, 0, "", message)])


def fly(plan: Plan, store: Store, engine: Engine, report: Report | None = None) -> Tally:
    """Fly every case that is missing, put the table together and return how it ended.

    Raises:
        ConfigError: a table that the cases read has changed meanwhile.
        OSError: something cannot be written, or the engine has failed.
    """
    info, parts = store.info, store.parts
    until = Until.parse(info.until) if info.until else None
    ranges = [(first, min(first + PART, plan.count)) for first in range(0, plan.count, PART)]
    kept = {
        k: good
        for k, (first, last) in enumerate(ranges)
        if (good := parts.successes(k, first, last)) is not None
    }
    tally, done = Tally(plan.count), 0
    flown = engine.rows(plan, (cases for k, cases in enumerate(ranges) if k not in kept))
    for index, (_, last) in enumerate(ranges):
        if index not in kept:
            rows = next(flown)
            _require_unchanged(store, info.identity)
            parts.write(index, table_of(rows))
            tally.here += len(rows)
        tally.flown, done = last, index + 1
        tally.successes += kept[index] if index in kept else sum(bool(row["success"]) for row in rows)
        if report is not None:
            report(tally)
        if until is not None and until.reached(tally.success):
            break
    if hasattr(flown, "close"):
        flown.close()
    ended = summary(plan, tally, causes(parts.table(range(done), ["cause"])), str(engine))
    if plan.fault_matrix is not None:
        faults = fault_figures(parts.table(range(done)).to_pylist())
        ended = ended.model_copy(update={"faults": faults})
    if plan.swaps is not None:
        success = independent_success(parts.table(range(done), ["success", MATRIX]))
        update = {"p_success": success.value, "p_success_95": list(success.interval)}
        ended = ended.model_copy(update=update)
    store.finish(done, ended)
    return tally


def _require_unchanged(store: Store, recorded: Identity) -> None:
    if changed := changed_files(recorded):
        words = f"{', '.join(changed)} changed while it was flown; restore it and go on with --resume"
        raise _refused(store, words)


def summary(plan: Plan, tally: Tally, causes: list[Cause], engine: str) -> Summary:
    """Outcome of a campaign."""
    return Summary(
        name=plan.name,
        cases=tally.flown,
        cases_planned=plan.count,
        successes=tally.successes,
        p_success=tally.success.value,
        p_success_95=list(tally.success.interval),
        causes=causes,
        edl6dof_version=edl6dof.__version__,
        engine=engine,
        flown_in_this_run=tally.here,
        flights_per_second=tally.rate,
    )


def independent_success(table: pa.Table) -> Proportion:
    """Share of successes among those flights of a design of Sobol indices that share nothing with another."""
    rows = table.filter(pc.is_in(table[MATRIX], pa.array([A, B])))
    return Proportion(sum(rows["success"].to_pylist()), len(rows))


def causes(table: pa.Table) -> list[Cause]:
    """Causes of failures with the number of cases, the most frequent first."""
    counted = Counter(cause for cause in table["cause"].to_pylist() if cause)
    return [Cause(cause=cause, cases=number) for cause, number in counted.most_common()]
