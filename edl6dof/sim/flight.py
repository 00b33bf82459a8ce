"""Fly a scenario: the Python side of the loop, and the flight that comes out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from edl6dof.interface.roles import during
from edl6dof.metrics.evaluation import Check, Figures, checks
from edl6dof.scenario import records
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.sim.checkpoint import State
from edl6dof.sim.flight_records import FlightRecords, figures_of, timeline_moments
from edl6dof.sim.flight_state import RunningFlight, continue_from, log_rows, resolved_text
from edl6dof.sim.outcome import FLYING, LANDED, NOT_FINITE, first_cause
from edl6dof.sim.termination import Termination, goal_code, termination
from edl6dof.telemetry.timeline import timeline

if TYPE_CHECKING:
    from pyquaternion import Quaternion

#: Flight time between two calls of ``progress``, and between two chances to interrupt a flight without it.
CHUNK_S, QUIET_CHUNK_S = 5.0, 50.0

#: Called between chunks with (time s, time limit s, phase name, altitude m, Mach).
Progress = Callable[[float, float, str, float, float], None]


@dataclass(repr=False)
class Flight(FlightRecords):
    """One finished flight: events, figures, limits and outcome, worked out from its records."""

    def __repr__(self) -> str:
        rows = f"{len(self.log)} rows of telemetry"
        return f"<Flight {self.name}: {self.outcome} at t = {self.time_s:.1f} s, {rows}>"

    def during(self, role: str) -> np.ndarray:
        """Rows of telemetry in the phases of a role, shape (rows,), bool."""
        return during(self.telemetry["guide.phase"], self.scenario.phase_roles, role)

    def release_log(self) -> None:
        """Drop the telemetry and keep the results: events, figures, limits, outcome."""
        self.events, self.figures, self.checks, self.termination  # noqa: B018  computed from it, and kept from here on
        self.log = self.log[:0].copy()
        self.__dict__.pop("telemetry", None)

    @cached_property
    def events(self) -> list[dict[str, Any]]:
        """Timeline: dicts with t_s, key, name, detail and the state at that time."""
        mission, vehicle, others = self.scenario.mission, self.scenario.vehicle, timeline_moments(self)
        return timeline(self.telemetry, self.plant[0], self.fsw[0], mission, vehicle, self.outcome, others)

    @cached_property
    def figures(self) -> Figures[float]:
        """Figures of the flight by name with unit suffix."""
        return Figures(figures_of(self))

    @cached_property
    def checks(self) -> list[Check]:
        """Every limit of the scenario with this flight's value."""
        return checks(self.scenario.limits, self.figures)

    @property
    def landed(self) -> bool:
        """True if the vehicle came to rest upright."""
        return self.code == LANDED

    @property
    def success(self) -> bool:
        """True if the flight reached the goal of its mission (landed, deployed, flown) within all limits."""
        return self.termination.success

    @cached_property
    def termination(self) -> Termination:
        """How the flight ended."""
        return termination(self, self.figures, self.checks)

    @property
    def outcome(self) -> str:
        """How the flight ended, in words."""
        return self.termination.outcome

    @property
    def cause(self) -> str:
        """Reason why the flight is no success, without numbers; empty for a success."""
        return self.termination.cause

    @cached_property
    def resolved_scenario(self) -> str:
        """The scenario as YAML with every default: enough to fly it again, bit for bit."""
        return resolved_text(self.loaded)

    def attitude(self, t: float) -> Quaternion:
        """Return the attitude ``q_I2B`` (it rotates the axes of I into those of B) at time ``t`` (s),
        interpolated between the rows of the telemetry.

        Raises:
            ValueError: ``t`` lies outside the telemetry.
        """
        return attitude_at(t, self.log["t"], [self.log["truth"][f"q_I2B_{c}"] for c in "wxyz"])


def attitude_at(t: float, times: np.ndarray, columns: Sequence[np.ndarray]) -> Quaternion:
    """Return the attitude at ``t`` (s), interpolated between rows.

    Args:
        t: flight time, s.
        times: flight times of the rows, s, shape (rows,).
        columns: the four components w, x, y, z of ``q_I2B``, each shape (rows,).

    Raises:
        ValueError: ``t`` lies outside the rows.
    """
    from pyquaternion import Quaternion

    if not times[0] <= t <= times[-1]:
        raise ValueError(f"t must lie in {times[0]:g} .. {times[-1]:g} s, got {t:g}")
    i = int(np.searchsorted(times, t, side="right")) - 1
    before, after = (Quaternion([column[j] for column in columns]) for j in (i, min(i + 1, len(times) - 1)))
    if t == times[i]:
        return before
    return Quaternion.slerp(before, after, (t - times[i]) / (times[i + 1] - times[i]))


def fly(
    loaded: LoadedScenario,
    *,
    start: State | None = None,
    save_at_s: float | None = None,
    progress: Progress | None = None,
    parts: records.Records | None = None,
    log: np.ndarray | None = None,
) -> Flight:
    """Fly a scenario to its end.

    Args:
        loaded: from :func:`edl6dof.load`.
        start: saved state to continue from, instead of the initial state.
        save_at_s: time (s) at which to save a state as ``Flight.saved``; rounded to the start of a base
            cycle.
        progress: called every few seconds of flight.
        parts: the scenario's records, where the caller has built them already.
        log: array for the telemetry, at least :func:`log_rows` rows of ``TICK`` or, with only the columns for
            figures and events, of ``BRIEF``; the flight then reads from it.

    Raises:
        ConfigError: the state does not fit the scenario.
    """
    flight = RunningFlight(loaded, start, parts, log)
    base = loaded.scenario.flight_software.rates.base_hz
    stop = max(flight.last_cycle, flight.cycle) + 1
    save_cycle = round(save_at_s * base) if save_at_s is not None else -1
    chunk = round((QUIET_CHUNK_S if progress is None else CHUNK_S) * base)
    saved = None
    while flight.code == FLYING and flight.cycle < stop:
        if flight.cycle == save_cycle:
            saved = flight.state()
        end = min(flight.cycle + chunk, stop)
        if flight.cycle < save_cycle:
            end = min(end, save_cycle)
        flight.advance(end - flight.cycle)
        if progress is not None:
            altitude, mach = (float(flight.outputs[name][0]) for name in ("altitude", "mach"))
            limit = loaded.scenario.simulation.time_limit_s
            progress(flight.time_s, limit, flight.phase, altitude, mach)
    return flight_of(flight, saved)


def flight_of(running: RunningFlight, saved: State | None = None) -> Flight:
    """Finished flight of a running one, with the telemetry since it began; the two share their records."""
    loaded, code = running.loaded, running.code
    state = running.plant, running.outputs
    wrong = None
    if code != goal_code(loaded.scenario.mission.goal):
        wrong = first_cause(*state, running.work, running.sensors, running.fsw)
    site = running.onboard["site"]
    return Flight(
        *(loaded, running.case, running.tables, *state, running.peaks, running.fsw),
        running.log[: running.rows],
        (float(site["aim_latitude"][0]), float(site["aim_longitude"][0])),
        NOT_FINITE if wrong else code,
        running.cycle - running.first,
        saved,
        wrong,
    )


__all__ = ["Flight", "Progress", "continue_from", "flight_of", "fly", "log_rows", "resolved_text"]
