"""A campaign flown into its folder, with its progress on standard error."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from os.path import lexists
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from edl6dof.api.campaign_flight import Watch, check_until
from edl6dof.api.campaign_flight import fly_new as fly_campaign
from edl6dof.api.campaign_flight import go_on as go_on_with
from edl6dof.app.campaign import CampaignOptions, engine_of
from edl6dof.app.campaign_show import show
from edl6dof.app.compiling import announce_compiling
from edl6dof.app.exit_status import INTERRUPTED, refuse
from edl6dof.campaign import run
from edl6dof.campaign.design.plan import Plan, load_plan
from edl6dof.campaign.storage.store import Store
from edl6dof.config.base import stated
from edl6dof.config.errors import ConfigError, refusal


def fly_new(options: CampaignOptions) -> int:
    """Fly a campaign from its first case; returns the exit status.

    Raises:
        ConfigError: the campaign is wrong, or there is something in its folder that it must not replace.
    """
    plan = _plan(options)
    check_until(options.until, plan)
    return fly_plan(plan, Store(options.out or Path("runs") / plan.name), options)


def fly_plan(plan: Plan, store: Store, options: CampaignOptions) -> int:
    """Fly a plan from its first case; returns the exit status.

    Raises:
        ConfigError: there is something in the folder that the plan must not replace.
    """
    try:
        fly_campaign(plan, store, engine_of(options), options.until, options.force, _watch(options))
        return _shown(plan, store, options)
    except KeyboardInterrupt:
        print(f"interrupted; {_standing(store, plan, options)}", file=sys.stderr)
        return INTERRUPTED
    except OSError as error:
        return refuse(f"{_reason(store, error)}; {_standing(store, plan, options)}")


def go_on(options: CampaignOptions) -> int:
    """Fly what is missing of a campaign; returns the exit status.

    Raises:
        ConfigError: the folder holds none, or one of another program, or is damaged.
    """
    check_until(options.until)
    store = Store(_folder(options))
    try:
        plan = go_on_with(store, engine_of(options), _watch(options))
        return _shown(plan, store, options)
    except OSError as error:
        return refuse(f"{_reason(store, error)}; {_going_on(store, options)}")


def _reason(store: Store, error: OSError) -> str:
    return f"{error.filename2 or error.filename or store.folder}: {error.strerror or error}"


def _going_on(store: Store, options: CampaignOptions) -> str:
    return f"what has flown is kept; go on with: edl6dof {options.command} {store.folder} --resume"


def _standing(store: Store, plan: Plan, options: CampaignOptions) -> str:
    """What has become of a new campaign that was stopped."""
    if store.is_half_begun:
        return f"{store.folder} was being begun or replaced; begin it anew with --force"
    with suppress(ConfigError):
        if store.plan_text == plan.text:
            return _going_on(store, options)
    return "nothing was written"


def _plan(options: CampaignOptions) -> Plan:
    return load_plan(stated(options.scenario), options.sets, options.cases, options.seed, options.sampling)


def _folder(options: CampaignOptions) -> Path:
    """The folder of a campaign, which its file may stand for."""
    folder = Path(stated(options.scenario))
    if not lexists(folder / "campaign.json") and not folder.is_dir():
        given = _plan(options)
        folder = options.out or Path("runs") / given.name
        require_plan(Store(folder), given, options)
    elif options.sets or any(given is not None for given in (options.cases, options.seed, options.sampling)):
        raise refusal(folder, "has its plan; it takes no other values when it goes on")
    return folder


def require_plan(store: Store, plan: Plan, options: CampaignOptions) -> None:
    """See that a folder was begun with this plan.

    Raises:
        ConfigError: it holds no campaign, or one of another plan.
    """
    if plan.text != store.plan_text:
        raise refusal(
            store.folder,
            "was begun with another plan; go on with it by: "
            f"edl6dof {options.command} {store.folder} --resume",
        )


def _shown(plan: Plan, store: Store, options: CampaignOptions) -> int:
    """What a complete campaign came to; returns the exit status."""
    if plan.fault_matrix is not None:
        from edl6dof.app.faults.show import show_matrix

        return show_matrix(store, options)
    show(store, options)
    return 0


def _watch(options: CampaignOptions) -> Watch:
    """Says that the simulator has to be compiled, if it has, and shows the progress."""
    talk = not (options.quiet or options.as_json)

    @contextmanager
    def watch(total: int) -> Iterator[run.Report | None]:
        announce_compiling(talk)
        with _progress(talk, total) as report:
            yield report

    return watch


@contextmanager
def _progress(talk: bool, total: int) -> Iterator[run.Report | None]:
    """Progress with rate, time left, and success so far, on stderr; a line at every tenth where that is no
    terminal.
    """
    console = Console(stderr=True)
    if not talk:
        yield None
        return
    if not console.is_terminal:
        yield _lines()
        return
    columns = (
        BarColumn(bar_width=24),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]:6.1f}/s"),
        TimeRemainingColumn(),
        TextColumn("success {task.fields[success]}"),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("fly", total=total, rate=0.0, success="")
        yield lambda tally: bar.update(
            task, completed=tally.flown, rate=tally.rate, success=str(tally.success)
        )


def _lines() -> run.Report:
    shown = [0]

    def report(tally: run.Tally) -> None:
        tenth = 10 * tally.flown // tally.total
        if tenth > shown[0]:
            shown[0] = tenth
            print(
                f"{tally.flown} of {tally.total}, {tally.rate:.1f}/s, success {tally.success}",
                file=sys.stderr,
                flush=True,
            )

    return report
