"""The director: a camera whose shots follow the stages of a flight, from parts let go, engines and ground.

Entry: slowly around the vehicle.  Under a parachute: all of it from below.  A separation: both parts, for as
long as they are near.  Engines burning: from low beside.  Landing: from where one could stand on the ground.

Its frame's x axis points from the eye to the middle of what it keeps in the picture, and its scale is such
that the eye stands still in it.  Shots blend into each other: distance and direction never jump.
"""

from __future__ import annotations

import numpy as np

from edl6dof.replay.recorder import Recorder
from edl6dof.replay.scene.motion import Motion
from edl6dof.replay.views.cameras import (
    CHANGE_S,
    SEPARATION_S,
    Spheres,
    away,
    facing,
    moving_mean,
    steady,
    together,
)
from edl6dof.replay.views.spatial import KEPT_DEG
from edl6dof.spatial import rotations as turns

#: How fast it goes around during entry, deg/s, and from how far above the horizon it looks, deg.
CIRCLING_DEG_S, ENTRY_DEG = 1.0, 14.0
#: Azimuth from the direction of flight and elevation of the eye under the parachute and under engines, deg.
PARACHUTE_DEG, POWERED_DEG = (60.0, -14.0), (74.0, 3.0)
#: From which height on it stands at the site, and how far from it, both in diameters of the vehicle.
LANDING_HEIGHT, LANDING_DISTANCE = 5.0, 4.0
#: How high (m) above the ground the eye stays, and a person stands.
CLEAR_M = 1.7


class Director(Recorder):
    """Writes ``tour``, the frame of the scripted camera."""

    def motions(self) -> None:
        """Where it is, whither it looks, how far it stands off."""
        kept, eye = shots(self.motion, self.flight["truth.engine_thrust_n"])
        distance = np.linalg.norm(kept.centre - eye, axis=-1, keepdims=True)
        pose = self.rr.Transform3D.columns(
            translation=kept.centre,
            quaternion=turns.xyzw(looking(self.motion, kept.centre - eye)),
            scale=np.repeat(distance * np.sin(np.radians(KEPT_DEG)), 3, axis=1),
        )
        self.columns(f"{self.root}/tour", self.t, pose)


def shots(motion: Motion, thrust_n: np.ndarray) -> tuple[Spheres, np.ndarray]:
    """What is kept in the picture, and the eye's places (m in L), shape (rows, 3)."""
    kept = steady(motion.t, motion.centre, _kept(motion))
    azimuth, elevation = _script(motion, thrust_n > 0.0)
    distance = kept.radius / np.sin(np.radians(KEPT_DEG))
    level = facing(motion)
    landing = _landing(motion)
    if landing.any():
        offset = _stand(motion, level, distance[-1]) - kept.centre
        seen = turns.rotate(level * [1.0, -1.0, -1.0, -1.0], offset)
        there = np.linalg.norm(seen, axis=-1)
        azimuth = _nearest(azimuth, np.degrees(np.arctan2(seen[:, 1], seen[:, 0])), landing)
        elevation = np.where(landing, np.degrees(np.arcsin(seen[:, 2] / there)), elevation)
        share = _blend(motion.t, landing.astype(float))
        distance = distance * np.maximum(there / distance, 1.0) ** share
    azimuth, elevation = np.radians(_blend(motion.t, azimuth)), np.radians(_blend(motion.t, elevation))
    return kept, _above_ground(motion, kept.centre, level, distance, azimuth, elevation)


def looking(motion: Motion, ahead: np.ndarray) -> np.ndarray:
    """Quaternions of frames whose x axis points ``ahead``, y level to the left."""
    up = turns.rotate(facing(motion), np.array([0.0, 0.0, 1.0]))
    x = ahead / np.linalg.norm(ahead, axis=-1, keepdims=True)
    y = np.cross(up, x)
    y /= np.linalg.norm(y, axis=-1, keepdims=True)
    return turns.from_axes(np.stack([x, y, np.cross(x, y)], axis=-1))


def _kept(motion: Motion) -> Spheres:
    """The vehicle with its canopy, and what falls away for as long as both are near."""
    kept, fallen = together(motion), away(motion)
    since = np.full(len(motion.t), np.inf)
    for part in (motion.heat_shield, motion.backshell):
        row = motion.released(part)
        if row is not None:
            since[row:] = motion.t[row:] - motion.t[row]
    return kept.with_(fallen, since <= SEPARATION_S)


def _script(motion: Motion, burning: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Azimuth from the direction of flight, and elevation, deg, shot by shot."""
    azimuth = 74.0 + CIRCLING_DEG_S * (motion.t - motion.t[0])
    elevation = np.full(len(motion.t), ENTRY_DEG)
    canopy, free = motion.released(motion.canopy), motion.released(motion.backshell)
    lit = np.flatnonzero(burning[free or 0 :])
    for row, shot in (
        (canopy, PARACHUTE_DEG),
        (free, POWERED_DEG),
        ((free or 0) + int(lit[0]) if len(lit) else None, POWERED_DEG),
    ):
        if row is not None:
            after = np.arange(len(motion.t)) >= row
            azimuth = _nearest(azimuth, np.full(len(motion.t), shot[0]), after)
            elevation[after] = shot[1]
    return azimuth, elevation


def _landing(motion: Motion) -> np.ndarray:
    """Whether the vehicle is about to arrive on the ground, or has."""
    size = motion.shape.size
    arrives = motion.height[-1] < 2.0 * size
    high = np.flatnonzero(motion.height > LANDING_HEIGHT * size)
    return arrives & (np.arange(len(motion.t)) > (high[-1] if len(high) else -1))


def _stand(motion: Motion, level: np.ndarray, least_m: float) -> np.ndarray:
    """A place on the ground beside the site, m in L."""
    azimuth = np.radians(POWERED_DEG[0])
    distance = max(LANDING_DISTANCE * motion.shape.size, least_m)
    place = motion.last + turns.rotate(
        level[-1], distance * np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    )
    place[2] = float(motion.site.ground(place[0], place[1])[1]) + CLEAR_M
    return place


def _above_ground(
    motion: Motion,
    centre: np.ndarray,
    level: np.ndarray,
    distance: np.ndarray,
    azimuth: np.ndarray,
    elevation: np.ndarray,
) -> np.ndarray:
    """The eye's places (m in L), looking more from above where it would be under the ground."""
    for _ in range(4):  # the ground is another one where the eye then is
        flat = np.cos(elevation)
        way = np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)], axis=-1)
        eye = centre + distance[:, None] * turns.rotate(level, way)
        lacking = motion.site.ground(eye[:, 0], eye[:, 1])[1] + CLEAR_M - eye[:, 2]
        rise = np.sin(elevation) + np.maximum(lacking, 0.0) / distance
        elevation = np.maximum(elevation, np.arcsin(np.clip(rise, -1.0, 0.98)))
    return eye


def _nearest(before: np.ndarray, angle: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Angles (deg) with others at some rows, by whole turns such that the way there is short."""
    return np.unwrap(np.where(where, angle, before), period=360.0)


def _blend(t: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Values that change over some seconds where they jumped."""
    step = (t[-1] - t[0]) / max(len(t) - 1, 1)
    width = round(CHANGE_S / step) | 1 if step > 0.0 else 1
    return moving_mean(moving_mean(values, width), width)
