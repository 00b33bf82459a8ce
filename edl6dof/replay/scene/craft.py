"""The vehicle: aeroshell and lander, heat glow, trim wing, legs and failed thrusters; its parachute,
discarded parts and flames.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from edl6dof.replay.history import thin
from edl6dof.replay.recorder import Recorder, and_next
from edl6dof.replay.scene import craft_shapes as shapes
from edl6dof.replay.scene.mesh import Mesh, plume
from edl6dof.replay.scene.poses import OpenParachute
from edl6dof.spatial import rotations as turns
from edl6dof.telemetry.thinning import spans

if TYPE_CHECKING:
    import rerun as rr

RED, PALE_RED = (255, 40, 40), (255, 120, 120)
#: Colours of lines and bridle, and of the marks of discarded parts.
LINE, PART = (222, 214, 204), (235, 190, 120)
#: Tints of a heat shield and of any other surface, cold, and of both as hot as they get.
SHIELD_COLD, COLD, HOT = (np.array(c, float) for c in ((104, 84, 70), (255, 255, 255), (255, 150, 70)))
#: Temperatures (K) at which a surface begins to glow (Draper) and at which it is drawn brightest, and the
#: Stefan-Boltzmann constant, W/(cm2 K4).
_GLOWS, _BRIGHT, _RADIATED = 798.0, 1900.0, 5.670374419e-12
#: Colour and size (points of the screen) of the spark that shows a firing thruster from any distance.
SPARK, _SPARK_SIZE = (255, 196, 96), 2.5
#: Least share of the thrust, and least duty of a thruster, with a flame.
_LEAST_LEVEL, _LEAST_DUTY = 0.01, 0.02
#: Length (m) of a flame that is out.
_GONE = 1e-4


class Vehicle(Recorder):
    """Writes ``vehicle``, whose axes are B."""

    def statics(self) -> None:
        """Write lander and nozzles."""
        body = f"{self.root}/vehicle/lander"
        if (own := self.own_mesh(None)) is not None:
            self.static(body, *own)
            return
        if (mesh := shapes.lander(self.vehicle, self.motion.shape)) is not None:
            self.static(body, self.mesh(mesh))
        if (mesh := shapes.nozzles(self.vehicle, self.motion.shape)) is not None:
            self.static(f"{self.root}/vehicle/nozzles", self.mesh(mesh))

    def motions(self) -> None:
        """Write everything that moves, leaves or fails."""
        motion, vehicle = self.motion, self.vehicle
        self.poses(f"{self.root}/vehicle", self.t, motion.nose, motion.rotation)
        self._aeroshell()
        self._legs()
        if vehicle.surfaces:
            self._trim_wing()
        for jet in vehicle.rcs.thrusters:
            self._failure(jet)

    def _aeroshell(self) -> None:
        """Write the entry vehicle: pieces that are discarded parts disappear at release, others stay."""
        motion, shape = self.motion, self.motion.shape
        parts = (self.vehicle.showing("capsule"), self.vehicle.showing("backshell"))
        front, back = (None if part is None else part.name for part in parts)
        if shape.body == "sphere_cone":
            ahead = "heat_shield" if front else "forebody"
            self._piece(ahead, front, shapes.heat_shield(shape), motion.heat_shield, SHIELD_COLD)
            behind = "backshell" if back else "afterbody"
            self._piece(behind, back, shapes.backshell(shape), motion.backshell)
        elif shape.body != "none":
            place = motion.heat_shield if front else motion.backshell
            self._piece("body", front or back, shapes.body(shape), place, COLD)

    def _piece(
        self, name: str, part: str | None, mesh: Mesh, place: np.ndarray, cold: np.ndarray | None = None
    ) -> None:
        """Write one piece until its release, glowing if its ``cold`` tint is given.  A piece that is no part
        (``None``) is left out if the user has a mesh for the vehicle.
        """
        entity, own = f"{self.root}/vehicle/{name}", self.own_mesh(part)
        if part is None and own is not None:
            return
        self.at(self.t[0], entity, *self.shown(part, mesh))
        released = self.motion.released(place) if part else None
        if cold is not None and own is None:
            self._glow(entity, released, cold)
        if released is not None:
            self.gone(self.t[released], entity)

    def _glow(self, entity: str, until: int | None, cold: np.ndarray) -> None:
        """Write the glow at the temperature at which a surface radiates its heat flux as a black body."""
        rows = thin(self.t, 2.0)
        rows = rows[rows < (len(self.t) if until is None else until)]
        hot = glow(self.flight["truth.heat_flux_w_cm2"][rows])[:, None]
        tint = np.column_stack([cold + (HOT - cold) * hot, np.full(len(rows), 255.0)]).astype(np.uint8)
        self.columns(entity, self.t[rows], self.rr.Mesh3D.columns(albedo_factor=tint))

    def _legs(self) -> None:
        """Write the legs as they extend, compressed by the ground once they stand on it."""
        pads, shape = np.array(self.vehicle.landing_gear.footpads_m).reshape(-1, 3), self.motion.shape
        since, out = self._legs_out(), shapes.legs(self.vehicle, shape, np.zeros(len(pads)))
        if since is None or out is None or self.own_mesh(None) is not None:
            return
        entity, touching = f"{self.root}/vehicle/legs", self.flight["truth.footpads"] > 0.0
        self.at(since, entity, self.mesh(out))
        if touching[-1] and (pressed := shapes.legs(self.vehicle, shape, self.motion.strokes(pads))):
            self.at(self.t[np.argmax(touching)], entity, self.mesh(pressed))

    def _legs_out(self) -> float | None:
        """Time (s) at which the legs appear: the mission extends them, else the heat shield is released."""
        events = self.flight.scenario.mission.events.values()
        if any(event.action == "extend" and event.component == "landing_gear" for event in events):
            return self.when.get("landing_legs")
        row = self.motion.released(self.motion.heat_shield) if self.vehicle.showing("capsule") else 0
        return None if row is None else float(self.t[row])

    def _trim_wing(self) -> None:
        """Write the trim wing, which opens about its hinge and leaves with the backshell."""
        vehicle, shape = self.vehicle, self.motion.shape
        entity = f"{self.root}/vehicle/trim_wing"
        mesh = self.mesh(shapes.trim_wing(vehicle, shape))
        hinge = shapes.wing_hinge(vehicle, shape)[0]
        opening = np.nan_to_num(self.flight["truth.trim_wing"])
        released = self.motion.released(self.motion.backshell)
        rows = np.append(0, np.flatnonzero(np.diff(opening)) + 1)
        rows = rows[rows < (len(self.t) if released is None else released)]
        turned = turns.from_axes(shapes.wing_axes(vehicle, shape, opening[rows]))
        self.at(self.t[0], entity, mesh)
        self.poses(entity, self.t[rows], np.tile(hinge, (len(rows), 1)), turned)
        if released is not None:
            self.gone(self.t[released], entity)
            last = self.rr.Transform3D(translation=hinge, quaternion=turns.xyzw(turned[-1]))
            self.at(self.t[released], f"{self.root}/backshell/trim_wing", mesh, last)

    def _failure(self, jet: Any) -> None:
        """Write a failed thruster in red, with a mark outside the hull that names an isolated fault."""
        entity = f"{self.root}/vehicle/failed/{jet.name}"
        place = np.array(jet.position_m) + 0.35 * np.array([0.0, *jet.position_m[1:]])
        failed = self.flight.failures.get(jet.name, np.zeros(0))
        for begin, end in spans(failed > 0):
            self.at(self.t[begin], entity, self.mesh(shapes.nozzle(jet, RED, 2.0)))
            self.at(self.t[begin], f"{entity}/mark", self.point(place, "failed", PALE_RED))
            if end < len(self.t):
                self.at(self.t[end], entity, self.rr.Clear(recursive=True))
        if (known := self.flight.diagnosed.get(jet.name)) is not None:
            self.at(known[0], f"{entity}/mark", self.point(place, known[1], PALE_RED))


class Descent(Recorder):
    """Writes ``parachute``, ``heat_shield`` and ``backshell``."""

    def motions(self) -> None:
        """Write parachutes and discarded parts."""
        motion, shape = self.motion, self.motion.shape
        for flown in motion.parachutes():
            self._parachute(flown)
        if shape.body == "sphere_cone":
            self._discarded("heat_shield", "capsule", motion.heat_shield, shapes.heat_shield(shape))
            self._discarded("backshell", "backshell", motion.backshell, shapes.backshell(shape))

    def _parachute(self, flown: OpenParachute) -> None:
        rows, place, turn, scale = self.motion.parachute(flown)
        if len(rows) == 0:
            return
        mesh, lines = shapes.canopy(self.vehicle, flown.number)
        start, entity = self.t[rows[0]], f"{self.root}/parachute"
        self.at(start, f"{entity}/canopy", self.mesh(mesh))
        self.at(start, f"{entity}/lines", self.rr.LineStrips3D(lines, colors=LINE, radii=-0.7))
        self.poses(entity, self.t[rows], place, turn, scale)
        bridle = self._bridle(flown.number)
        self.at(start, f"{self.root}/vehicle/bridle", bridle)
        gone = self.motion.released(self.motion.backshell)
        if gone is not None and flown.end == len(self.t):
            self.gone(self.t[gone], f"{self.root}/vehicle/bridle")
            self.at(self.t[gone], f"{self.root}/backshell/bridle", bridle)

    def _bridle(self, number: int) -> rr.LineStrips3D:
        """The bridle of a parachute."""
        strips = shapes.bridle(self.vehicle, self.motion.shape, number)
        return self.rr.LineStrips3D(strips, colors=LINE, radii=-1.0)

    def _discarded(self, name: str, shown_as: str, place: np.ndarray, mesh: Mesh) -> None:
        """Write a discarded part: its mesh, and a labelled point that is visible from afar."""
        part, first = self.vehicle.showing(shown_as), self.motion.released(place)
        if part is None or first is None:
            return
        origin, turn = self.motion.discarded(place, part.centre_m)
        rows = first + np.flatnonzero(np.isfinite(origin[first:, 0]))
        tint = {"albedo_factor": [104, 84, 70, 255]} if name == "heat_shield" else {}
        self.at(self.t[first], f"{self.root}/{name}/shape", *self.shown(part.name, mesh, **tint))
        self.poses(f"{self.root}/{name}", self.t[rows], origin[rows], np.tile(turn, (len(rows), 1)))
        look = {"labels": [name.replace("_", " ")], "colors": PART, "radii": -3.5, "show_labels": True}
        label, rows = f"{self.root}/labels/{name}", rows[::6]
        self.at(self.t[first], label, self.rr.Points3D.from_fields(**look))
        self.columns(label, self.t[rows], self.rr.Points3D.columns(positions=place[rows]))


class Flames(Recorder):
    """Writes ``vehicle/thruster_plumes``, ``vehicle/thruster_sparks`` and ``vehicle/engine_plume``."""

    def motions(self) -> None:
        """Write the shapes of the flames from the first one on, and their lengths over time."""
        self._thrusters()
        self._engines()

    def _thrusters(self) -> None:
        jets = self.vehicle.rcs.thrusters
        duty = self.flight.duty
        if not jets or duty.shape[1] != len(jets):
            return
        back = turns.xyzw(turns.from_x_to(-np.array([jet.direction for jet in jets])))
        places = np.array([jet.position_m for jet in jets])
        size = np.array([1.5 * max(jet.thrust_n / 250.0, 0.05) ** 0.4 for jet in jets])
        firing = duty > _LEAST_DUTY
        length, shown, rows = _burning(size * (0.35 + 0.65 * duty), firing)
        if not len(rows):
            return
        which, length = np.nonzero(shown)[1], length[shown]
        scales = np.column_stack([length, 0.37 * length, 0.37 * length])
        pose = {"translations": places[which], "quaternions": back[which], "scales": scales}
        self._flames("thruster_plumes", rows, pose, shown.sum(axis=1))
        # points of one size on the screen: a flame is too small to be seen from afar
        sparks = {"positions": places[np.nonzero(firing[rows])[1]]}
        entity, look = f"{self.root}/vehicle/thruster_sparks", {"colors": SPARK, "radii": -_SPARK_SIZE}
        self.series(entity, self.t[rows], self.rr.Points3D, look, sparks, firing[rows].sum(axis=1))

    def _engines(self) -> None:
        engines = self.vehicle.own_engines
        full = sum(engine.full_thrust_n for engine in engines)
        if full <= 0.0:
            return
        # telemetry holds the thrust of all engines together
        level = np.nan_to_num(self.flight["truth.engine_thrust_n"]) / full
        flicker = 1.0 + 0.06 * np.sin(2.0 * np.pi * 7.3 * self.t)
        burns = (level > _LEAST_LEVEL)[:, None]
        length, shown, rows = _burning(((0.8 + 3.2 * level) * flicker)[:, None], burns)
        if not len(rows):
            return
        girth = np.minimum(0.55 + 0.35 * level[rows], length[:, 0])
        scales = np.column_stack([length[:, 0], girth, girth])
        back = turns.xyzw(turns.from_x_to(-np.array([engine.direction for engine in engines])))
        pose = {
            "translations": np.tile([engine.nozzle_m for engine in engines], (len(scales), 1)),
            "quaternions": np.tile(back, (len(scales), 1)),
            "scales": np.repeat(scales, len(engines), axis=0),
        }
        self._flames("engine_plume", rows, pose, len(engines) * shown.sum(axis=1))

    def _flames(self, name: str, rows: np.ndarray, pose: dict[str, Any], each: np.ndarray) -> None:
        """Write white cores in orange mantles from the first of ``rows``; ``each``: flames in each row."""
        poses = self.rr.InstancePoses3D.columns(**pose).partition(each)
        for layer, opacity in (("core", 255), ("mantle", 120)):
            entity = f"{self.root}/vehicle/{name}/{layer}"
            shape = self.mesh(plume(layer == "core"), albedo_factor=[255, 255, 255, opacity])
            self.at(self.t[rows[0]], entity, shape)
            self.columns(entity, self.t[rows], poses)


def glow(heat_w_cm2: np.ndarray) -> np.ndarray:
    """Return how bright surfaces glow, 0 to 1, at the temperature at which they radiate their heat flux."""
    heat = np.maximum(np.nan_to_num(heat_w_cm2), 0.0)
    return np.clip(((heat / _RADIATED) ** 0.25 - _GLOWS) / (_BRIGHT - _GLOWS), 0.0, 1.0)


def _burning(length: np.ndarray, firing: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows in which something fires, or has just stopped.

    A row in which it has just stopped shows one flame too small to see: the viewer takes an empty row for one
    instance in the default pose.

    Args:
        length: lengths of the flames, m, shape (rows, nozzles).
        firing: True for each burning flame, shape (rows, nozzles).

    Returns:
        lengths and shown flames of the rows kept, and the kept rows.
    """
    active: np.ndarray = np.logical_or.reduce(firing, axis=1)
    keep = np.flatnonzero(and_next(active))
    length, shown = length[keep].copy(), firing[keep].copy()
    silent = ~active[keep]
    length[silent], shown[silent, 0] = _GONE, True
    return length, shown, keep
