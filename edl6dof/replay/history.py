"""The data of a replay: the rows of a flight with a finite place and attitude, thinned."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from edl6dof.telemetry.columns import columns_of, instruments
from edl6dof.telemetry.timeline import first_times

if TYPE_CHECKING:
    from edl6dof.scenario.schema import Scenario
    from edl6dof.telemetry.landing_map import LandingMap

#: Rate of the thinned rows, Hz.
POSE_HZ = 25.0
#: Least duty of a thruster that counts as firing.
FIRING = 0.02
#: Number of rows beyond which only those near an event are all kept, and time (s) from an event that is near.
MANY, BESIDE_S = 30_000, 60.0

#: Bodies that have columns of their place, and the columns of all places and poses.
PARTS = ("site", "canopy", "heat_shield", "backshell")
POSES = (
    *(f"truth.{one}_{axis}_m" for one in PARTS for axis in ("east", "north", "up")),
    *(f"truth.q_I2B_{axis}" for axis in "wxyz"),
    *(f"truth.centre_{axis}_m" for axis in "xyz"),
    *(f"truth.v_{axis}_m_s" for axis in ("north", "east", "down")),
    *(f"truth.aero_force_{axis}_n" for axis in "xyz"),
    *(f"truth.disturbance_{axis}_nm" for axis in "xyz"),
    *("t_s", "truth.height_m", "truth.altitude_m", "truth.heat_flux_w_cm2", "truth.engine_thrust_n"),
    *("truth.footpads", "truth.trim_wing", "guide.phase"),
)


class Flown(Protocol):
    """Interface of a flight, or of a run read back, to a replay."""

    @property
    def name(self) -> str:
        """Name of the scenario."""

    @property
    def outcome(self) -> str:
        """Outcome in words."""

    @property
    def success(self) -> bool:
        """True if the flight reached its goal within all limits."""

    @property
    def scenario(self) -> Scenario:
        """The scenario."""

    @property
    def phase_names(self) -> list[str]:
        """Names of the mission phases."""

    @property
    def events(self) -> Sequence[Mapping[str, Any]]:
        """The timeline."""

    @property
    def landing_map(self) -> LandingMap | None:
        """Map of hazard detection and the choice made on it; ``None`` without a scan."""

    @property
    def telemetry(self) -> Mapping[str, np.ndarray]:
        """Telemetry columns by name, shape (rows,)."""


class History:
    """One flight, thinned to the rows that a replay draws.

    Attributes:
        t: time of the thinned rows, s, shape (rows,).
        series: telemetry columns of plots by name, in single precision, and ``t_s``, at all rows with a
            finite place and attitude.
        columns: telemetry columns by name at the thinned rows ``t``; those that the flight lacks are absent.
        duty: mean duty of each thruster from each row to the next, shape (rows, thrusters), single precision.
        firing: True where a thruster fires, by its name, at the rows of ``series``, which resolve each pulse.
        jets: names of the thrusters.
        instruments: state of each instrument at the thinned rows; empty without navigation on instruments.
        failures: true state of each thruster that fails, by name, at the thinned rows; 0 works.
        diagnosed: time (s) and words of the first isolation of each thruster, by its name.
        landing_map: map of hazard detection and the choice made on it; ``None`` without a scan.
        when: time (s) of the first event of each key, and of the first phase of each role.
    """

    def __init__(self, flight: Flown, names: Iterable[str], plotted: Iterable[str] = ()) -> None:
        """Take the columns ``names`` and those of poses, thinned, and the columns ``plotted`` at all rows."""
        table = flight.telemetry
        self.name, self.outcome, self.success = flight.name, flight.outcome, flight.success
        self.scenario, self.landing_map = flight.scenario, flight.landing_map
        self.phase_names, self.events = flight.phase_names, flight.events
        self.when = first_times(flight.events)
        rows = _drawable(table)
        with np.errstate(over="ignore"):  # of a flight that diverged
            self.series = {name: table[name][rows].astype(np.float32) for name in plotted if name in table}
        self.series["t_s"] = table["t_s"][rows]
        self.jets = [jet.name for jet in flight.scenario.vehicle.rcs.thrusters if f"rcs.{jet.name}" in table]
        self.firing = {jet: table[f"rcs.{jet}"][rows] > FIRING for jet in self.jets}
        rows = rows[poses(table["t_s"][rows], [event["t_s"] for event in flight.events])]
        components = flight.scenario.components if on_instruments(flight) else {}
        needed = dict.fromkeys([*POSES, *names, *columns_of(components)])
        self.columns = {name: np.asarray(table[name][rows], dtype=float) for name in needed if name in table}
        self.t = self.columns["t_s"]
        self.duty = np.zeros((len(rows), len(self.jets)), np.float32)
        for k, jet in enumerate(self.jets if len(rows) else ()):
            self.duty[:, k] = _mean_between(np.nan_to_num(table[f"rcs.{jet}"]), rows)
        self.instruments = instruments(self.columns, components)
        states = {jet: table[f"fault.{jet}"][rows] for jet in self.jets if f"fault.{jet}" in table}
        self.failures = {jet: state for jet, state in states.items() if np.any(state > 0)}
        isolations = [event for event in flight.events if event["key"] == "diagnosis"]
        self.diagnosed = {one["thruster"]: (one["t_s"], one["isolated"]) for one in reversed(isolations)}

    def __getitem__(self, name: str) -> np.ndarray:
        return self.columns[name]


def on_instruments(flight: Flown) -> bool:
    """Return True if the flight computer navigates on instruments, and not on a given state."""
    return flight.scenario.navigation_filter != "given"


def _drawable(table: Mapping[str, np.ndarray]) -> np.ndarray:
    """Rows with a finite place and attitude."""
    good = np.ones(len(table["t_s"]), bool)
    for axis in ("east", "north", "up"):
        good &= np.isfinite(table[f"truth.site_{axis}_m"])
    size = sum(table[f"truth.q_I2B_{axis}"] ** 2 for axis in "wxyz")
    return np.flatnonzero(good & np.isfinite(size) & (size > 0.25))


def _mean_between(values: np.ndarray, rows: np.ndarray) -> np.ndarray:
    counts = np.diff(np.append(rows, len(values)))
    return np.add.reduceat(values, rows, axis=0) / counts.reshape(-1, *[1] * (values.ndim - 1))


def vector(columns: Mapping[str, np.ndarray], stem: str, axes: str, suffix: str = "") -> np.ndarray:
    """Return columns ``stem_axis_suffix`` side by side, shape (rows, axes)."""
    return np.stack([columns[f"{stem}_{axis}{suffix}"] for axis in axes.split()], axis=-1)


def poses(t: np.ndarray, events: Iterable[float]) -> np.ndarray:
    """Return the rows in which the vehicle is drawn: at ``POSE_HZ``; of a flight of hours about ``MANY`` of
    these, namely all rows near its events and the others evenly spaced.
    """
    rows = thin(t, POSE_HZ)
    if len(rows) <= MANY:
        return rows
    kept = np.zeros(len(rows), bool)
    for event in events:
        kept[slice(*t[rows].searchsorted((event - BESIDE_S, event + BESIDE_S)))] = True
    seldom = np.flatnonzero(~kept)
    kept[seldom[:: -(-len(seldom) // max(MANY - int(kept.sum()), MANY // 3))]] = True
    kept[[0, -1]] = True
    return rows[kept]


def thin(t: np.ndarray, rate_hz: float) -> np.ndarray:
    """Return rows at about ``rate_hz``, with the first and the last row."""
    if len(t) < 2:
        return np.arange(len(t))
    step = max(1, round((len(t) - 1) / max(t[-1] - t[0], 1e-9) / rate_hz))
    rows = np.arange(0, len(t), step)
    return rows if rows[-1] == len(t) - 1 else np.append(rows, len(t) - 1)
