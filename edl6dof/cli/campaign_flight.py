"""Fly a campaign into its folder, with progress on standard error, and print its result."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.progress import TextColumn
from rich.table import Table

from edl6dof.api.campaign import EngineChoice, Watch, fly_new, go_on
from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.run import Report, Tally
from edl6dof.campaign.statistics import SHARES, flights_needed, quantile
from edl6dof.campaign.store import Store
from edl6dof.cli.exit_status import INTERRUPTED, refuse
from edl6dof.cli.fault_tables import show_matrix
from edl6dof.cli.progress import count_runs
from edl6dof.config.errors import ConfigError, refusal
from edl6dof.metrics.figures import LIMITS
from edl6dof.report.campaign.campaign_results import Results
from edl6dof.report.campaign.margins import head, in_words, note, shown_shares
from edl6dof.report.document import significant
from edl6dof.report.terminal import open_table


def fly_campaign(
    store: Store,
    engine: EngineChoice,
    plan: Plan | None = None,
    *,
    command: str = "campaign",
    until: str | None = None,
    force: bool = False,
    quiet: bool = False,
    as_json: bool = False,
) -> int:
    """Fly a plan from its first case, or without a plan the missing cases of the campaign in the folder;
    print the result and return the exit status.

    Raises:
        ConfigError: the folder holds what the plan must not replace, or no campaign of this program.
        KeyboardInterrupt: the campaign was interrupted while it ran.
    """
    watch = _watch(quiet or as_json)
    try:
        if plan is None:
            flown = go_on(store, engine, watch)
        else:
            fly_new(plan, store, engine, until, force, watch)
            flown = plan
        if flown.fault_matrix is not None:
            return show_matrix(store, as_json)
        show(store, quiet, as_json)
        return 0
    except KeyboardInterrupt:
        if plan is None:
            raise
        print(f"interrupted; {_standing(store, plan, command)}", file=sys.stderr)
        return INTERRUPTED
    except OSError as error:
        reason = f"{error.filename2 or error.filename or store.folder}: {error.strerror or error}"
        return refuse(f"{reason}; {_standing(store, plan, command)}")


def require_plan(store: Store, plan: Plan, command: str = "campaign") -> None:
    """Check that the campaign in a folder was started with this plan.

    Raises:
        ConfigError: it holds no campaign, or one of another plan.
    """
    if plan.text != store.plan_text:
        how = f"go on with it by: edl6dof {command} {store.folder} --resume"
        raise refusal(store.folder, f"was begun with another plan; {how}")


def require_no_values(folder: Path, *values: object) -> None:
    """Refuse options that would change a campaign that is resumed.

    Raises:
        ConfigError: one of the values is given.
    """
    if any(not (value is None or value is False or value in ("", ())) for value in values):
        raise refusal(folder, "has its plan; it accepts no other values when it is resumed")


def _standing(store: Store, plan: Plan | None, command: str) -> str:
    """Say what is left of a campaign that was stopped: a new one of a ``plan``, or one that went on."""
    kept = f"what has flown is kept; go on with: edl6dof {command} {store.folder} --resume"
    if plan is None:
        return kept
    if store.is_half_begun:
        return f"{store.folder} was being begun or replaced; begin it anew with --force"
    with suppress(ConfigError):
        if store.plan_text == plan.text:
            return kept
    return "nothing was written"


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


def show(store: Store, quiet: bool, as_json: bool) -> None:
    """Print how a complete campaign ended.

    Raises:
        ConfigError: its table or its summary is not as it was written.
    """
    summary = store.summary
    results = Results(store.folder, [figure.name for figure in LIMITS])
    if as_json:
        print(json.dumps({**summary.model_dump(mode="json"), "figures": figures(results)}, indent=1))
        return
    console = Console(highlight=False, soft_wrap=True)
    success = results.success
    style = "bold green" if success.value >= 0.99 else "bold yellow"
    share = f", {success}" if results.is_sample else ""
    console.print(
        f"[{style}]{escape(summary.name)}: {success.successes} of {success.trials} succeed{share}[/]"
    )
    if quiet:
        return
    for cause in summary.causes:
        console.print(f"  {cause.cases:>6}  {cause.cause}", markup=False)
    if results.limits:
        console.print(limits_table(results))
        console.print(note(results), style="dim")
    if results.has_design:
        told = f"{success.trials} of {summary.cases} flights are independent of each other and count above"
        console.print(f"{told}; the report tells the Sobol indices", markup=False)
    if summary.cases < summary.cases_planned:
        console.print(
            f"stopped after {summary.cases} of {summary.cases_planned} cases: the interval is narrow enough"
        )
    if summary.flown_in_this_run:
        console.print(
            f"{summary.flights_per_second:.1f} flights per second on {summary.engine}", markup=False
        )
    again = f"edl6dof refly {store.folder} CASE (or --worst FIGURE)"
    console.print(f"next: edl6dof report {store.folder}, {again}", markup=False)


def limits_table(results: Results) -> Table:
    """Return the outermost quantile, with its bounds, of every figure that has a limit, and the limit."""
    shares = shown_shares(results)[-1:]
    bounds = " (bounds at 95 %)" if results.is_sample else ""
    heads = [f"{head(share)}{bounds}>" for share in shares]
    table = open_table("Limits", "figure", "unit", *heads, "limit>", "missed>")
    for figure, label, limit, unit in results.limits:
        values = results[figure]
        cells = [in_words(results, values, share) for share in shares]
        table.add_row(label, unit, *cells, significant(limit), str(int((values > limit).sum())))
    return table


def figures(results: Results) -> dict[str, Any]:
    """Every figure with a limit, for JSON: quantiles with 95 % bounds, or how many flights they need."""
    found = {}
    for figure, label, limit, unit in results.limits:
        values = results[figure]
        known = {share: quantile(values, share) for share in SHARES if results.is_sample}
        found[figure] = {
            "meaning": label,
            "unit": unit,
            "limit": limit,
            "missed": int((values > limit).sum()),
            "quantiles": [asdict(one) for one in known.values() if one is not None],
            "flights_needed": {
                f"{share:g}": flights_needed(share) for share, one in known.items() if one is None
            },
        }
    return found
