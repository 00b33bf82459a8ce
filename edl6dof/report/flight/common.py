"""Shared pieces of figures: plots of the catalogue over time, events, and maps about the landing site."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from math import inf
from textwrap import fill

import numpy as np

from edl6dof.report import catalogue
from edl6dof.report.catalogue import Plot, Stack
from edl6dof.report.figure import Axis, Figure, Heat, Mark, Panel, Trace
from edl6dof.report.palette import BLACK, BLUE, GREY, SERIES
from edl6dof.runs.run import FlightColumns, Run

TIME = "time since entry (s)"
#: Most letters in a line of an axis title.
LETTERS = 15
#: Largest multiple of the largest error up to which bounds are shown; beyond it the error could not be seen.
FAR = 30.0
#: Least share of the values that an axis has room for, and multiple of them beyond which a peak is cut off.
BULK, PEAK = 0.999, 3.0

#: Events that are marked by a line across a plot over time, with the label of the line.
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


def over_flight(run: Run, stacks: Iterable[Stack]) -> Iterator[Figure]:
    """Draw those of the stacks for which the flight has data."""
    for stack in stacks:
        if (figure := figure_with_data(run, stack)) is not None:
            yield figure


def figure_with_data(run: FlightColumns, stack: Stack) -> Figure | None:
    """Draw a stack; ``None`` if the flight has no data for it."""
    if stack.needs and not run.when.keys() & set(stack.needs) and not has_signal(run, *stack.needs):
        return None
    figure = figure_of(run, stack)
    return figure if figure.panels else None


def figure_of(run: FlightColumns, stack: Stack, rows: np.ndarray | bool = True, **words: str) -> Figure:
    """Draw a stack at some rows (bool); ``words`` go into the caption."""
    panels: list[Panel] = []
    colours: dict[str, str] = {}  # a name has one colour in all panels, and no other name has it
    same = len({plot.title.partition(", ")[0] for plot in stack.plots}) == 1  # the figure's title names it
    for plot in stack.plots:
        plot = plot._replace(title=plot.title.partition(", ")[2] or plot.title) if same else plot
        own = run.between(stack.since or plot.since, stack.until or plot.until)
        if stack.around is not None:
            first, last = (run.when.get(stack.since, inf) + seconds for seconds in stack.around)
            own = run.between("", stack.until or plot.until) & (run.t > first) & (run.t < last)
        if stack.within is not None and stack.within[0] in run:
            channel, low, high = stack.within
            own &= (run[channel] > low) & (run[channel] < high)
        if (panel := over_time(run, plot, own & rows)) is None:
            continue
        alone, traces = len(panel.traces) == 1, list[Trace]()
        for trace in panel.traces:
            name = plot.key if alone else trace.name
            if trace.colour in SERIES:
                colours.setdefault(name, SERIES[len(colours) % len(SERIES)])
            shown = "" if alone else name  # the axis title names the curve
            traces.append(replace(trace, name=shown, colour=colours.get(name, trace.colour)))
        panels.append(replace(panel, traces=traces))
    caption = stack.caption
    if "{" in caption:
        given = {name: value or 0.0 for name, value in run.figures.items()}
        caption = caption.format_map(defaultdict(float, given | words))
    return stacked(stack.key, stack.title, panels, caption, stack.height)


def over_time(run: FlightColumns, plot: Plot, rows: np.ndarray) -> Panel | None:
    """Draw a plot at some rows (bool), with the events of that time; ``None`` if it has no data."""
    found = plot.shown({channel: run[channel][rows] for channel in plot.channels if channel in run})
    if found is None:
        return None
    t, values = run.t[rows], found.values(run, rows)
    traces = [
        Trace(t, y, name, colour=colour, dash=dash)
        for y, (name, colour, dash) in zip(values, found.lines, strict=True)
    ]
    span = _clipped(values) if plot.clip else None
    if found.sigma:
        traces, span = [*traces[1:], traces[0]], _with_bounds(values[0], values[1])
    return time_panel(run, t, Axis(found.label, span), traces)


def time_panel(
    run: FlightColumns, t: np.ndarray, y: Axis, traces: Sequence[Trace], marks: Sequence[Mark] = ()
) -> Panel:
    """Return a panel over times ``t`` (s), with a line at each event within these times."""
    inside = {key: when for key in EVENTS if len(t) and t[0] < (when := run.when.get(key, inf)) < t[-1]}
    events = [Mark("x", when, EVENTS[key], GREY) for key, when in inside.items()]
    return Panel(Axis(TIME), y, traces, marks=[*events, *marks])


def _with_bounds(error: np.ndarray, bound: np.ndarray) -> tuple[float, float] | None:
    """Axis range, symmetrical about zero, for an error and its bounds."""
    largest = float(np.max(np.abs(error)))
    reach = 1.08 * max(largest, min(float(np.max(bound)), FAR * largest))
    return (-reach, reach) if reach > 0.0 else None


def _clipped(values: Sequence[np.ndarray]) -> tuple[float, float] | None:
    """Axis range that cuts off a high single peak; ``None`` if there is no such peak."""
    sizes = [np.abs(one) for one in values]
    bulk = max(float(np.nanquantile(one, BULK)) for one in sizes)
    if max(float(np.nanmax(one)) for one in sizes) <= PEAK * bulk:
        return None
    return -1.1 * bulk, 1.1 * bulk


def stacked(key: str, title: str, panels: Sequence[Panel], caption: str = "", height: int = 190) -> Figure:
    """Stack panels over time; the first one names the events, and panels without a curve are left out."""
    drawn: list[Panel] = []
    for panel in (panel for panel in panels if panel.traces):
        marks = [replace(mark, label="") if drawn and mark.axis == "x" else mark for mark in panel.marks]
        y = replace(panel.y, title=fill(panel.y.title, LETTERS))
        drawn.append(replace(panel, y=y, marks=marks))
    return Figure(key, title, drawn, caption, share_x=True, height=height)


def flown(x: np.ndarray, y: np.ndarray, name: str = "flown") -> Trace:
    """Return the path of the vehicle in a plane."""
    return Trace(x, y, name, colour=BLUE, width=2.2)


def site_panel(
    traces: Sequence[Trace], unit: str = "m", title: str = "", equal: bool = True, heat: Heat | None = None
) -> Panel:
    """Return a map (east, north) around the landing site; with ``heat`` it is as large as the cells."""
    spans = (None, None) if heat is None else ((heat.x[0], heat.x[-1]), (heat.y[0], heat.y[-1]))
    east, north = (
        Axis(f"{way} of the landing site ({unit})", span)
        for way, span in zip(("east", "north"), spans, strict=True)
    )
    return Panel(east, north, traces, heat=heat, equal=equal, title=title)


def circle(centre: Sequence[float], radius: float, points: int) -> tuple[np.ndarray, np.ndarray]:
    """Return x and y of points around a circle, shape (points,); the last one repeats the first."""
    turn = np.linspace(0.0, 2.0 * np.pi, points)
    return centre[0] + radius * np.cos(turn), centre[1] + radius * np.sin(turn)


def has_signal(run: FlightColumns, *channels: str) -> bool:
    """Return True if the run has one of the channels with more in it than zeros and gaps."""
    return any(channel in run and catalogue.has_signal(run[channel]) for channel in channels)


def placed(
    run: Run, x: str, y: str, events: Mapping[str, str] = EVENTS, scale: tuple[float, float] = (1.0, 1.0)
) -> Trace:
    """Return the events as labelled points in the plane of two channels."""
    keys = [key for key in events if key in run.when]
    xs, ys = (
        np.array([factor * run.at(channel, run.when[key]) for key in keys])
        for channel, factor in zip((x, y), scale, strict=True)
    )
    labels = [events[key] for key in keys]
    return Trace(xs, ys, "events", "points", BLACK, labels=labels, legend=False, border=True)
