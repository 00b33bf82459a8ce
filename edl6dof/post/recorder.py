"""What everything that writes into the recording shares: the flight, its poses, and short ways to log."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from edl6dof.post import scene
from edl6dof.post.history import History
from edl6dof.post.layout import PHASES, TIMELINE
from edl6dof.post.motion import Motion

if TYPE_CHECKING:
    import rerun as rr

SCALAR_HZ = 12.5


class Recorder:
    """A recording of one flight being written."""

    def __init__(self, flight: History, motion: Motion, recording: rr.RecordingStream) -> None:
        import rerun as rr

        self.rr, self.rec = rr, recording
        self.flight, self.vehicle = flight, flight.scenario.vehicle
        self.motion, self.t, self.when = motion, flight.t, flight.when
        self.names = flight.phase_names or ["free flight"]
        self.phase = np.clip(np.nan_to_num(flight["guide.phase"]).astype(int), 0, len(self.names) - 1)
        self.colours = np.array([PHASES[i % len(PHASES)] for i in range(len(self.names))], np.uint8)

    def static(self, entity: str, *what: Any) -> None:
        """Log what holds for all time."""
        self.rec.log(entity, *what, static=True)

    def columns(self, entity: str, t: np.ndarray, columns: Any) -> None:
        """Log a series, one row for each time (s)."""
        self.rec.send_columns(entity, [self.rr.TimeColumn(TIMELINE, duration=t)], columns)

    def at(self, t: float, entity: str, *what: Any) -> None:
        """Log what holds from time ``t`` (s) on."""
        self.rec.set_time(TIMELINE, duration=float(t))
        self.rec.log(entity, *what)
        self.rec.reset_time()

    def mesh(self, mesh: scene.Mesh, **more: Any) -> rr.Mesh3D:
        """The mesh as rerun takes it."""
        return self.rr.Mesh3D(
            vertex_positions=mesh.positions,
            triangle_indices=mesh.triangles,
            vertex_normals=mesh.normals,
            vertex_colors=mesh.colours,
            **more,
        )
