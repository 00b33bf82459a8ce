"""A matrix of faults flown as a campaign, into the folder of one."""

from __future__ import annotations

from dataclasses import replace
from os.path import lexists
from pathlib import Path

from edl6dof.app import campaign_flight
from edl6dof.app.campaign import CampaignOptions
from edl6dof.app.compiling import announce_compiling
from edl6dof.app.faults.choice import matrix_of
from edl6dof.app.faults.command import Wanted
from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.fault_kinds import matrix_plan
from edl6dof.campaign.storage.store import Store
from edl6dof.config.base import stated
from edl6dof.config.errors import refusal
from edl6dof.scenario.loading import load_scenario


def fly_new(wanted: Wanted, options: CampaignOptions) -> int:
    """Fly a matrix from its first case; returns the exit status.

    Raises:
        ConfigError: everything that is wrong with what is wanted; or its folder must not be replaced.
    """
    plan, store = _plan(wanted, options)
    return campaign_flight.fly_plan(plan, store, options)


def go_on(wanted: Wanted, options: CampaignOptions) -> int:
    """Fly what is missing of a matrix, which its folder or the same words name; returns the exit status.

    Raises:
        ConfigError: the folder holds none, or another, or one of another program, or is damaged.
    """
    folder = Path(stated(options.scenario))
    if lexists(folder / "campaign.json"):
        if wanted != Wanted():
            raise refusal(folder, "has its plan; it takes no other values when it goes on")
        return campaign_flight.go_on(options)
    plan, store = _plan(wanted, options)
    campaign_flight.require_plan(store, plan, options)
    found = replace(options, scenario=str(store.folder), sets=(), cases=None, seed=None)
    return campaign_flight.go_on(found)


def _plan(wanted: Wanted, options: CampaignOptions) -> tuple[Plan, Store]:
    """The plan of what is wanted, and its folder."""
    scenario = stated(options.scenario)
    loaded = load_scenario(scenario, options.sets)
    announce_compiling(not options.as_json)
    matrix = matrix_of(wanted, loaded)
    plan = matrix_plan(scenario, matrix, options.sets, options.cases, options.seed)
    what = "sensor-faults" if wanted.sensors else "faults"
    return plan, Store(options.out or Path("runs") / f"{what}-{plan.name}")
