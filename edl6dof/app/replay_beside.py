"""The replay of a flight, drawn by a second process while this one flies and writes the other files.

The other process is a copy of this one (fork) from before the flight: it loads what it draws with, which
takes as long as the flight, then reads the telemetry where the flight has put it, in memory that both share.
"""

from __future__ import annotations

import gc
import mmap
import os
import pickle
import signal
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from edl6dof.api.blocked_imports import lean_arrow
from edl6dof.scenario.loading import LoadedScenario
from edl6dof.sim.flight import Flight, log_rows
from edl6dof.telemetry.channels import TICK
from edl6dof.telemetry.columns import Telemetry

if TYPE_CHECKING:
    from edl6dof.scenario.schema import Scenario
    from edl6dof.telemetry.landing_map import LandingMap


@dataclass(frozen=True)
class Outcome:
    """What a replay needs of a flight besides its scenario and its telemetry."""

    rows: int
    outcome: str
    success: bool
    events: Sequence[Mapping[str, Any]]
    landing_map: LandingMap | None


@dataclass(frozen=True)
class Landed:
    """A flight as the drawing process has it; see :class:`edl6dof.replay.history.Flown`."""

    loaded: LoadedScenario
    telemetry: Telemetry
    name: str
    outcome: str
    success: bool
    phase_names: list[str]
    events: Sequence[Mapping[str, Any]]
    landing_map: LandingMap | None

    @property
    def scenario(self) -> Scenario:
        """What was flown."""
        return self.loaded.scenario


class SharedLog:
    """Memory for the telemetry of a flight that two processes share.

    Each takes it once and does not keep it beside the flight: it is free when both have let it go.
    """

    def __init__(self, loaded: LoadedScenario) -> None:
        self._held = [np.frombuffer(mmap.mmap(-1, log_rows(loaded) * TICK.itemsize), TICK)]

    def take(self) -> np.ndarray:
        """Rows for the longest flight allowed, zero where nobody has written."""
        return self._held.pop()


class Artist:
    """The other process, seen from this one.

    Attributes:
        log: where the flight has to put its telemetry.
    """

    def __init__(self, process: int, order: BinaryIO, log: SharedLog) -> None:
        self._process, self._order, self.log = process, order, log

    def draw(self, flight: Flight) -> None:
        """Let it begin: the flight is over."""
        what = Outcome(len(flight.log), flight.outcome, flight.success, flight.events, flight.landing_map)
        with suppress(BrokenPipeError):
            pickle.dump(what, self._order)
            self._order.close()

    def wait(self) -> bool:
        """Wait until it has ended; returns whether the replay is written."""
        status, self._process = os.waitpid(self._process, 0)[1], 0
        return status == 0

    def dismiss(self) -> None:
        """End it, if it has not ended."""
        with suppress(BrokenPipeError):
            self._order.close()
        if self._process:
            os.kill(self._process, signal.SIGKILL)
            os.waitpid(self._process, 0)


@contextmanager
def artist_beside(loaded: LoadedScenario, path: Path) -> Iterator[Artist | None]:
    """A process that will draw the replay of a flight of ``loaded`` into ``path``; ``None`` where this one
    must: with one core only, off Linux, or beside other threads, which a copy would not have.
    """
    if sys.platform != "linux" or threading.active_count() > 1 or len(os.sched_getaffinity(0)) < 2:
        yield None
        return
    log = SharedLog(loaded)
    reading, writing = os.pipe()
    gc.freeze()  # or looking for garbage would write to, and so copy, every page that both share
    with _undisturbed():
        process = os.fork()
        if process == 0:
            os.close(writing)
            _work(loaded, log, reading, path)
    os.close(reading)
    artist = Artist(process, os.fdopen(writing, "wb"), log)
    try:
        yield artist
    finally:
        artist.dismiss()
        gc.unfreeze()


@contextmanager
def _undisturbed() -> Iterator[None]:
    """Keep Ctrl-C for the end of the block, so that a copy made in it never does its parent's cleaning up."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _work(loaded: LoadedScenario, log: SharedLog, reading: int, path: Path) -> None:
    """All that the other process does: it ends here, and does not end what it has of its parent.  Where it
    fails, its parent draws, and says what is wrong; Ctrl-C stays blocked, since its parent ends it.
    """
    status = 1
    try:
        os.nice(5)  # on a busy machine the telemetry is written, and gone, before this draws
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # rerun logs there what fails
        with lean_arrow(), os.fdopen(reading, "rb") as order:
            import rerun.blueprint  # noqa: F401  while the flight is flown

            from edl6dof.replay.recording import history, write_replay

            flown = pickle.load(order)  # of this very program
            write_replay([history(_landed(loaded, log.take(), flown))], path)
        status = 0
    finally:
        os._exit(status)


def _landed(loaded: LoadedScenario, log: np.ndarray, flown: Outcome) -> Landed:
    scenario = loaded.scenario
    names = scenario.thruster_names, scenario.beam_names, list(scenario.branches)
    telemetry = Telemetry(log[: flown.rows], *names)
    return Landed(
        loaded,
        telemetry,
        scenario.name,
        flown.outcome,
        flown.success,
        scenario.phase_names,
        flown.events,
        flown.landing_map,
    )
