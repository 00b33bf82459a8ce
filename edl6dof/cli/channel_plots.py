"""Plots of channels of a run: one file, or the list of what can be plotted."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from edl6dof.api.results import channels_figure
from edl6dof.config.errors import refusal
from edl6dof.report.catalogue import chosen
from edl6dof.report.document import Report, Section
from edl6dof.report.figure import Figure
from edl6dof.report.flight.flight_report import headline, mood
from edl6dof.report.page import page
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
