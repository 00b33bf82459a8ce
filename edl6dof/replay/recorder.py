"""The base of all writers of a recording: the flight, its poses, and helpers to log them.

A negative radius is a size on the screen, in points.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from edl6dof.interchange.meshes import read_mesh_file
from edl6dof.replay.history import History
from edl6dof.replay.pages import FLIGHTS, PHASES, TIMELINE, root_of
from edl6dof.replay.scene.mesh import Mesh
from edl6dof.replay.scene.poses import Motion
from edl6dof.spatial import rotations as turns

if TYPE_CHECKING:
    import rerun as rr

#: Rate of all series except poses, Hz.
SCALAR_HZ = 12.5
#: Rate of series that are drawn as a line, or are a mean, Hz.
SLOW_HZ = 6.25


class Sink(Protocol):
    """The methods of a recording stream of rerun that recorders call."""

    def log(self, entity_path: str, entity: Any, /, *more: Any, static: bool = False) -> None:
        """Log an entity."""

    def set_time(self, timeline: str, /, *, duration: float) -> None:
        """Set the time (s) of what is logged next."""

    def reset_time(self) -> None:
        """End the effect of :meth:`set_time`."""

    def send_columns(self, entity_path: str, /, indexes: Iterable[Any], columns: Iterable[Any]) -> None:
        """Send a series."""


class Recorder:
    """Writes one part of one flight.

    Attributes:
        number: index of this flight in the recording, from 0.
        label: name of this flight among others in the recording; empty when it is alone.
        own: colour of this flight among others.
        root: entity under which lies what belongs to this flight alone.
    """

    def __init__(
        self, flight: History, motion: Motion, recording: Sink, number: int = 0, label: str = ""
    ) -> None:
        import rerun as rr

        self.rr, self.rec = rr, recording
        self.flight, self.vehicle = flight, flight.scenario.vehicle
        self.motion, self.t, self.when = motion, flight.t, flight.when
        self.number, self.label, self.root = number, label, root_of(number)
        self.own = FLIGHTS[number % len(FLIGHTS)]
        self.names = flight.phase_names or ["free flight"]
        self.phase = np.clip(np.nan_to_num(flight["guide.phase"]).astype(int), 0, len(self.names) - 1)
        place = np.cumsum(np.isin(range(len(self.names)), self.phase)) - 1  # among the phases that were flown
        self.colours = np.array(PHASES, np.uint8)[place % len(PHASES)]

    def statics(self) -> None:
        """Write timeless entities, before all motions, so that a slow viewer has them from the beginning."""

    def motions(self) -> None:
        """Write everything that changes with time."""

    def static(self, entity: str, *what: Any) -> None:
        """Log a timeless entity."""
        self.rec.log(entity, *what, static=True)

    def columns(self, entity: str, t: np.ndarray, columns: Any) -> None:
        """Log a series, one row for each time (s)."""
        self.rec.send_columns(entity, [self.rr.TimeColumn(TIMELINE, duration=t)], columns)

    def poses(
        self,
        entity: str,
        t: np.ndarray,
        place: np.ndarray | None = None,
        turn: np.ndarray | None = None,
        scale: np.ndarray | None = None,
    ) -> None:
        """Log place (m), attitude (quaternions, scalar first) and scale of a frame, one row for each time."""
        quaternion = None if turn is None else turns.xyzw(turn)
        pose = self.rr.Transform3D.columns(translation=place, quaternion=quaternion, scale=scale)
        self.columns(entity, t, pose)

    def series(
        self,
        entity: str,
        t: np.ndarray,
        kind: Any,
        look: dict[str, Any],
        data: dict[str, Any],
        each: np.ndarray | None = None,
    ) -> None:
        """Log a series of one archetype with a constant look; ``each``: items in each row, by default one."""
        self.static(entity, kind.from_fields(**look))
        columns = kind.columns(**data)
        self.columns(entity, t, columns if each is None else columns.partition(each))

    def lines(self, entity: str, strips: Any, colour: Any, points: float) -> None:
        """Log lines for all time; ``points``: their width on the screen."""
        self.static(entity, self.rr.LineStrips3D(strips, colors=colour, radii=-points))

    def at(self, t: float, entity: str, *what: Any) -> None:
        """Log an entity that exists from time ``t`` (s)."""
        self.rec.set_time(TIMELINE, duration=float(t))
        self.rec.log(entity, *what)
        self.rec.reset_time()

    def gone(self, t: float, entity: str) -> None:
        """Remove an entity at time ``t`` (s)."""
        self.at(t, entity, self.rr.Clear(recursive=False))

    def mesh(self, mesh: Mesh, **more: Any) -> rr.Mesh3D:
        """Return the mesh as a rerun archetype."""
        return self.rr.Mesh3D(
            vertex_positions=mesh.positions,
            triangle_indices=mesh.triangles,
            vertex_normals=mesh.normals,
            vertex_colors=mesh.colours,
            **more,
        )

    def own_mesh(self, part: str | None) -> list[Any] | None:
        """Return the user's mesh for a part (``None``: for the rest of the vehicle), in its place in B."""
        own = next((mesh for mesh in self.vehicle.appearance.meshes if mesh.part == part), None)
        if own is None:
            return None
        file, half = read_mesh_file(Path(own.file)), 0.5 * np.radians(own.yaw_pitch_roll_deg)
        yaw, pitch, roll = (
            np.insert(np.sin(angle) * np.eye(3)[2 - k], 0, np.cos(angle)) for k, angle in enumerate(half)
        )
        place = self.rr.Transform3D(
            translation=own.origin_m,
            quaternion=turns.xyzw(turns.multiply(turns.multiply(yaw, pitch), roll)),
            scale=np.full(3, own.scale),
        )
        return [self.rr.Asset3D(contents=file.content, media_type=file.media_type), place]

    def shown(self, part: str | None, mesh: Mesh, **more: Any) -> list[Any]:
        """Return a part as rerun archetypes: the user's mesh, or else ``mesh``, with the options ``more``."""
        return self.own_mesh(part) or [self.mesh(mesh, **more)]

    def point(self, place: Any, words: str, colour: Any, points: float = 4.0) -> rr.Points3D:
        """Return a labelled point; ``points``: its size on the screen."""
        return self.rr.Points3D([place], labels=[words], colors=colour, radii=-points, show_labels=True)


def and_next(shown: np.ndarray) -> np.ndarray:
    """Return the rows (bool) with something to show, and each row after them, which ends the display."""
    return shown | np.append(False, shown[:-1])
