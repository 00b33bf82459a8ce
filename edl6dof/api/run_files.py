"""All files of a run, with no more memory than it takes."""

from __future__ import annotations

from pathlib import Path

from edl6dof.api.blocked_imports import lean_arrow
from edl6dof.sim.flight import Flight

REPLAY = "replay.rrd"


def write_files(flight: Flight, folder: Path, replay: bool, release: bool = False) -> None:
    """Write all files of a run.

    Args:
        flight: the flight.
        folder: where to, which exists.
        replay: whether to write the 3D replay.
        release: whether the flight may let its telemetry go, once it is written, and keep its results only:
            the replay takes as much memory again.
    """
    write_numbers(flight, folder)
    if replay:
        draw_replay(flight, folder, release)


@lean_arrow()
def write_numbers(flight: Flight, folder: Path) -> None:
    """Write all files of a run but its replay."""
    from edl6dof.runs.run_writer import write_run

    write_run(flight, folder)
    if flight.saved is not None:
        flight.saved.save(folder / "state.npz")


@lean_arrow()
def draw_replay(flight: Flight, folder: Path, release: bool) -> None:
    """Write the replay of a run; ``release`` as of :func:`write_files`."""
    from edl6dof.replay.recording import history, write_replay

    shown = history(flight)
    if release:
        flight.release_log()
    write_replay([shown], folder / REPLAY)
