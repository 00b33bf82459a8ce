"""What the following cameras keep in the frame: vehicle, lines and canopy from the mortar until after they
have parted, and then what fell away, projected as the viewer does.
"""

from __future__ import annotations

import numpy as np
import pytest
from made_up import MORTAR, SHELL, SHIELD, synthetic_flight

import edl6dof
from edl6dof.replay.cameras import SEPARATION_S, Spheres, away, facing, steady, together
from edl6dof.replay.pages import EYE, FIELD_DEG
from edl6dof.replay.recording import history
from edl6dof.replay.scene.craft_shapes import canopy
from edl6dof.replay.scene.poses import Motion
from edl6dof.spatial import rotations as turns

#: The narrowest shape of a view, width over height.
NARROW = 0.75


class Picture:
    """What a camera that follows some spheres shows at each row."""

    def __init__(self, motion: Motion, kept: Spheres) -> None:
        self.kept, self.back = kept, facing(motion) * [1.0, -1.0, -1.0, -1.0]

    def holds(self, row: int, places: np.ndarray) -> bool:
        """Whether places (m in L) are all inside the frame."""
        seen = turns.rotate(self.back[row], places - self.kept.centre[row]) / self.kept.radius[row] - EYE
        ahead = -EYE / np.linalg.norm(EYE)
        right = np.cross(ahead, [0.0, 0.0, 1.0])
        right /= np.linalg.norm(right)
        depth = seen @ ahead
        assert np.all(depth > 0.0), "nothing behind the eye"
        half = depth * np.tan(np.radians(0.5 * FIELD_DEG))
        x, y = np.abs(seen @ right) / half, np.abs(seen @ np.cross(right, ahead)) / half
        return bool(x.max() < NARROW and y.max() < 1.0)


def canopy_at(motion: Motion) -> dict[int, np.ndarray]:
    """Corners of canopy and lines, m in L, by row."""
    flown = motion.parachutes()
    if not flown:
        return {}
    rows, place, turn, scale = motion.parachute(flown[-1])
    mesh, lines = canopy(motion.vehicle, flown[-1].number)
    corners = np.concatenate([mesh.positions[::23], lines.reshape(-1, 3)[::11]])
    return {
        int(row): place[k] + turns.rotate(turn[k], corners * scale[k])
        for k, row in enumerate(rows)
        if k % 40 == 0 or k < 200
    }


@pytest.fixture(
    scope="module", params=["tianwen1", "schiaparelli", pytest.param("titan_probe", marks=pytest.mark.long)]
)
def motion(request) -> Motion:
    return Motion(history(edl6dof.fly(request.param)))


def test_vehicle_and_canopy_are_in_the_frame_until_they_have_parted(motion):
    kept = steady(motion, together(motion))
    picture = Picture(motion, kept)
    size = 0.6 * motion.shape.size * np.array([*np.eye(3), *-np.eye(3)])
    for row in range(0, len(motion.t), 25):
        assert picture.holds(row, motion.centre[row] + size), f"vehicle at {motion.t[row]:.1f} s"
    free = motion.released(motion.backshell)
    last = motion.t[-1] if free is None else motion.t[free] + SEPARATION_S
    looked = 0
    for row, places in (canopies := canopy_at(motion)).items():
        if motion.t[row] <= last:
            assert picture.holds(row, places), f"canopy at {motion.t[row]:.1f} s"
            looked += 1
    assert looked > 200 or not canopies


def test_camera_moves_without_a_jump(motion):
    """Zoom and place change by less than a hundredth and a twentieth of what is seen from row to row."""
    kept = steady(motion, together(motion))
    assert np.abs(np.diff(np.log(kept.radius))).max() < 0.06
    shift = np.diff(kept.centre - motion.centre, axis=0)
    assert (np.linalg.norm(shift, axis=-1) / kept.radius[1:]).max() < 0.06


def test_second_camera_keeps_what_fell_away_last_in_the_frame():
    motion = Motion(history(synthetic_flight()))
    kept, canopies = away(motion), canopy_at(motion)
    picture = Picture(motion, kept)
    for row, t in enumerate(motion.t):
        if t < SHIELD - 0.05:
            assert np.array_equal(kept.centre[row], motion.centre[row])
        elif SHIELD + 0.05 < t < SHELL - 0.05:
            assert picture.holds(row, motion.heat_shield[row][None])
            assert np.allclose(kept.centre[row], motion.heat_shield[row])
        elif t > SHELL + 0.05:
            assert picture.holds(row, motion.backshell[row][None])
            assert row not in canopies or picture.holds(row, canopies[row])
    assert MORTAR < SHIELD < SHELL < motion.t[-1]


def test_spheres_around_both_touch_them():
    near, far = Spheres(np.zeros((3, 3)), np.ones(3)), Spheres(
        np.array([[10.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.2, 0.0, 0.0]]), np.array([2.0, 0.3, 5.0])
    )  # fmt: skip
    both = near.with_(far, np.array([True, True, True]))
    assert both.radius.tolist() == [6.5, 1.0, 5.0]
    assert np.allclose(both.centre, [[5.5, 0.0, 0.0], [0.0, 0.0, 0.0], [0.2, 0.0, 0.0]])
    assert near.with_(far, np.zeros(3, bool)).radius.tolist() == [1.0, 1.0, 1.0]
