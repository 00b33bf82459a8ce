"""A flight in the desktop viewer while it is flown."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import sleep

from edl6dof.api.flight import Flight
from edl6dof.api.replays import ended_by_signals
from edl6dof.api.simulation import Simulation
from edl6dof.replay import viewer
from edl6dof.replay.live import Live
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.sim.flight import fly

#: Time (s) between two updates of the viewer.
_INTERVAL_S = 0.5


@contextmanager
def live(simulation: Simulation) -> Iterator[Callable[[], None]]:
    """Show a flight in the desktop viewer while it is flown; yield the function that shows what has been
    flown since its last call.  After the block, wait until the window is closed.

    >>> simulation = edl6dof.Simulation("tianwen1")
    >>> with edl6dof.live(simulation) as show:
    ...     while simulation.step(cycles=50):
    ...         show()

    Raises:
        NoViewer: there is no display, or no graphics to draw with.
        ViewerFailed: the viewer ended with an error.
    """
    import rerun as rr

    port, stream = viewer.free_port(), rr.RecordingStream("edl6dof")
    shown = Live(stream, fly(simulation.loaded))
    with ended_by_signals(), viewer.running("--port", str(port)) as program:
        program.wait_for(port)
        stream.connect_grpc(f"rerun+http://{viewer.HOST}:{port}/proxy", default_blueprint=shown.blueprint)

        def show() -> None:
            with program.asked():
                shown.update(simulation.flight())

        yield show
        show()
        program.wait()


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
