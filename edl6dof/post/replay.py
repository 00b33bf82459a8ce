"""The 3D replay of a flight, as a rerun recording with its own arrangement of views.

Root ``/site``: east, north, up (m) at the landing site, so that single precision is fine where the vehicle lands.
``/site/vehicle`` is the body frame.  ``/site/camera`` follows the vehicle without turning with it and grows under the
parachute: seen from it, capsule and canopy both fill the view.  ``/plots`` holds the time series, ``/states`` the phase
lanes, ``/events`` the timeline.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from edl6dof.post.charts import COLUMNS, Charts
from edl6dof.post.history import Flown, History
from edl6dof.post.layout import GROUPS, blueprint
from edl6dof.post.motion import Motion
from edl6dof.post.stage import Stage

if TYPE_CHECKING:
    import rerun.blueprint as rrb


def history(flight: Flown) -> History:
    """What a replay needs of a flight; the flight's telemetry may be let go afterwards."""
    return History(flight, COLUMNS)


def write_replay(flight: History, path: Path) -> None:
    """Write the replay of ``flight`` to ``path`` (.rrd)."""
    import rerun as rr

    motion = Motion(flight)
    with rr.RecordingStream("edl6dof", recording_id=f"edl6dof-{flight.name}") as recording:
        recording.save(str(path), default_blueprint=_blueprint(flight, motion))
        recording.send_recording_name(f"{flight.name}: {flight.outcome}")
        if len(motion.t) == 0:
            return
        stage, charts = Stage(flight, motion, recording), Charts(flight, motion, recording)
        charts.statics()
        stage.statics()
        recording.flush()  # or the viewer would find them at the end of the file
        stage.motions()
        charts.series()
        recording.flush()


def _blueprint(flight: History, motion: Motion) -> rrb.Blueprint:
    when = flight.when
    whole = (float(flight.t[0]), float(flight.t[-1])) if len(flight.t) else (0.0, 1.0)
    span = {"": whole, "Guidance": (whole[0], when.get("mortar", whole[1]))}
    span["Parachute"] = (when.get("mortar", whole[0]), when.get("backshell", whole[1]))
    span["Powered descent"] = (when.get("backshell", when.get("mortar", whole[0])) - 5.0, whole[1])
    groups = {jet.group for jet in flight.scenario.vehicle.rcs.thrusters}
    places = motion.centre if len(motion.t) else np.zeros((1, 3))
    deploy = motion.released(motion.canopy)
    return blueprint([g for g in GROUPS if g in groups], span, places[-1], places[0], None if deploy is None else places[deploy])
