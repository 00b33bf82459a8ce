"""The three-dimensional part of the replay: ground, path, vehicle, flames, parachute, what was thrown off."""

from __future__ import annotations

from typing import Any

import numpy as np

from edl6dof.post import scene
from edl6dof.post.history import thin
from edl6dof.post.recorder import SCALAR_HZ, Recorder
from edl6dof.post.turns import from_x_to, xyzw


class Stage(Recorder):
    """Writes ``/site``."""

    def statics(self) -> None:
        """What is there from the beginning."""
        self._ground()
        self._path()
        self._vehicle_parts()

    def motions(self) -> None:
        """What moves."""
        self._vehicle_motion()
        self._plumes()
        self._parachute()
        mass, motion = self.vehicle.mass, self.motion
        self._discarded("heat_shield", motion.heat_shield, mass.heat_shield.centre_m, scene.heat_shield(self.vehicle))
        self._discarded("backshell", motion.backshell, mass.backshell.centre_m, scene.backshell(self.vehicle))
        self._trail()

    def _ground(self) -> None:
        rr, motion = self.rr, self.motion
        self.static("site", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
        reach = float(np.clip(1.15 * np.linalg.norm(motion.centre - motion.last, axis=-1).max(), 5e3, 1.2e6))
        self.static("site/ground", self.mesh(scene.ground(motion.last, motion.ground_up, reach)))
        turn = np.linspace(0.0, 2.0 * np.pi, 97)
        circle = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
        limit = self.flight.scenario.limits.landing_distance_m

        def ring(radius: float, centre: np.ndarray) -> np.ndarray:
            flat = centre[:2] + radius * circle
            return np.column_stack([flat, motion.ground_up(flat[:, 0], flat[:, 1]) + 0.02 + 1e-4 * radius])

        radii = [r for r in (5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1e3, 2e3, 5e3) if r < reach]
        here = motion.last
        self.static(
            "site/ground/rings",
            rr.LineStrips3D([ring(r, here) for r in radii], colors=[96, 54, 34], radii=rr.Radius.ui_points(0.6)),
        )
        target = np.zeros(3)
        self.static(
            "site/markers/target",
            rr.LineStrips3D(
                [ring(r, target) for r in (0.01 * limit, 0.1 * limit, limit)],
                colors=[90, 220, 230],
                radii=rr.Radius.ui_points(1.2),
            ),
        )
        self._label("target", [0.0, 0.0, float(motion.ground_up(np.zeros(1), np.zeros(1))[0])], (90, 220, 230))
        if self.flight["truth.footpads"][-1] > 0.0:
            self._label("touchdown", [*here[:2], float(here[2] - motion.height[-1])], (120, 235, 140))

    def _label(self, name: str, place: list[float], colour: scene.RGB) -> None:
        radius = self.rr.Radius.ui_points(4.0)
        point = self.rr.Points3D([place], labels=[name], colors=colour, radii=radius, show_labels=True)
        self.static(f"site/labels/{name}", point)

    def _path(self) -> None:
        rows = thin(self.t, 5.0)
        phase = self.phase[rows]
        cuts = np.flatnonzero(np.diff(phase)) + 1
        strips = [part if k == 0 else np.append(rows[c - 1 : c], part) for k, (c, part) in enumerate(self._split(rows, cuts))]
        colours = [self.colours[self.phase[strip[-1]]] for strip in strips]
        self.static(
            "site/path",
            self.rr.LineStrips3D([self.motion.centre[strip] for strip in strips], colors=colours, radii=self.rr.Radius.ui_points(2.0)),
        )

    @staticmethod
    def _split(rows: np.ndarray, cuts: np.ndarray) -> list[tuple[int, np.ndarray]]:
        starts = [0, *cuts.tolist()]
        return list(zip(starts, np.split(rows, cuts), strict=True))

    def _vehicle_parts(self) -> None:
        vehicle, motion = self.vehicle, self.motion
        start = self.t[0]
        self.static("site/vehicle/lander", self.mesh(scene.lander(vehicle)))
        self.at(start, "site/vehicle/heat_shield", self.mesh(scene.heat_shield(vehicle)))
        self.at(start, "site/vehicle/backshell", self.mesh(scene.backshell(vehicle)))
        for part, place in (("heat_shield", motion.heat_shield), ("backshell", motion.backshell)):
            gone = motion.released(place)
            if gone is not None:
                self.at(self.t[gone], f"site/vehicle/{part}", self.rr.Clear(recursive=False))
        legs = scene.legs(vehicle)
        if legs is not None and "landing_legs" in self.when:
            self.at(self.when["landing_legs"], "site/vehicle/legs", self.mesh(legs))
        wing = vehicle.trim_wing
        if wing.area_m2 > 0.0 and "trim_wing" in self.when:
            flap = scene.box((wing.position_x_m, 0.0, 0.97 * wing.position_z_m), (0.04, 0.5, 0.8), scene.ORANGE)
            self.at(self.when["trim_wing"], "site/vehicle/trim_wing", self.mesh(flap))
            gone = motion.released(motion.backshell)
            if gone is not None:
                self.at(self.t[gone], "site/vehicle/trim_wing", self.rr.Clear(recursive=False))
        rows = thin(self.t, 2.0)
        heat = np.maximum(np.nan_to_num(self.flight["truth.heat_flux_w_cm2"][rows]), 0.0)
        glow = (heat / max(heat.max(), 1e-9))[:, None] ** 0.6
        tint = np.array([104, 84, 70]) + (np.array([255, 150, 70]) - [104, 84, 70]) * glow
        until = motion.released(motion.heat_shield)
        keep = rows < (until if until is not None else len(self.t))
        self.columns(
            "site/vehicle/heat_shield",
            self.t[rows[keep]],
            self.rr.Mesh3D.columns(albedo_factor=np.column_stack([tint, np.full(len(tint), 255)])[keep].astype(np.uint8)),
        )

    def _vehicle_motion(self) -> None:
        rr, motion = self.rr, self.motion
        turn = xyzw(motion.rotation)
        self.columns("site/vehicle", self.t, rr.Transform3D.columns(translation=motion.nose, quaternion=turn))
        look, facing, scale = motion.camera()
        frame = rr.Transform3D.columns(translation=look, quaternion=xyzw(facing), scale=np.repeat(scale[:, None], 3, axis=1))
        self.columns("site/camera", self.t, frame)
        self._velocity(np.arange(len(self.t)))
        rows = thin(self.t, SCALAR_HZ)
        self.static("site/markers/vehicle", rr.Points3D.from_fields(colors=[255, 255, 255], radii=-5.0))
        self.columns("site/markers/vehicle", self.t[rows], rr.Points3D.columns(positions=motion.centre[rows]))
        low = rows[motion.height[rows] < 20e3]
        if len(low):
            below = motion.centre[low] - [0.0, 0.0, 1.0] * motion.height[low, None]
            self.static("site/drop_line", rr.LineStrips3D.from_fields(colors=[190, 170, 150], radii=-0.7))
            line = np.stack([motion.centre[low], below], axis=1)
            self.columns("site/drop_line", self.t[low], rr.LineStrips3D.columns(strips=line))
        self._shadow(rows)

    def _velocity(self, rows: np.ndarray) -> None:
        """Arrow along the flight path, ahead of the nose, until the parachute."""
        rr, motion = self.rr, self.motion
        rows = rows[self.t[rows] < self.when.get("mortar", np.inf)]
        if len(rows) < 3:
            return
        way = np.gradient(motion.centre[rows], self.t[rows], axis=0)
        way /= np.maximum(np.linalg.norm(way, axis=-1, keepdims=True), 1e-9)
        size = self.vehicle.aero.capsule.diameter_m
        self.static("site/velocity", rr.Arrows3D.from_fields(colors=[110, 230, 240], radii=0.012 * size))
        self.columns(
            "site/velocity",
            self.t[rows],
            rr.Arrows3D.columns(origins=motion.centre[rows] + 0.45 * size * way, vectors=0.55 * size * way),
        )
        self.at(self.when.get("mortar", self.t[rows[-1]]), "site/velocity", rr.Clear(recursive=False))

    def _shadow(self, rows: np.ndarray) -> None:
        """Dark disc under the vehicle, for the eye to judge the height by."""
        motion = self.motion
        rows = rows[motion.height[rows] < 300.0]
        if len(rows) == 0:
            return
        disc = scene.revolve([(0.0, 1.3), (0.0, 1e-4)], (84, 46, 28), 32, (np.zeros(3), np.array([0.0, 0.0, 1.0])))
        self.at(self.t[rows[0]], "site/shadow", self.mesh(disc))
        place = motion.centre[rows] - [0.0, 0.0, 1.0] * motion.height[rows, None] + [0.0, 0.0, 0.03]
        self.columns("site/shadow", self.t[rows], self.rr.Transform3D.columns(translation=place))

    def _plumes(self) -> None:
        rr = self.rr
        jets = self.vehicle.rcs.thrusters
        t = self.t
        if jets:
            duty = self.flight.duty
            back = xyzw(from_x_to(-np.array([jet.direction for jet in jets])))
            places = np.array([jet.position_m for jet in jets])
            size = np.array([1.5 * max(jet.thrust_n / 250.0, 0.05) ** 0.4 for jet in jets])
            firing = duty > 0.02
            length = size * (0.35 + 0.65 * duty)
            length, shown, rows_shown = _hide(length, firing)
            which = np.nonzero(shown)[1]
            length = length[shown]
            scales = np.column_stack([length, 0.37 * length, 0.37 * length])
            poses = rr.InstancePoses3D.columns(translations=places[which], quaternions=back[which], scales=scales)
            self._flames("thruster_plumes", t[rows_shown], poses.partition(shown.sum(axis=1)))
        engine = self.vehicle.engine
        thrust = np.nan_to_num(self.flight["truth.engine_thrust_n"])
        if engine.full_thrust_n > 0.0 and thrust.max() > 0.0:
            level = thrust / engine.full_thrust_n
            flicker = 1.0 + 0.06 * np.sin(2.0 * np.pi * 7.3 * t)
            length, shown, rows_shown = _hide(((0.8 + 3.2 * level) * flicker)[:, None], (level > 0.01)[:, None])
            girth = np.minimum(0.55 + 0.35 * level[rows_shown], length[:, 0])
            scales = np.column_stack([length[:, 0], girth, girth])
            nozzle = np.broadcast_to(engine.nozzle_m, scales.shape)
            poses = rr.InstancePoses3D.columns(translations=nozzle, scales=scales)
            self._flames("engine_plume", t[rows_shown], poses.partition(shown.sum(axis=1)))

    def _flames(self, name: str, t: np.ndarray, poses: Any) -> None:
        for layer in ("core", "mantle"):
            tint = [255, 255, 255, 255 if layer == "core" else 120]
            self.static(f"site/vehicle/{name}/{layer}", self.mesh(scene.plume(layer == "core"), albedo_factor=tint))
            self.columns(f"site/vehicle/{name}/{layer}", t, poses)

    def _parachute(self) -> None:
        rr = self.rr
        rows, place, turn, scale = self.motion.parachute()
        if len(rows) == 0:
            return
        mesh, lines = scene.canopy(self.vehicle)
        start = self.t[rows[0]]
        self.at(start, "site/parachute/canopy", self.mesh(mesh))
        self.at(start, "site/parachute/lines", rr.LineStrips3D(lines, colors=[222, 214, 204], radii=rr.Radius.ui_points(0.7)))
        self.columns("site/parachute", self.t[rows], rr.Transform3D.columns(translation=place, quaternion=xyzw(turn), scale=scale))
        lid_x, lid_r = scene.backshell_profile(self.vehicle)[-1]
        ends = [[lid_x, lid_r * np.cos(a), lid_r * np.sin(a)] for a in (0.0, 2.1, 4.2)]
        bridle = rr.LineStrips3D(
            [[end, self.vehicle.parachute.confluence_m] for end in ends], colors=[222, 214, 204], radii=rr.Radius.ui_points(1.0)
        )
        self.at(start, "site/vehicle/bridle", bridle)
        gone = self.motion.released(self.motion.backshell)
        if gone is not None:
            self.at(self.t[gone], "site/vehicle/bridle", rr.Clear(recursive=False))
            self.at(self.t[gone], "site/backshell/bridle", bridle)

    def _discarded(self, name: str, place: np.ndarray, own_centre: Any, mesh: scene.Mesh) -> None:
        """A part on its own: its mesh, and a labelled point that is seen from afar."""
        rr, first = self.rr, self.motion.released(place)
        if first is None:
            return
        origin, turn = self.motion.discarded(place, own_centre)
        rows = np.arange(first, len(self.t))
        rows = rows[np.isfinite(origin[rows, 0])]
        tint = {"albedo_factor": [104, 84, 70, 255]} if name == "heat_shield" else {}
        self.at(self.t[first], f"site/{name}/shape", self.mesh(mesh, **tint))
        attitude = np.tile(xyzw(turn), (len(rows), 1))
        self.columns(f"site/{name}", self.t[rows], rr.Transform3D.columns(translation=origin[rows], quaternion=attitude))
        rows = rows[::5]
        label = rr.Points3D.from_fields(labels=[name.replace("_", " ")], colors=[235, 190, 120], radii=-3.5, show_labels=True)
        self.at(self.t[first], f"site/labels/{name}", label)
        self.columns(f"site/labels/{name}", self.t[rows], rr.Points3D.columns(positions=place[rows]))

    def _trail(self) -> None:
        """Short segments; the views show those of the last minute."""
        rows = thin(self.t, SCALAR_HZ)
        if len(rows) < 2:
            return
        segments = np.stack([self.motion.centre[rows[:-1]], self.motion.centre[rows[1:]]], axis=1)
        colours = np.append(self.colours[self.phase[rows[1:]]], np.full((len(rows) - 1, 1), 255, np.uint8), axis=1)
        self.static("site/trail", self.rr.LineStrips3D.from_fields(radii=-1.5))
        self.columns("site/trail", self.t[rows[1:]], self.rr.LineStrips3D.columns(strips=segments, colors=colours))


def _hide(length: np.ndarray, firing: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows in which something fires, or has just stopped.

    The latter show one flame too small to see: the viewer takes an empty row for one instance in the default pose.

    Args:
        length: of the flames, shape (rows, nozzles).
        firing: which of them burn.

    Returns:
        lengths and shown flames of the rows kept, and the kept rows.
    """
    active = firing.any(axis=1)
    keep = np.flatnonzero(active | np.append([True], active[:-1]))
    length, shown = length[keep].copy(), firing[keep].copy()
    silent = ~active[keep]
    length[silent], shown[silent, 0] = 1e-4, True
    return length, shown, keep
