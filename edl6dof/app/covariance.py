"""``edl6dof covariance``."""

from __future__ import annotations

import time
from dataclasses import dataclass
from os.path import lexists
from pathlib import Path

from edl6dof.app.counting import count_runs
from edl6dof.app.covariance_show import show, write_budget
from edl6dof.campaign.covariance.events import figures_at
from edl6dof.campaign.covariance.fly import ending_at_deployment, fly_covariance
from edl6dof.campaign.covariance.sampled import flown
from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.run import resumed_plan
from edl6dof.campaign.storage.files import refused
from edl6dof.campaign.storage.store import Store
from edl6dof.config.errors import refusal
from edl6dof.runs.files import atomic_file, refuse_existing_file

SUFFIXES = (".csv",)


@dataclass(frozen=True)
class CovarianceOptions:
    """Options of ``edl6dof covariance``."""

    campaign: str
    at: str
    sets: tuple[str, ...]
    pairs: int
    seed: int | None
    workers: int | None
    out: Path | None
    force: bool


def run_covariance(options: CovarianceOptions) -> int:
    """Fly the pairs, show what they gave, write the file asked for; returns the exit status."""
    event = figures_at(options.at)
    if (target := options.out) is not None:
        if target.suffix not in SUFFIXES:
            raise refusal(target, f"must end in {', '.join(SUFFIXES)}")
        refuse_existing_file(target, options.force)
    folder = Path(options.campaign)
    store = Store(folder) if lexists(folder / "campaign.json") else None
    if store is not None and (options.sets or options.seed is not None):
        raise refused(folder, "has its plan; covariance beside it takes no other values")
    plan = (
        resumed_plan(store)
        if store is not None
        else load_plan(options.campaign, options.sets, seed=options.seed)
    )
    sampled = None if store is None else flown(store.table(list(event.all)), event, folder)
    if options.at == "parachute":
        plan = ending_at_deployment(plan)
    flights = 2 * options.pairs
    with count_runs("covariance", quiet=False) as report:
        began = time.perf_counter()
        found = fly_covariance(
            plan, event, options.pairs, options.workers, lambda done, _: report(done, flights)
        )
        took_s = time.perf_counter() - began
    show(plan.name, options.at, found, sampled, took_s)
    if target is not None:
        with atomic_file(target, options.force) as partial:
            write_budget(found, partial)
        print(target)
    return 0
