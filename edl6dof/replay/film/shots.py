"""Shots of a film: where the camera stands and what it frames, by phase role and event, with cuts between."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Literal, NamedTuple

import numpy as np

from edl6dof.interface import roles
from edl6dof.replay import cameras
from edl6dof.replay.cameras import Spheres
from edl6dof.replay.scene.poses import Motion
from edl6dof.spatial import rotations as turns

#: Contents of a frame: the vehicle; vehicle, lines and canopy; the vehicle and the part released last; the
#: vehicle, from a place on the ground.
Framed = Literal["vehicle", "canopy", "pair", "ground"]
#: Radius of the framed sphere around a vehicle, and largest around a pair, in diameters of the vehicle.
_ROOM, _PAIR = 0.85, 3.2
#: Largest distance of two parts that fit into a pair, diameters.
_NEAR = 2.0 * _PAIR - _ROOM - 0.5
#: Share of half the field of view that the framed sphere fills.
_FILLED = 0.8
#: Height at which the camera on the ground takes over, and its distance from the landing place, diameters.
_LANDING, _STAND = 5.0, 4.2
#: Least duration (s of the film) of a shot.
_SHORTEST_S = 1.5
#: Least height (m) of the camera above the ground.
_CLEAR_M = 1.7


class Shot(NamedTuple):
    """One shot, which lasts until the next one.

    Attributes:
        start_s: its first time, s.
        framed: contents of the frame.
        azimuth_deg: direction from the vehicle to the camera, from the direction of flight to the left.
        elevation_deg: elevation of the camera above the vehicle.
        room: size of the framed sphere relative to the usual one.
        circling_deg_s: rate of the azimuth in seconds of the film.
        field_deg: field of view from bottom to top.
    """

    start_s: float
    framed: Framed
    azimuth_deg: float
    elevation_deg: float
    room: float = 1.0
    circling_deg_s: float = 1.5
    field_deg: float = 34.0


class View(NamedTuple):
    """Camera of one frame: eye and aim (m in L), vertical direction, and field of view (deg)."""

    eye: np.ndarray
    aim: np.ndarray
    up: np.ndarray
    field_deg: float


def shot_list(motion: Motion, when: Mapping[str, float], reversals: Sequence[float]) -> list[Shot]:
    """Return the shots of a flight in order of time; ``when``: first time (s) of each event and role;
    ``reversals``: times (s) of bank reversals seen from behind.
    """
    found = [Shot(float(motion.t[0]), "vehicle", 62.0, 10.0, 1.25)]
    mortar, shield, shell = (when.get(key, np.inf) for key in ("mortar", "heat_shield", "backshell"))
    for number, reversal in enumerate(one for one in reversals if one < mortar):
        found.append(Shot(reversal - 0.8, "vehicle", 176.0, 16.0, 1.3))
        lasts = 7.0 if number else 5.0  # the pace is faster around later ones
        found.append(Shot(reversal + lasts, "vehicle", (68.0, 112.0)[number % 2], 9.0, 1.25))
    if mortar < np.inf:
        found.append(Shot(mortar - 0.8, "canopy", 84.0, -4.0))
        found.append(Shot(mortar + 9.0, "vehicle", 30.0, -52.0, 1.0, 3.0, 52.0))
        found += _hanging(motion, min(shield, shell, float(motion.t[-1])))
    if shield < np.inf:
        found.append(Shot(shield - 1.0, "pair", 48.0, -34.0))
        found.append(Shot(_apart(motion, motion.heat_shield, shield + 4.5), "canopy", 110.0, 6.0))
        if shell - shield > 40.0:
            found.append(Shot(0.5 * (shield + shell), "vehicle", 40.0, 34.0, 1.2))
    if shell < np.inf:
        found.append(Shot(shell - 2.0, "pair", 82.0, 8.0))
        found.append(Shot(_apart(motion, motion.backshell, shell + 3.5), "vehicle", 70.0, -14.0))
    if (burn := when.get(roles.begun(roles.POWERED_DECELERATION))) is not None:
        found.append(Shot(max(burn, shell + 8.0) if shell < np.inf else burn, "vehicle", 58.0, 18.0, 1.15))
    if (hover := when.get(roles.begun(roles.HOVER_IMAGING))) is not None:
        found.append(Shot(hover, "vehicle", 36.0, 24.0, 1.5, 4.0))
        found.append(Shot(when.get("scan", hover + 3.0), "vehicle", 150.0, 52.0, 1.6, 6.0, 48.0))
    if (avoid := when.get(roles.begun(roles.HAZARD_AVOIDANCE))) is not None:
        found.append(Shot(avoid, "vehicle", 30.0, 12.0, 1.3, 4.0))
    if (slow := when.get(roles.begun(roles.SLOW_DESCENT))) is not None:
        found.append(Shot(slow, "vehicle", 80.0, 5.0, 1.3, 3.0))
    if len(found) == 1:  # nothing happens
        third = (motion.t[-1] - motion.t[0]) / 3.0
        found.append(Shot(float(motion.t[0] + third), "vehicle", 140.0, 24.0, 1.4))
        found.append(Shot(float(motion.t[-1] - third), "vehicle", 40.0, -16.0, 1.2, 3.0))
    if (low := _landing(motion)) is not None:
        found = [shot for shot in found if shot.start_s < low]
        found.append(Shot(low, "ground", 64.0, 0.0, field_deg=38.0))
    return sorted(found, key=lambda shot: shot.start_s)


def _hanging(motion: Motion, until_s: float) -> list[Shot]:
    """Shots under the parachutes until a time (s): each later one opens, and all of each in half its time."""
    found = []
    begins = [float(motion.t[flown.first]) for flown in motion.parachutes()]
    for number, (begin, end) in enumerate(pairwise([*begins, until_s])):
        if number:
            found.append(Shot(begin - 0.8, "canopy", 84.0, -4.0))
            found.append(Shot(begin + 9.0, "vehicle", 30.0, -52.0, 1.0, 3.0, 52.0))
        if end - begin > 40.0:
            found.append(Shot(0.5 * (begin + end), "canopy", 110.0, 6.0))
    return found


def views(motion: Motion, shots: list[Shot], times: np.ndarray, fps: float) -> list[View]:
    """Return the camera of each frame of a film."""
    spheres, level = _spheres(motion), cameras.facing(motion)
    rows = np.clip(np.searchsorted(motion.t, times, side="right") - 1, 0, len(motion.t) - 1)
    up = turns.rotate(level[rows], np.array([0.0, 0.0, 1.0]))
    shown = _shown(shots, times, round(_SHORTEST_S * fps))
    eye, aim = np.empty((2, len(times), 3))
    for number in np.unique(shown):
        shot, own = shots[number], np.flatnonzero(shown == number)
        seen = spheres[shot.framed]
        side = _lit_side(motion, level[rows[own[0]]], shot.azimuth_deg)
        aim[own] = _at(motion.t, seen.centre, times[own])
        if shot.framed == "ground":
            eye[own] = _stand(motion, level[-1], side * shot.azimuth_deg)
            continue
        radius = shot.room * np.interp(times[own], motion.t, seen.radius)
        distance = radius / np.sin(0.5 * _FILLED * np.radians(shot.field_deg))
        azimuth = side * np.radians(shot.azimuth_deg + shot.circling_deg_s * (own - own[0]) / fps)
        elevation = np.full(len(own), np.radians(shot.elevation_deg))
        flat = np.cos(elevation)
        way = np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)], axis=-1)
        eye[own] = aim[own] + distance[:, None] * turns.rotate(level[rows[own]], way)
    lowest = motion.site.ground(eye[:, 0], eye[:, 1])[1] + _CLEAR_M
    eye[:, 2] = np.maximum(eye[:, 2], lowest)
    return [View(eye[k], aim[k], up[k], shots[shown[k]].field_deg) for k in range(len(times))]


def _shown(shots: list[Shot], times: np.ndarray, shortest: int) -> np.ndarray:
    """Number of the shot of each frame, without cuts to the same view or to less than ``shortest`` frames."""
    shown = np.searchsorted([shot.start_s for shot in shots], times, side="right") - 1
    shown = np.maximum(shown, 0)
    begins = np.flatnonzero(np.diff(shown, prepend=shown[0]))
    for first, end in pairwise([*begins, len(times)]):
        if end - first < shortest or shots[shown[first]][1:] == shots[shown[first - 1]][1:]:
            shown[first:end] = shown[first - 1]
    return shown


def _lit_side(motion: Motion, level: np.ndarray, azimuth_deg: float) -> float:
    """Sign of the azimuth with which the camera sees the lit side of the vehicle."""
    left = turns.rotate(level, np.array([0.0, np.sin(np.radians(azimuth_deg)), 0.0]))
    return 1.0 if left @ motion.site.light >= 0.0 else -1.0


def _spheres(motion: Motion) -> dict[str, Spheres]:
    """Spheres that the shots frame, at the rows of the flight."""
    size = motion.shape.size
    alone = Spheres(motion.centre, np.full(len(motion.t), _ROOM * size))
    free = np.isfinite(motion.backshell[:, :1])
    part = Spheres(np.where(free, motion.backshell, motion.heat_shield), np.full(len(motion.t), 0.5 * size))
    both = alone.with_(part, np.linalg.norm(part.centre - motion.centre, axis=-1) <= _NEAR * size)
    radius = np.minimum(both.radius, _PAIR * size)
    shift = both.centre - motion.centre
    reach = np.linalg.norm(shift, axis=-1)
    shift *= np.minimum(1.0, np.maximum(radius - alone.radius, 0.0) / np.maximum(reach, 1e-9))[:, None]
    return {
        "vehicle": alone,
        "ground": alone,
        "canopy": cameras.steady(motion, cameras.together(motion)),
        "pair": Spheres(motion.centre + shift, radius),
    }


def _apart(motion: Motion, part: np.ndarray, latest_s: float) -> float:
    """Time (s) from which a released part is too far away for a picture of both."""
    away = np.linalg.norm(part - motion.centre, axis=-1)
    far = motion.t[away > _NEAR * motion.shape.size]
    return min(latest_s, float(far[0])) if len(far) else latest_s


def _landing(motion: Motion) -> float | None:
    """Time (s) from which the camera stands on the ground; ``None`` if the flight ends in the air."""
    size = motion.shape.size
    if motion.height[-1] > 2.0 * size:
        return None
    high = np.flatnonzero(motion.height > _LANDING * size)
    return float(motion.t[min(high[-1] + 1, len(motion.t) - 1)]) if len(high) else float(motion.t[0])


def _stand(motion: Motion, level: np.ndarray, azimuth_deg: float) -> np.ndarray:
    """Place of the camera on the ground next to the place of landing, m in L."""
    azimuth = np.radians(azimuth_deg)
    way = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    place = motion.last + turns.rotate(level, _STAND * motion.shape.size * way)
    height = float(motion.site.ground(place[0], place[1])[1])
    place[2] = max(height, motion.last[2] - motion.height[-1]) + _CLEAR_M + 0.12 * _STAND * motion.shape.size
    return place


def _at(t: np.ndarray, values: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Values, shape (rows, 3), at other times."""
    return np.stack([np.interp(times, t, column) for column in values.T], axis=-1)
