"""A flight in the desktop viewer while it is flown."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from math import inf
from time import sleep
from uuid import uuid4

from edl6dof.api.flight import Flight
from edl6dof.api.replays import ended_by_signals
from edl6dof.api.simulation import Fleet, Simulation
from edl6dof.replay import viewer
from edl6dof.replay.live import Live
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.records import Records
from edl6dof.sim.flight import fly
from edl6dof.sim.flight_state import Snapshot
from edl6dof.sim.simulation import SteppedFlight

#: Time (s) between two updates of the viewer; of an environment, flight time.
_INTERVAL_S = 0.5


@contextmanager
def live(simulation: SteppedFlight, wait: bool = True) -> Iterator[Callable[..., None]]:
    """Show a flight in the desktop viewer while it is flown; yield the function that shows what has been
    flown since its last call.  A flight that begins again, at an earlier time or with ``anew=True``, is
    another recording in the same window.  After the block, wait until the window is closed, unless ``wait``
    is false, which closes it.

    >>> simulation = edl6dof.Simulation("tianwen1")
    >>> with edl6dof.live(simulation) as show:
    ...     while simulation.step(cycles=50):
    ...         show()

    Raises:
        NoViewer: there is no display, or no graphics to draw with.
        ViewerFailed: the viewer ended with an error.
    """
    import rerun as rr

    port, planned = viewer.free_port(), fly(simulation.loaded)
    with ended_by_signals(), viewer.running("--port", str(port)) as program:
        program.wait_for(port)
        shown: Live | None = None
        shown_s = inf

        def show(anew: bool = False) -> None:
            nonlocal shown, shown_s
            if shown is None or anew or simulation.time_s < shown_s:
                stream = rr.RecordingStream("edl6dof", recording_id=str(uuid4()))
                shown = Live(stream, planned)
                address = f"rerun+http://{viewer.HOST}:{port}/proxy"
                stream.connect_grpc(address, default_blueprint=shown.blueprint)
            shown_s = simulation.time_s
            with program.asked():
                shown.update(simulation.flight())

        yield show
        if wait:
            show()
            program.wait()


class WatchedFleet:
    """Shows the first flight of a fleet in the desktop viewer.  A fleet keeps no telemetry, so the flight is
    flown a second time, with the same commands and to the same bits.

    Args:
        fleet: a fleet in which this flight has begun.
        loaded: its scenario.

    Raises:
        NoViewer: there is no display, or no graphics to draw with.
    """

    def __init__(self, fleet: Fleet, loaded: LoadedScenario) -> None:
        self._fleet, first = fleet, slice(0, 1)
        parts = Records(fleet.cases[first], fleet.tables, fleet.onboards[first])
        self.flight = SteppedFlight(loaded, parts)
        self._viewer = ExitStack()
        self._show = self._viewer.enter_context(live(self.flight, wait=False))
        self.close = self._viewer.close

    def begin(self) -> None:
        """Follow the fleet to the start of its flight."""
        fleet = self._fleet
        records = (one[:1] for one in (fleet.plants, fleet.peaks, fleet.sensors, fleet.memories))
        self.flight.restore(Snapshot(int(fleet.cycles[0]), *records))
        self._shown_s, self._begins = self.flight.time_s, True

    def step(self, over: bool) -> None:
        """Follow the fleet after a step; update the viewer now and then, and when the flight is ``over``.

        Raises:
            ViewerFailed: the window was closed, or the viewer ended with an error.
        """
        running = self.flight.running
        running.fsw["external"] = self._fleet.memories["external"][:1]
        running.advance(int(self._fleet.cycles[0]) - running.cycle)
        if over or running.time_s - self._shown_s >= _INTERVAL_S:
            self._show(anew=self._begins)
            self._shown_s, self._begins = running.time_s, False


def fly_live(loaded: LoadedScenario, pace: float) -> Flight:
    """Fly a scenario in the viewer, ``pace`` seconds of flight in a second, and return the flight.  If the
    window is closed, it goes on without pauses.

    Raises:
        ViewerFailed: the viewer has not shown the flight at all.
    """
    simulation, seen = Simulation(loaded), False
    cycles = max(round(pace * _INTERVAL_S / simulation.cycle_s), 1)
    try:
        with live(simulation) as show:
            while simulation.step(cycles=cycles):
                show()
                seen = True
                sleep(_INTERVAL_S)
    except viewer.ViewerFailed:
        if not seen:
            raise
        while simulation.step(cycles=cycles):
            pass
    return simulation.flight()
