"""What can be asked of a flight, whether it has just been flown or is read from its files."""

from __future__ import annotations

import io
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from edl6dof.api.optional import library
from edl6dof.metrics.evaluation import Check

if TYPE_CHECKING:
    import pandas
    import xarray

    from edl6dof.report.matplotlib_figure import Canvas


class FlightResults(ABC):
    """A flight as columns, tables and plots."""

    @property
    @abstractmethod
    def name(self) -> str:
        """Name of the scenario."""

    @property
    @abstractmethod
    def outcome(self) -> str:
        """How it ended, in words."""

    @property
    @abstractmethod
    def success(self) -> bool:
        """Whether it reached the goal of the mission within all limits."""

    @property
    @abstractmethod
    def time_s(self) -> float:
        """When it ended, s."""

    @property
    @abstractmethod
    def telemetry(self) -> Mapping[str, np.ndarray]:
        """Columns by name, each shape (rows,), in the unit of the name's suffix."""

    @property
    @abstractmethod
    def events(self) -> Sequence[Mapping[str, Any]]:
        """The timeline: mappings with ``t_s``, ``key``, ``name``, ``detail`` and the state then."""

    @property
    @abstractmethod
    def metrics(self) -> Mapping[str, float | None]:
        """Figures by name with unit suffix."""

    @property
    @abstractmethod
    def checks(self) -> Sequence[Check]:
        """Every limit with this flight's value."""

    @abstractmethod
    def unit(self, name: str) -> str:
        """Printed unit of a channel."""

    @abstractmethod
    def meaning(self, name: str) -> str:
        """What a channel means."""

    def __repr__(self) -> str:
        rows = len(self.telemetry["t_s"])
        return f"<Flight {self.name}: {self.outcome} at t = {self.time_s:.1f} s, {rows} rows of telemetry>"

    def _repr_html_(self) -> str:
        """Outcome, timeline, limits and a small figure, for notebooks."""
        from edl6dof.api.html import flight_html

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
        """Plot channels; those of one unit share a panel.

        Args:
            channels: names, or patterns such as ``"truth.rate_*"``.
            against: channel of the x axis.
            since_s: first time, s.
            until_s: last time, s.

        Raises:
            ConfigError: there is no such channel, or nothing between these times.
            TypeError: a channel is no name.
        """
        from edl6dof.config.errors import refusal
        from edl6dof.report.channels import channel_plot, chosen
        from edl6dof.report.matplotlib_figure import styled

        if wrong := [one for one in channels if not isinstance(one, str)]:
            raise TypeError(f"channels are names, one after the other: plot('truth.mach') (got {wrong[0]!r})")
        if not channels:
            raise refusal("plot", "name a channel, such as truth.mach; flight.telemetry has them all")
        names = chosen(self, channels, self.name)
        (x,) = chosen(self, [against], self.name)
        t = self.telemetry["t_s"]
        rows = (t >= (-np.inf if since_s is None else since_s)) & (
            t <= (np.inf if until_s is None else until_s)
        )
        if not rows.any():
            raise refusal(self.name, f"has no telemetry between these times ({t[0]:g} to {t[-1]:g} s)")
        return Plot(styled(channel_plot(self, names, x, rows)))

    def to_pandas(self) -> pandas.DataFrame:
        """Telemetry as a data frame indexed by time.

        Raises:
            ImportError: pandas is not installed.
        """
        return library("pandas", "to_pandas").DataFrame(dict(self.telemetry)).set_index("t_s")

    def to_xarray(self) -> xarray.Dataset:
        """Telemetry as a data set along time, with unit and meaning of each variable.

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
    """A plot, which a notebook shows.

    Attributes:
        figure: of matplotlib.
    """

    figure: Canvas

    def save(self, path: str | Path, dpi: int = 200) -> None:
        """Write it in the form that the suffix names: ``.png``, ``.pdf`` or ``.svg``."""
        self.figure.savefig(path, dpi=dpi)

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.figure.savefig(buffer, format="png", dpi=110)
        return buffer.getvalue()
