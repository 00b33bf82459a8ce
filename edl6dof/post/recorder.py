"""What everything that writes into the recording shares: the flight, its poses, and short ways to log."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from edl6dof.post import scene
from edl6dof.post.layout import PHASES, TIMELINE
from edl6dof.post.motion import Motion

if TYPE_CHECKING:
    import rerun as rr

    from edl6dof.sim.flight import Flight

POSE_HZ = 25.0
SCALAR_HZ = 10.0


class Recorder:
    """A recording of one flight being written."""

    def __init__(self, flight: Flight, motion: Motion, recording: rr.RecordingStream) -> None:
        import rerun as rr

        self.rr, self.rec = rr, recording
        self.flight, self.vehicle = flight, flight.scenario.vehicle
        self.tm, self.motion = flight.telemetry, motion
        self.t = self.motion.t
        self.when = {event["key"]: float(event["t_s"]) for event in reversed(flight.events) if "key" in event}
        phase = np.nan_to_num(self.tm["guide.phase"][self.motion.valid]).astype(int)
        self.names = flight.phase_names or ["free flight"]
        self.phase = np.clip(phase, 0, len(self.names) - 1)
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

    def mean_duty(self, rows: np.ndarray, names: list[str]) -> np.ndarray:
        """Mean duty of each thruster from each of ``rows`` to the next, shape (rows, thrusters)."""
        duty = np.stack([np.nan_to_num(self.tm[f"rcs.{name}"][self.motion.valid]) for name in names], axis=-1)
        return np.add.reduceat(duty, rows, axis=0) / np.diff(np.append(rows, len(duty)))[:, None]
