"""A flight as columns, tables and plots, flown or read from its files."""

from __future__ import annotations

import base64
import io
import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from edl6dof.api.arguments import library
from edl6dof.config.errors import refusal
from edl6dof.metrics.evaluation import Check
from edl6dof.report.catalogue import Columns, channel_plot, chosen
from edl6dof.report.terminal import LIMIT_STATUS, aligned_pair

if TYPE_CHECKING:
    import pandas
    import xarray

    from edl6dof.report.figure import Figure
    from edl6dof.report.matplotlib_figure import Canvas

#: Channels of the small figure in a notebook.
SHOWN = ("truth.height_m", "truth.mach")
_GOOD, _BAD = "#1a7f37", "#b42318"


class FlightResults(ABC):
    """A flight as columns, tables and plots."""

    @property
    @abstractmethod
    def name(self) -> str:
        """Name of the scenario."""

    @property
    @abstractmethod
    def outcome(self) -> str:
        """Outcome of the flight in words."""

    @property
    @abstractmethod
    def success(self) -> bool:
        """True if the flight reached the goal of the mission within all limits."""

    @property
    @abstractmethod
    def time_s(self) -> float:
        """Time at the end of the flight, s."""

    @property
    @abstractmethod
    def telemetry(self) -> Mapping[str, np.ndarray]:
        """Columns by name, each shape (rows,), in the unit of the name's suffix."""

    @property
    @abstractmethod
    def events(self) -> Sequence[Mapping[str, Any]]:
        """Events in the order of time: mappings with ``t_s``, ``key``, ``name``, ``detail`` and the state."""

    @property
    @abstractmethod
    def checks(self) -> Sequence[Check]:
        """Every limit with the value of this flight."""

    @abstractmethod
    def unit(self, name: str) -> str:
        """Return the printed unit of a channel."""

    @abstractmethod
    def meaning(self, name: str) -> str:
        """Return the meaning of a channel."""

    def __repr__(self) -> str:
        rows = len(self.telemetry["t_s"])
        return f"<Flight {self.name}: {self.outcome} at t = {self.time_s:.1f} s, {rows} rows of telemetry>"

    def _repr_html_(self) -> str:
        """Outcome, timeline, limits and a small figure, for notebooks."""
        return flight_html(self)

    def __getitem__(self, channel: str) -> np.ndarray:
        return self.telemetry[channel]

    def __iter__(self) -> Iterator[str]:
        return iter(self.telemetry)

    def plot(
        self,
        *channels: str,
        against: str = "t_s",
        since_s: float | None = None,
        until_s: float | None = None,
    ) -> Plot:
        """Plot channels; channels with the same unit share a panel.

        Args:
            channels: names, or patterns such as ``"truth.rate_*"``.
            against: channel of the x axis.
            since_s: first time, s.
            until_s: last time, s.

        Raises:
            ConfigError: there is no such channel, or no data between these times.
            TypeError: a channel is not a name.
        """
        from edl6dof.report.matplotlib_figure import matplotlib_figure

        if wrong := [one for one in channels if not isinstance(one, str)]:
            raise TypeError(f"channels are names, one after the other: plot('truth.mach') (got {wrong[0]!r})")
        if not channels:
            raise refusal("plot", "name a channel, such as truth.mach; flight.telemetry has them all")
        figure = channels_figure(self, self.name, channels, against, since_s, until_s)
        return Plot(matplotlib_figure(figure))

    def to_pandas(self) -> pandas.DataFrame:
        """Return the telemetry as a data frame indexed by time.

        Raises:
            ImportError: pandas is not installed.
        """
        return library("pandas", "to_pandas").DataFrame(dict(self.telemetry)).set_index("t_s")

    def to_xarray(self) -> xarray.Dataset:
        """Return the telemetry as a data set along time, with unit and meaning of each variable.

        Raises:
            ImportError: xarray is not installed.
        """
        columns = {
            name: ("t_s", np.asarray(values), {"units": self.unit(name), "long_name": self.meaning(name)})
            for name, values in self.telemetry.items()
        }
        time = {"t_s": columns.pop("t_s")}
        return library("xarray", "to_xarray").Dataset(
            columns, time, {"name": self.name, "outcome": self.outcome}
        )


@dataclass(frozen=True)
class Plot:
    """A plot that a notebook can show.

    Attributes:
        figure: figure of matplotlib.
    """

    figure: Canvas

    def save(self, path: str | Path, dpi: int = 200) -> None:
        """Write the plot in the format of the suffix: ``.png``, ``.pdf`` or ``.svg``."""
        self.figure.savefig(path, dpi=dpi)

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.figure.savefig(buffer, format="png", dpi=110)
        return buffer.getvalue()


def channels_figure(
    columns: Columns,
    place: object,
    patterns: Sequence[str],
    against: str = "t_s",
    since_s: float | None = None,
    until_s: float | None = None,
) -> Figure:
    """Plot the channels that match, as :meth:`FlightResults.plot`; ``place`` names the flight in messages.

    Raises:
        ConfigError: there is no such channel, or no data between these times.
    """
    names, (x,) = chosen(columns, patterns, place), chosen(columns, [against], place)
    t = columns["t_s"]
    rows = (t >= (-np.inf if since_s is None else since_s)) & (t <= (np.inf if until_s is None else until_s))
    if not rows.any():
        words = f"has no telemetry between the given times (it runs from {t[0]:g} to {t[-1]:g} s)"
        raise refusal(place, words)
    return channel_plot(columns, names, x, rows)


def flight_html(flight: FlightResults) -> str:
    """Return a flight as self-contained HTML."""
    colour = _GOOD if flight.success else _BAD
    head = (
        f'<p><b>{escape(flight.name)}</b>: <span style="color:{colour}">{escape(flight.outcome)}</span> '
        f"at t = {flight.time_s:.1f} s</p>"
    )
    formats = {"height_m": ",.0f", "speed_m_s": ",.1f", "mach": ".2f"}
    events = [
        (f"{event['t_s']:.2f}", str(event["name"]), *(_number(event[key], formats[key]) for key in formats))
        for event in flight.events
    ]
    checks = [
        (one.label, one.unit, *aligned_pair(one.value, one.limit, one.ok), LIMIT_STATUS[one.ok])
        for one in flight.checks
    ]
    timeline = html_table(("t (s)", "event", "height (m)", "speed (m/s)", "Mach"), events)
    limits = html_table(("limit", "unit", "this flight", "allowed", ""), checks)
    return f"<div>{head}{_picture(flight)}<div>{timeline}</div><div>{limits}</div></div>"


def _picture(flight: FlightResults) -> str:
    """Return a plot of height and Mach number as HTML; empty if the telemetry is brief or freed."""
    channels = [name for name in SHOWN if name in flight.telemetry]
    if len(channels) < len(SHOWN) or len(flight.telemetry["t_s"]) < 2:
        return ""
    picture = base64.b64encode(flight.plot(*channels)._repr_png_()).decode("ascii")
    return f'<img width="480" alt="height and Mach number" src="data:image/png;base64,{picture}">'


def _number(value: float | None, form: str) -> str:
    return f"{value:{form}}" if value is not None and math.isfinite(value) else ""


def html_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table of texts as HTML."""
    cells = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{cells}</tr></thead><tbody>{body}</tbody></table>"
