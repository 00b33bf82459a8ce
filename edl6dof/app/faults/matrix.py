"""``edl6dof faults``: a matrix of faults is flown as a campaign, and its folder is that of one."""

from __future__ import annotations

from dataclasses import replace
from os.path import lexists
from pathlib import Path

from edl6dof.app.campaign import CampaignOptions, go_on_later
from edl6dof.app.campaign_flight import fly_plan, go_on, require_plan
from edl6dof.app.compiling import announce_compiling
from edl6dof.app.faults.choice import Wanted, matrix_of
from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.faults import matrix_plan
from edl6dof.campaign.storage.files import refused
from edl6dof.campaign.storage.store import Store
from edl6dof.config.base import stated
from edl6dof.scenario.schema import load_scenario


def run_faults(wanted: Wanted, options: CampaignOptions) -> int:
    """Fly a matrix of faults, or go on with one; returns the exit status."""
    if not options.resume:
        plan, store = _plan(wanted, options)
        return fly_plan(plan, store, options)
    try:
        return _go_on(wanted, options)
    except KeyboardInterrupt:
        return go_on_later(options)


def _plan(wanted: Wanted, options: CampaignOptions) -> tuple[Plan, Store]:
    """The plan of what is wanted, and its folder."""
    scenario = stated(options.scenario)
    loaded = load_scenario(scenario, options.sets)
    announce_compiling(not options.as_json)
    matrix = matrix_of(wanted, loaded)
    plan = matrix_plan(scenario, matrix, options.sets, options.cases, options.seed)
    what = "sensor-faults" if wanted.sensors else "faults"
    return plan, Store(options.out or Path("runs") / f"{what}-{plan.name}")


def _go_on(wanted: Wanted, options: CampaignOptions) -> int:
    """Fly what is missing of a matrix, which its folder or the same words name."""
    folder = Path(stated(options.scenario))
    if lexists(folder / "campaign.json"):
        if wanted != Wanted():
            raise refused(folder, "has its plan; it takes no other values when it goes on")
        return go_on(options)
    plan, store = _plan(wanted, options)
    require_plan(store, plan, options)
    return go_on(replace(options, scenario=str(store.folder), sets=(), cases=None, seed=None))
