"""Where episodes begin: dispersed flights, flown by the flight software up to the task, and kept."""

from __future__ import annotations

from threading import Lock

from edl6dof.api.simulation import Starts
from edl6dof.config.errors import refusal
from edl6dof.gym.task import Task
from edl6dof.sim.fleet import Fleet, Start
from edl6dof.sim.simulation import SteppedFlight

#: Base cycles between two looks at the phase.
_LOOK = 5
#: Flights in a row that may end before the task begins.
_PATIENCE = 20


class StartPool:
    """The beginnings of the episodes of a task: as many as ``size``, each of a dispersed flight of its own;
    one is flown when it is first asked for.
    """

    def __init__(self, task: type[Task], size: int):
        self._task, self._size, self._lock = task, size, Lock()
        self._flights = Starts(task.scenario, task.overrides, task.faults)
        self._known: dict[int, Start] = {}
        self.loaded = self._flights.loaded

    def __len__(self) -> int:
        return self._size

    def __getitem__(self, number: int) -> Start:
        with self._lock:
            if number not in self._known:
                self._known[number] = self._flown(number)
            return self._known[number]

    def fleet(self, count: int, workers: int) -> Fleet:
        """As many flights of the scenario."""
        return Fleet(count, self._flights.base.records.tables, self.loaded.scenario.steps_per_cycle, workers)

    def _flown(self, number: int) -> Start:
        """The flight of a number; of one that does not come so far the next that does.

        Raises:
            ConfigError: no flight comes so far, or they are of several worlds.
        """
        for seed in range(number, number + _PATIENCE * self._size, self._size):
            variant = self._flights.of(seed)
            parts = variant.parts
            if parts.tables is not self._flights.base.records.tables:
                raise refusal(self._task.scenario, "disperses the tables of the world, which a fleet shares")
            flight = SteppedFlight(variant.loaded, parts, telemetry=False)
            if self._comes(flight):
                return Start.of(parts, flight.underway.moment())
        raise refusal(self._task.scenario, f"none of {_PATIENCE} flights came to the phase {self._task.role}")

    def _comes(self, flight: SteppedFlight) -> bool:
        """Fly to the beginning of the task; whether the flight comes so far."""
        roles = flight.loaded.scenario.phase_roles
        phase = flight.underway.fsw["mission"]["phase"]
        while roles[int(phase[0])] != self._task.role:
            if not flight.step(cycles=_LOOK):
                return False
        return flight.step(cycles=max(round(self._task.later_s / flight.cycle_s), 1))
