"""``edl6dof plot``."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from fnmatch import fnmatchcase
from pathlib import Path

import numpy as np

from edl6dof.config.errors import refusal
from edl6dof.config.wording import nearest
from edl6dof.report.document import Report, Section
from edl6dof.report.figure import Axis, Figure, Panel, Trace
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
    channels = chosen(run, patterns)
    x = chosen(run, [against])[0]
    rows = (run.t >= (-np.inf if since is None else since)) & (run.t <= (np.inf if until is None else until))
    if not rows.any():
        raise refusal(
            folder,
            f"has no telemetry between the given times (it runs from {run.t[0]:g} to {run.t[-1]:g} s)",
        )
    target = out or folder / "plots" / f"{channels[0]}{'-and-more' if len(channels) > 1 else ''}.html"
    if target.suffix not in SUFFIXES:
        raise refusal(target, f"must end in {', '.join(SUFFIXES)}")
    refuse_existing_file(target, force)
    figure = channel_plot(run, channels, x, rows)
    with atomic_file(target, force) as partial:
        _write(run, figure, partial)
    print(target)
    return 0


def chosen(run: Run, patterns: Sequence[str]) -> list[str]:
    """Names of the columns that match, in the order of the patterns.

    Raises:
        ConfigError: a pattern matches nothing.
    """
    found: dict[str, None] = {}
    for pattern in patterns:
        names = [name for name in run if fnmatchcase(name, pattern)]
        if not names:
            begun = [name for name in run if name.startswith(pattern)]
            near = f"{pattern}*" if len(begun) > 1 else nearest(pattern, begun or list(run))
            raise refusal(
                run.folder,
                f"no channel {pattern!r}"
                + (f"; did you mean {near!r}?" if near else "")
                + " (edl6dof plot RUN lists all)",
            )
        found.update(dict.fromkeys(names))
    return list(found)


def channel_plot(run: Run, channels: Sequence[str], x: str, rows: np.ndarray) -> Figure:
    """One panel for each unit."""
    by_unit: dict[str, list[str]] = {}
    for name in channels:
        by_unit.setdefault(run.unit(name), []).append(name)
    across = Axis(f"{run.meaning(x)} ({run.unit(x) or '1'})")
    panels = []
    for unit, names in by_unit.items():
        title = run.meaning(names[0]) if len(names) == 1 else "value"
        traces = [Trace(run[x][rows], run[name][rows], name) for name in names]
        panels.append(Panel(across, Axis(f"{title} ({unit or '1'})"), traces))
    return Figure(
        "plot",
        ", ".join(channels) if len(channels) < 4 else f"{len(channels)} channels",
        panels,
        share_x=True,
        height=320,
    )


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
