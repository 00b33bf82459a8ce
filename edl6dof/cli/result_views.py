"""Plots of channels, and comparisons of two flights or two campaigns."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from math import floor, log10
from pathlib import Path

from rich.console import Console
from rich.markup import escape

from edl6dof.api.flight_results import channels_figure
from edl6dof.api.reports import write_page
from edl6dof.campaign.compare import Comparison, Difference, compare
from edl6dof.campaign.store import Store
from edl6dof.config.errors import refusal
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.report.catalogue import chosen
from edl6dof.report.document import Report, Section, Table, Text, as_cell
from edl6dof.report.figure import Figure
from edl6dof.report.flight.flight_report import headline, mood
from edl6dof.report.flight.overlay import comparison_report
from edl6dof.report.page import page
from edl6dof.report.terminal import open_table
from edl6dof.runs.files import atomic_file, refuse_existing_file
from edl6dof.runs.run import Run

SUFFIXES = (".html", ".png", ".pdf", ".svg")


def write_plot(
    folder: Path,
    patterns: Sequence[str],
    against: str,
    since: float | None,
    until: float | None,
    out: Path | None,
    force: bool,
) -> Path:
    """Write a plot of channels in the form that the suffix of ``out`` names; returns its path."""
    run = Run(folder)
    figure = channels_figure(run, folder, patterns, against, since, until)
    channels = chosen(run, patterns, folder)
    target = out or folder / "plots" / f"{channels[0]}{'-and-more' if len(channels) > 1 else ''}.html"
    if target.suffix not in SUFFIXES:
        raise refusal(target, f"must end in {', '.join(SUFFIXES)}")
    refuse_existing_file(target, force, folder)
    with atomic_file(target, force, folder) as partial:
        _write(run, figure, partial)
    return target


def _write(run: Run, figure: Figure, path: Path) -> None:
    if path.suffix == ".html":
        report = Report(
            run.name,
            headline(run),
            mood(run.summary),
            str(run.folder),
            sections=[Section("plots", figure.title, [figure])],
        )
        path.write_text(page(report), encoding="utf-8")
    else:
        from edl6dof.report.matplotlib_figure import write_figure

        write_figure(figure, path)


def list_channels(folder: Path) -> int:
    """Print name, unit and meaning of every channel of a run; returns the exit status."""
    run = Run(folder)
    widest = max(map(len, run))
    units = max(len(run.unit(name)) for name in run)
    try:
        for name in run:
            print(f"{name:<{widest}}  {run.unit(name):<{units}}  {run.meaning(name)}")
    except BrokenPipeError:
        sys.stderr.close()
    return 0


#: Differences of the scenarios that the terminal shows.
MOST = 20
#: Decimals of a number in a table; smaller ones have an exponent.
_MOST_PLACES = 8


def compare_campaigns(first: Path, second: Path, as_json: bool) -> None:
    """Print two campaigns on common random numbers."""
    result = compare(Store(first), Store(second))
    if as_json:
        print(json.dumps(result.data, indent=1))
    else:
        _show_campaigns(result)


def compare_flights(first: Path, second: Path, out: Path | None, force: bool) -> None:
    """Print the tables of two runs and write the page with their plots."""
    one, two = Run(first), Run(second)
    target = out or second / f"compared-with-{first.resolve().name}.html"
    refuse_existing_file(target, force, second)
    report = comparison_report(one, two)
    console = Console(highlight=False, soft_wrap=True)
    for section in report.sections[:4]:
        for block in section.blocks:
            if isinstance(block, Text):
                console.print(block.words, markup=False)
            elif isinstance(block, Table):
                rows = [[as_cell(item).text for item in row] for row in block.rows]
                if section.key == "differences":
                    _show_differences(console, section.title, block.columns[1:], rows)
                    continue
                table = open_table(section.title, *block.columns)
                for row in rows:
                    table.add_row(*map(escape, row))
                console.print(table)
    write_page(report, target, force, second)
    console.print(str(target), markup=False)


def _show_differences(
    console: Console, title: str, names: Sequence[str], rows: Sequence[Sequence[str]]
) -> None:
    """A line for each parameter: its path is never broken, and two scenarios may differ in hundreds."""
    console.print(f"[bold]{title}[/]: parameter: {escape(names[0])} | {escape(names[1])}")
    for path, one, two in rows[:MOST]:
        console.print(f"  {path}: {one} | {two}", markup=False)
    if len(rows) > MOST:
        console.print(f"  and {len(rows) - MOST} more, listed in the page")


def _show_campaigns(result: Comparison) -> None:
    """Print a comparison of two campaigns."""
    console = Console(highlight=False, soft_wrap=True)
    a, b = result.names
    both, only_a, only_b, neither = result.counts
    for name, success in zip(result.names, result.success, strict=True):
        console.print(f"{name}: success {success}", markup=False)
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
    """Means, their difference and half its interval, with the decimals that the difference is known to."""
    places = max(1 - floor(log10(one.half_width)), 0) if one.half_width else 3
    form = f",.{places}f" if places <= _MOST_PLACES else ".3e"
    means = (f"{value:{form}}" for value in (one.mean_a, one.mean_b))
    return [*means, f"{one.difference:+{form}}", f"+-{one.half_width:{form}}"]
