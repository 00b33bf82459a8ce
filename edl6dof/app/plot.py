"""``edl6dof plot``."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from edl6dof.config.errors import refusal
from edl6dof.report.channels import channel_plot, chosen
from edl6dof.report.document import Report, Section
from edl6dof.report.figure import Figure
from edl6dof.runs.files import atomic_file, refuse_existing_file
from edl6dof.runs.run import Run

SUFFIXES = (".html", ".png", ".pdf", ".svg")


def run_plot(
    folder: Path,
    patterns: Sequence[str],
    against: str,
    since: float | None,
    until: float | None,
    out: Path | None,
    force: bool,
) -> int:
    """Write a plot of channels; without any, list them all."""
    run = Run(folder)
    if not patterns:
        return _list(run)
    channels = chosen(run, patterns, folder)
    x = chosen(run, [against], folder)[0]
    rows = (run.t >= (-np.inf if since is None else since)) & (run.t <= (np.inf if until is None else until))
    if not rows.any():
        raise refusal(
            folder,
            f"has no telemetry between the given times (it runs from {run.t[0]:g} to {run.t[-1]:g} s)",
        )
    target = out or folder / "plots" / f"{channels[0]}{'-and-more' if len(channels) > 1 else ''}.html"
    if target.suffix not in SUFFIXES:
        raise refusal(target, f"must end in {', '.join(SUFFIXES)}")
    refuse_existing_file(target, force, folder)
    figure = channel_plot(run, channels, x, rows)
    with atomic_file(target, force, folder) as partial:
        _write(run, figure, partial)
    print(target)
    return 0


def _write(run: Run, figure: Figure, path: Path) -> None:
    if path.suffix == ".html":
        from edl6dof.report.flight.words import headline, mood
        from edl6dof.report.page import page

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


def _list(run: Run) -> int:
    widest = max(map(len, run))
    units = max(len(run.unit(name)) for name in run)
    try:
        for name in run:
            print(f"{name:<{widest}}  {run.unit(name):<{units}}  {run.meaning(name)}")
    except BrokenPipeError:
        sys.stderr.close()
    return 0
