"""Actors of a film: the vehicle and its glow, parachutes, discarded parts, flames and the shadow."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from edl6dof.replay.film.stage import Stage, Track, pose, upright
from edl6dof.replay.history import History
from edl6dof.replay.scene import craft_shapes as shapes
from edl6dof.replay.scene.craft import LINE, SHIELD_COLD, glow
from edl6dof.replay.scene.ground import RINGS, dust, dust_ring, puffs
from edl6dof.replay.scene.mesh import Mesh, bright, grid_triangles, merge, plume, revolve, sphere
from edl6dof.replay.scene.poses import Motion, OpenParachute
from edl6dof.spatial import rotations as turns

#: Least duty of a thruster and least share of the thrust with a flame.
_LEAST = 0.02
#: Heights (m) over which the shadow fades by e, and its opacity.
_FADES_M, _DARK = 60.0, 0.62
#: Opacity of the thickest dust.
_DUST = 0.3
#: Colours of a heat shield that glows, and of the gas in front of it.
_HOT, _GAS = (255, 140, 60), (255, 170, 105)

#: Function of the time (s) that updates an actor.
Update = Callable[[float], None]


class Cast:
    """All actors of a flight on a stage, which follow its time."""

    def __init__(self, stage: Stage, flight: History, motion: Motion) -> None:
        self.stage, self.flight, self.motion = stage, flight, motion
        self.vehicle, self.shape, self.t = flight.scenario.vehicle, motion.shape, flight.t
        self.body = Track.of(self.t, motion.nose, motion.rotation)
        self._updates: list[Update] = []
        self._aeroshell()
        self._lander()
        self._glow()
        for flown in motion.parachutes():
            self._parachute(flown)
        self._flames()
        self._shadow()
        self._dust()

    def show(self, t: float) -> None:
        """Put every actor in its place at time ``t`` (s)."""
        for update in self._updates:
            update(t)

    def _moves(
        self, actor: Any, track: Track, since: float = -np.inf, until: float = np.inf, place: Any = None
    ) -> None:
        """Let an actor follow a track from one time (s) to another; ``place``: its pose in these axes."""

        def update(t: float) -> None:
            actor.visibility = since <= t < until
            if actor.visibility:
                actor.user_matrix = track.at(t) if place is None else track.at(t) @ place

        self._updates.append(update)

    def _time_of(self, row: int | None) -> float:
        return np.inf if row is None else float(self.t[row])

    def _aeroshell(self) -> None:
        """Add the entry vehicle, whose parts leave it."""
        motion, shape = self.motion, self.shape
        shield, shell = self.vehicle.showing("capsule"), self.vehicle.showing("backshell")
        if shape.body == "sphere_cone":
            self._part(_tinted(shapes.heat_shield(shape)), shield, motion.heat_shield)
            self._part(shapes.backshell(shape), shell, motion.backshell)
        elif shape.body != "none":
            self._part(
                shapes.body(shape), shield or shell, motion.heat_shield if shield else motion.backshell
            )

    def _part(self, mesh: Mesh, part: Any, place: np.ndarray) -> None:
        """Add a part of the aeroshell, and after its release, if it has one, the part that falls."""
        row = None if part is None else self.motion.released(place)
        self._moves(self.stage.add(mesh), self.body, until=self._time_of(row))
        if row is not None:
            self._moves(self.stage.add(mesh), self._falling(place, part), since=self._time_of(row))

    def _falling(self, place: np.ndarray, part: Any) -> Track:
        """Poses of a released part."""
        origin, turn = self.motion.discarded(place, part.centre_m)
        rows = np.flatnonzero(np.isfinite(origin[:, 0]))
        return Track.of(self.t[rows], origin[rows], turn)

    def _lander(self) -> None:
        """Add lander, nozzles, legs and trim wing."""
        vehicle, shape = self.vehicle, self.shape
        for mesh in (shapes.lander(vehicle, shape), shapes.nozzles(vehicle, shape)):
            if mesh is not None:
                self._moves(self.stage.add(mesh), self.body)
        pads = np.array(vehicle.landing_gear.footpads_m).reshape(-1, 3)
        legs = shapes.legs(vehicle, shape, np.zeros(len(pads)))
        if legs is not None:
            row = self.motion.released(self.motion.heat_shield) if vehicle.showing("capsule") else 0
            since = self.flight.when.get("landing_legs", self._time_of(row))
            touching = self.flight["truth.footpads"] > 0.0
            lands = float(self.t[np.argmax(touching)]) if touching[-1] else np.inf
            self._moves(self.stage.add(legs), self.body, since, lands)
            pressed = shapes.legs(vehicle, shape, self.motion.strokes(pads))
            if pressed is not None:
                self._moves(self.stage.add(pressed), self.body, since=lands)
        if vehicle.surfaces:
            self._wing()

    def _wing(self) -> None:
        vehicle, shape = self.vehicle, self.shape
        actor, hinge = self.stage.add(shapes.trim_wing(vehicle, shape)), shapes.wing_hinge(vehicle, shape)[0]
        opening = np.nan_to_num(self.flight["truth.trim_wing"])
        until = self._time_of(self.motion.released(self.motion.backshell))

        def update(t: float) -> None:
            actor.visibility = t < until
            now = np.array(np.interp(t, self.t, opening))
            turned = turns.from_axes(shapes.wing_axes(vehicle, shape, now))
            actor.user_matrix = self.body.at(t) @ pose(hinge, turned)

        self._updates.append(update)

    def _glow(self) -> None:
        """Add the glow of the heat shield and of the gas around it, as bright as its heat flux makes it."""
        if self.shape.body != "sphere_cone":
            return
        hot = glow(np.nan_to_num(self.flight["truth.heat_flux_w_cm2"]))
        if not np.any(hot > 0.0):
            return
        until = self._time_of(self.motion.released(self.motion.heat_shield))
        face = [(x + 0.004 * self.shape.size, r * 1.002) for x, r in self.shape.forebody]
        skin = revolve(face, _HOT, 64)
        edge = np.hypot(*skin.positions[:, 1:].T) / self.shape.radius
        face_actor = self.stage.add(skin, 0.95 - 0.35 * edge**2, lit=False)
        gas = [(self.stage.add_gas(mesh, opacity), share) for mesh, opacity, share in _gas(self.shape)]
        speed = np.gradient(self.motion.centre, self.t, axis=0)
        flow = Track.of(self.t, self.motion.nose, turns.from_x_to(speed))

        def update(t: float) -> None:
            brightness = float(np.interp(t, self.t, hot))
            shown = brightness > 0.01 and t < until
            for actor, share, track in (
                (face_actor, 1.0, self.body),
                *((one, part, flow) for one, part in gas),
            ):
                actor.visibility = shown
                if shown:
                    actor.prop.opacity = min(1.0, brightness * share)
                    actor.user_matrix = track.at(t)

        self._updates.append(update)

    def _parachute(self, flown: OpenParachute) -> None:
        """Add canopy, lines and bridle."""
        rows, place, turn, scale = self.motion.parachute(flown)
        if len(rows) == 0:
            return
        mesh, lines = shapes.canopy(self.vehicle, flown.number)
        track = Track.of(self.t[rows], place, turn, scale)
        since = float(self.t[rows[0]])
        until = np.inf if flown.end == len(self.t) else float(self.t[flown.end])
        self._moves(self.stage.add(mesh), track, since, until)
        self._moves(self.stage.add_lines(lines, LINE, 1.6), track, since, until)
        bridle = self.stage.add_lines(shapes.bridle(self.vehicle, self.shape, flown.number), LINE, 2.0)
        shell = self.vehicle.showing("backshell")
        gone = self.motion.released(self.motion.backshell) if flown.end == len(self.t) else None
        self._moves(bridle, self.body, since, min(until, self._time_of(gone)))
        if gone is not None and shell is not None:
            hung = self.stage.add_lines(shapes.bridle(self.vehicle, self.shape, flown.number), LINE, 2.0)
            self._moves(hung, self._falling(self.motion.backshell, shell), since=self._time_of(gone))

    def _flames(self) -> None:
        """Add the flames of thrusters and engines."""
        for number, jet in enumerate(self.vehicle.rcs.thrusters):
            if self.flight.duty.shape[1] != len(self.vehicle.rcs.thrusters):
                break
            size = 1.5 * max(jet.thrust_n / 250.0, 0.05) ** 0.4
            duty = self.flight.duty[:, number]
            if np.any(duty > _LEAST):
                self._flame(jet.position_m, jet.direction, duty, (size, 0.37 * size))
        engines = self.vehicle.own_engines
        full = sum(engine.full_thrust_n for engine in engines)
        if full > 0.0:
            level = np.nan_to_num(self.flight["truth.engine_thrust_n"]) / full
            for engine in engines:
                self._flame(engine.nozzle_m, engine.direction, level, (4.0, 0.8))

    def _flame(self, place: Any, direction: Any, level: np.ndarray, size: tuple[float, float]) -> None:
        """Add one flame, as long as the level of the thrust (0 to 1) over time makes it."""
        back = turns.from_x_to(-np.array(direction, float))
        layers = []
        for core in (True, False):
            mesh = plume(core)
            along = mesh.positions[:, 0] / mesh.positions[:, 0].max()
            opacity = (0.85 if core else 0.38) * (1.0 - along) ** 1.1
            layers.append(self.stage.add(mesh, opacity, lit=False))

        def update(t: float) -> None:
            now = float(np.interp(t, self.t, level))
            flicker = 1.0 + 0.05 * np.sin(46.0 * t) + 0.03 * np.sin(111.0 * t)
            for actor in layers:
                actor.visibility = now > _LEAST
                if actor.visibility:
                    length, girth = size[0] * (0.25 + 0.75 * now) * flicker, size[1] * (0.6 + 0.4 * now)
                    scale = np.array([length, girth, girth])
                    actor.user_matrix = self.body.at(t) @ pose(np.array(place), back, scale)

        self._updates.append(update)

    def _shadow(self) -> None:
        """Add the shadow on the ground, paler and wider from higher up."""
        site = self.motion.site
        rings, spokes = np.linspace(0.0, 1.0, 9), 40
        turn = np.linspace(0.0, 2.0 * np.pi, spokes, endpoint=False)
        place = np.stack(
            [np.outer(rings, np.cos(turn)), np.outer(rings, np.sin(turn)), np.zeros((9, spokes))], axis=-1
        )
        mesh = bright(place.reshape(-1, 3), grid_triangles(9, spokes), np.full((9 * spokes, 3), 12.0))
        actor = self.stage.add(mesh, np.repeat((1.0 - rings**2) ** 0.7, spokes), lit=False)
        pads = np.array(self.vehicle.landing_gear.footpads_m).reshape(-1, 3)
        wide = 1.05 * float(np.hypot(pads[:, 1], pads[:, 2]).max(initial=self.shape.radius))

        def update(t: float) -> None:
            height = float(np.interp(t, self.t, self.motion.height))
            actor.visibility = 0.0 <= height < 5.0 * _FADES_M
            if not actor.visibility:
                return
            centre = self.body.at(t)[:3, 3]
            spot = centre[:2] - max(height, 0.0) / site.light[2] * site.light[:2]
            steps = wide * np.array([[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
            up = site.ground(*(spot + steps).T)[1]
            normal = np.array([up[2] - up[1], up[4] - up[3], 2.0 * wide])
            size = wide * (1.0 + height / 40.0)
            place = np.array([*spot, up[0] + 0.06])
            actor.user_matrix = pose(place, upright(normal), np.array([size, size, 1.0]))
            actor.prop.opacity = _DARK * float(np.exp(-height / _FADES_M))

        self._updates.append(update)

    def _dust(self) -> None:
        """Add rings of dust that run outwards under the engines, as thick as the plume presses."""
        if not self.vehicle.engines:
            return
        site, thrust = self.motion.site, self.flight["truth.engine_thrust_n"]
        nozzle = np.append(np.mean([engine.nozzle_m for engine in self.vehicle.engines], axis=0), 1.0)
        rings = [self.stage.add_gas(*_ring(ring, site.appearance.haze)) for ring in range(RINGS)]

        def update(t: float) -> None:
            mouth = (self.body.at(t) @ nozzle)[:3]
            up = float(site.ground(mouth[0], mouth[1])[1])
            height = np.array(max(float(mouth[2]) - up, 0.5))
            thick = float(dust(np.array(np.interp(t, self.t, thrust)), height))
            for number, actor in enumerate(rings):
                actor.visibility = thick > 0.0
                if actor.visibility:
                    run, wide = dust_ring(np.array(t), height, number)
                    size = np.array([wide, wide, 0.4 * wide + 0.3])
                    actor.user_matrix = pose(np.array([*mouth[:2], up]), np.array([1.0, 0.0, 0.0, 0.0]), size)
                    actor.prop.opacity = _DUST * thick * float(np.sin(np.pi * run))

        self._updates.append(update)


def _ring(seed: int, colour: Any) -> tuple[Mesh, np.ndarray]:
    """Puffs of a ring of dust of unit radius, and the opacity of their vertices."""
    ball = sphere(9, 16, 0.01).reshape(-1, 3)
    one = Mesh(ball, grid_triangles(9, 16), ball, np.tile(np.array(colour, np.uint8), (len(ball), 1)))
    mesh = merge(one._replace(positions=at + size * ball) for at, size in zip(*puffs(seed), strict=True))
    return mesh, np.ones(len(mesh.positions))


def _tinted(mesh: Mesh) -> Mesh:
    """The heat shield in its own colour: its mesh is light, so that heat can tint it."""
    return mesh._replace(colours=(mesh.colours * (SHIELD_COLD / 255.0)).astype(np.uint8))


def _gas(shape: Any) -> list[tuple[Mesh, np.ndarray, float]]:
    """Layers of hot gas from ahead of the nose to the wake: meshes, opacity of vertices, brightness."""
    found = []
    for grown, reach, share in ((1.06, 2.2, 0.50), (1.16, 4.0, 0.30), (1.32, 7.0, 0.18)):
        radius, x = shape.radius * grown, np.concatenate([np.linspace(0.0, 1.0, 16) ** 2, [2.0, 3.0, 4.0]])
        ahead = 0.10 * grown**3 * shape.radius
        cap = [(ahead - 0.62 * shape.radius * s, max(radius * np.sqrt(s), 1e-4)) for s in x[:16]]
        tail = [
            (cap[-1][0] - shape.radius * reach * s, radius * (1.0 - 0.72 * s**1.5))
            for s in np.linspace(0.06, 1.0, 14)
        ]
        mesh = revolve([*cap, *tail], _GAS, 48)
        along = (ahead - mesh.positions[:, 0]) / (ahead - tail[-1][0])
        mesh = mesh._replace(
            colours=(np.array([255.0, 214.0, 170.0]) + np.outer(along, [0.0, -120.0, -140.0])).astype(
                np.uint8
            )
        )
        found.append((mesh, (1.0 - along) ** 1.6, share))
    return found
