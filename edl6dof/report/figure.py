"""The content of a figure, independent of the library that draws it.

One description has two drawings: by plotly.js in a page, where a reader zooms and reads values off, and by
matplotlib on paper.

>>> t = np.linspace(0.0, 1.0, 11)
>>> fall = Trace(t, 1.0 - t**2, "fall")
>>> panel = Panel(Axis("time (s)"), Axis("height (m)"), [fall], marks=[Mark("x", 1.0)])
>>> figure = Figure("fall", "A fall", [panel], "Height of a falling stone.")
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import cycle
from typing import Any, Literal

import numpy as np

from edl6dof.report.palette import GREY, SEQUENTIAL, SERIES
from edl6dof.telemetry.thinning import bends, rows_to_draw

Kind = Literal["line", "points", "steps", "bars", "region"]
Dash = Literal["solid", "dash", "dot", "dashdot"]


@dataclass(frozen=True)
class Axis:
    """An axis: title with unit, range (by default that of the data), and names that replace the numbers."""

    title: str
    range: tuple[float, float] | None = None
    log: bool = False
    names: Sequence[str] = ()

    def decades(self, span: tuple[float, float]) -> list[float]:
        """Return the numbers along a logarithmic axis: 1, 2, 5 of each decade, only 1 over many decades; none
        if fewer than two of them lie in the span.
        """
        low, high = (int(np.floor(np.log10(bound))) for bound in span)
        steps = (1, 2, 5) if high - low <= 3 else (1,)
        every = [step * 10.0**power for power in range(low, high + 1) for step in steps]
        more = 1.0 + 1e-9
        found = [value for value in every if span[0] <= value * more and value <= span[1] * more]
        return found if len(found) > 1 else []


@dataclass(frozen=True)
class Trace:
    """One curve, set of points or of bars, or filled outline (region); ``x`` and ``y`` have shape (n,), NaN
    is a gap.

    Attributes:
        labels: words at the points, n of them.
        colour: ``#rrggbb``; empty: the next colour of the palette.
        legend: whether the name is shown in the legend; traces of one name share an entry.
        border: True for a limit or a goal, False for flown data.
    """

    x: np.ndarray
    y: np.ndarray
    name: str = ""
    kind: Kind = "line"
    colour: str = ""
    dash: Dash = "solid"
    width: float = 1.6
    symbol: str = "circle"
    labels: Sequence[str] = ()
    legend: bool = True
    border: bool = False


def through(places: np.ndarray, name: str = "", kind: Kind = "line", **look: Any) -> Trace:
    """Return a trace through places, shape (n, 2)."""
    return Trace(places[:, 0], places[:, 1], name, kind, **look)


def legend_entry(name: str, colour: str, width: float = 3.0, border: bool = False) -> Trace:
    """Return a trace that only adds an entry to the legend."""
    nowhere = np.array([np.nan])
    return Trace(nowhere, nowhere, name, "points", colour, symbol="square", width=width, border=border)


@dataclass(frozen=True)
class Heat:
    """A field of coloured cells.

    Attributes:
        x, y: centres of the cells.
        values: shape (len(y), len(x)); NaN is an empty cell.
        title: title of the colour scale. Without a title the values are kinds of cells, whole numbers from
            ``low`` to ``high``.
        low, high: values at the ends of the colour scale.
        colours: colours of the scale from ``low`` to ``high``, between which colours are interpolated; of
            kinds, the colour of each kind.
        labels: text of each cell, shown when a reader points at the cell.
    """

    x: np.ndarray
    y: np.ndarray
    values: np.ndarray
    title: str
    low: float
    high: float
    colours: Sequence[str] = SEQUENTIAL
    labels: Sequence[Sequence[str]] = ()

    @property
    def kinds(self) -> bool:
        """True if the cells are of kinds, each of one colour, which traces name in the legend."""
        return not self.title

    @property
    def scale(self) -> list[tuple[float, str]]:
        """Colours at shares of the way from the lowest to the highest value of :attr:`limits`."""
        if not self.kinds:
            return [(i / (len(self.colours) - 1), colour) for i, colour in enumerate(self.colours)]
        n = len(self.colours)
        return [(edge / n, colour) for i, colour in enumerate(self.colours) for edge in (i, i + 1)]

    @property
    def limits(self) -> tuple[float, float]:
        """Values at the ends of the scale."""
        return (self.low - 0.5, self.high + 0.5) if self.kinds else (self.low, self.high)


def cell_edges(centres: np.ndarray) -> np.ndarray:
    """Return the edges of adjacent cells with these centres, shape (n + 1,); a single cell is 1 wide."""
    if len(centres) == 1:
        return centres[0] + np.array([-0.5, 0.5])
    half = 0.5 * np.diff(centres)
    return np.concatenate([centres[:1] - half[:1], centres[:-1] + half, centres[-1:] + half[-1:]])


@dataclass(frozen=True)
class Band:
    """A shaded rectangle; a bound of ``None`` is the edge of the panel."""

    colour: str
    x: tuple[float | None, float | None] = (None, None)
    y: tuple[float | None, float | None] = (None, None)
    label: str = ""
    opacity: float = 0.5
    outline: bool = False

    def bounds(self, axis: Literal["x", "y"], span: tuple[float, float]) -> tuple[float, float] | None:
        """Return the ends along an axis of range ``span``; ``None`` if the band has no bound along it."""
        low, high = self.x if axis == "x" else self.y
        if low is None and high is None:
            return None
        return span[0] if low is None else low, span[1] if high is None else high


@dataclass(frozen=True)
class Mark:
    """A straight line across the panel at one value of an axis, with a label."""

    axis: Literal["x", "y"]
    at: float
    label: str = ""
    colour: str = GREY
    dash: Dash = "dot"


@dataclass(frozen=True)
class Panel:
    """One pair of axes and its content; ``equal`` gives both axes the same scale."""

    x: Axis
    y: Axis
    traces: Sequence[Trace] = ()
    bands: Sequence[Band] = ()
    marks: Sequence[Mark] = ()
    heat: Heat | None = None
    title: str = ""
    equal: bool = False
    weight: float = 1.0

    def span(self, axis: Literal["x", "y"]) -> tuple[float, float]:
        """Return the range of an axis: the given one, or that of traces and marks with a margin."""
        mine = self.x if axis == "x" else self.y
        if mine.range is not None:
            return mine.range
        if mine.names:
            return -0.5, len(mine.names) - 0.5
        every = [np.asarray(getattr(trace, axis), float) for trace in self.traces]
        every += [cell_edges(getattr(self.heat, axis))] if self.heat is not None else []
        bars = [trace for trace in self.traces if trace.kind == "bars"]
        every += [cell_edges(trace.x) if axis == "x" else np.zeros(1) for trace in bars]
        every += [np.array([mark.at]) for mark in self.marks if mark.axis == axis and axis == "y"]
        values = np.concatenate([np.empty(0), *every])
        values = values[np.isfinite(values) & ((values > 0.0) | (not mine.log))]
        if not len(values):
            return (1.0, 10.0) if mine.log else (0.0, 1.0)
        low, high = float(values.min()), float(values.max())
        if mine.log:
            return low / 1.2, high * 1.2
        points = any(trace.kind == "points" and np.isfinite(trace.x).any() for trace in self.traces)
        if low == high:
            room = 0.1 * max(abs(high), 1.0)  # more than the rounding of a large number
        elif self.heat is not None or axis == "x" and not points:
            room = 0.0
        else:
            room = (0.12 if any(trace.labels for trace in self.traces) else 0.05) * (high - low)
        return low - room * (axis == "x" or not bars or low < 0.0), high + room

    def coloured(self) -> list[Trace]:
        """Return the traces; each one without a colour gets the next colour of the palette."""
        used = {trace.colour for trace in self.traces}
        free = cycle([colour for colour in SERIES if colour not in used] or SERIES)
        return [trace if trace.colour else replace(trace, colour=next(free)) for trace in self.traces]


@dataclass(frozen=True)
class Figure:
    """Panels in rows of ``columns``, under one title.

    Attributes:
        key: file name and anchor: letters, digits and ``_``.
        caption: text below the figure.
        share_x: True if the panels of a column share one x axis, labelled under the last panel.
        height: of a row of panels, in px on a page 1000 px wide.
    """

    key: str
    title: str
    panels: Sequence[Panel]
    caption: str = ""
    columns: int = 1
    share_x: bool = False
    height: int = 300

    @property
    def rows(self) -> int:
        """Rows of panels."""
        return -(-len(self.panels) // self.columns)

    @property
    def entries(self) -> set[str]:
        """Names in the legend: none if there is one only, unless it names a kind of cells."""
        names = {trace.name for panel in self.panels for trace in panel.traces if trace.legend and trace.name}
        kinds = any(panel.heat is not None and panel.heat.kinds for panel in self.panels)
        return names if len(names) > 1 or kinds else set()

    def size(self, index: int) -> tuple[float, float]:
        """Return width and height (px) of one panel on a page 1000 px wide."""
        return 880.0 / self.columns, self.height * self.panels[index].weight

    def spans(self, index: int) -> tuple[tuple[float, float], tuple[float, float]]:
        """Return the ranges of x and y of one panel; a shared x axis covers all panels of its column."""
        panel = self.panels[index]
        column = self.panels[index % self.columns :: self.columns] if self.share_x else (panel,)
        x = [other.span("x") for other in column]
        return (min(low for low, _ in x), max(high for _, high in x)), panel.span("y")


def thinned(trace: Trace, most: int = 4000) -> Trace:
    """Return the trace without points that cannot be seen, with about ``most`` points if its ``x`` rises.

    A peak keeps its height and its place however long the flight is.  A curve whose ``x`` does not rise, in
    which every point is seen, is thinned only where it is straight.
    """
    n = len(trace.x)
    if trace.kind not in ("line", "steps") or n <= most // 2 or trace.labels:
        return trace
    x, y = np.asarray(trace.x, float), np.asarray(trace.y, float)
    if trace.kind == "steps":
        rows = np.union1d([0, n - 1], 1 + np.flatnonzero(y[1:] != y[:-1]))
    elif np.all(np.diff(x) > 0.0):
        rows = rows_to_draw(x, y[:, None], most)
    else:
        rows = bends(np.arange(n), np.stack([x, y], axis=1))
    return replace(trace, x=x[rows], y=y[rows])
