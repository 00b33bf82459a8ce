"""Ground, sky and target of the replay, shared by all flights of a recording; and what a vehicle does to the
ground that it comes close to: its shadow, and the dust of its engines.

The shadow lies where the light throws it.  The dust is a picture only: how much of it there is follows from
the pressure of the plume on the ground, and nothing in the simulation knows of it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from edl6dof.replay.history import thin
from edl6dof.replay.recorder import SCALAR_HZ, SLOW_HZ, Recorder, and_next
from edl6dof.replay.scene.landscape import SHADE, Landscape, dither, grain, sky
from edl6dof.replay.scene.mesh import bright, disc, grid_triangles, rock, sphere
from edl6dof.report.flight.common import circle
from edl6dof.scenario.terrain_preview import planned_ellipse
from edl6dof.spatial import rotations as turns

if TYPE_CHECKING:
    import rerun as rr

TARGET = (90, 220, 230)
SUNLIGHT = (255, 250, 235)
#: Radius of the sun's disc on the dome of unit radius: four times the true one, or it would be a point.
_SUN_SIZE = 0.025
KINDS_OF_ROCK = 4
#: Radius (m) of the target's largest circle where no limit sets it.
_TARGET_M = 10e3
#: Heights (m) below which there is a shadow, and over which it fades by e.
_SHADOW_BELOW, _FADES = 300.0, 60.0
#: Opacity of each of the discs that form a shadow, and their radii relative to the shadow's: a soft edge.
_OPACITY, _LAYERS = 0.26, (1.0, 0.9, 0.8, 0.68, 0.55)
#: Tangent of the half angle at which a plume spreads, and its mean pressure (Pa) on the ground at which dust
#: begins to rise, and at which the dust is thickest: after pictures of landings on Mars.
_SPREAD, _LIFTS, _THICK = 0.2, 5.0, 120.0
#: Rings of dust that run outwards one after the other, and how long (s) each takes; opacity of the thickest.
RINGS, _RUNS_S, _DUST = 3, 1.8, 34.0
#: Puffs of dust in a ring.
_PUFFS = 44


class Ground(Recorder):
    """Recorder of ``/site/ground``, ``/site/sky`` and the target."""

    def statics(self) -> None:
        """Write landscape, rocks, rings around touchdown and target, and the planned ellipse."""
        motion, scenario = self.motion, self.flight.scenario
        self.static("site", self.rr.ViewCoordinates.RIGHT_HAND_Z_UP)
        reach = float(np.clip(1.15 * np.linalg.norm(motion.centre - motion.last, axis=-1).max(), 5e3, 1.2e6))
        landscape = Landscape(motion.site, motion.last)
        self.static("site/ground", self.mesh(landscape.mesh(), **grain()))
        if (near := landscape.near()) is not None:
            self.static("site/ground/near", self.mesh(near, albedo_factor=[SHADE] * 3))
            self._rocks(landscape)
        radii = [r for r in (10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1e3, 2e3, 5e3) if r < reach]
        rings = [self._ring(landscape, r, motion.last) for r in radii]
        self.lines("site/ground/rings", rings, [120, 72, 48], 0.5)
        limit = scenario.limits.landing_distance_m or _TARGET_M
        circles = [self._ring(landscape, r, np.zeros(3)) for r in (0.01 * limit, 0.1 * limit, limit)]
        self.lines("site/markers/target", circles, TARGET, 1.2)
        terrain = scenario.terrain
        if terrain.ellipse_length_m > 0.0:
            azimuth = np.radians(terrain.ellipse_azimuth_deg)
            curve = planned_ellipse(terrain.ellipse_length_m, terrain.ellipse_width_m, azimuth)
            line = landscape.above(np.column_stack(curve), 100.0)
            self.lines("site/markers/ellipse", [line], TARGET, 0.8)
        level = float(motion.site.ground(np.zeros(1), np.zeros(1))[1][0])
        self.static("site/labels/target", self.point([0.0, 0.0, level], "target", TARGET))
        if self.flight["truth.footpads"][-1] > 0.0:
            place = [*motion.last[:2], float(motion.last[2] - motion.height[-1])]
            self.static("site/labels/touchdown", self.point(place, "touchdown", (120, 235, 140)))

    def motions(self) -> None:
        """Write the sky, which moves with the vehicle and darkens with height."""
        look = self.motion.site.appearance
        rows = np.flatnonzero(self.motion.height < look.sky_top_m)[::12]
        if len(rows) == 0:
            return
        self.at(
            self.t[rows[0]], "site/sky/dome", self.mesh(sky(look.sky_horizon, look.sky_zenith), **dither())
        )
        if (sun := self.motion.site.sun) is not None and sun[2] > 0.0:
            self.at(self.t[rows[0]], "site/sky/sun", self.mesh(disc(0.97 * sun, sun, _SUN_SIZE, SUNLIGHT)))
        # radius beyond the horizon of the highest place with a sky
        reach = 1.5 * np.sqrt(look.sky_top_m * (2.0 * self.motion.site.radius + look.sky_top_m))
        self.poses("site/sky", self.t[rows], self.motion.centre[rows], scale=np.full((len(rows), 3), reach))
        bright = np.exp(-np.maximum(self.motion.height[rows], 0.0) / look.sky_scale_m)
        tint = np.column_stack([np.outer(255.0 * bright, np.ones(3)), np.full(len(rows), 255.0)])
        tints = self.rr.Mesh3D.columns(albedo_factor=tint.astype(np.uint8))
        self.columns("site/sky/dome", self.t[rows], tints)

    def _ring(self, landscape: Landscape, radius: float, centre: np.ndarray) -> np.ndarray:
        curve = np.column_stack(circle(centre[:2].tolist(), radius, 181))
        return landscape.above(curve, 0.1 + 5e-3 * radius)

    def _rocks(self, landscape: Landscape) -> None:
        places, sizes, headings = landscape.rocks()
        site, upright = self.motion.site, turns.xyzw(turns.about_z(headings))
        for kind in range(KINDS_OF_ROCK):
            own = slice(kind, None, KINDS_OF_ROCK)
            pose = {"translations": places[own], "quaternions": upright[own], "scales": sizes[own]}
            mesh = self.mesh(rock(kind, site.appearance.rock, site.light))
            self.static(f"site/ground/rocks/{kind}", mesh, self.rr.InstancePoses3D(**pose))


class NearGround(Recorder):
    """Writes ``near_ground/shadow`` and ``near_ground/dust``."""

    def motions(self) -> None:
        """Write shadow and dust, where the vehicle is low enough."""
        rows = thin(self.t, SCALAR_HZ)
        self._shadow(rows[self.motion.height[rows] < _SHADOW_BELOW])
        self._dust()

    def _shadow(self, rows: np.ndarray) -> None:
        """Write discs on the ground, paler and wider from higher up, by which the height can be judged."""
        if len(rows) == 0:
            return
        motion, rr, entity = self.motion, self.rr, f"{self.root}/near_ground/shadow"
        towards, height = motion.site.light, motion.height[rows]
        lies, turn = self._on_ground(motion.centre[rows, :2] - np.outer(height / towards[2], towards[:2]))
        size = self._width() * (1.0 + height / 40.0)
        wide = np.column_stack([size, size, np.ones(len(rows))])
        self.poses(entity, self.t[rows], lies, turn, wide)
        seldom = rows[thin(self.t[rows], SLOW_HZ)]
        tint = np.zeros((len(seldom), 4), np.uint8)
        tint[:, 3] = 255.0 * _OPACITY * np.exp(-motion.height[seldom] / _FADES)
        plate = disc(np.zeros(3), np.array([0.0, 0.0, 1.0]), 1.0, (255, 255, 255))  # its tint is black
        for layer, share in enumerate(_LAYERS):
            above = rr.Transform3D(translation=[0.0, 0.0, 0.03 + 0.004 * layer], scale=[share, share, 1.0])
            self.at(self.t[rows[0]], f"{entity}/{layer}", self.mesh(plate), above)
            self.columns(f"{entity}/{layer}", self.t[seldom], rr.Mesh3D.columns(albedo_factor=tint))

    def _width(self) -> float:
        """Radius (m) of the shadow: of the footpads' circle once the vehicle is a lander."""
        pads = np.array(self.vehicle.landing_gear.footpads_m).reshape(-1, 3)
        return 0.85 * float(np.hypot(pads[:, 1], pads[:, 2]).max(initial=self.motion.shape.radius))

    def _dust(self) -> None:
        """Write rings that run outwards under the engines, as thick as the plume presses."""
        if not self.vehicle.engines:
            return
        rows, rr = thin(self.t, SCALAR_HZ), self.rr
        nozzle = np.mean([engine.nozzle_m for engine in self.vehicle.engines], axis=0)
        mouth = self.motion.nose[rows] + turns.rotate(self.motion.rotation[rows], nozzle)
        lies, turn = self._on_ground(mouth[:, :2])
        height = np.maximum(mouth[:, 2] - lies[:, 2], 0.5)
        thick = dust(self.flight["truth.engine_thrust_n"][rows], height)
        raised = thick > 0.0
        keep = np.flatnonzero(and_next(raised))
        if not len(keep):
            return
        puff = self._puff()
        for ring in range(RINGS):
            run, wide = dust_ring(self.t[rows[keep]], height[keep], ring)
            opaque = np.where(raised[keep], _DUST * thick[keep] * np.sin(np.pi * run), 0.0)
            entity = f"{self.root}/near_ground/dust/{ring}"
            self.at(self.t[rows[keep[0]]], f"{entity}/puffs", puff, self._puffs(ring))
            size = np.column_stack([wide, wide, 0.4 * wide + 0.3])
            self.poses(entity, self.t[rows[keep]], lies[keep], turn[keep], size)
            tint = np.column_stack([np.full((len(keep), 3), 255.0), opaque]).astype(np.uint8)
            self.columns(f"{entity}/puffs", self.t[rows[keep]], rr.Mesh3D.columns(albedo_factor=tint))

    def _puff(self) -> rr.Mesh3D:
        """A ball of unit radius."""
        place = sphere(9, 16, 0.01)
        tone = np.array(self.motion.site.appearance.haze) * (0.94 + 0.06 * place[..., 2:])
        return self.mesh(bright(place.reshape(-1, 3), grid_triangles(9, 16), tone.reshape(-1, 3)))

    def _puffs(self, seed: int) -> rr.InstancePoses3D:
        """Places and sizes of the puffs of a ring of unit radius."""
        place, size = puffs(seed)
        return self.rr.InstancePoses3D(translations=place, scales=np.repeat(size[:, None], 3, axis=1))

    def _on_ground(self, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Places east and north (m), shape (n, 2), on the ground; and turns of z to its normal."""
        site, reach = self.motion.site, max(self._width(), 0.5)
        up = site.ground(*places.T)[1]
        rise = [
            (site.ground(*(places + step).T)[1] - site.ground(*(places - step).T)[1]) / (2.0 * reach)
            for step in (np.array([reach, 0.0]), np.array([0.0, reach]))
        ]
        normal = np.column_stack([-rise[0], -rise[1], np.ones(len(places))])
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        half = np.column_stack([1.0 + normal[:, 2], -normal[:, 1], normal[:, 0], np.zeros(len(places))])
        return np.column_stack([places, up]), half / np.linalg.norm(half, axis=-1, keepdims=True)


def dust(thrust_n: np.ndarray, height_m: np.ndarray) -> np.ndarray:
    """Return how thick the dust is, 0 to 1, that engines raise from a height (m) above the ground."""
    pressure = np.nan_to_num(thrust_n) / (np.pi * (_SPREAD * height_m) ** 2)
    thick = np.log(np.maximum(pressure / _LIFTS, 1e-9)) / np.log(_THICK / _LIFTS)
    return np.asarray(np.clip(thick, 0.0, 1.0))


def dust_ring(t: np.ndarray, height_m: np.ndarray, ring: int) -> tuple[np.ndarray, np.ndarray]:
    """Return how far a ring of dust has run at times (s), 0 to 1, and its radius (m) under engines at a
    height (m).
    """
    run = np.mod(t / _RUNS_S + ring / RINGS, 1.0)
    return run, (1.5 + 1.2 * _SPREAD * height_m) * (0.5 + 2.5 * run)


def puffs(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return places, shape (n, 3), and radii of the puffs of a ring of unit radius."""
    random = np.random.default_rng(seed)
    turn, out = random.uniform(0.0, 2.0 * np.pi, _PUFFS), random.uniform(0.45, 1.0, _PUFFS)
    size = random.uniform(0.22, 0.42, _PUFFS)
    return np.column_stack([out * np.cos(turn), out * np.sin(turn), 0.5 * size]), size
