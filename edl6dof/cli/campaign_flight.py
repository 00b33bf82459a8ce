"""Fly a campaign into its folder, with its progress on standard error, and show what it came to."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from rich.progress import TextColumn

from edl6dof.api.campaign import EngineChoice, Watch, fly_new
from edl6dof.api.campaign import go_on as go_on_with
from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.run import Report, Tally
from edl6dof.campaign.store import Store
from edl6dof.cli.campaign_tables import show
from edl6dof.cli.exit_status import INTERRUPTED, refuse
from edl6dof.cli.fault_tables import show_matrix
from edl6dof.cli.progress import count_runs
from edl6dof.config.errors import ConfigError, refusal


def fly_plan(
    plan: Plan,
    store: Store,
    engine: EngineChoice,
    *,
    command: str = "campaign",
    until: str | None = None,
    force: bool = False,
    quiet: bool = False,
    as_json: bool = False,
) -> int:
    """Fly a plan from its first case; returns the exit status.

    Raises:
        ConfigError: there is something in the folder that the plan must not replace.
    """
    try:
        fly_new(plan, store, engine, until, force, _watch(quiet or as_json))
        return _show(plan, store, quiet, as_json)
    except KeyboardInterrupt:
        print(f"interrupted; {_standing(store, plan, command)}", file=sys.stderr)
        return INTERRUPTED
    except OSError as error:
        return refuse(f"{_reason(store, error)}; {_standing(store, plan, command)}")


def go_on(
    store: Store,
    engine: EngineChoice,
    *,
    command: str = "campaign",
    quiet: bool = False,
    as_json: bool = False,
) -> int:
    """Fly what is missing of a campaign; returns the exit status.

    Raises:
        ConfigError: the folder holds none, or one of another program, or is damaged.
    """
    try:
        return _show(go_on_with(store, engine, _watch(quiet or as_json)), store, quiet, as_json)
    except OSError as error:
        return refuse(f"{_reason(store, error)}; {_going_on(store, command)}")


def require_plan(store: Store, plan: Plan, command: str = "campaign") -> None:
    """See that a folder was begun with this plan.

    Raises:
        ConfigError: it holds no campaign, or one of another plan.
    """
    if plan.text != store.plan_text:
        how = f"go on with it by: edl6dof {command} {store.folder} --resume"
        raise refusal(store.folder, f"was begun with another plan; {how}")


def require_no_values(folder: Path, *values: object) -> None:
    """See that nothing else is asked of a campaign that goes on.

    Raises:
        ConfigError: one of the values is given.
    """
    if any(not (value is None or value is False or value in ("", ())) for value in values):
        raise refusal(folder, "has its plan; it takes no other values when it goes on")


def _reason(store: Store, error: OSError) -> str:
    return f"{error.filename2 or error.filename or store.folder}: {error.strerror or error}"


def _going_on(store: Store, command: str) -> str:
    return f"what has flown is kept; go on with: edl6dof {command} {store.folder} --resume"


def _standing(store: Store, plan: Plan, command: str) -> str:
    """Say what has become of a new campaign that was stopped."""
    if store.is_half_begun:
        return f"{store.folder} was being begun or replaced; begin it anew with --force"
    with suppress(ConfigError):
        if store.plan_text == plan.text:
            return _going_on(store, command)
    return "nothing was written"


def _show(plan: Plan, store: Store, quiet: bool, as_json: bool) -> int:
    if plan.fault_matrix is not None:
        return show_matrix(store, as_json)
    show(store, quiet, as_json)
    return 0


def _watch(silent: bool) -> Watch:
    """Show progress and success so far; a line at every tenth where stderr is no terminal."""

    @contextmanager
    def watch(total: int) -> Iterator[Report]:
        with count_runs("campaign", silent, TextColumn("{task.fields[words]}")) as count:
            lines = not silent and not sys.stderr.isatty()
            tenth = 0

            def report(tally: Tally) -> None:
                nonlocal tenth
                words = f"{tally.rate:.1f}/s, success {tally.success}"
                count(tally.flown, tally.total, words)
                if lines and 10 * tally.flown // tally.total > tenth:
                    tenth = 10 * tally.flown // tally.total
                    print(f"{tally.flown} of {tally.total}, {words}", file=sys.stderr, flush=True)

            yield report

    return watch
