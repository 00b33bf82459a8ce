"""Parachute and the parts that were thrown off."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from edl6dof.config.base import Vec3
from edl6dof.replay.recorder import Recorder
from edl6dof.replay.scene import aeroshell
from edl6dof.replay.scene.aeroshell import canopy
from edl6dof.replay.scene.mesh import Mesh
from edl6dof.replay.scene.motion import OpenParachute
from edl6dof.spatial import rotations as turns

if TYPE_CHECKING:
    import rerun as rr

LINE = (222, 214, 204)
PART = (235, 190, 120)


class Descent(Recorder):
    """Writes ``parachute``, ``heat_shield`` and ``backshell``."""

    def motions(self) -> None:
        """What hangs and what falls."""
        motion, shape = self.motion, self.motion.shape
        for flown in motion.parachutes():
            self._parachute(flown)
        meshes = (aeroshell.heat_shield, aeroshell.backshell) if shape.body == "sphere_cone" else ()
        places = (
            ("heat_shield", "capsule", motion.heat_shield),
            ("backshell", "backshell", motion.backshell),
        )
        for (name, shown_as, place), mesh in zip(places, meshes, strict=False):
            if (part := self.vehicle.showing(shown_as)) is not None:
                self._discarded(name, place, part.name, part.centre_m, mesh(shape))

    def _parachute(self, flown: OpenParachute) -> None:
        rr = self.rr
        rows, place, turn, scale = self.motion.parachute(flown)
        if len(rows) == 0:
            return
        mesh, lines = canopy(self.vehicle, flown.number)
        start, entity = self.t[rows[0]], f"{self.root}/parachute"
        self.at(start, f"{entity}/canopy", self.mesh(mesh))
        self.at(start, f"{entity}/lines", rr.LineStrips3D(lines, colors=LINE, radii=rr.Radius.ui_points(0.7)))
        pose = rr.Transform3D.columns(translation=place, quaternion=turns.xyzw(turn), scale=scale)
        self.columns(entity, self.t[rows], pose)
        bridle = self._bridle(flown.number)
        self.at(start, f"{self.root}/vehicle/bridle", bridle)
        gone = self.motion.released(self.motion.backshell)
        if gone is not None and flown.end == len(self.t):
            self.gone(self.t[gone], f"{self.root}/vehicle/bridle")
            self.at(self.t[gone], f"{self.root}/backshell/bridle", bridle)

    def _bridle(self, number: int) -> rr.LineStrips3D:
        """The bridle of a parachute, from its attachments or from around the lid to the confluence."""
        chute = self.vehicle.parachutes[number]
        ends = [list(one) for one in chute.bridle_attachments_m]
        if not ends and self.motion.shape.afterbody:
            x, r = self.motion.shape.afterbody[-1]
            ends = [[x, r * np.cos(a), r * np.sin(a)] for a in (0.0, 2.1, 4.2)]
        ends = ends or [list(self.motion.shape.centre)]
        strips = [[end, list(chute.confluence_m)] for end in ends]
        return self.rr.LineStrips3D(strips, colors=LINE, radii=self.rr.Radius.ui_points(1.0))

    def _discarded(self, name: str, place: np.ndarray, part: str, own_centre: Vec3, mesh: Mesh) -> None:
        """A part on its own: its mesh, and a labelled point that is seen from afar."""
        rr, first = self.rr, self.motion.released(place)
        if first is None:
            return
        origin, turn = self.motion.discarded(place, own_centre)
        rows = first + np.flatnonzero(np.isfinite(origin[first:, 0]))
        tint = {"albedo_factor": [104, 84, 70, 255]} if name == "heat_shield" else {}
        self.at(self.t[first], f"{self.root}/{name}/shape", *self.shown(part, mesh, **tint))
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
