"""The plots over time, and the thrusters' duty.

The viewer puts its ticks at multiples of a power of ten, and leaves out those that would stand closer than a
line of text: of seven or more in a plot a sixth of a window high it shows the zero alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from edl6dof.replay.history import History, thin
from edl6dof.replay.recorder import SLOW_HZ, Recorder
from edl6dof.replay.views.layout import GROUPS, NAVIGATION, OF_JETS, PAGES
from edl6dof.report.catalogue import Plot
from edl6dof.report.figure import SERIES, rgb
from edl6dof.telemetry.thinning import rows_to_draw

if TYPE_CHECKING:
    import rerun as rr

#: Telemetry columns that the plots show, of every flight and of one on instruments.
COLUMNS = tuple(
    {
        name: 0
        for page, plots in PAGES.items()
        if page != NAVIGATION
        for plot in plots
        for name in plot.channels
    }
)
NAVIGATION_COLUMNS = tuple(name for plot in PAGES[NAVIGATION] for name in plot.channels)
#: Rows of a plot about at most: more than a screen has columns of pixels.
MOST = 6000
#: Most steps between ticks that a plot of the least height has room for.
STEPS = 4.5
#: Room above and below the curves, share of the range.
ROOM = 0.06


class Charts(Recorder):
    """Writes ``/plots``."""

    def statics(self) -> None:
        """Names and colours of the series."""
        for plot in shown(self.flight):
            self.static(
                self._entity(plot.key), self._lines([(name, colour) for name, colour, _ in plot.lines])
            )
        for group, names in self._groups():
            lines = [(name, SERIES[k % len(SERIES)]) for k, name in enumerate(names)]
            self.static(self._entity(f"thruster_duty/{group}"), self._lines(lines))

    def motions(self) -> None:
        """The series, where they mean something."""
        for plot in shown(self.flight):
            t, curves = drawn(plot, self.flight)
            if len(t):
                rows = rows_to_draw(t, curves, MOST)
                self._scalars(plot.key, t[rows], curves[rows])
        rows = thin(self.t, SLOW_HZ)
        for group, names in self._groups():
            self._scalars(f"thruster_duty/{group}", self.t[rows], self.flight.mean_duty(rows, names))

    def _entity(self, name: str) -> str:
        return f"plots/{name}/flight_{self.number}" if self.number else f"plots/{name}"

    def _groups(self) -> list[tuple[str, list[str]]]:
        by_group = {
            group: [jet.name for jet in self.vehicle.rcs.thrusters if jet.group == group] for group in GROUPS
        }
        return [
            (group, names)
            for group, names in by_group.items()
            if names and set(names) <= set(self.flight.jets)
        ]

    def _lines(self, lines: Sequence[tuple[str, str]]) -> rr.SeriesLines:
        """Lines of some names and colours; where there are several flights, they carry the flight's label,
        and its colour, the darker the later in the plot.
        """
        colours = np.array([rgb(colour) for _, colour in lines])
        if self.label:
            colours = np.outer(1.0 - 0.55 * np.arange(len(lines)) / len(lines), self.own).astype(int)
        return self.rr.SeriesLines(
            names=[f"{self.label}: {name}" if self.label else name for name, _ in lines],
            colors=colours.tolist(),
            widths=[1.0 if self.number else 1.5] * len(lines),
            aggregation_policy=self.rr.components.AggregationPolicy.MinMax,  # a mean would lose the peaks
        )

    def _scalars(self, entity: str, t: np.ndarray, values: np.ndarray) -> None:
        columns = self.rr.Scalars.columns(scalars=values.ravel())
        self.columns(self._entity(entity), t, columns.partition(np.full(len(t), values.shape[1])))


def shown(flight: History) -> list[Plot]:
    """The plots that a flight has something for."""
    pages = [plots for page, plots in PAGES.items() if flight.jets or page not in OF_JETS]
    own = {plot.key: plot for plots in pages for plot in plots}
    return [found for plot in own.values() if (found := plot.shown(flight.series)) is not None]


def drawn(plot: Plot, flight: History) -> tuple[np.ndarray, np.ndarray]:
    """Times (s), shape (n,), and curves of a plot, shape (n, curves), where they mean something."""
    t = flight.series["t_s"]
    rows = _within(t, flight.when.get(plot.since, -np.inf), flight.when.get(plot.until, np.inf))
    return t[rows], np.stack(plot.values(flight.series, rows), axis=-1)


def ends(t: np.ndarray, curves: np.ndarray, span: tuple[float, float]) -> list[float]:
    """Least and largest value of curves within a time (s); empty where there are none."""
    values = curves[_within(t, *span)]
    values = values[np.isfinite(values)]
    return [float(values.min()), float(values.max())] if len(values) else []


def axis_range(low: float, high: float) -> tuple[float, float]:
    """First and last value of an axis on which values from ``low`` to ``high`` are drawn, with two ticks."""
    if abs(low + high) < 3.0 * (high - low):  # zero is near
        low, high = min(low, 0.0), max(high, 0.0)
    if high - low < 1e-9 * max(abs(low), abs(high), 1.0):
        low, high = low - 0.5, high + 0.5
    step = 10.0 ** np.ceil(np.log10((high - low) / STEPS))
    if _ticks(low, high, step) < 2:
        high = step * np.ceil(high / step)
    if _ticks(low, high, step) < 2:
        low = step * np.floor(low / step)
    room = ROOM * (high - low)
    return float(low - room), float(high + room)


def _within(t: np.ndarray, first: float, last: float) -> slice:
    """Rows from one time (s) to another, both among them."""
    return slice(int(np.searchsorted(t, first)), int(np.searchsorted(t, last, side="right")))


def _ticks(low: float, high: float, step: float) -> int:
    return int(np.floor(high / step + 1e-9) - np.ceil(low / step - 1e-9)) + 1
