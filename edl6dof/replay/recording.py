"""The 3D replay of flights, as a rerun recording with its own arrangement of views.

Root ``/site``: east, north, up (m) at the landing site, so that single precision is fine where the vehicle
lands. ``/site/vehicle`` is the body frame.  ``/site/camera`` follows the vehicle without turning with it and
grows under the parachute: seen from it, capsule and canopy both fill the view; ``/site/camera_away`` follows
the part released last; ``/site/tour`` is the frame of the director's camera.  Further flights lie under
``/site/flight_1`` and so on. Root ``/globe``: planet-fixed, km.  ``/plots`` holds the time series,
``/phase_plane`` the phase planes, ``/Phase``, ``/Vehicle``, ``/Engine``, ``/Thruster-A1``, ``/Gyro-g1`` and
so on the lanes, ``/events`` the timeline, ``/legend`` the meaning of the colours.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from edl6dof.replay import charts, lanes
from edl6dof.replay.blueprint import Layout
from edl6dof.replay.cameras import Cameras
from edl6dof.replay.history import Flown, History, on_instruments
from edl6dof.replay.pages import TIMELINE
from edl6dof.replay.recorder import Recorder
from edl6dof.replay.scene.arrows import Arrows
from edl6dof.replay.scene.craft import Descent, Flames, Vehicle
from edl6dof.replay.scene.ensemble import Ensemble, write_ensemble
from edl6dof.replay.scene.ground import Ground, NearGround
from edl6dof.replay.scene.landscape import Landscape
from edl6dof.replay.scene.poses import Motion
from edl6dof.replay.scene.sensing import NAVIGATED, Beams, Hazards
from edl6dof.replay.scene.tracks import Globe, Track

#: Writers of the parts of a recording: of the first flight alone, and of every flight.
OF_FIRST: tuple[type[Recorder], ...] = (Ground, Hazards, charts.PhasePlanes, lanes.Lanes, lanes.Readout)
OF_EACH: tuple[type[Recorder], ...] = (
    Globe, Track, Cameras, Vehicle, Flames, NearGround, Arrows, Beams, Descent, charts.Charts,
)  # fmt: skip


def history(flight: Flown) -> History:
    """Return the data that a replay needs of a flight, whose telemetry may be released afterwards."""
    navigation = charts.NAVIGATION_COLUMNS if on_instruments(flight) else ()
    columns = (*charts.PLANE_COLUMNS, *lanes.COLUMNS, *NAVIGATED)
    return History(flight, columns, (*charts.COLUMNS, *navigation))


@np.errstate(over="ignore", invalid="ignore")  # a flight that diverged is drawn as far as it can be
def write_replay(
    flights: Sequence[History],
    path: Path,
    labels: Sequence[str] = (),
    page: str = "Flight",
    ensemble: Ensemble | None = None,
    bare: bool = False,
) -> None:
    """Write flights, in the landing-site frame of the first, as one recording (.rrd) with ``page`` in front,
    or alone and without the viewer's controls if ``bare``.

    ``labels`` distinguish several flights, or one from the trajectories of a campaign in ``ensemble``; a
    flight alone needs none.

    Raises:
        OSError: the file cannot be written.
    """
    import pyarrow as pa
    import rerun as rr

    first = flights[0]
    motions = [Motion(flight) for flight in flights]
    name = first.name if len(flights) == 1 else " and ".join(labels)
    stream = rr.RecordingStream("edl6dof", recording_id=f"edl6dof-{name}")
    with _failing_as_the_system_says(path), stream as recording:
        layout = Layout(flights, motions[0], recording, labels, ensemble)
        recording.save(str(path), default_blueprint=layout.blueprint(page, bare))
        recording.send_recording_name(f"{name}: {first.outcome}" if len(flights) == 1 else name)
        plotted = labels if len(flights) > 1 else ()  # the curves of a single flight keep their own colours
        parts = [
            part(
                flight,
                motion,
                recording,
                k,
                "".join((plotted if part is charts.Charts else labels)[k : k + 1]),
            )
            for k, (flight, motion) in enumerate(zip(flights, motions, strict=True))
            if len(flight.t)
            for part in (OF_EACH if k else (*OF_FIRST, *OF_EACH))
        ]
        for part in parts:
            part.statics()
        if ensemble is not None:
            write_ensemble(recording, ensemble, Landscape(motions[0].site, motions[0].last))
        recording.flush()  # otherwise the viewer would find them at the end of the file
        for part in parts:
            part.motions()
            recording.flush()  # otherwise it would keep all of them in memory
    pa.default_memory_pool().release_unused()


@contextmanager
def _failing_as_the_system_says(path: Path) -> Iterator[None]:
    """Raise ``OSError`` with the system's reason: rerun only says that its writer has ended."""
    try:
        yield
    except RuntimeError as error:
        with path.open("ab") as file:
            file.write(bytes(1 << 20))
        raise OSError(str(error)) from None


def recorded_span(path: Path) -> tuple[float, float]:
    """Return the first and last time (s) of the first flight in a recording.

    Raises:
        ValueError: the recording contains no flight.
    """
    from rerun.chunk import RrdReader

    poses = RrdReader(path).stream().filter(content=["/site/near"], is_static=False).to_chunks()
    times = [chunk.to_record_batch().column(TIMELINE).to_numpy(zero_copy_only=False) for chunk in poses]
    if not times:
        raise ValueError("not drawn by this version of edl6dof; --page Flight draws a run folder anew")
    seconds = np.concatenate(times).astype("timedelta64[ns]") / np.timedelta64(1, "s")
    return float(seconds.min()), float(seconds.max())
