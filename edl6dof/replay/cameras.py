"""The cameras that follow a flight: one keeps vehicle and parachute in the frame, another the part that was
released last, and the director's shots follow the stages of the flight.

A camera is a frame that does not turn with the vehicle or part that it follows: x level along the flight, z
up.  Its origin and scale are centre and radius (m) of the sphere that it keeps in the frame, so that the eye
has a fixed place in this frame. The director's frame has x from the eye to the middle of the sphere.

The director's shots.  Entry: slowly around the vehicle.  Under a parachute: all of it from below.  A
separation: both parts, for as long as they are near.  Engines burning: from low beside.  Landing: from where
one could stand on the ground.  They blend into each other: distance and direction never jump.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from edl6dof.replay.history import thin
from edl6dof.replay.pages import EYE, KEPT_DEG
from edl6dof.replay.recorder import SLOW_HZ, Recorder
from edl6dof.replay.scene.craft_shapes import canopy as canopy_of
from edl6dof.replay.scene.poses import Motion
from edl6dof.spatial import rotations as turns

#: For how long (s) after a separation both parts stay in the frame; how long (s) a camera takes to change.
SEPARATION_S, CHANGE_S = 3.0, 2.5
#: Colour of the scale bar; its height in the camera's frame, the largest length there, and the strokes at its
#: ends.
COLOUR, _ABOVE, _LONGEST, _STROKE = (225, 225, 225), 1.12, 0.7, 0.03
#: Radius of the sphere around a vehicle in its diameters: room for flames and arrows.
ROOM = 1.0
#: Rate at which the director's eye circles the vehicle during entry, deg/s, and its elevation, deg.
CIRCLING_DEG_S, ENTRY_DEG = 1.0, 14.0
#: Azimuth from the direction of flight and elevation of the eye under the parachute and under engines, deg.
PARACHUTE_DEG, POWERED_DEG = (60.0, -14.0), (74.0, 3.0)
#: Height below which the director's eye stands on the ground, and its distance from the place of landing,
#: both in diameters of the vehicle.
LANDING_HEIGHT, LANDING_DISTANCE = 5.0, 4.0
#: Least height (m) of the director's eye above the ground: that of a standing person.
CLEAR_M = 1.7


class Spheres(NamedTuple):
    """A sphere at each row: centres (m in L), shape (rows, 3), and radii (m)."""

    centre: np.ndarray
    radius: np.ndarray

    def with_(self, other: Spheres, where: np.ndarray) -> Spheres:
        """Return the smallest spheres around these and, at the rows ``where`` (bool), around ``other``."""
        way = other.centre - self.centre
        apart = np.linalg.norm(way, axis=-1)
        radius = np.maximum(0.5 * (apart + self.radius + other.radius), np.maximum(self.radius, other.radius))
        share = np.clip((radius - self.radius) / np.maximum(apart, 1e-9), 0.0, 1.0)
        return Spheres(
            np.where(where[:, None], self.centre + share[:, None] * way, self.centre),
            np.where(where, radius, self.radius),
        )


class Cameras(Recorder):
    """Recorder of the views: ``near``, which moves with the centre of mass, ``camera`` with its
    ``scale_bar``, ``camera_away``, and ``tour``, which follows the events of the flight.
    """

    def statics(self) -> None:
        """Write the name of the flight below the vehicle, if there are several flights."""
        if self.label:
            place = [0.0, 0.0, -1.12 - 0.15 * self.number]
            self.static(f"{self.root}/camera/name", self.point(place, self.label, self.own, 2.0))

    def motions(self) -> None:
        """Write the frames of the cameras, and the scale bar."""
        motion, turn = self.motion, facing(self.motion)
        self.poses(f"{self.root}/near", self.t, motion.centre)
        kept = steady(motion, together(motion))
        for name, seen in (("camera", kept), ("camera_away", away(motion))):
            self.poses(f"{self.root}/{name}", self.t, seen.centre, turn, cubed(seen.radius))
        self._scale_bar(kept.radius)
        seen, eye = shots(motion, self.flight["truth.engine_thrust_n"])
        ahead = seen.centre - eye
        scale = cubed(np.linalg.norm(ahead, axis=-1) * np.sin(np.radians(KEPT_DEG)))
        self.poses(f"{self.root}/tour", self.t, seen.centre, looking(motion, ahead), scale)

    def _scale_bar(self, radius: np.ndarray) -> None:
        """Write a bar of a round length (m), once more whenever the scale of the camera has changed."""
        rr, rows = self.rr, thin(self.t, SLOW_HZ)
        radius = radius[rows]
        anew = np.append(True, np.abs(np.diff(np.round(np.log(radius) / 0.02))) > 0)
        rows, radius = rows[anew], radius[anew]
        length = round_down(_LONGEST * radius)
        across = np.cross(-EYE, [0.0, 0.0, 1.0])
        across /= np.linalg.norm(across)
        half = (0.5 * length / radius)[:, None] * across
        ends = np.stack([-half, half], axis=1) + [0.0, 0.0, _ABOVE]
        stroke = np.array([0.0, 0.0, _STROKE])
        bar = [ends, ends[:, :1] + [-stroke, stroke], ends[:, 1:] + [-stroke, stroke]]
        strips, each = np.stack(bar, axis=1).reshape(-1, 2, 3), np.full(len(rows), 3)
        entity, look = f"{self.root}/camera/scale_bar", {"colors": COLOUR, "radii": -0.9}
        self.series(entity, self.t[rows], rr.LineStrips3D, look, {"strips": strips}, each)
        look = {"colors": COLOUR, "radii": -0.01, "show_labels": True}
        data = {"positions": ends[:, 1] + 0.12 * across, "labels": [f"{one:g} m" for one in length]}
        self.series(f"{entity}/length", self.t[rows], rr.Points3D, look, data)


def cubed(size: np.ndarray) -> np.ndarray:
    """Return a scale, shape (rows,), for all three axes, shape (rows, 3)."""
    return np.repeat(size[:, None], 3, axis=1)


def together(motion: Motion) -> Spheres:
    """Return spheres around the vehicle, and until shortly after its release also around the canopy."""
    size = ROOM * motion.shape.size
    kept = Spheres(motion.centre, np.full(len(motion.t), size))
    canopy = parachute(motion)
    if canopy is None:
        return kept
    free = motion.released(motion.backshell)
    last = np.inf if free is None else motion.t[free] + SEPARATION_S
    return kept.with_(canopy, np.isfinite(canopy.radius) & (motion.t <= last))


def away(motion: Motion) -> Spheres:
    """Return spheres around the part released last; before the first release, around the vehicle."""
    size = ROOM * motion.shape.size
    centre, radius = motion.centre.copy(), np.full(len(motion.t), size)
    shield, free = motion.released(motion.heat_shield), motion.released(motion.backshell)
    if shield is not None:
        centre[shield:] = _held(motion.heat_shield[shield:])
    if free is not None:
        centre[free:], radius[free:] = _held(motion.backshell[free:]), size
    kept, canopy = Spheres(centre, radius), parachute(motion)
    if canopy is None or free is None:
        return kept
    there = np.isfinite(canopy.radius) & (np.arange(len(radius)) >= free)
    return kept.with_(canopy, there)


def parachute(motion: Motion) -> Spheres | None:
    """Return spheres around canopy and lines; ``None`` for a flight without a parachute."""
    centre, radius = np.full((len(motion.t), 3), np.nan), np.full(len(motion.t), np.nan)
    for flown in motion.parachutes():
        rows, place, turn, scale = motion.parachute(flown)
        x, y, z = canopy_of(motion.vehicle, flown.number)[0].positions.T
        half = 0.5 * scale[:, 0] * x.max()
        centre[rows] = place + turns.rotate(turn, half[:, None] * np.array([1.0, 0.0, 0.0]))
        radius[rows] = np.hypot(half, scale[:, 1] * np.hypot(y, z).max())
    return Spheres(centre, radius) if np.isfinite(radius).any() else None


def steady(motion: Motion, kept: Spheres) -> Spheres:
    """Return spheres that contain ``kept``, with smooth changes of radius and of place from the vehicle."""
    shift, width = kept.centre - motion.centre, _rows_of_change(motion.t)
    calm = blend(motion.t, shift)
    needed = kept.radius + np.linalg.norm(calm - shift, axis=-1)
    # the mean of the largest radii around a row is at least the row's own radius
    largest = _around(needed, width).max(axis=-1)
    return Spheres(motion.centre + calm, np.exp(_around(np.log(largest), width).mean(axis=-1)))


def blend(t: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return values, shape (rows,) or (rows, n), smoothed over the time that a camera takes to change."""
    for _ in range(2):
        values = _around(values, _rows_of_change(t)).mean(axis=-1)
    return values


def _around(values: np.ndarray, width: int) -> np.ndarray:
    """View of the ``width`` (odd) rows around each row, on a last axis; the end rows are repeated."""
    ends = ((width // 2, width // 2),) + ((0, 0),) * (values.ndim - 1)
    return np.lib.stride_tricks.sliding_window_view(np.pad(values, ends, mode="edge"), width, axis=0)


def _rows_of_change(t: np.ndarray) -> int:
    """Number of rows (odd) in the time that a camera takes to change."""
    step = (t[-1] - t[0]) / max(len(t) - 1, 1)
    return round(CHANGE_S / step) | 1 if step > 0.0 else 1


def facing(motion: Motion) -> np.ndarray:
    """Return quaternions of the cameras: x level along the flight, z up from the planet."""
    up = motion.centre + motion.site.axes @ motion.site.origin
    up /= np.linalg.norm(up, axis=-1, keepdims=True)
    along = motion.last - motion.centre[0]
    side = np.cross(up, along if np.linalg.norm(along[:2]) > 100.0 else [0.0, 1.0, 0.0])
    side /= np.linalg.norm(side, axis=-1, keepdims=True)
    return turns.from_axes(np.stack([np.cross(side, up), side, up], axis=-1))


def _held(places: np.ndarray) -> np.ndarray:
    """Places, replaced by the last known one where they are unknown."""
    known = np.maximum.accumulate(np.where(np.isfinite(places[:, 0]), np.arange(len(places)), 0))
    return places[known]


def round_down(values: np.ndarray) -> np.ndarray:
    """Return each value, positive, rounded down to 1, 2 or 5 times a power of ten."""
    power = 10.0 ** np.floor(np.log10(values))
    return power * np.select([values >= 5.0 * power, values >= 2.0 * power], [5.0, 2.0], 1.0)


def shots(motion: Motion, thrust_n: np.ndarray) -> tuple[Spheres, np.ndarray]:
    """Return the spheres that the director's camera shows, and its places (m in L), shape (rows, 3)."""
    kept, level, landing = steady(motion, _kept(motion)), facing(motion), _landing(motion)
    azimuth, elevation = _angles(motion, thrust_n > 0.0)
    distance = kept.radius / np.sin(np.radians(KEPT_DEG))
    if landing.any():
        offset = _stand(motion, level, distance[-1]) - kept.centre
        seen = turns.rotate(level * [1.0, -1.0, -1.0, -1.0], offset)
        there = np.linalg.norm(seen, axis=-1)
        azimuth = _nearest(azimuth, np.degrees(np.arctan2(seen[:, 1], seen[:, 0])), landing)
        elevation = np.where(landing, np.degrees(np.arcsin(seen[:, 2] / there)), elevation)
        share = blend(motion.t, landing.astype(float))
        distance = distance * np.maximum(there / distance, 1.0) ** share
    azimuth, elevation = np.radians(blend(motion.t, azimuth)), np.radians(blend(motion.t, elevation))
    return kept, _above_ground(motion, kept.centre, level, distance, azimuth, elevation)


def looking(motion: Motion, ahead: np.ndarray) -> np.ndarray:
    """Return quaternions of frames whose x axis points ``ahead``, y level to the left."""
    up = turns.rotate(facing(motion), np.array([0.0, 0.0, 1.0]))
    x = ahead / np.linalg.norm(ahead, axis=-1, keepdims=True)
    y = np.cross(up, x)
    y /= np.linalg.norm(y, axis=-1, keepdims=True)
    return turns.from_axes(np.stack([x, y, np.cross(x, y)], axis=-1))


def _kept(motion: Motion) -> Spheres:
    """Spheres around vehicle and canopy, and for seconds after a separation also around the released part."""
    kept, fallen = together(motion), away(motion)
    since = np.full(len(motion.t), np.inf)
    for part in (motion.heat_shield, motion.backshell):
        row = motion.released(part)
        if row is not None:
            since[row:] = motion.t[row:] - motion.t[row]
    return kept.with_(fallen, since <= SEPARATION_S)


def _angles(motion: Motion, burning: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Azimuth of the director's eye from the direction of flight, and its elevation, deg, shape (rows,)."""
    azimuth = 74.0 + CIRCLING_DEG_S * (motion.t - motion.t[0])
    elevation = np.full(len(motion.t), ENTRY_DEG)
    canopy, free = motion.released(motion.canopy), motion.released(motion.backshell)
    lit = np.flatnonzero(burning[free or 0 :])
    ignited = (free or 0) + int(lit[0]) if len(lit) else None
    for row, shot in ((canopy, PARACHUTE_DEG), (free, POWERED_DEG), (ignited, POWERED_DEG)):
        if row is not None:
            after = np.arange(len(motion.t)) >= row
            azimuth = _nearest(azimuth, np.full(len(motion.t), shot[0]), after)
            elevation[after] = shot[1]
    return azimuth, elevation


def _landing(motion: Motion) -> np.ndarray:
    """Rows (bool) in which the vehicle is about to land, or has landed."""
    size = motion.shape.size
    arrives = motion.height[-1] < 2.0 * size
    high = np.flatnonzero(motion.height > LANDING_HEIGHT * size)
    return arrives & (np.arange(len(motion.t)) > (high[-1] if len(high) else -1))


def _stand(motion: Motion, level: np.ndarray, least_m: float) -> np.ndarray:
    """Place of an eye above the ground next to the place of landing, at least ``least_m`` away, m in L."""
    azimuth = np.radians(POWERED_DEG[0])
    distance = max(LANDING_DISTANCE * motion.shape.size, least_m)
    way = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    place = motion.last + turns.rotate(level[-1], distance * way)
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
    """Places of the eye (m in L); its elevation is increased where it would be under the ground."""
    for _ in range(4):  # the eye moves, and so does the ground below it
        flat = np.cos(elevation)
        way = np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)], axis=-1)
        eye = centre + distance[:, None] * turns.rotate(level, way)
        lacking = motion.site.ground(eye[:, 0], eye[:, 1])[1] + CLEAR_M - eye[:, 2]
        rise = np.sin(elevation) + np.maximum(lacking, 0.0) / distance
        elevation = np.maximum(elevation, np.arcsin(np.clip(rise, -1.0, 0.98)))
    return eye


def _nearest(before: np.ndarray, angle: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Angles (deg): ``angle`` at the rows ``where``, ``before`` elsewhere; whole turns are added so that each
    change is at most half a turn.
    """
    return np.unwrap(np.where(where, angle, before), period=360.0)
