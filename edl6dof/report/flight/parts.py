"""Pieces that many figures share: curves over time, the phases behind them and the events across them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from edl6dof.report.figure import BLACK, GREY, PHASES, Axis, Band, Dash, Figure, Mark, Panel, Trace
from edl6dof.runs.run import Run

TIME = "time since entry (s)"

#: Events worth a line across a plot, and the word beside it.
EVENTS: dict[str, str] = {
    "fault": "fault",
    "diagnosis": "diagnosed",
    "exclusion": "excluded",
    "guard": "guard",
    "trim_wing": "trim wing",
    "mortar": "parachute",
    "heat_shield": "heat shield",
    "backshell": "backshell",
    "touchdown": "touchdown",
}


class Curve(NamedTuple):
    """One channel in a panel: its name in the legend, a factor on the values, and how it is drawn."""

    channel: str
    name: str = ""
    scale: float = 1.0
    colour: str = ""
    dash: Dash = "solid"


def over_time(
    run: Run, title: str, curves: Sequence[Curve], rows: np.ndarray, span: tuple[float, float] | None = None
) -> Panel:
    """Channels over time for some rows (bool), with the events of that time; channels that the run does not
    have are left out.
    """
    t = run.t[rows]
    traces = [
        Trace(t, run[curve.channel][rows] * curve.scale, curve.name, colour=curve.colour, dash=curve.dash)
        for curve in curves
        if curve.channel in run
    ]
    return Panel(Axis(TIME), Axis(title, span), traces, marks=event_marks(run, t))


def stacked(key: str, title: str, panels: Sequence[Panel], caption: str = "", height: int = 190) -> Figure:
    """Panels over time, one above the other; events are named in the first, and panels without a curve are
    left out.
    """
    drawn = [panel for panel in panels if panel.traces]
    below = [
        replace(panel, marks=[replace(mark, label="") if mark.axis == "x" else mark for mark in panel.marks])
        for panel in drawn[1:]
    ]
    return Figure(key, title, [*drawn[:1], *below], caption, share_x=True, height=height)


def event_marks(run: Run, t: np.ndarray) -> list[Mark]:
    """Lines at the events inside the times ``t``."""
    if not len(t):
        return []
    inside = {
        name: run.when[key]
        for key, name in EVENTS.items()
        if key in run.when and t[0] < run.when[key] < t[-1]
    }
    return [Mark("x", when, name, GREY) for name, when in inside.items()]


def phase_bands(run: Run) -> list[Band]:
    """The mission phases as bands over time."""
    keys, colours = phase_keys(run), phase_colours(run)
    starts = [*(run.when[key] for key in keys), float(run.t[-1])]
    return [
        Band(colours[key], x=span, opacity=0.75) for key, span in zip(keys, pairwise(starts), strict=True)
    ]


def phase_legend(run: Run) -> list[Trace]:
    """Entries of the legend for :func:`phase_bands`."""
    nowhere, colours = np.array([np.nan]), phase_colours(run)
    names = {key: key.removeprefix("phase.").replace("_", " ") for key in phase_keys(run)}
    return [
        Trace(nowhere, nowhere, name, "points", colours[key], symbol="square", width=3.0, border=True)
        for key, name in names.items()
    ]


def phase_keys(run: Run) -> list[str]:
    """Event keys of the phases that were flown, in their order."""
    return [f"phase.{name}" for name in run.phase_names if f"phase.{name}" in run.when]


def phase_colours(run: Run) -> Mapping[str, str]:
    """Colour of each phase that was flown by its event key."""
    return {key: PHASES[i % len(PHASES)] for i, key in enumerate(phase_keys(run))}


def has_signal(run: Run, channel: str, rows: np.ndarray | slice = slice(None)) -> bool:
    """Whether the run has the channel and it is anything but zero and gaps."""
    return channel in run and bool(np.any(np.nan_to_num(run[channel][rows]) != 0.0))


def placed(
    run: Run, x: str, y: str, events: Mapping[str, str] = EVENTS, scale: tuple[float, float] = (1.0, 1.0)
) -> Trace:
    """The events as labelled points in the plane of two channels."""
    found = [
        (run.at(x, run.when[key]) * scale[0], run.at(y, run.when[key]) * scale[1], name)
        for key, name in events.items()
        if key in run.when
    ]
    xs, ys, labels = zip(*found, strict=True) if found else ((), (), ())
    return Trace(
        np.array(xs),
        np.array(ys),
        "events",
        "points",
        colour=BLACK,
        labels=labels,
        legend=False,
        border=True,
    )
