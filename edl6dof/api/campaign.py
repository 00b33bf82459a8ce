"""A campaign: many flights of one scenario, flown into a folder or into memory, and their results."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field, replace
from functools import cached_property
from os.path import lexists
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa

from edl6dof.api.arguments import library
from edl6dof.api.flight import Flight, html_table
from edl6dof.campaign import run
from edl6dof.campaign.design.plan import Plan, load_plan
from edl6dof.campaign.engines import Engine, Threads, dask_engine
from edl6dof.campaign.executor import BELIEF, TRUTH, CaseRunner
from edl6dof.campaign.fault_choice import FaultRequest, faults_plan
from edl6dof.campaign.run import case_scenario, differences
from edl6dof.campaign.statistics import SHARES, Quantile, Until, quantile
from edl6dof.campaign.store import Store, Summary
from edl6dof.config.errors import UnknownName, refusal
from edl6dof.config.model_paths import Slot, root_slot
from edl6dof.config.units import split_unit
from edl6dof.config.wording import unknown
from edl6dof.metrics.figures import DECLARED, figure_of_merit
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.flight import fly
from edl6dof.sim.functions import is_compiled

if TYPE_CHECKING:
    import pandas
    import xarray

#: Engines that may fly a campaign, and as many threads, or processes, at most.
ENGINES, MOST_WORKERS = ("threads", "dask"), 1024

#: Called with how many flights have flown, and of how many.
Progress = Callable[[int, int], None]


@dataclass(frozen=True, repr=False)
class CampaignResult:
    """Result of a campaign, a sweep or a matrix of faults.

    Attributes:
        summary: successes, causes of failures, versions and machine.
        table: a row for each case: drawn values, outcome, figures with unit suffix.
        folder: folder of the campaign; ``None`` if it is in memory only.
    """

    summary: Summary
    table: pa.Table
    folder: Path | None = None
    _plan: Plan | None = None
    _columns: dict[str, np.ndarray] = field(default_factory=dict, repr=False)

    @cached_property
    def plan(self) -> Plan:
        """The plan: the scenario, and every case as a function of its number.

        Raises:
            ConfigError: the campaign was flown by another program or with other files, so its cases would
                differ.
        """
        if self._plan is not None:
            return self._plan
        assert self.folder is not None, "a campaign in memory has its plan"
        return run.resumed_plan(Store(self.folder))

    @property
    def cases(self) -> int:
        """Number of cases flown."""
        return self.summary.cases

    @property
    def successes(self) -> int:
        """Number of cases that reached their goal within all limits."""
        return self.summary.successes

    @property
    def p_success(self) -> float:
        """Share of successes."""
        return self.summary.p_success

    @property
    def p_success_95(self) -> tuple[float, float]:
        """Confidence interval of the share of successes at 95 %."""
        return self.summary.p_success_95[0], self.summary.p_success_95[1]

    @cached_property
    def causes(self) -> dict[str, int]:
        """Causes of failures, and the number of cases of each."""
        return {one.cause: one.cases for one in self.summary.causes}

    def __len__(self) -> int:
        return self.table.num_rows

    def __getitem__(self, column: str) -> np.ndarray:
        """Return a column, shape (cases,); a number is NaN if a case has none.

        Raises:
            KeyError: there is no such column; the message suggests a similar name.
        """
        if column not in self.table.column_names:
            raise UnknownName("column", column, self.table.column_names)
        if column not in self._columns:
            self._columns[column] = _array(self.table[column])
        return self._columns[column]

    def quantile(self, column: str, share: float) -> Quantile | None:
        """Return the quantile of a share of the flights with 95 % bounds; ``None`` if cases are too few."""
        return quantile(self[column].astype(float), share)

    def quantiles(self, column: str) -> list[Quantile]:
        """Return the quantiles from 0.13 % to 99.87 % that the cases can bound."""
        found = (self.quantile(column, share) for share in SHARES)
        return [one for one in found if one is not None]

    def worst(self, figure: str) -> int:
        """Return the number of the case in which a figure is worst: largest in magnitude, or smallest if the
        figure is a clearance.

        Raises:
            ConfigError: there is no such figure, or no case has a value of it.
        """
        return worst_case(self.table, figure)

    def to_pandas(self) -> pandas.DataFrame:
        """Return the rows as a data frame indexed by case.

        Raises:
            ImportError: pandas is not installed.
        """
        columns = {name: self[name] for name in self.table.column_names}
        return library("pandas", "to_pandas").DataFrame(columns).set_index("case")

    def to_xarray(self) -> xarray.Dataset:
        """Return the rows as a data set along ``case``, with unit and meaning of each variable.

        Raises:
            ImportError: xarray is not installed.
        """
        names = [name for name in self.table.column_names if name != "case"]
        columns = {name: ("case", self[name], described(name)) for name in names}
        about = {"name": self.summary.name, "cases": self.cases, "successes": self.successes}
        return library("xarray", "to_xarray").Dataset(columns, {"case": self["case"]}, about)

    def refly(self, case: int) -> Flight:
        """Fly a case again with all its telemetry; ``differences`` of the flight lists columns that do not
        equal its row.

        Raises:
            ConfigError: there is no such case, or it was flown by another program or with other files.
        """
        return refly_case(self.plan, self.table, self.folder or "campaign", case)

    def __repr__(self) -> str:
        low, high = (100.0 * one for one in self.p_success_95)
        share = f"{100.0 * self.p_success:.1f} % ({low:.1f} to {high:.1f} %)"
        return f"<Campaign {self.summary.name}: {self.successes} of {self.cases} succeed, {share}>"

    def _repr_html_(self) -> str:
        """Success and causes, for notebooks."""
        rows = [(cause, str(count)) for cause, count in self.causes.items()]
        causes = html_table(("cause of failure", "cases"), rows) if rows else ""
        return f"<div><p>{repr(self)[1:-1]}</p>{causes}</div>"


def described(column: str) -> dict[str, str]:
    """Return unit and meaning of a column of a campaign, which is a drawn parameter or a figure.

    >>> described("truth.vehicle.mass.entry_kg")
    {'units': 'kg', 'long_name': 'vehicle mass at entry'}
    """
    prefix, _, path = column.partition(".")
    if f"{prefix}." not in (TRUTH, BELIEF):
        figure = figure_of_merit(column)
        return {"units": figure.unit.label, "long_name": figure.meaning}
    slot: Slot | None = root_slot(Scenario)
    meaning = ""
    for part in path.split("."):
        slot = slot and (slot.child(int(part) if part.isdecimal() else part) or slot.child(0))
        meaning = slot.info.description or meaning if slot and slot.info else meaning
    return {"units": split_unit(slot.name if slot else path)[1].label, "long_name": meaning}


def _array(column: Any) -> np.ndarray:
    """Return a column as an array, without the conversion of arrow, which loads pandas."""
    values = column.to_pylist()
    if None in values and (pa.types.is_floating(column.type) or pa.types.is_integer(column.type)):
        return np.array([np.nan if value is None else value for value in values], dtype=float)
    return np.array(values)


def worst_case(table: pa.Table, figure: str) -> int:
    """Return the number of the case in which a figure is worst; see :meth:`CampaignResult.worst`."""
    names = [name for name in table.column_names if name in DECLARED]
    if figure not in names:
        raise refusal("--worst", unknown("figure", figure, names))
    values = np.abs(_array(table[figure]).astype(float))
    if np.isnan(values).all():
        raise refusal("--worst", f"no case has come to {figure}")
    choose = np.nanargmin if figure_of_merit(figure).clearance else np.nanargmax
    return int(_array(table["case"])[choose(values)])


def refly_case(plan: Plan, table: pa.Table, place: object, number: int) -> Flight:
    """Fly a case again and compare it with its row; ``place`` names the table in errors."""
    flight = Flight.of(fly(case_scenario(plan, number)))
    flight.differences = tuple(differences(table, place, plan, number, flight))
    return flight


def chosen_engine(
    name: str = "threads", workers: int | None = None, cluster: str | None = None
) -> AbstractContextManager[Engine]:
    """Return one of :data:`ENGINES`, which runs in a block; ``cluster``: address of a Dask scheduler."""
    if name not in ENGINES:
        raise refusal("--engine", f"must be threads or dask (got {name!r})")
    if cluster is not None and name != "dask":
        raise refusal("--cluster", "needs --engine dask")
    if workers is not None and not 1 <= workers <= MOST_WORKERS:
        raise refusal("--workers", f"must be 1 .. {MOST_WORKERS} (got {workers})")
    return dask_engine(cluster, workers) if name == "dask" else nullcontext(Threads(workers))


@dataclass(frozen=True)
class Job:
    """A campaign that is to be flown into a folder: every case of a plan, or the missing cases of a folder.

    Attributes:
        store: the folder.
        engine: engine that flies it.
        plan: plan of a new campaign, which may stop early with ``until`` and replace another with ``force``;
            ``None`` for the plan that the folder has.
    """

    store: Store
    engine: AbstractContextManager[Engine]
    plan: Plan | None = None
    until: str | None = None
    force: bool = False

    def fly(self, report: run.Report | None = None) -> Plan:
        """Fly the cases; return the plan.

        Raises:
            ConfigError: the folder has content that the plan must not replace; or it has no plan, or one of
                another program, or is damaged.
            OSError: a file cannot be written, or the engine has failed.
        """
        plan, store = self.plan, self.store
        with store.lock(make=plan is not None):
            if plan is None:
                plan = run.resumed_plan(store)
                store.tidy()
                if store.complete:
                    return plan
            else:
                store.check_new(self.force)
            with self.engine as engine:  # before anything is replaced: it may not be there
                if self.plan is not None:
                    run.begin(plan, store, self.until, self.force)
                if not is_compiled():  # before anything flies in parallel: two processes would do it twice
                    CaseRunner(plan.loaded).fly(list(plan.cases(0, 1)))
                run.fly(plan, store, engine, report)
        return plan

    def result(self, progress: Progress | None = None, in_memory: bool = False) -> CampaignResult:
        """Fly the cases and return the result; ``in_memory``: no folder of a plan is to stay."""
        report = None if progress is None else lambda tally: progress(tally.flown, tally.total)
        if not in_memory:
            self.fly(report)
            return replace(open_campaign(self.store.folder), _plan=self.plan)
        with tempfile.TemporaryDirectory(prefix="edl6dof-") as folder:
            job = replace(self, store=Store(Path(folder) / "campaign"))
            plan = job.fly(report)
            return CampaignResult(job.store.summary, job.store.table(), None, plan)


def campaign_job(
    scenario: str,
    sets: Sequence[str],
    drawn: tuple[int | None, int | None, str | None],
    engine: AbstractContextManager[Engine],
    until: str | None,
    *,
    out: str | Path | None,
    force: bool,
    resume: bool,
) -> Job:
    """Prepare a campaign; ``drawn``: cases, seed and sampling, see :func:`edl6dof.campaign`."""
    if until is not None:
        try:
            Until.parse(until)
        except ValueError as error:
            raise refusal("--until", str(error)) from None
    if resume and (is_campaign(scenario) or Path(scenario).is_dir()):
        return _continued(scenario, engine, sets, *drawn)
    plan = load_plan(scenario, tuple(sets), *drawn)
    if until is not None and plan.saltelli is not None:
        raise refusal("--until", "sobol_indices flies its whole design: its flights are not independent")
    job = Job(Store(Path(out or Path("runs") / plan.name)), engine, plan, until, force)
    return _resumed(job, plan, "campaign") if resume else job


def faults_job(
    scenario: str,
    sets: Sequence[str],
    request: FaultRequest,
    drawn: tuple[int | None, int | None],
    engine: AbstractContextManager[Engine],
    *,
    out: str | Path | None,
    force: bool,
    resume: bool = False,
) -> Job:
    """Prepare a matrix of faults; ``drawn``: vehicles and seed, see :func:`edl6dof.faults`."""
    if resume and is_campaign(scenario):
        return _continued(scenario, engine, *request, sets, *drawn)
    plan = faults_plan(scenario, sets, request, *drawn)
    name = f"{'sensor-faults' if request.sensors else 'faults'}-{plan.name}"
    job = Job(Store(Path(out or Path("runs") / name)), engine, plan, force=force)
    return _resumed(job, plan, "faults") if resume else job


def _continued(folder: str, engine: AbstractContextManager[Engine], *values: object) -> Job:
    """Prepare the missing cases of a folder; refuse ``values`` that would change its plan."""
    if any(not (value is None or value is False or value in ("", ())) for value in values):
        raise refusal(folder, "has its plan; it accepts no other values when it is resumed")
    return Job(Store(Path(folder)), engine)


def _resumed(job: Job, plan: Plan, command: str) -> Job:
    """Prepare the missing cases of a folder; refuse one that was begun with another plan."""
    folder = job.store.folder
    if plan.text != job.store.plan_text:
        how = f"go on with it by: edl6dof {command} {folder} --resume"
        raise refusal(folder, f"was begun with another plan; {how}")
    return Job(job.store, job.engine)


def is_campaign(operand: str | Path) -> bool:
    """Return True if an operand is the folder of a campaign."""
    return lexists(Path(operand) / "campaign.json")


def open_campaign(folder: Path) -> CampaignResult:
    """Read the result of a complete campaign from its folder.

    Raises:
        ConfigError: the folder has no campaign, or an incomplete or damaged one.
    """
    store = Store(folder)
    store.require_complete()
    return CampaignResult(store.summary, store.table(), store.folder)
