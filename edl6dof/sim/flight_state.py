"""State of a flight in progress: its records, and the compiled loop that advances them by any number of base
cycles.

The bits of a flight do not depend on how its cycles are divided among calls.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import NamedTuple

import numpy as np

from edl6dof.config.document.overrides import apply_overrides
from edl6dof.config.document.source import parse_document
from edl6dof.config.dtype import duplicate
from edl6dof.config.dump import dump_resolved
from edl6dof.fsw.onboard import FSW
from edl6dof.scenario import records
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.loading import check_document
from edl6dof.scenario.schema import Scenario
from edl6dof.sensors.registry import SENSORS
from edl6dof.sim.checkpoint import State
from edl6dof.sim.functions import compile_loop, compiling_flight_software, functions_of
from edl6dof.sim.loop import fly as fly_cycles
from edl6dof.sim.loop import look, prepare, take_up
from edl6dof.sim.outcome import FLYING
from edl6dof.telemetry.channels import BRIEF, TICK
from edl6dof.vehicle.plant import OUTPUTS, WORKSPACE

#: Logs of a flight that keeps no telemetry.
NO_TICKS, NO_BRIEFS = np.zeros(0, TICK), np.zeros(0, BRIEF)


class Snapshot(NamedTuple):
    """All that changes in a flight, at the start of a base cycle, each record of shape (1,)."""

    cycle: int
    plant: np.ndarray
    peaks: np.ndarray
    sensors: np.ndarray
    fsw: np.ndarray


def beginning(
    loaded: LoadedScenario,
    case: np.ndarray,
    onboard: np.ndarray,
    sensors: np.dtype = SENSORS,
    fsw: np.dtype = FSW,
) -> Snapshot:
    """The start of the flight of a scenario with these records; ``sensors``, ``fsw``: layouts of the records
    of these names.
    """
    plant, memory = records.initial_plant(loaded.truth, case), records.initial_fsw(onboard, fsw)
    prepare(case, plant)
    return Snapshot(0, plant, records.initial_peaks(), records.initial_sensors(sensors), memory)


class RunningFlight:
    """A flight in progress.

    Args:
        loaded: from :func:`edl6dof.load`.
        start: saved state to continue from, instead of the initial state.
        parts: the scenario's records, where the caller has built them already.
        log: array for the telemetry, at least :func:`log_rows` rows of ``TICK`` or ``BRIEF``, or no rows for
            no telemetry; ``None``: a new array.

    Attributes:
        cycle: base cycle that comes next.
        code: outcome code of the loop so far.
        rows: rows of the log that are filled.

    Raises:
        ConfigError: the state does not fit the scenario.
    """

    def __init__(
        self,
        loaded: LoadedScenario,
        start: State | None = None,
        parts: records.Records | None = None,
        log: np.ndarray | None = None,
    ):
        self.loaded, scenario = loaded, loaded.scenario
        with compiling_flight_software(scenario) as members:
            self.case, self.tables, self.onboard = parts or records.build_records(loaded)
            self.outputs, self.work = np.zeros(1, OUTPUTS), np.zeros(1, WORKSPACE)
            self.code, self.rows, self.cycle = FLYING, 0, 0
            if start is None:
                _, self.plant, self.peaks, self.sensors, self.fsw = beginning(loaded, self.case, self.onboard)
            else:
                start.check_fits(scenario)
                self.plant, self.fsw = duplicate(start.plant), duplicate(start.fsw)
                self.peaks, self.sensors = duplicate(start.peaks), duplicate(start.sensors)
                self.cycle = start.cycle
                take_up(self.case, self.plant, self.fsw)
            if log is None:
                # zeroed pages cost memory only once they are written, so the log may be as long as the
                # longest flight allowed
                log = np.zeros(log_rows(loaded, self.cycle), TICK)
            self.log = log
            self.first, self._steps = self.cycle, scenario.steps_per_cycle
            self._logs = (log, NO_BRIEFS) if log.dtype == TICK else (NO_TICKS, log)
            self._records = (
                *(self.case, self.onboard, self.tables, self.plant, self.outputs),
                *(self.peaks, self.work, self.sensors, self.fsw),
            )
            if members is not None:
                compile_loop(members, *self._records, self.cycle, self.cycle, 0, self._steps, *self._logs, 0)
        self._functions = functions_of(self.case, self.onboard[0])

    @property
    def last_cycle(self) -> int:
        """Base cycle after which the time limit has ended the flight."""
        return last_cycle(self.loaded)

    @property
    def time_s(self) -> float:
        """Flight time, s."""
        return float(self.plant["t"][0])

    @property
    def phase(self) -> str:
        """Name of the present mission phase."""
        return phase_name(self.loaded.scenario, self.fsw)

    def advance(self, cycles: int) -> int:
        """Fly some base cycles, or up to the end of the flight; returns the outcome code."""
        if self.code == FLYING:
            end = self.cycle + cycles
            counts = self.cycle, end, 0, self._steps, *self._logs, self.rows
            self.code, flown, new = fly_cycles(self._functions, *self._records, *counts)
            self.cycle += flown
            self.rows += new
        return self.code

    def look(self) -> None:
        """Update :attr:`outputs` to the present state."""
        look(self.case, self.tables, self.plant, self.outputs, self.work)

    def snapshot(self) -> Snapshot:
        """All that changes, copied."""
        return Snapshot(self.cycle, *map(duplicate, (self.plant, self.peaks, self.sensors, self.fsw)))

    def restore(self, snapshot: Snapshot | State) -> None:
        """Continue from a snapshot of a flight of this scenario; telemetry starts again there."""
        for name in ("plant", "peaks", "sensors", "fsw"):
            getattr(self, name).view(np.uint8)[:] = getattr(snapshot, name).view(np.uint8)
        self.cycle = self.first = snapshot.cycle
        self.code, self.rows = FLYING, 0

    def state(self) -> State:
        """The present state of the flight, for :meth:`edl6dof.sim.checkpoint.State.save`."""
        return State(*self.snapshot(), self.scenario_text)

    @cached_property
    def scenario_text(self) -> str:
        """The resolved scenario."""
        return resolved_text(self.loaded)


def snapshots_at(loaded: LoadedScenario, times_s: Iterable[float]) -> list[Snapshot]:
    """Snapshots of one flight at rising times (s), rounded to base cycles, up to the end of the flight."""
    flight, found = RunningFlight(loaded, log=NO_TICKS), []
    for t in times_s:
        flight.advance(round(t * loaded.scenario.flight_software.rates.base_hz) - flight.cycle)
        if flight.code != FLYING:
            break
        found.append(flight.snapshot())
    return found


def phase_name(scenario: Scenario, fsw: np.ndarray) -> str:
    """Name of the mission phase in a flight-software memory; ``free flight`` without phases."""
    names = scenario.phase_names
    return names[int(fsw["mission"]["phase"][0])] if names else "free flight"


def log_rows(loaded: LoadedScenario, first_cycle: int = 0) -> int:
    """Rows of telemetry that the longest flight allowed can fill, from a base cycle on."""
    return max(last_cycle(loaded) + 1 - first_cycle, 1) // loaded.truth.simulation.log_every + 2


def last_cycle(loaded: LoadedScenario) -> int:
    """Base cycle in which the time limit ends a flight."""
    return int(np.ceil(loaded.truth.simulation.time_limit_s * loaded.scenario.flight_software.rates.base_hz))


def resolved_text(loaded: LoadedScenario) -> str:
    """Resolved scenario with the package version on top."""
    from edl6dof import __version__

    words = "every default written out; flying this file repeats the flight bit for bit"
    header = [f"resolved by edl6dof {__version__}: {words}"]
    return dump_resolved(loaded.scenario, header, loaded.document.status, loaded.document.sources)


def continue_from(state: State, overrides: tuple[str, ...] = ()) -> LoadedScenario:
    """Scenario of a saved state, with ``overrides``."""
    return check_document(
        apply_overrides(parse_document(state.scenario_text, "(saved state)"), overrides, Scenario)
    )
