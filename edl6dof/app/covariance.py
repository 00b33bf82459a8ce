"""``edl6dof covariance``."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from os.path import lexists
from pathlib import Path

import numpy as np

from edl6dof.app.counting import count_runs
from edl6dof.app.covariance_show import show, show_alone, write_budget
from edl6dof.campaign.covariance.event_figures import EventFigures, ending_at_deployment, figures_at
from edl6dof.campaign.covariance.mirrored_pairs import fly_covariance
from edl6dof.campaign.covariance.one_at_a_time import fly_alone
from edl6dof.campaign.covariance.sample_covariance import flown
from edl6dof.campaign.design.plan import Plan, load_plan
from edl6dof.campaign.run import resumed_plan
from edl6dof.campaign.storage.store import Store
from edl6dof.config.errors import refusal
from edl6dof.runs.files import atomic_file, refuse_existing_file

SUFFIXES = (".csv", ".png", ".pdf", ".svg")
#: Events before whose end no flight need go on beyond the deployment of the parachute.
ENDS_AT_DEPLOYMENT = ("parachute", "trim_wing")


@dataclass(frozen=True)
class CovarianceOptions:
    """Options of ``edl6dof covariance``."""

    campaign: str
    at: str
    sets: tuple[str, ...]
    pairs: int
    each: bool
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
    plan, sampled = _given(options, event)
    if options.at in ENDS_AT_DEPLOYMENT:
        plan = ending_at_deployment(plan)
    with count_runs("covariance", quiet=False) as report:
        began = time.perf_counter()
        found = fly_covariance(plan, event, options.pairs, options.workers, report)
        took_s = time.perf_counter() - began
    show(plan.name, options.at, found, sampled, took_s)
    if options.each:
        show_alone(fly_alone(plan, event, options.workers), event)
    if target is not None:
        with atomic_file(target, options.force) as partial:
            if target.suffix == ".csv":
                write_budget(found, partial)
            else:
                from edl6dof.report.campaign.covariance import ellipse_figure
                from edl6dof.report.matplotlib_figure import write_figure

                write_figure(ellipse_figure(f"{plan.name}, {options.at}", found, sampled), partial)
        print(target)
    return 0


def _given(options: CovarianceOptions, event: EventFigures) -> tuple[Plan, np.ndarray | None]:
    """The plan of a campaign; of a finished one with the figures of its flights.

    Raises:
        ConfigError: it is wrong, or was flown with another program.
    """
    folder = Path(options.campaign)
    if not lexists(folder / "campaign.json"):
        return load_plan(options.campaign, options.sets, seed=options.seed), None
    if options.sets:
        raise refusal(folder, "has its plan; covariance beside it takes no other values")
    store = Store(folder)
    plan = resumed_plan(store)
    if options.seed is not None and plan.campaign is not None:
        plan = replace(plan, campaign=plan.campaign.model_copy(update={"seed": options.seed}))
    return plan, flown(store.table(list(event.all)), event, folder)
