"""Plots of channels, and comparisons of two flights or two campaigns."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from dataclasses import replace
from math import floor, log10
from pathlib import Path

from rich.console import Console
from rich.markup import escape

from edl6dof.api.flight import channels_figure
from edl6dof.api.functions import activate
from edl6dof.api.progress import count_runs
from edl6dof.api.reports import write_page
from edl6dof.campaign.ensemble import SampleMean, clear_differences, fly_neighbours, sample_means
from edl6dof.campaign.statistics import Comparison, Difference, compare
from edl6dof.campaign.store import Store
from edl6dof.config.errors import ConfigError, refusal
from edl6dof.config.wording import counted
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.report.catalogue import chosen
from edl6dof.report.document import Report, Section, Table, Text, as_cell, significant
from edl6dof.report.figure import Figure
from edl6dof.report.flight.flight_report import headline, mood
from edl6dof.report.flight.overlay import (
    comparison_report,
    differences_table,
    events_table,
    figures_table,
    labels,
    outcomes,
    together,
)
from edl6dof.report.page import page
from edl6dof.report.terminal import as_rich, open_table
from edl6dof.runs.files import atomic_file, refuse_existing_file
from edl6dof.runs.run import Run
from edl6dof.scenario.loading import load_scenario

SUFFIXES = (".html", ".png", ".pdf", ".svg")


def write_plot(
    folders: Sequence[Path],
    patterns: Sequence[str],
    against: str,
    since: float | None,
    until: float | None,
    out: Path | None,
    force: bool,
) -> Path:
    """Write a plot of channels of runs in the form that the suffix of ``out`` names; return its path."""
    runs = [Run(folder) for folder in folders]
    channels, names = chosen(runs[0], patterns, folders[0]), labels(*runs)
    several = len(runs) > 1
    figures = [
        channels_figure(run, run.folder, channels, against, since, until, apart=several) for run in runs
    ]
    figure = together(figures, names) if several else figures[0]
    others = "".join(f"-with-{name.replace('/', '-')}" for name in names[1:])
    more = "-and-more" if len(channels) > 1 else ""
    target = out or folders[0] / "plots" / f"{channels[0]}{more}{others}.html"
    if target.suffix not in SUFFIXES:
        raise refusal(target, f"must end in {', '.join(SUFFIXES)}")
    with atomic_file(target, force, folders[0]) as partial:
        _write(runs, figure, partial)
    return target


def _write(runs: Sequence[Run], figure: Figure, path: Path) -> None:
    if path.suffix != ".html":
        from edl6dof.report.matplotlib_figure import write_figure

        return write_figure(figure, path)
    title, headlines = runs[0].name, [headline(run) for run in runs]
    if len(runs) > 1:
        title = ", ".join(names := labels(*runs))
        headlines = [f"{name}: {words}" for name, words in zip(names, headlines, strict=True)]
    report = Report(
        title,
        "; ".join(headlines),
        max((mood(run.summary) for run in runs), key=("good", "warn", "bad").index),
        ", ".join(str(run.folder) for run in runs),
        sections=[Section("plots", figure.title, [figure])],
    )
    path.write_text(page(report), encoding="utf-8")


def list_channels(folder: Path) -> None:
    """Print name, unit and meaning of every channel of a run."""
    run = Run(folder)
    widest = max(map(len, run))
    units = max(len(run.unit(name)) for name in run)
    try:
        for name in run:
            print(f"{name:<{widest}}  {run.unit(name):<{units}}  {run.meaning(name)}")
    except BrokenPipeError:
        sys.stderr.close()


#: Most figures and differences of scenarios of two flights on a terminal, without ``--all``.
MOST_FIGURES, MOST = 10, 20
#: Neighbours that are flown for the variation of figures from flight to flight.
NEIGHBOURS = 10
#: Most decimals of a number in a table; smaller ones have an exponent.
_MOST_PLACES = 8


def compare_campaigns(first: Path, second: Path, as_json: bool) -> None:
    """Compare two campaigns that were flown with common random numbers, and print the result."""
    result = compare(Store(first), Store(second))
    if as_json:
        print(json.dumps(result.data, indent=1))
    else:
        _show_campaigns(result)


def compare_flights(first: Path, second: Path, out: Path | None, force: bool, everything: bool) -> None:
    """Print the tables of two runs and write the page with their plots."""
    one, two = Run(first), Run(second)
    target = out or second / f"compared-with-{first.resolve().name}.html"
    refuse_existing_file(target, force, second)
    report = comparison_report(one, two)
    console = Console(highlight=False, soft_wrap=True)
    console.print(as_rich(outcomes(one, two)))
    if everything:
        console.print(as_rich(replace(figures_table(one, two), caption="Figures")))
        console.print(as_rich(replace(events_table(one, two), caption="Events")))
    else:
        _show_clear_differences(console, one, two)
    _show_scenarios(console, differences_table(one, two), everything)
    write_page(report, target, force, second)
    print(str(target))


def _show_clear_differences(console: Console, one: Run, two: Run) -> None:
    """Print the figures with the largest differences beyond the variation between flights of one scenario."""
    figures = one.summary["figures"], two.summary["figures"]
    try:
        clear = {} if figures[0] == figures[1] else clear_differences(_spreads(one), *figures)
    except ConfigError as error:
        words = f"{error.problems[0]}: how much flights vary is not known; --all shows every figure"
        print(words)
        return
    shown = list(clear)[:MOST_FIGURES]
    if not shown:
        console.print("No figure differs by more than from flight to flight; --all shows every figure.")
        return
    table = figures_table(one, two, shown)
    rows = [[*row, f"+-{significant(clear[name], 2)}"] for name, row in zip(shown, table.rows, strict=True)]
    title = "Largest differences beyond the variation from flight to flight"
    console.print(as_rich(Table([*table.columns, "variation>"], rows, title)))
    count = f"{len(shown)} of {counted(len(clear), 'figure')} that differ clearly"
    console.print(f"{count}; --all shows every figure and event", style="dim", end="\n\n")


def _spreads(run: Run) -> dict[str, SampleMean]:
    """Mean and spread of the figures over neighbouring flights of a run.

    Raises:
        ConfigError: its scenario cannot be flown here.
    """
    path = run.folder / "scenario.yaml"
    activate(path)
    loaded = load_scenario(path)
    with count_runs("variation from flight to flight", quiet=False) as progress:
        rows = fly_neighbours(loaded, NEIGHBOURS, progress=lambda done, row: progress(done, NEIGHBOURS))
    return sample_means(rows, {})


def _show_scenarios(console: Console, table: Table | Text, everything: bool) -> None:
    """Print a line for each parameter that differs, its path unbroken; only a few unless ``everything``."""
    if isinstance(table, Text):
        print(table.words)
        return
    names = (escape(name) for name in table.columns[1:])
    console.print(f"[bold]Differences of the scenarios[/]: parameter: {' | '.join(names)}")
    rows = table.rows if everything else table.rows[:MOST]
    for row in rows:
        path, mine, theirs = (as_cell(item).text for item in row)
        print(f"  {path}: {mine} | {theirs}")
    if len(rows) < len(table.rows):
        console.print(f"  and {len(table.rows) - len(rows)} more: --all, or the page")


def _show_campaigns(result: Comparison) -> None:
    """Print a comparison of two campaigns."""
    console = Console(highlight=False, soft_wrap=True)
    a, b = result.names
    both, only_a, only_b, neither = result.counts
    for name, success in zip(result.names, result.success, strict=True):
        print(f"{name}: success {success}")
    console.print(
        f"both succeed {both}, {a} alone {only_a}, {b} alone {only_b}, neither {neither}", markup=False
    )
    console.print(f"probability of a split as uneven by chance: {result.p_value:.3g} (McNemar, exact)")
    title = f"Paired differences, {b} less {a}, that are clear at 95 %, all figures together"
    table = open_table(title, "figure", "unit", *(f"{head}>" for head in (a, b, "difference", "95 %")))
    for one in result.figures:
        if one.clear:
            figure = figure_of_merit(one.figure)
            table.add_row(figure.meaning, figure.unit.label, *_numbers(one))
    console.print(table if table.row_count else "no figure differs clearly")


def _numbers(one: Difference) -> list[str]:
    """Means, difference and half the difference's interval, with the decimals known of the difference."""
    places = max(1 - floor(log10(one.half_width)), 0) if one.half_width else 3
    form = f",.{places}f" if places <= _MOST_PLACES else ".3e"
    means = (f"{value:{form}}" for value in (one.mean_a, one.mean_b))
    return [*means, f"{one.difference:+{form}}", f"+-{one.half_width:{form}}"]
