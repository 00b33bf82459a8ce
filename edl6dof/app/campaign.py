"""``edl6dof campaign`` and ``edl6dof refly``.

Heavy modules are imported inside: an interruption while they load must end like one later on.
"""

from __future__ import annotations

import shlex
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from edl6dof.app.exit_status import INTERRUPTED
from edl6dof.config.base import stated
from edl6dof.config.errors import ConfigError, Problem

if TYPE_CHECKING:
    from edl6dof.api.campaign_flight import EngineChoice


@dataclass(frozen=True)
class CampaignOptions:
    """Options of ``edl6dof campaign``, and of what is flown like one; ``command`` goes on with it."""

    scenario: str | None
    sets: tuple[str, ...]
    cases: int | None
    seed: int | None
    engine: str
    cluster: str | None
    workers: int | None
    out: Path | None
    force: bool
    resume: bool
    until: str | None
    quiet: bool
    as_json: bool
    command: str = "campaign"
    sampling: str | None = None


def run_campaign(options: CampaignOptions) -> int:
    """Fly a campaign, or go on with one; returns the exit status."""
    try:
        _check(options)
        from edl6dof.app.campaign_flight import fly_new, go_on

        return go_on(options) if options.resume else fly_new(options)
    except KeyboardInterrupt:
        if not options.resume:
            raise  # nothing was written
        return go_on_later(options)


def go_on_later(options: CampaignOptions) -> int:
    """Say how to go on with a campaign that was interrupted; returns the exit status."""
    place = [stated(options.scenario), *(["--out", str(options.out)] if options.out else [])]
    print(
        "interrupted; what has flown is kept; go on with: "
        f"edl6dof {options.command} {shlex.join(place)} --resume",
        file=sys.stderr,
    )
    return INTERRUPTED


def _check(options: CampaignOptions) -> None:
    if options.scenario is None:
        raise problem(
            "edl6dof campaign",
            "name a campaign file, such as tianwen1_mc, or with --resume the folder of a campaign",
        )
    engine_of(options).check()


def engine_of(options: CampaignOptions) -> EngineChoice:
    """What flies."""
    from edl6dof.api.campaign_flight import EngineChoice

    return EngineChoice(options.engine, options.workers, options.cluster)


def run_refly(folder: Path, number: int, out: Path | None, force: bool, replay: bool) -> int:
    """Fly one case again with all its telemetry, and compare it with its row; returns the exit status."""
    from edl6dof.api.run_files import write_files
    from edl6dof.campaign.refly import differences, reflown
    from edl6dof.campaign.run import resumed_plan
    from edl6dof.campaign.storage.store import Store
    from edl6dof.runs.folder import atomic_folder, default_folder

    target = out or default_folder(f"{folder.resolve().name}_case{number}", force)
    store = Store(folder)
    plan = resumed_plan(store)
    with atomic_folder(target, "flight", force) as partial:
        flight = reflown(plan, number)
        wrong = differences(store.table(), folder, plan, number, flight)
        write_files(flight, partial, replay, release=True)
    print(f"{target}: case {number}, {flight.outcome}")
    if not wrong:
        print("identical to its row")
        return 0
    print(f"differs from its row: {', '.join(wrong)}")
    print(
        "program, files and libraries are those of the campaign; check this machine: edl6dof verify --golden"
    )
    return 1


def problem(place: str, message: str) -> ConfigError:
    """The error of an option or an argument."""
    return ConfigError([Problem(place, 0, 0, "", message)])
