"""The result of a campaign on standard output."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from edl6dof.campaign.statistics import SHARES, flights_needed, quantile
from edl6dof.campaign.store import Store
from edl6dof.metrics.figures import LIMITS
from edl6dof.report.campaign.campaign_results import Results
from edl6dof.report.campaign.margins import head, in_words, note, shown_shares
from edl6dof.report.numbers import significant
from edl6dof.report.terminal import open_table


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
    console.print(f"next: edl6dof report {store.folder}, edl6dof refly {store.folder} CASE", markup=False)


def limits_table(results: Results) -> Table:
    """The outermost quantile of every figure that has a limit, with its bounds, beside it."""
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
    """Every figure that has a limit, ready for JSON: of a sample its quantiles with their 95 % bounds; in the
    place of one that the flights cannot bound, how many it takes.
    """
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
