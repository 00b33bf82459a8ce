"""``edl6dof figures``: what a document quotes of a scenario."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from math import isfinite
from typing import Any

from rich.console import Console

from edl6dof.app.counting import count_runs
from edl6dof.app.exit_status import refuse
from edl6dof.campaign.neighbours import FLIGHTS, SPEED_STEP_M_S, SampleMean, fly_neighbours, sample_means
from edl6dof.campaign.rows import Row
from edl6dof.config.wording import counted
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.report.numbers import significant
from edl6dof.report.terminal import comparison, open_table, published_table
from edl6dof.scenario.loading import LoadedScenario, load_scenario

#: More flights than any mean needs.
MOST_FLIGHTS = 100_000


def run_figures(scenario: str, sets: Sequence[str], flights: int | None, as_json: bool) -> int:
    """Fly neighbours of a scenario and show mean and spread of their figures; returns the exit status."""
    flights = FLIGHTS if flights is None else flights
    if not 2 <= flights <= MOST_FLIGHTS:
        return refuse(f"-n {flights}: a spread needs 2 flights, and at most {MOST_FLIGHTS} are flown")
    loaded = load_scenario(scenario, sets)
    with count_runs(loaded.scenario.name, quiet=as_json) as progress:
        rows = fly_neighbours(loaded, flights, progress=lambda done, row: progress(done, flights))
    found = sample_means(rows, loaded.scenario.published)
    if as_json:
        print(json.dumps(_plain(loaded, rows, found), indent=1))
    else:
        _show(loaded, rows, found)
    return 0 if all(row["success"] for row in rows) else 1


def _plain(loaded: LoadedScenario, rows: Sequence[Row], found: Mapping[str, SampleMean]) -> dict[str, Any]:
    return {
        "scenario": loaded.scenario.name,
        "flights": len(rows),
        "within_limits": sum(bool(row["success"]) for row in rows),
        "figures": {
            name: {
                "mean": s.mean,
                "deviation": s.deviation if isfinite(s.deviation) else None,
                "flights": s.flights,
            }
            for name, s in found.items()
        },
    }


def _show(loaded: LoadedScenario, rows: Sequence[Row], found: Mapping[str, SampleMean]) -> None:
    console = Console(highlight=False)
    beside = comparison(
        {name: s.mean for name, s in found.items()},
        loaded.scenario.published,
        {name: s.deviation for name, s in found.items()},
    )
    if beside:
        console.print(published_table(beside, "Beside the published flight", "mean and spread"))
    table = open_table("Other figures", "figure", "unit", "mean>", "spread>", "flights>")
    for name, s in found.items():
        if name not in loaded.scenario.published:
            figure = figure_of_merit(name)
            spread = significant(s.deviation, 2) if isfinite(s.deviation) else "-"
            table.add_row(figure.meaning, figure.unit.label, significant(s.mean), spread, str(s.flights))
    console.print(table)
    good = sum(bool(row["success"]) for row in rows)
    console.print(
        f"{loaded.scenario.name}: {counted(len(rows), 'flight')} that differ by {SPEED_STEP_M_S:g} m/s in "
        f"entry speed and by their random profiles; {good} within limits"
    )
