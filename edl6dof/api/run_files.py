"""All files of a run, with no more memory than it takes."""

from __future__ import annotations

from pathlib import Path

from edl6dof.api.blocked_imports import blocked_imports
from edl6dof.sim.flight import Flight

#: What pyarrow takes along where it is installed, without need: 28 MiB and a quarter of a second, and its
#: access to Amazon's storage.
UNUSED_BY_ARROW = ("pandas", "pyarrow._s3fs")


@blocked_imports(*UNUSED_BY_ARROW)
def write_files(flight: Flight, folder: Path, replay: bool, release: bool = False) -> None:
    """Write all files of a run.

    Args:
        flight: the flight.
        folder: where to, which exists.
        replay: whether to write the 3D replay.
        release: whether the flight may let its telemetry go, once it is written, and keep its results only:
            the replay takes as much memory again.
    """
    from edl6dof.runs.results import write_run

    write_run(flight, folder)
    if flight.saved is not None:
        flight.saved.save(folder / "state.npz")
    if replay:
        from edl6dof.replay.recording import history, write_replay

        shown = history(flight)
        if release:
            flight.release_log()
        write_replay([shown], folder / "replay.rrd")
