"""Fly a campaign into its folder: begin, go on, stop early, finish."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pyarrow.parquet as pq

import edl6dof
from edl6dof.campaign.engines import Engine
from edl6dof.campaign.origin import plugin_complaint, plugin_hashes, source_hash
from edl6dof.campaign.plan import Plan, parse_plan
from edl6dof.campaign.rows import table_of
from edl6dof.campaign.statistics import Proportion, Until
from edl6dof.campaign.store import PART, Store, StoreError


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


def begin(plan: Plan, store: Store, until: str | None) -> None:
    """Make the folder of a new campaign.

    Raises:
        StoreError: there is something already.
    """
    sources = {"edl6dof_version": edl6dof.__version__, "source": source_hash(), "plugins": plugin_hashes()}
    store.begin(plan.text, {**sources, "cases": plan.count, "part": PART, "until": until})


def resumed_plan(store: Store) -> Plan:
    """The plan of a campaign that was begun earlier.

    Raises:
        StoreError: it was begun with other sources or plugins: rows of two programs would stand in one table.
    """
    info = store.info
    if complaint := plugin_complaint(info.get("plugins", {})):
        raise StoreError(f"{store.folder} was begun {complaint}")
    if info["source"] != source_hash():
        raise StoreError(f"{store.folder} was begun with other sources of edl6dof ({info['edl6dof_version']}); begin anew with --force")
    return parse_plan(store.plan_text, str(store.folder / "campaign.yaml"))


def fly(plan: Plan, store: Store, engine: Engine, report: Report | None = None) -> Tally:
    """Fly every case that is missing, put the table together and return how it ended."""
    until = Until.parse(text) if (text := store.info["until"]) else None
    ranges = [(first, min(first + PART, plan.count)) for first in range(0, plan.count, PART)]
    tally, done = Tally(plan.count), 0
    missing = {k for k, (first, last) in enumerate(ranges) if not store.has_part(k, first, last)}
    flown = engine.rows(plan, (ranges[k] for k in sorted(missing)))
    for index, (_, last) in enumerate(ranges):
        if index in missing:
            rows = next(flown)
            store.write_part(index, table_of(rows))
            successes, here = sum(row["success"] for row in rows), len(rows)
        else:
            successes, here = int(np.sum(pq.read_table(store.part(index), columns=["success"])["success"].to_numpy())), 0
        tally.flown, tally.successes, tally.here, done = last, tally.successes + successes, tally.here + here, index + 1
        if report is not None:
            report(tally)
        if until is not None and until.reached(tally.success):
            break
    if hasattr(flown, "close"):
        flown.close()
    store.finish(done, summary(plan, tally, store, str(engine)))
    return tally


def summary(plan: Plan, tally: Tally, store: Store, engine: str) -> dict[str, Any]:
    """Outcome of a campaign, ready for JSON."""
    low, high = tally.success.interval
    return {
        "name": plan.name,
        "kind": "campaign",
        "cases": tally.flown,
        "cases_planned": plan.count,
        "successes": tally.successes,
        "p_success": tally.success.value,
        "p_success_95": [low, high],
        "causes": causes(store),
        "edl6dof_version": edl6dof.__version__,
        "engine": engine,
        "flown_in_this_run": tally.here,
        "flights_per_second": tally.rate,
    }


def causes(store: Store) -> list[dict[str, Any]]:
    """Causes of failures with the number of cases, the most frequent first."""
    counted: Counter[str] = Counter()
    for cause in _columns(store, "cause"):
        counted[cause] += 1
    counted.pop("", None)
    return [{"cause": cause, "cases": number} for cause, number in counted.most_common()]


def _columns(store: Store, name: str) -> Iterator[str]:
    yield from store.table([name])[name].to_pylist()
