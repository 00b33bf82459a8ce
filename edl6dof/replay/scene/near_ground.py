"""What the vehicle does to the ground that it comes close to: its shadow, and the dust of its engines.

The shadow lies where the light throws it.  The dust is a picture only: how much of it there is follows from
the pressure of the plume on the ground, and nothing in the simulation knows of it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from edl6dof.replay.history import thin
from edl6dof.replay.recorder import SCALAR_HZ, SLOW_HZ, Recorder
from edl6dof.replay.scene.mesh import Mesh, bright, disc, grid_triangles, sphere
from edl6dof.spatial import rotations as turns

if TYPE_CHECKING:
    import rerun as rr

#: Heights (m) below which there is a shadow, and over which it fades by e.
_SHADOW_BELOW, _FADES = 300.0, 60.0
#: Opacity of each of the discs that a shadow is made of, and their radii over its own: a soft edge.
_OPACITY, _LAYERS = 0.26, (1.0, 0.9, 0.8, 0.68, 0.55)
#: Tangent of the half angle at which a plume spreads, and the mean pressure (Pa) of it on the ground from
#: which on it raises dust, and at which there is as much as can be: after pictures of landings on Mars.
_SPREAD, _LIFTS, _THICK = 0.2, 5.0, 120.0
#: Rings of dust that run outwards one after the other, and how long (s) each takes; opacity of the thickest.
_RINGS, _RUNS_S, _DUST = 3, 1.8, 34.0
#: Puffs of dust in a ring.
_PUFFS = 44


class NearGround(Recorder):
    """Writes ``near_ground/shadow`` and ``near_ground/dust``."""

    def motions(self) -> None:
        """Both, where the vehicle is low enough."""
        rows = thin(self.t, SCALAR_HZ)
        self._shadow(rows[self.motion.height[rows] < _SHADOW_BELOW])
        self._dust()

    def _shadow(self, rows: np.ndarray) -> None:
        """Discs on the ground, paler and wider from higher up: by them the eye estimates the height."""
        if len(rows) == 0:
            return
        motion, rr, entity = self.motion, self.rr, f"{self.root}/near_ground/shadow"
        towards, height = motion.site.light, motion.height[rows]
        lies, turn = self._on_ground(motion.centre[rows, :2] - np.outer(height / towards[2], towards[:2]))
        size = self._width() * (1.0 + height / 40.0)
        wide = np.column_stack([size, size, np.ones(len(rows))])
        pose = rr.Transform3D.columns(translation=lies, quaternion=turns.xyzw(turn), scale=wide)
        self.columns(entity, self.t[rows], pose)
        seldom = rows[thin(self.t[rows], SLOW_HZ)]
        tint = np.zeros((len(seldom), 4), np.uint8)
        tint[:, 3] = 255.0 * _OPACITY * np.exp(-motion.height[seldom] / _FADES)
        plate = disc(np.zeros(3), np.array([0.0, 0.0, 1.0]), 1.0, (255, 255, 255))  # its tint is black
        for layer, share in enumerate(_LAYERS):
            above = rr.Transform3D(translation=[0.0, 0.0, 0.03 + 0.004 * layer], scale=[share, share, 1.0])
            self.at(self.t[rows[0]], f"{entity}/{layer}", self.mesh(plate), above)
            tints = rr.Mesh3D.columns(albedo_factor=tint)
            self.columns(f"{entity}/{layer}", self.t[seldom], tints)

    def _width(self) -> float:
        """Radius (m) of what throws the shadow: of the footpads' circle once the vehicle is a lander."""
        pads = np.array(self.vehicle.landing_gear.footpads_m).reshape(-1, 3)
        return 0.85 * float(np.hypot(pads[:, 1], pads[:, 2]).max(initial=self.motion.shape.radius))

    def _dust(self) -> None:
        """Rings that run outwards under the engines, as thick as the plume presses."""
        if not self.vehicle.engines:
            return
        rows, rr = thin(self.t, SCALAR_HZ), self.rr
        nozzle = np.mean([engine.nozzle_m for engine in self.vehicle.engines], axis=0)
        mouth = self.motion.nose[rows] + turns.rotate(self.motion.rotation[rows], nozzle)
        lies, turn = self._on_ground(mouth[:, :2])
        height = np.maximum(mouth[:, 2] - lies[:, 2], 0.5)
        thrust = np.nan_to_num(self.flight["truth.engine_thrust_n"][rows])
        pressure = thrust / (np.pi * (_SPREAD * height) ** 2)
        thick = np.clip(np.log(np.maximum(pressure / _LIFTS, 1e-9)) / np.log(_THICK / _LIFTS), 0.0, 1.0)
        raised = thick > 0.0
        keep = np.flatnonzero(raised | np.append(False, raised[:-1]))  # a row without ends it
        if not raised.any():
            return
        colour = np.array(self.motion.site.appearance.haze)
        for ring in range(_RINGS):
            run = np.mod(self.t[rows[keep]] / _RUNS_S + ring / _RINGS, 1.0)
            wide = (1.5 + 1.2 * _SPREAD * height[keep]) * (0.5 + 2.5 * run)
            opaque = np.where(raised[keep], _DUST * thick[keep] * np.sin(np.pi * run), 0.0)
            entity = f"{self.root}/near_ground/dust/{ring}"
            self.at(self.t[rows[keep[0]]], f"{entity}/puffs", self.mesh(_puff(colour)), self._ring(ring))
            pose = rr.Transform3D.columns(
                translation=lies[keep],
                quaternion=turns.xyzw(turn[keep]),
                scale=np.column_stack([wide, wide, 0.4 * wide + 0.3]),
            )
            self.columns(entity, self.t[rows[keep]], pose)
            tint = np.column_stack([np.full((len(keep), 3), 255.0), opaque]).astype(np.uint8)
            self.columns(f"{entity}/puffs", self.t[rows[keep]], rr.Mesh3D.columns(albedo_factor=tint))

    def _ring(self, seed: int) -> rr.InstancePoses3D:
        """Places and sizes of the puffs of a ring of unit radius."""
        random = np.random.default_rng(seed)
        turn, out = random.uniform(0.0, 2.0 * np.pi, _PUFFS), random.uniform(0.45, 1.0, _PUFFS)
        size = random.uniform(0.22, 0.42, _PUFFS)
        place = np.column_stack([out * np.cos(turn), out * np.sin(turn), 0.5 * size])
        return self.rr.InstancePoses3D(translations=place, scales=np.repeat(size[:, None], 3, axis=1))

    def _on_ground(self, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Places east and north (m), shape (n, 2), on the ground, and the turn that lays z along its normal
        there.
        """
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


def _puff(colour: np.ndarray) -> Mesh:
    """A ball of unit radius."""
    place = sphere(9, 16, 0.01)
    tone = colour * (0.94 + 0.06 * place[..., 2:])
    return bright(place.reshape(-1, 3), grid_triangles(9, 16), tone.reshape(-1, 3))
