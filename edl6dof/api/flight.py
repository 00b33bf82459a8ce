"""Flights as objects of the API, flown or read from the folder of a run: columns, tables and plots."""

from __future__ import annotations

import base64
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import fields
from functools import cached_property
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from edl6dof.api.arguments import library, naming_arguments
from edl6dof.api.plots import ColumnsInMemory, Plot, Plots
from edl6dof.config.errors import refusal
from edl6dof.metrics.evaluation import Check, Figures
from edl6dof.metrics.figures import LIMITS
from edl6dof.report.catalogue import Columns, channel_plot, chosen
from edl6dof.report.terminal import LIMIT_STATUS, aligned_pair
from edl6dof.runs.files import atomic_folder
from edl6dof.runs.run import Run, write_run
from edl6dof.scenario.loading import viewed_scenario
from edl6dof.sim import flight as sim
from edl6dof.sim.flight import attitude_at

if TYPE_CHECKING:
    import pandas
    import xarray
    from pyquaternion import Quaternion

    from edl6dof.replay.history import Flown
    from edl6dof.report.figure import Figure
    from edl6dof.scenario.loaded import LoadedScenario
    from edl6dof.scenario.schema import Scenario
    from edl6dof.telemetry.columns import Telemetry
    from edl6dof.telemetry.landing_map import LandingMap

    class _Flight(Flown, Protocol):
        """A flight, flown or recorded, as :class:`FlightResults` needs it."""

        @property
        def time_s(self) -> float: ...
        @property
        def checks(self) -> Sequence[Check]: ...
        @property
        def figures(self) -> Mapping[str, float | None]: ...
        @property
        def telemetry(self) -> Telemetry | Run: ...


#: Name of the 3D replay in the folder of a run.
REPLAY = "replay.rrd"
#: Channels of the small figure in a notebook.
SHOWN = ("truth.height_m", "truth.mach")
_GOOD, _BAD = "#1a7f37", "#b42318"


class FlightResults:
    """A flight as columns, tables and plots."""

    def __repr__(self: _Flight) -> str:
        rows = len(self.telemetry["t_s"])
        return f"<Flight {self.name}: {self.outcome} at t = {self.time_s:.1f} s, {rows} rows of telemetry>"

    def _repr_html_(self: _Flight) -> str:
        """Outcome, timeline, limits and a small figure, for notebooks."""
        return _html(self)

    def __getitem__(self: _Flight, channel: str) -> np.ndarray:
        return self.telemetry[channel]

    def __iter__(self: _Flight) -> Iterator[str]:
        return iter(self.telemetry)

    def unit(self: _Flight, name: str) -> str:
        """Return the printed unit of a channel."""
        return self.telemetry.unit(name)

    def meaning(self: _Flight, name: str) -> str:
        """Return the meaning of a channel."""
        return self.telemetry.meaning(name)

    @naming_arguments(**{"from": "since_s"})
    def plot(
        self: _Flight,
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
        if wrong := [one for one in channels if not isinstance(one, str)]:
            raise TypeError(f"channels are names, one after the other: plot('truth.mach') (got {wrong[0]!r})")
        if not channels:
            raise refusal("plot", "name a channel, such as truth.mach; flight.telemetry has them all")
        return Plot.of(channels_figure(self.telemetry, self.name, channels, against, since_s, until_s))

    @property
    def plots(self: _Flight) -> Plots:
        """Plots of the report over time for which the flight has data: ``flight.plots.rates``."""
        table = self.telemetry
        known = table if isinstance(table, Run) else ColumnsInMemory(table, self.events, self.figures)
        return Plots(known)

    def to_pandas(self: _Flight) -> pandas.DataFrame:
        """Return the telemetry as a data frame indexed by time.

        Raises:
            ImportError: pandas is not installed.
        """
        return library("pandas", "to_pandas").DataFrame(dict(self.telemetry)).set_index("t_s")

    def to_xarray(self: _Flight) -> xarray.Dataset:
        """Return the telemetry as a data set along time, with unit and meaning of each variable.

        Raises:
            ImportError: xarray is not installed.
        """
        table = self.telemetry
        columns = {
            name: ("t_s", np.asarray(values), {"units": table.unit(name), "long_name": table.meaning(name)})
            for name, values in table.items()
        }
        time = {"t_s": columns.pop("t_s")}
        about = {"name": self.name, "outcome": self.outcome}
        return library("xarray", "to_xarray").Dataset(columns, time, about)


class Flight(sim.Flight, FlightResults):
    """A flight flown by this process; :class:`edl6dof.sim.flight.Flight` describes its contents.

    Attributes:
        differences: columns that differ from the row of the case, if a case of a campaign was flown again.
        folder: folder to which it was saved last; ``None`` if it is in memory only.
    """

    differences: tuple[str, ...] = ()
    folder: Path | None = None

    @classmethod
    def of(cls, flight: sim.Flight) -> Flight:
        """Make an object of the API from a flight."""
        return cls(**{field.name: getattr(flight, field.name) for field in fields(flight)})

    def save(self, folder: str | Path, *, replay: bool = True, force: bool = False) -> Path:
        """Write the folder of a run, as ``edl6dof fly`` does.

        Raises:
            ConfigError: the folder exists and must not be replaced, or cannot be written.
        """
        flown_into(Path(folder), lambda: self, replay=replay, force=force)
        return Path(folder)

    def write(self, folder: Path, replay: bool = True, release: bool = False) -> None:
        """Write all files of a run into a folder that exists.

        Args:
            folder: folder of the run.
            replay: True to write the 3D replay.
            release: True to free the telemetry once it is written and keep only the results; the replay
                needs as much memory again.
        """
        write_run(self, folder)
        if self.saved is not None:
            self.saved.save(folder / "state.npz")
        if replay:
            from edl6dof.replay.recording import history, write_replay

            shown = history(self)
            if release:
                self.release_log()
            write_replay([shown], folder / REPLAY)


class RecordedFlight(FlightResults):
    """A flight that is read from the folder of a run; the hash of every file is checked before use.

    Attributes:
        folder: folder of the run.
        name: name of the scenario.
        outcome: outcome of the flight in words.
        success: True if the flight reached the goal of the mission within all limits.
        time_s: time at the end of the flight, s.
        phase: name of the last phase.
        events: events in the order of time: mappings with ``t_s``, ``key``, ``name``, ``detail`` and the
            state.
        figures: figures by name with unit suffix; ``None`` for a figure that could not be computed.
        checks: every limit with the value of this flight.
        telemetry: columns by name, each shape (rows,), in the unit of the name's suffix, read at first use.
    """

    def __init__(self, folder: Path):
        self.folder, self.telemetry = folder, Run(folder)
        summary = self.telemetry.summary
        self.name, self.outcome, self.success = summary["name"], summary["outcome"], summary["success"]
        self.time_s, self.phase = summary["time_s"], summary["phase"]
        self.events: Sequence[Mapping] = self.telemetry.events
        self.figures: Figures[float | None] = Figures(summary["figures"])
        limited = {figure.meaning: figure for figure in LIMITS}
        self.checks = [
            Check(
                limited[limit["name"]].name if limit["name"] in limited else "",
                limit["name"],
                math.nan if limit["value"] is None else limit["value"],
                limit["limit"],
                limit["unit"],
                limit["least"],
            )
            for limit in summary["limits"]
        ]

    @property
    def phase_names(self) -> list[str]:
        """Names of the mission phases; ``guide.phase`` is the index."""
        return self.telemetry.phase_names

    @property
    def landing_map(self) -> LandingMap | None:
        """Map of the ground from the scan of the lander, and the chosen spot; ``None`` without a scan."""
        return self.telemetry.landing_map

    @cached_property
    def scenario(self) -> Scenario:
        """The resolved scenario, without parts that only a plugin defines."""
        return viewed_scenario(self.scenario_text, str(self.folder / "scenario.yaml")).scenario

    @property
    def scenario_text(self) -> str:
        """The resolved scenario as YAML."""
        return self.telemetry.scenario_text

    def attitude(self, t: float) -> Quaternion:
        """Return the attitude at time ``t`` (s); see :meth:`edl6dof.sim.flight.Flight.attitude`."""
        return attitude_at(t, self["t_s"], [self[f"truth.q_I2B_{c}"] for c in "wxyz"])


def fly_loaded(
    loaded: LoadedScenario, out: str | Path | None, *, replay: bool, force: bool, **options: Any
) -> Flight:
    """Fly a scenario, into a folder or into memory; ``options`` as for :func:`edl6dof.sim.flight.fly`.

    Raises:
        ConfigError: the folder exists and must not be replaced, or cannot be written.
    """

    def flown() -> Flight:
        return Flight.of(sim.fly(loaded, **options))

    return flown() if out is None else flown_into(Path(out), flown, replay=replay, force=force)


def flown_into(
    folder: Path, fly: Callable[[], Flight], *, replay: bool, force: bool, release: bool = False
) -> Flight:
    """Fly and write the folder of the run, which is reserved before the flight; see :meth:`Flight.write`.

    Raises:
        ConfigError: the folder exists and must not be replaced, or cannot be written.
    """
    with atomic_folder(folder, "flight", force) as partial:
        flight = fly()
        flight.write(partial, replay, release)
    flight.folder = folder
    return flight


def channels_figure(
    columns: Columns,
    place: object,
    patterns: Sequence[str],
    against: str = "t_s",
    since_s: float | None = None,
    until_s: float | None = None,
    *,
    apart: bool = False,
) -> Figure:
    """Plot the channels that match, as :meth:`FlightResults.plot`, each ``apart`` in its own panel if wished;
    ``place`` names the flight in messages.

    Raises:
        ConfigError: there is no such channel, or no data between these times.
    """
    if since_s is not None and until_s is not None and since_s > until_s:
        raise refusal("--from", f"must not be after the last time, {until_s:g} s (got {since_s:g} s)")
    names, (x,) = chosen(columns, patterns, place), chosen(columns, [against], place)
    t = columns["t_s"]
    rows = (t >= (-np.inf if since_s is None else since_s)) & (t <= (np.inf if until_s is None else until_s))
    if not rows.any():
        words = f"has no telemetry between the given times (it runs from {t[0]:g} to {t[-1]:g} s)"
        raise refusal(place, words)
    return channel_plot(columns, names, x, rows, apart)


def _html(flight: _Flight) -> str:
    """Return a flight as self-contained HTML."""
    colour = _GOOD if flight.success else _BAD
    outcome = f'<span style="color:{colour}">{escape(flight.outcome)}</span>'
    head = f"<p><b>{escape(flight.name)}</b>: {outcome} at t = {flight.time_s:.1f} s</p>"
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


def _picture(flight: _Flight) -> str:
    """Return a plot of height and Mach number as HTML; empty if the telemetry is brief or freed."""
    columns = flight.telemetry
    if not set(SHOWN) <= set(columns) or len(columns["t_s"]) < 2:
        return ""
    picture = Plot.of(channels_figure(columns, flight.name, SHOWN))._repr_png_()
    coded = base64.b64encode(picture).decode("ascii")
    return f'<img width="480" alt="height and Mach number" src="data:image/png;base64,{coded}">'


def _number(value: float | None, form: str) -> str:
    return f"{value:{form}}" if value is not None and math.isfinite(value) else ""


def html_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table of texts as HTML."""
    cells = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{cells}</tr></thead><tbody>{body}</tbody></table>"
