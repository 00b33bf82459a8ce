"""Fly a campaign into its folder, with progress on standard error, and print its result."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict
from typing import Any

from rich.console import Console
from rich.progress import TextColumn
from rich.table import Table
from rich.text import Text

from edl6dof.api.campaign import Job
from edl6dof.api.progress import count_runs
from edl6dof.api.reports import report_of, write_page
from edl6dof.campaign.executor import Row
from edl6dof.campaign.faults import EFFECTS, can_be_known, is_right
from edl6dof.campaign.run import Report, Tally
from edl6dof.campaign.statistics import SHARES, flights_needed, quantile
from edl6dof.campaign.store import Store
from edl6dof.cli.group import INTERRUPTED, NOT_WITHIN_LIMITS, refuse
from edl6dof.config.base import stated
from edl6dof.config.dump import json_text
from edl6dof.config.errors import ConfigError
from edl6dof.config.wording import counted
from edl6dof.metrics.figures import LIMITS
from edl6dof.report.campaign.campaign_results import Results
from edl6dof.report.campaign.margins import allowed, head, in_words, note, shown_shares
from edl6dof.report.terminal import open_table


def fly_campaign(job: Job, *, command: str = "campaign", quiet: bool = False, as_json: bool = False) -> int:
    """Fly a campaign, print the result and return the exit status.

    Raises:
        ConfigError: the folder contains files that must not be replaced, or (to resume) no campaign.
        KeyboardInterrupt: a resumed campaign was interrupted.
    """
    silent = quiet or as_json
    try:
        with count_runs("campaign", silent, TextColumn("{task.fields[words]}")) as count:
            plan = job.fly(_report(count, lines=not silent and not sys.stderr.isatty()))
        if plan.fault_matrix is not None:
            return show_matrix(job.store, as_json)
        show(job.store, quiet, as_json)
        return 0
    except KeyboardInterrupt:
        if job.plan is None:
            raise
        print(f"interrupted; {_standing(job, command)}", file=sys.stderr)
        return INTERRUPTED
    except OSError as error:
        reason = f"{error.filename2 or error.filename or job.store.folder}: {error.strerror or error}"
        return refuse(f"{reason}; {_standing(job, command)}")


def _standing(job: Job, command: str) -> str:
    """Text on the files that a stopped campaign left, and on how to resume it."""
    store, plan = job.store, job.plan
    kept = f"what has flown is kept; go on with: edl6dof {command} {store.folder} --resume"
    if plan is None:
        return kept
    if store.is_half_begun:
        return f"{store.folder} was being begun or replaced; begin it anew with --force"
    with suppress(ConfigError):
        if store.plan_text == plan.text:
            return kept
    return "nothing was written"


def _report(count: Callable[..., None], lines: bool) -> Report:
    """Return a function that shows progress and success; with ``lines`` it prints a line at each tenth."""
    tenth = 0

    def report(tally: Tally) -> None:
        nonlocal tenth
        words = f"{tally.rate:.1f}/s, success {tally.success}"
        count(tally.flown, tally.total, words)
        if lines and 10 * tally.flown // tally.total > tenth:
            tenth = 10 * tally.flown // tally.total
            print(f"{tally.flown} of {tally.total}, {words}", file=sys.stderr, flush=True)

    return report


def show(store: Store, quiet: bool, as_json: bool) -> None:
    """Print the result of a complete campaign."""
    summary = store.summary
    results = Results(store.folder, [figure.name for figure in LIMITS])
    if as_json:
        print(json.dumps({**summary.model_dump(mode="json"), "figures": figures(results)}, indent=1))
        return
    console = Console(highlight=False, soft_wrap=True)
    success = results.success
    style = "bold green" if success.value >= 0.99 else "bold yellow"
    share = f", {success}" if results.is_sample else ""
    words = f"{summary.name}: {success.successes} of {success.trials} succeed{share}"
    console.print(words, style=style, markup=False)
    if quiet:
        return
    for cause in summary.causes:
        print(f"  {cause.cases:>6}  {cause.cause}")
    if results.limits:
        console.print(limits_table(results))
        console.print(note(results), style="dim")
    if results.has_design:
        independent = f"{success.trials} of {summary.cases} flights are independent of each other"
        print(f"{independent} and count above; the report contains the Sobol indices")
    if summary.cases < summary.cases_planned:
        counts = f"{summary.cases} of {summary.cases_planned} cases"
        print(f"stopped after {counts}: the interval is narrow enough")
    if summary.flown_in_this_run:
        print(f"{summary.flights_per_second:.1f} flights per second on {summary.engine}")
    judged = f"edl6dof assure {store.folder}, " if results.is_sample else ""
    again = f"edl6dof refly {store.folder} CASE (or --worst FIGURE)"
    print(f"next: edl6dof report {store.folder}, {judged}{again}")


def limits_table(results: Results) -> Table:
    """Return the outermost quantile, with its bounds, of every figure that has a limit, and the limit."""
    shares = shown_shares(results)[-1:]
    bounds = " (bounds at 95 %)" if results.is_sample else ""
    heads = [f"{head(share)}{bounds}>" for share in shares]
    table = open_table("Limits", "figure", "unit", *heads, "limit>", "missed>")
    for figure, limit in results.limits:
        values = results[figure.name]
        cells = [in_words(results, values, figure.toward_limit(share)) for share in shares]
        missed = str(int(figure.violates(values, limit).sum()))
        table.add_row(figure.meaning, figure.unit.label, *cells, allowed(figure, limit), missed)
    return table


def figures(results: Results) -> dict[str, Any]:
    """Every figure with a limit, for JSON: quantiles with 95 % bounds, or how many flights they need."""
    found = {}
    for figure, limit in results.limits:
        values = results[figure.name]
        known = {share: quantile(values, share) for share in SHARES if results.is_sample}
        found[figure.name] = {
            "meaning": figure.meaning,
            "unit": figure.unit.label,
            "limit": limit,
            "missed": int(figure.violates(values, limit).sum()),
            "quantiles": [asdict(one) for one in known.values() if one is not None],
            "flights_needed": {f"{share:g}": flights_needed(share) for share in known if not known[share]},
        }
    return found


#: Most moments, components, and lines of one kind that are printed; more are left to the report.
_COLUMNS, _ROWS, _LINES = 10, 40, 20
#: Characters of a line if there is no terminal.
_WIDTH = 120
_LEGEND = """\
matrix: s from first use to the right isolation; a name: what was named instead;
?: in use, and not named; -: not used after the fault, so nobody can know;
x: not within limits
tables: right names and kinds are shares of the flights in which the fault can
be known; times are to the right isolation, and first use may be a leak"""


def show_matrix(store: Store, as_json: bool) -> int:
    """Print the result of a complete matrix of faults and write its report; return the exit status."""
    rows = store.table().to_pylist()
    figures = stated(store.summary.faults)
    if not (page := store.folder / "report.html").exists():
        write_page(report_of(store.folder), page, False, store.folder)
    if as_json:
        print(json_text({**figures, "rows": rows}), end="")
    else:
        width = None if sys.stdout.isatty() else _WIDTH
        _print(Console(highlight=False, soft_wrap=True, width=width), rows, figures)
        print(f"{store.folder}: report.html, cases.parquet, summary.json")
        print(f"next: edl6dof refly {store.folder} CASE")
    return 0 if all(row["success"] for row in rows) else NOT_WITHIN_LIMITS


def _print(console: Console, rows: Sequence[Row], figures: Mapping[str, Any]) -> None:
    for kind in dict.fromkeys(row["kind"] for row in rows):
        some = [row for row in rows if row["kind"] == kind]
        if _fits(some):
            console.print(_matrix(some, kind))
    console.print(_shares(figures["groups"]))
    for start, words in (("from_use_s", "first use"), ("from_fault_s", "the fault")):
        console.print(_times(figures["groups"], start, f"time from {words} to isolation, s"))
    if figures["undetected"]:
        console.print(_undetected(figures["undetected"]))
    console.print(_LEGEND, style="dim")
    lost = [row for row in rows if not row["success"]]
    _lines(console, "red", [f"{_case(row)}: {row['outcome']}" for row in lost])
    wrong = [f"{_case(row)}: named {row['wrongly_named']}" for row in rows if row.get("wrongly_named")]
    _lines(console, "magenta", wrong)
    for one in figures["acceptance"]:
        words = f"{one['meaning']}: {one['value']:.2f} {one['unit']} (required: {one['limit']})"
        console.print(Text(words, style="green" if one["met"] else "bold red"))
    flights = counted(len(rows), "flight")
    outcome = f"{len(lost)} of {flights} not within limits" if lost else f"{flights} within limits"
    console.print(Text(outcome, style="bold red" if lost else "bold green"))


def _fits(rows: Sequence[Row]) -> bool:
    """True if a matrix with one flight in each cell fits a terminal."""
    components, moments = ({row[name] for row in rows} for name in ("component", "moment"))
    one_each = len(rows) <= len(components) * len(moments)
    return one_each and len(moments) <= _COLUMNS and len(components) <= _ROWS


def _case(row: Row) -> str:
    fault = " ".join(filter(None, (row["component"], row["kind"], row.get("size"))))
    return f"case {row['case']}, {fault} at {row['moment']}"


def _lines(console: Console, style: str, lines: Sequence[str]) -> None:
    for line in lines[:_LINES]:
        console.print(Text(line, style=style))
    if len(lines) > _LINES:
        console.print(Text(f"and {len(lines) - _LINES} more, in report.html", style=style))


def _matrix(rows: Sequence[Row], kind: str) -> Table:
    """Components by moments; named rightly: green, wrongly: magenta, not: yellow; out of limits: red."""
    table = open_table(kind.replace("_", " "), "", narrow=True)
    moments = list(dict.fromkeys(row["moment"] for row in rows))
    for moment in moments:
        table.add_column(moment.replace("_", " "), justify="right", vertical="bottom")
    cells = {(row["component"], row["moment"]): _cell(row) for row in rows}
    for name in dict.fromkeys(row["component"] for row in rows):
        table.add_row(name, *(cells[name, moment] for moment in moments))
    return table


def _cell(row: Row) -> Text:
    if is_right(row):
        found, style = f"{row['isolation_from_use_s']:.2f}", "green"
    elif row.get("named"):
        found, style = str(row["named"]), "magenta"
    else:
        found, style = "?" if can_be_known(row) else "-", "yellow"
    return Text(found, style=style) if row["success"] else Text(f"x {found}", style="bold red")


def _shares(groups: Sequence[Mapping[str, Any]]) -> Table:
    """Return the number of flights of each kind of fault and regime, and percentages of them."""
    heads = ("flights>", "% in\nlimits>", "can be\nknown>", "% right\nname>", "% right\nkind>")
    table = open_table("", "kind", "regime", *heads, "wrong\nnames>", narrow=True)
    for group in groups:
        flights, known, wrong = group["flights"], group["can_be_known"], group["with_wrong_isolations"]
        right = (_share(group[name], known) for name in ("name_right", "kind_right"))
        cells = (str(flights), _share(group["within_limits"], flights), str(known), *right, str(wrong))
        table.add_row(group["kind"], group["regime"], *cells)
    return table


def _times(groups: Sequence[Mapping[str, Any]], start: str, title: str) -> Table:
    """Return a table of the times (s) from ``start`` to the right isolations, by kind of fault and regime."""
    table = open_table(title, "kind", "regime", "median>", "95 %>", "longest>", narrow=True)
    for group in groups:
        shown = [f"{group[start][name]:.2f}" if group[start] else "" for name in ("median", "p95", "worst")]
        table.add_row(group["kind"], group["regime"], *shown)
    return table


def _undetected(swept: Sequence[Mapping[str, Any]]) -> Table:
    """Return the largest effects of faults that were not detected, by kind and swept parameter."""
    title = "faults in use that were not named: their largest size, and largest errors at touchdown"
    heads = ("flights>", "not\nnamed>", "not in\nlimits>", "largest\nsize>", "velocity\nm/s>", "height\nm>")
    table = open_table(title, "kind", "parameter", *heads, "vertical\ndeg>", narrow=True)
    for one in swept:
        counts = (str(one[name]) for name in ("flights", "undetected", "not_within_limits"))
        values = ("" if one[name] is None else f"{one[name]:.3g}" for name in ("largest", *EFFECTS))
        table.add_row(one["kind"], one["parameter"], *counts, *values)
    return table


def _share(part: int, whole: int) -> str:
    return f"{100.0 * part / whole:.1f}" if whole else ""
