"""Parachute and the parts that were thrown off."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from edl6dof.replay.recorder import Recorder
from edl6dof.replay.scene import vehicle_shapes as shapes
from edl6dof.replay.scene.mesh import Mesh
from edl6dof.spatial import rotations as turns

LINE = (222, 214, 204)
PART = (235, 190, 120)


class Descent(Recorder):
    """Writes ``parachute``, ``heat_shield`` and ``backshell``."""

    def motions(self) -> None:
        """What hangs and what falls."""
        vehicle, motion = self.vehicle, self.motion
        self._parachute()
        for name, shown, place, mesh in (
            ("heat_shield", "capsule", motion.heat_shield, shapes.heat_shield(vehicle)),
            ("backshell", "backshell", motion.backshell, shapes.backshell(vehicle)),
        ):
            if (part := vehicle.showing(shown)) is not None:
                self._discarded(name, place, part.centre_m, mesh)

    def _parachute(self) -> None:
        rr = self.rr
        rows, place, turn, scale = self.motion.parachute()
        if len(rows) == 0:
            return
        mesh, lines = shapes.canopy(self.vehicle)
        start, entity = self.t[rows[0]], f"{self.root}/parachute"
        self.at(start, f"{entity}/canopy", self.mesh(mesh))
        self.at(start, f"{entity}/lines", rr.LineStrips3D(lines, colors=LINE, radii=rr.Radius.ui_points(0.7)))
        pose = rr.Transform3D.columns(translation=place, quaternion=turns.xyzw(turn), scale=scale)
        self.columns(entity, self.t[rows], pose)
        lid_x, lid_r = shapes.backshell_profile(self.vehicle)[-1]
        ends = [[lid_x, lid_r * np.cos(a), lid_r * np.sin(a)] for a in (0.0, 2.1, 4.2)]
        strips = [[end, self.vehicle.main_parachute.confluence_m] for end in ends]
        bridle = rr.LineStrips3D(strips, colors=LINE, radii=rr.Radius.ui_points(1.0))
        self.at(start, f"{self.root}/vehicle/bridle", bridle)
        gone = self.motion.released(self.motion.backshell)
        if gone is not None:
            self.gone(self.t[gone], f"{self.root}/vehicle/bridle")
            self.at(self.t[gone], f"{self.root}/backshell/bridle", bridle)

    def _discarded(self, name: str, place: np.ndarray, own_centre: Sequence[float], mesh: Mesh) -> None:
        """A part on its own: its mesh, and a labelled point that is seen from afar."""
        rr, first = self.rr, self.motion.released(place)
        if first is None:
            return
        origin, turn = self.motion.discarded(place, own_centre)
        rows = first + np.flatnonzero(np.isfinite(origin[first:, 0]))
        tint = {"albedo_factor": [104, 84, 70, 255]} if name == "heat_shield" else {}
        self.at(self.t[first], f"{self.root}/{name}/shape", self.mesh(mesh, **tint))
        attitude = np.tile(turns.xyzw(turn), (len(rows), 1))
        self.columns(
            f"{self.root}/{name}",
            self.t[rows],
            rr.Transform3D.columns(translation=origin[rows], quaternion=attitude),
        )
        rows = rows[::6]
        label = rr.Points3D.from_fields(
            labels=[name.replace("_", " ")], colors=PART, radii=-3.5, show_labels=True
        )
        self.at(self.t[first], f"{self.root}/labels/{name}", label)
        self.columns(f"{self.root}/labels/{name}", self.t[rows], rr.Points3D.columns(positions=place[rows]))
