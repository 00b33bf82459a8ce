"""Fly a campaign into its folder: begin, resume, stop early, finish; and fly one of its cases again."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import islice
from math import isnan

import pyarrow as pa
import pyarrow.compute as pc

import edl6dof
from edl6dof.campaign.design.case import BELIEF, MATRIX, TRUTH, A, B, scenario_of
from edl6dof.campaign.design.plan import Plan, parse_plan
from edl6dof.campaign.engines import Engine
from edl6dof.campaign.executor import table_of
from edl6dof.campaign.fault_response import collected
from edl6dof.campaign.faults import fault_figures
from edl6dof.campaign.identity import changed_files, compared, differences_from, identity
from edl6dof.campaign.parts import PART
from edl6dof.campaign.statistics import Proportion, Until
from edl6dof.campaign.store import Cause, Info, Store, Summary
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.sim.flight import Flight


@dataclass
class Tally:
    """Progress of a campaign."""

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
        """Flights per second since this process began, without the cases of earlier processes."""
        return self.here / max(time.perf_counter() - self.began, 1e-9)


Report = Callable[[Tally], None]


def begin(plan: Plan, store: Store, until: str | None, force: bool = False) -> None:
    """Make the folder of a new campaign; errors are those of :meth:`Store.check_new`."""
    store.begin(plan.text, Info(until=until, identity=identity(plan)), force)


def resumed_plan(store: Store) -> Plan:
    """Return the plan of a campaign that was begun earlier.

    Raises:
        ConfigError: the campaign was begun with other sources, plugins, versions or tables, so that the table
            would mix the rows of two programs.
    """
    recorded, text = store.info.identity, store.plan_text
    _require_same(store, differences_from(recorded, text))
    plan = parse_plan(text, str(store.folder / "campaign.yaml"))
    _require_same(store, compared(recorded, identity(plan)))
    return plan


def _require_same(store: Store, found: list[str]) -> None:
    if found:
        words = f"was begun with another program or other files ({'; '.join(found)})"
        raise _refused(store, f"{words}; restore them or begin anew with --force")


def _refused(store: Store, message: str) -> ConfigError:
    """The error of a campaign that cannot be resumed; its message names every difference."""
    return ConfigError([Problem(str(store.folder), 0, 0, "", message)])


def fly(plan: Plan, store: Store, engine: Engine, report: Report | None = None) -> Tally:
    """Fly every missing case, write the table and return the final progress.

    Raises:
        ConfigError: a table that the cases read has changed since the campaign began.
        OSError: a file cannot be written, or the engine has failed.
    """
    info, parts = store.info, store.parts
    until = Until.parse(info.until) if info.until else None
    ranges = [(first, min(first + PART, plan.count)) for first in range(0, plan.count, PART)]
    found = {k: parts.successes(k, *cases) for k, cases in enumerate(ranges)}
    kept = {k: good for k, good in found.items() if good is not None}
    tally, done = Tally(plan.count), 0
    flown = engine.rows(plan, (cases for k, cases in enumerate(ranges) if k not in kept))
    for index, (first, last) in enumerate(ranges):
        if index not in kept:
            rows = list(islice(flown, last - first))
            if changed := changed_files(info.identity):
                words = f"{', '.join(changed)} changed while it was flown; restore it and go on with --resume"
                raise _refused(store, words)
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
    columns = None if plan.fault_matrix is not None else ["cause", "success", MATRIX]
    store.finish(done, _summary(plan, tally, parts.table(range(done), columns), str(engine)))
    return tally


def _summary(plan: Plan, tally: Tally, table: pa.Table, engine: str) -> Summary:
    """Results of a campaign; in a Sobol design only the independent flights count for success."""
    success = tally.success
    if plan.saltelli is not None:
        independent = table.filter(pc.is_in(table[MATRIX], pa.array([A, B])))
        success = Proportion.of(independent["success"].to_pylist())
    causes = Counter(cause for cause in table["cause"].to_pylist() if cause)
    return Summary(
        name=plan.name,
        cases=tally.flown,
        cases_planned=plan.count,
        successes=tally.successes,
        p_success=success.value,
        p_success_95=list(success.interval),
        causes=[Cause(cause=cause, cases=number) for cause, number in causes.most_common()],
        edl6dof_version=edl6dof.__version__,
        engine=engine,
        flown_in_this_run=tally.here,
        flights_per_second=tally.rate,
        faults=fault_figures(table.to_pylist()) if plan.fault_matrix is not None else None,
    )


def case_scenario(plan: Plan, number: int) -> LoadedScenario:
    """The scenario of a case, checked like a file.

    Raises:
        ConfigError: there is no such case, or its values are not allowed.
    """
    if not 0 <= number < plan.count:
        raise ConfigError([Problem("case", 0, 0, "", f"must be 0 .. {plan.count - 1} (got {number})")])
    case = next(plan.cases(number, number + 1))
    return scenario_of(
        plan.loaded, replace(case, belief={**case.belief, "name": f"{plan.name}_case{number}"})
    )


def differences(table: pa.Table, place: object, plan: Plan, number: int, flight: Flight) -> list[str]:
    """Columns in which a flight differs from its row, if only by one bit; ``place``: path of the table.

    Raises:
        ConfigError: the case has no row yet.
    """
    found = table["case"].to_pylist()
    if number not in found:
        raise ConfigError([Problem(str(place), 0, 0, "", f"case {number} has not flown yet")])
    row = table.slice(found.index(number), 1).to_pylist()[0]
    ended = {"cause": flight.cause, "outcome": flight.outcome, "end_s": flight.time_s}
    collect = collected(plan)
    mine = {"success": flight.success, **ended, **flight.figures, **(collect(flight) if collect else {})}
    case = next(plan.cases(number, number + 1))
    changed = (*(TRUTH + path for path in case.truth), *(BELIEF + path for path in case.belief))
    known = {"case", "profile", *mine, *case.label, *changed}
    extra = [name for name, value in row.items() if name not in known and value is not None]
    return [name for name, value in mine.items() if not _same(value, row.get(name))] + extra


def _same(value: object, stored: object) -> bool:
    """Return whether two values are equal; NaN may be stored as null."""
    missing = isinstance(value, float) and isnan(value)
    return value == stored or (missing and (stored is None or stored != stored))
