"""The flight of an environment in the viewer."""

from __future__ import annotations

from contextlib import ExitStack

from edl6dof.api.live import live
from edl6dof.gym.task import Task
from edl6dof.scenario.records import Records
from edl6dof.sim.flight_state import Snapshot
from edl6dof.sim.simulation import SteppedFlight

#: Time (s) of flight between two updates of the viewer.
INTERVAL_S = 0.5


class Watched:
    """Shows the flight of a task in the desktop viewer.  A fleet keeps no telemetry, so the flight is flown
    once more beside it, with the same commands and to the same bits.

    Args:
        task: a task whose fleet has one flight, which has begun.

    Raises:
        NoViewer: there is no display, or no graphics to draw with.
    """

    def __init__(self, task: Task) -> None:
        fleet = self._fleet = task.fleet
        self.flight = SteppedFlight(task.loaded, Records(fleet.cases, fleet.tables, fleet.onboards))
        self._viewer = ExitStack()
        self._show = self._viewer.enter_context(live(self.flight, wait=False))
        self.close = self._viewer.close

    def begin(self) -> None:
        """Follow the fleet to the start of an episode."""
        fleet = self._fleet
        records = fleet.plants, fleet.peaks, fleet.sensors, fleet.memories
        self.flight.restore(Snapshot(int(fleet.cycles[0]), *records))
        self._shown_s, self._begins = self.flight.time_s, True

    def step(self, over: bool) -> None:
        """Follow the fleet after a step; update the viewer now and then, and when the episode is ``over``.

        Raises:
            ViewerFailed: the window was closed, or the viewer ended with an error.
        """
        running = self.flight.running
        running.fsw["external"] = self._fleet.memories["external"]
        running.advance(int(self._fleet.cycles[0]) - running.cycle)
        if over or running.time_s - self._shown_s >= INTERVAL_S:
            self._show(anew=self._begins)
            self._shown_s, self._begins = running.time_s, False
