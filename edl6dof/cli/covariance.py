"""The command that forms covariance from a few dozen flights."""

from __future__ import annotations

import time
from dataclasses import replace
from os.path import lexists
from pathlib import Path
from typing import Annotated

from edl6dof.api.functions import activate
from edl6dof.cli.options import Sets, argument, flag, option
from edl6dof.config.errors import refusal

SUFFIXES = (".csv", ".png", ".pdf", ".svg")
#: Events before whose end no flight need go on beyond the deployment of the parachute.
ENDS_AT_DEPLOYMENT = ("parachute", "trim_wing")


def covariance(
    campaign: Annotated[
        str,
        argument(
            "CAMPAIGN",
            "Campaign file or name, tianwen1_mc if not given; or the folder of a finished "
            "campaign, to be held against it.",
        ),
    ] = "tianwen1_mc",
    at: Annotated[
        str, option("EVENT", "entry (its peaks), parachute, trim_wing, backshell or touchdown.")
    ] = "parachute",
    sets: Sets = None,
    pairs: Annotated[
        int, option("N", "Pairs of flights; more where there are more dispersions.", min=8, max=4096)
    ] = 24,
    each: Annotated[
        bool, flag("Step each dispersion alone, too: where is it linear, where not.", "--each")
    ] = False,
    seed: Annotated[int | None, option("N", "Seed of the steps; the campaign's if not given.", min=0)] = None,
    workers: Annotated[
        int | None, option("N", "Threads; as many as there are cores if not given.", min=1, max=1024)
    ] = None,
    out: Annotated[
        Path | None, option("FILE", "Write the error budget (.csv) or the ellipse (.png, .pdf, .svg).")
    ] = None,
    force: Annotated[bool, flag("Replace an existing file.", "--force")] = False,
) -> int:
    """Spread of an event, and what each dispersion gives to it.

    Every dispersion is a standard deviation high in half of the flights and low in their mirror images, all
    at once; a twentieth of the flights of a campaign gives its ellipse and its error budget.

    Exit status: 0 formed, 2 bad input or nothing could be written, 130 interrupted.
    """
    activate(campaign)
    from edl6dof.campaign.covariance.alone import fly_alone
    from edl6dof.campaign.covariance.events import figures_at
    from edl6dof.campaign.covariance.flights import ending_at_deployment
    from edl6dof.campaign.covariance.fly import fly_covariance
    from edl6dof.campaign.covariance.sampled import flown
    from edl6dof.campaign.design.plan import load_plan
    from edl6dof.campaign.run import resumed_plan
    from edl6dof.campaign.storage.files import refused
    from edl6dof.campaign.storage.store import Store
    from edl6dof.cli.covariance_tables import show, show_alone, write_budget
    from edl6dof.cli.progress import count_runs
    from edl6dof.runs.files import atomic_file, refuse_existing_file

    event = figures_at(at)
    if out is not None:
        if out.suffix not in SUFFIXES:
            raise refusal(out, f"must end in {', '.join(SUFFIXES)}")
        refuse_existing_file(out, force)
    folder, sampled = Path(campaign), None
    if not lexists(folder / "campaign.json"):
        plan = load_plan(campaign, tuple(sets or ()), seed=seed)
    elif sets:
        raise refused(folder, "has its plan; covariance beside it takes no other values")
    else:
        store = Store(folder)
        plan = resumed_plan(store)
        if seed is not None and plan.campaign is not None:
            plan = replace(plan, campaign=plan.campaign.model_copy(update={"seed": seed}))
        sampled = flown(store.table(list(event.all)), event, folder)
    if at in ENDS_AT_DEPLOYMENT:
        plan = ending_at_deployment(plan)
    with count_runs("covariance", quiet=False) as progress:
        began = time.perf_counter()
        found = fly_covariance(plan, event, pairs, workers, progress)
        took_s = time.perf_counter() - began
    show(plan.name, at, found, sampled, took_s)
    if each:
        show_alone(fly_alone(plan, event, workers), event)
    if out is not None:
        with atomic_file(out, force) as partial:
            if out.suffix == ".csv":
                write_budget(found, partial)
            else:
                from edl6dof.report.campaign.covariance import ellipse_figure
                from edl6dof.report.matplotlib_figure import write_figure

                write_figure(ellipse_figure(f"{plan.name}, {at}", found, sampled), partial)
        print(out)
    return 0
