"""Many flights of one scenario, as one object."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from os.path import lexists
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa

from edl6dof.api.campaign_flight import EngineChoice, Watch, check_until, fly_new, go_on, unwatched
from edl6dof.api.flights import Flight
from edl6dof.api.html import table as html_table
from edl6dof.api.optional import library
from edl6dof.api.overrides import Overrides, texts
from edl6dof.campaign import run
from edl6dof.campaign.design.plan import Plan, load_plan
from edl6dof.campaign.quantiles import SHARES, Quantile, quantile
from edl6dof.campaign.storage.documents import Summary
from edl6dof.campaign.storage.store import Store
from edl6dof.config.errors import UnknownName, refusal

if TYPE_CHECKING:
    import pandas

#: Called as cases have flown: with how many, of how many.
Progress = Callable[[int, int], None]


@dataclass(frozen=True, repr=False)
class CampaignResult:
    """What a campaign, a sweep or a matrix of faults came to.

    Attributes:
        summary: successes, causes of failures, what flew them.
        table: a row for each case: what was drawn, how it ended, figures with unit suffix.
        folder: where it is kept; ``None`` of one that is in memory only.
    """

    summary: Summary
    table: pa.Table
    folder: Path | None = None
    _plan: Plan | None = None
    _columns: dict[str, np.ndarray] = field(default_factory=dict, repr=False)

    @cached_property
    def plan(self) -> Plan:
        """Scenario, and every case as a function of its number.

        Raises:
            ConfigError: it was flown by another program or other files, which would fly other cases.
        """
        if self._plan is not None:
            return self._plan
        assert self.folder is not None, "a campaign in memory has its plan"
        return run.resumed_plan(Store(self.folder))

    @property
    def cases(self) -> int:
        """Cases that have flown."""
        return self.summary.cases

    @property
    def successes(self) -> int:
        """Those that reached their goal within all limits."""
        return self.summary.successes

    @property
    def p_success(self) -> float:
        """Share of successes."""
        return self.summary.p_success

    @property
    def p_success_95(self) -> tuple[float, float]:
        """Bounds of it at 95 %."""
        low, high = self.summary.p_success_95
        return low, high

    @cached_property
    def causes(self) -> dict[str, int]:
        """Causes of failures, and how many cases failed by each."""
        return {one.cause: one.cases for one in self.summary.causes}

    def __len__(self) -> int:
        return self.table.num_rows

    def __getitem__(self, column: str) -> np.ndarray:
        """A column, shape (cases,); of numbers NaN where a case has none.

        Raises:
            KeyError: there is no such column; the text says which was probably meant.
        """
        if column not in self.table.column_names:
            raise UnknownName("column", column, self.table.column_names)
        if column not in self._columns:
            self._columns[column] = _array(self.table[column])
        return self._columns[column]

    def quantile(self, column: str, share: float) -> Quantile | None:
        """Value below which a share of all flights stays, with its bounds at 95 %; ``None`` where the cases
        are too few to bound it.
        """
        return quantile(self[column].astype(float), share)

    def quantiles(self, column: str) -> list[Quantile]:
        """The quantiles that the cases can bound, of those from 0.13 % to 99.87 %."""
        found = (self.quantile(column, share) for share in SHARES)
        return [one for one in found if one is not None]

    def to_pandas(self) -> pandas.DataFrame:
        """The rows as a data frame indexed by case.

        Raises:
            ImportError: pandas is not installed.
        """
        columns = {name: self[name] for name in self.table.column_names}
        return library("pandas", "to_pandas").DataFrame(columns).set_index("case")

    def refly(self, case: int) -> Flight:
        """Fly a case again with all its telemetry; ``differences`` of the flight names what is not as its
        row.

        Raises:
            ConfigError: there is no such case, or it was flown by another program or other files.
        """
        from edl6dof.campaign.refly import differences, reflown

        flight = Flight.of(reflown(self.plan, case))
        flight.differences = tuple(
            differences(self.table, self.folder or "campaign", self.plan, case, flight)
        )
        return flight

    def __repr__(self) -> str:
        low, high = (100.0 * one for one in self.p_success_95)
        share = f"{100.0 * self.p_success:.1f} % ({low:.1f} to {high:.1f} %)"
        return f"<Campaign {self.summary.name}: {self.successes} of {self.cases} succeed, {share}>"

    def _repr_html_(self) -> str:
        """Success and causes, for notebooks."""
        rows = [(cause, str(count)) for cause, count in self.causes.items()]
        causes = html_table(("cause of failure", "cases"), rows) if rows else ""
        return f"<div><p>{repr(self)[1:-1]}</p>{causes}</div>"


def _array(column: Any) -> np.ndarray:
    """A column as an array; without arrow's own conversion, which loads pandas."""
    values = column.to_pylist()
    if pa.types.is_floating(column.type) or pa.types.is_integer(column.type):
        if None not in values:
            return np.array(values)
        return np.array([np.nan if value is None else value for value in values], dtype=float)
    return np.array(values)


def open_campaign(folder: str | Path) -> CampaignResult:
    """The result of a complete campaign, from its folder.

    Raises:
        ConfigError: the folder holds none, or it is not complete, or damaged.
    """
    store = Store(Path(folder))
    if store.info and not store.complete:  # reading it says whether there is a campaign
        raise refusal(folder, "is not complete; go on with edl6dof campaign FOLDER --resume")
    return CampaignResult(store.summary, store.table(), store.folder)


def fly_campaign(
    scenario: str | Path,
    overrides: Overrides,
    *,
    cases: int | None,
    seed: int | None,
    sampling: str | None,
    engine: EngineChoice,
    until: str | None,
    out: str | Path | None,
    force: bool,
    resume: bool,
    progress: Progress | None,
) -> CampaignResult:
    """Fly a campaign, or go on with one; see :func:`edl6dof.campaign`."""
    engine.check()
    if resume and lexists(Path(scenario) / "campaign.json"):
        return _resumed(Path(scenario), engine, progress)
    plan = load_plan(str(scenario), texts(overrides), cases, seed, sampling)
    check_until(until, plan)
    if resume:
        return _resumed(Path(out or Path("runs") / plan.name), engine, progress)
    return flown(plan, engine, until, out, force, progress)


def _resumed(folder: Path, engine: EngineChoice, progress: Progress | None) -> CampaignResult:
    go_on(Store(folder), engine, _watch(progress))
    return open_campaign(folder)


def flown(
    plan: Plan,
    engine: EngineChoice,
    until: str | None,
    out: str | Path | None,
    force: bool,
    progress: Progress | None,
) -> CampaignResult:
    """A plan flown into its folder, or for want of one into memory."""
    if out is not None:
        store = Store(Path(out))
        fly_new(plan, store, engine, until, force, _watch(progress))
        return CampaignResult(store.summary, store.table(), store.folder, plan)
    with tempfile.TemporaryDirectory(prefix="edl6dof-") as place:
        store = Store(Path(place) / plan.name)
        fly_new(plan, store, engine, until, False, _watch(progress))
        return CampaignResult(store.summary, store.table(), None, plan)


def _watch(progress: Progress | None) -> Watch:
    if progress is None:
        return unwatched
    told = progress

    @contextmanager
    def watch(total: int) -> Iterator[run.Report]:
        yield lambda tally: told(tally.flown, total)

    return watch


def listed(names: str | float | Iterable[str | float]) -> str:
    """Names, or times, as a text with commas."""
    return str(names) if isinstance(names, str | float | int) else ",".join(map(str, names))
