"""The plots over time, and the phase planes with the zones of the controller at work.

The viewer puts its ticks at multiples of a power of ten, and leaves out those that would stand closer than a
line of text: of seven or more in a plot a sixth of a window high, only the one at zero remains.  It draws a
legend over the curves; a legend therefore gets the corner with the most room, and the axis is extended as far
as room is lacking.  On a page that shows the time around the present, the viewer itself fits the axis.

Phase planes have the attitude error (goal minus actual) across and the body's rate upwards (bank control
subtracts the slow turn of the velocity frame).  Both axes are compressed beyond about one unit (arsinh), so
that a bank reversal and the last tenth of a degree fit into one picture.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from edl6dof.replay.history import History, thin, vector
from edl6dof.replay.pages import NAVIGATION, OF_JETS, PAGES, SHARES, plot_columns
from edl6dof.replay.recorder import SLOW_HZ, Recorder
from edl6dof.report.catalogue import ALTITUDE, Plot
from edl6dof.report.flight.phase_planes import zones_of
from edl6dof.report.palette import BLUE, GREEN, ORANGE, VERMILION, rgb
from edl6dof.telemetry.thinning import rows_to_draw

if TYPE_CHECKING:
    import rerun as rr

#: Telemetry columns that the plots show: of every flight, and of a flight that navigates on instruments.
_PLOTS = [plot for page, plots in PAGES.items() if page != NAVIGATION for plot in plots]
COLUMNS = tuple(dict.fromkeys(name for plot in _PLOTS for name in plot.channels))
NAVIGATION_COLUMNS = tuple(name for plot in PAGES[NAVIGATION] for name in plot.channels)
#: Approximate limit on the rows of a plot: more than a screen has columns of pixels.
MOST = 6000
#: Most steps between ticks that a plot of the least height has room for.
STEPS = 5.5
#: Room above and below the curves, share of the range.
ROOM = 0.06
#: Width and height (px) of the window for which legends are laid out; height of the plots of a page, and what
#: axes and title take of the width and height of a plot; width of a letter and height of a line of a legend,
#: and its width and height without them.
WINDOW_PX, PLOTS_PX, AROUND_PX, LETTER_PX, LEGEND_PX = 1920, 763, (50, 44), (6.5, 23.0), (30, 8)
AXES = ("roll", "pitch", "yaw")
#: Telemetry columns that the phase planes show.
PLANE_COLUMNS = (
    *(f"control.error_{axis}_deg" for axis in AXES),
    *(f"truth.rate_{axis}_deg_s" for axis in "pqr"),
)
TICKS = (-100, -30, -10, -3, -1, 0, 1, 3, 10, 30, 100)
#: Ends of the axes of a phase plane, deg and deg/s.
REACH_DEG, REACH_DEG_S = 180.0, 40.0
GRID, ZERO = (40, 40, 46), (86, 86, 94)
Line = tuple[np.ndarray, tuple[int, int, int]]


class Charts(Recorder):
    """Writes the plots over time, entity ``/plots``."""

    def statics(self) -> None:
        """Write names and colours of the series."""
        for plot in shown(self.flight, bool(self.label)):
            lines = [(name, colour) for name, colour, _ in plot.lines]
            self.static(self._entity(plot.key), self._lines(lines))

    def motions(self) -> None:
        """Write each series over the time in which it is valid."""
        for plot in shown(self.flight, bool(self.label)):
            t, curves = drawn(plot, self.flight)
            if len(t):
                rows = rows_to_draw(t, curves, MOST)
                self._scalars(plot.key, t[rows], curves[rows])

    def _entity(self, name: str) -> str:
        return f"plots/{name}/flight_{self.number}" if self.number else f"plots/{name}"

    def _lines(self, lines: Sequence[tuple[str, str]]) -> rr.SeriesLines:
        """Look of lines (name, colour); with several flights, the flight's label is added, and shades of its
        colour replace the colours.
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


def shown(flight: History, one_of_several: bool = False) -> list[Plot]:
    """Return the plots for which a flight has data; of several flights, one height: there is no room for the
    legend of more.
    """
    pages = [plots for page, plots in PAGES.items() if flight.jets or page not in OF_JETS]
    own = {plot.key: plot for plots in pages for plot in plots}
    if one_of_several:
        own[ALTITUDE.key] = own[ALTITUDE.key]._replace(curves={"truth.height_m": "above the ground"})
    return [found for plot in own.values() if (found := plot.shown(flight.series)) is not None]


def drawn(plot: Plot, flight: History) -> tuple[np.ndarray, np.ndarray]:
    """Return times (s), shape (n,), and curves of a plot, shape (n, curves), where it is valid."""
    t = flight.series["t_s"]
    rows = _within(t, flight.when.get(plot.since, -np.inf), flight.when.get(plot.until, np.inf))
    return t[rows], np.stack(plot.values(flight.series, rows), axis=-1)


def ends(t: np.ndarray, curves: np.ndarray, span: tuple[float, float]) -> list[float]:
    """Return least and largest value of curves within a time (s); empty if there are none."""
    values = curves[_within(t, *span)]
    values = values[np.isfinite(values)]
    return [float(values.min()), float(values.max())] if len(values) else []


def axis_range(low: float, high: float) -> tuple[float, float]:
    """Return the range of an axis for values from ``low`` to ``high``, with two ticks."""
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


class Frame(NamedTuple):
    """First and last value on the axis of a plot, and the corner of its legend."""

    axis: tuple[float, float]
    corner: Literal["RightTop", "RightBottom", "LeftTop", "LeftBottom"]


def legend(plot: Plot, label: str) -> list[str]:
    """Return the names in the legend of a plot for the flight with a label, empty if it is alone."""
    return list(dict.fromkeys(f"{label}: {name}" if label else name for name, _, _ in plot.lines))


def legend_share(page: str, count: int, names: Sequence[str]) -> tuple[float, float]:
    """Return width and height of a legend as shares of each of the ``count`` plots of a page."""
    columns, share = plot_columns(page, count), SHARES[page][-1] / sum(SHARES[page])
    width = WINDOW_PX * share / columns - AROUND_PX[0]
    height = PLOTS_PX / -(-count // columns) - AROUND_PX[1]
    wide, high = LEGEND_PX[0] + LETTER_PX[0] * max(map(len, names)), LEGEND_PX[1] + LETTER_PX[1] * len(names)
    return wide / width, min(high / height, 0.6)


def framed(whole: Sequence[float], left: Sequence[float], right: Sequence[float], height: float) -> Frame:
    """Return the frame of curves with the ends ``whole``, so that a legend of some ``height`` (share of the
    plot) covers none; ``left`` and ``right``: ends of the curves in its width at both sides.
    """
    low, high = whole
    while True:
        first, last = axis_range(low, high)
        room: dict[Any, float] = {}
        for side, values in (("Right", right), ("Left", left)):
            bottom, top = values or (np.inf, -np.inf)
            room |= {f"{side}Top": (last - top) / (last - first)}
            room |= {f"{side}Bottom": (bottom - first) / (last - first)}
        corner = max(room, key=lambda name: room[name])
        lacking = (height - room[corner]) * (last - first) / (1.0 - height)
        if lacking <= 1e-6 * (last - first):
            return Frame((first, last), corner)
        if corner.endswith("Top"):
            high += lacking
        else:
            low -= lacking


def frames(
    flights: Sequence[History], spans: Mapping[str, tuple[float, float]], labels: Sequence[str]
) -> dict[tuple[str, str], Frame]:
    """Return the frame of each plot, by page and key, in the time (s) of the page; ``labels``: of flights."""
    found = {}
    plots = [{plot.key: plot for plot in shown(flight, len(flights) > 1)} for flight in flights]
    for page, (first, last) in spans.items():
        keys = [plot.key for plot in PAGES[page] if plot.key in plots[0]]
        for key in keys:
            having = [k for k, own in enumerate(plots) if key in own]
            names = [name for k in having for name in legend(plots[k][key], labels[k])]
            width, height = legend_share(page, len(keys), names) if len(names) > 1 else (0.0, 0.0)
            room, curves = width * (last - first), [drawn(plots[k][key], flights[k]) for k in having]
            of_whole, of_left, of_right = (
                [value for one in curves for value in ends(*one, within)]
                for within in ((first, last), (first, first + room), (last - room, last))
            )
            if of_whole:
                left, right = ([min(of), max(of)] if of else [] for of in (of_left, of_right))
                found[page, key] = framed([min(of_whole), max(of_whole)], left, right, height)
    return found


def _within(t: np.ndarray, first: float, last: float) -> slice:
    """Rows from one time (s) to another, inclusive."""
    return slice(int(np.searchsorted(t, first)), int(np.searchsorted(t, last, side="right")))


def _ticks(low: float, high: float, step: float) -> int:
    return int(np.floor(high / step + 1e-9) - np.ceil(low / step - 1e-9)) + 1


def squeeze(x: np.ndarray | float) -> np.ndarray:
    """Compress values: linear below one unit, logarithmic beyond; 180 maps to 1."""
    return np.arcsinh(x) / np.arcsinh(180.0)


def on_picture(error_deg: np.ndarray, rate_deg_s: np.ndarray) -> np.ndarray:
    """Return picture coordinates (x right, y down), shape (..., 2)."""
    return np.stack(np.broadcast_arrays(squeeze(error_deg), -squeeze(rate_deg_s)), axis=-1)


class PhasePlanes(Recorder):
    """Writes ``/phase_plane``."""

    def statics(self) -> None:
        """Write grid and scales."""
        if not self.flight.jets:
            return
        x, y = squeeze(REACH_DEG), squeeze(REACH_DEG_S)
        rates = [k for k in TICKS if abs(k) < REACH_DEG_S]
        grid = [[[squeeze(k), -y], [squeeze(k), y]] for k in TICKS]
        grid += [[[-x, -squeeze(k)], [x, -squeeze(k)]] for k in rates]
        colours = [ZERO if k == 0 else GRID for k in (*TICKS, *rates)]
        named = [k for k in TICKS if k % 10 == 0 or abs(k) < 2]
        places = [[squeeze(k), y + 0.045] for k in named] + [[-x - 0.07, -squeeze(k)] for k in rates]
        names = [f"{k}°" for k in named] + [f"{k}°/s" for k in rates]
        scale = self.rr.Points2D(places, labels=names, colors=(150, 150, 160), radii=-0.01, show_labels=True)
        for axis in AXES:
            lines = self.rr.LineStrips2D(grid, colors=colours, radii=-0.6)
            self.static(f"phase_plane/{axis}/grid", lines)
            self.static(f"phase_plane/{axis}/scale", scale)

    def motions(self) -> None:
        """Write zones by phase, the path of the last seconds, and the present state."""
        if len(self.t) < 5 or not self.flight.jets:
            return
        rr, rows = self.rr, thin(self.t, SLOW_HZ)
        error = vector(self.flight.columns, "control.error", "roll pitch yaw", "_deg")
        rate = vector(self.flight.columns, "truth.rate", "p q r", "_deg_s")
        for k, axis in enumerate(AXES):
            plane, place = f"phase_plane/{axis}", on_picture(error[rows, k], rate[rows, k])
            self._zones(k, f"{plane}/zones")
            line, way = {"colors": rgb(BLUE), "radii": -1.2}, np.stack([place[:-1], place[1:]], axis=1)
            self.series(f"{plane}/way", self.t[rows[1:]], rr.LineStrips2D, line, {"strips": way})
            point = {"colors": (255, 255, 255), "radii": -4.0}
            self.series(f"{plane}/now", self.t[rows], rr.Points2D, point, {"positions": place})

    def _zones(self, axis: int, entity: str) -> None:
        """Write the lines of the controller of each phase."""
        phases = self.flight.scenario.mission.phases
        for row in np.append(0, np.flatnonzero(np.diff(self.phase)) + 1):
            name = phases[self.phase[row]].control if phases else "off"
            gains = getattr(self.flight.scenario.flight_software.control, name, None)
            lines = boundaries({} if gains is None else gains.model_dump(), axis)
            if lines:
                strips, colours = zip(*lines, strict=True)
                self.at(self.t[row], entity, self.rr.LineStrips2D(strips, colors=colours, radii=-1.0))
            else:
                self.gone(self.t[row], entity)


def boundaries(gains: Mapping[str, Any], axis: int) -> list[Line]:
    """Return lines of a controller's zones on the picture for axis 0 roll, 1 pitch, 2 yaw."""
    zones = zones_of(gains, axis)
    inside = (np.abs(zones.error) <= REACH_DEG) & (np.abs(zones.rate) <= REACH_DEG_S)
    error, rate = zones.error[inside], zones.rate[inside]
    across, up, both = np.array([-REACH_DEG, REACH_DEG]), np.array([-REACH_DEG_S, REACH_DEG_S]), (-1.0, 1.0)
    lines = [(on_picture(sign * error, sign * rate), rgb(GREEN)) for sign in both if zones.name]
    lines += [(on_picture(np.full(2, sign * at), up), rgb(ORANGE)) for at in zones.errors for sign in both]
    lines += [
        (on_picture(across, np.full(2, sign * at)), rgb(VERMILION)) for at in zones.rates for sign in both
    ]
    return lines
