"""The scripted camera: the vehicle in the picture at all times, the eye above the ground, no jump."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from made_up import SHELL, SHIELD, entities, synthetic_flight

import edl6dof
from edl6dof.replay.cameras import CLEAR_M, LANDING_DISTANCE, ROOM, SEPARATION_S, shots
from edl6dof.replay.history import History
from edl6dof.replay.pages import FIELD_DEG, TOUR
from edl6dof.replay.recording import history, write_replay
from edl6dof.replay.scene.poses import Motion


class Shown:
    """The script of one flight."""

    def __init__(self, flight: History) -> None:
        self.flight, self.motion = flight, Motion(flight)
        self.kept, self.eye = shots(self.motion, flight["truth.engine_thrust_n"])
        self.ahead = self.kept.centre - self.eye
        self.distance = np.linalg.norm(self.ahead, axis=-1)

    def off_axis(self, places: np.ndarray, radius: float = 0.0) -> np.ndarray:
        """Angle (deg) from the middle of the picture to the farthest point of spheres, at each row."""
        way = places - self.eye
        far = np.linalg.norm(way, axis=-1)
        between = np.arccos(np.clip(np.einsum("ij,ij->i", way, self.ahead) / far / self.distance, -1.0, 1.0))
        return np.degrees(between + np.arcsin(np.clip(radius / far, 0.0, 1.0)))


def hits(motion: Motion) -> bool:
    """Whether the flight ends with the vehicle still at speed."""
    return float(np.linalg.norm(motion.centre[-1] - motion.centre[-2]) / (motion.t[-1] - motion.t[-2])) > 10.0


@pytest.fixture(
    scope="module",
    params=["tianwen1", "schiaparelli", pytest.param("titan_probe", marks=pytest.mark.long), "earth_drop"],
)
def shown(request) -> Shown:
    return Shown(history(edl6dof.fly(request.param)))


def test_vehicle_is_in_the_picture_at_all_times(shown):
    off = shown.off_axis(shown.motion.centre, ROOM * shown.motion.shape.size)
    assert np.all(off < 0.5 * FIELD_DEG), f"{off.max():.1f} deg at {shown.motion.t[off.argmax()]:.1f} s"


def test_eye_stays_above_the_ground_from_first_to_last(shown):
    ground = shown.motion.site.ground(shown.eye[:, 0], shown.eye[:, 1])[1]
    clear = shown.eye[:, 2] - ground
    low = shown.motion.height < 2000.0  # in L the ground far away lies below its own level
    assert np.all(clear[low] > 0.5 * CLEAR_M)
    assert np.all(shown.eye[~low, 2] > ground[~low])


def test_nothing_jumps_between_two_rows(shown):
    way = shown.ahead / shown.distance[:, None]
    turned = np.degrees(np.arccos(np.clip(np.einsum("ij,ij->i", way[1:], way[:-1]), -1.0, 1.0)))
    step = np.maximum(np.diff(shown.motion.t), 0.02)
    t = shown.motion.t[1:]
    falling = t < t[-1] - (
        0.1 if hits(shown.motion) else -1.0
    )  # at the impact the eye keeps above the ground
    assert np.all((turned / step)[falling] < 90.0), f"{(turned / step)[falling].max():.0f} deg/s"
    assert np.abs(np.diff(np.log(shown.distance)) / step)[falling].max() < 2.5


def test_a_landed_vehicle_is_seen_from_the_ground_beside_it(shown):
    motion = shown.motion
    if motion.height[-1] > motion.shape.size or motion.released(motion.backshell) is None or hits(motion):
        pytest.skip("does not land on its own")
    still = motion.t > motion.t[-1] - 1.0
    assert np.ptp(shown.eye[still], axis=0).max() < 0.1 * LANDING_DISTANCE * motion.shape.size
    ground = motion.site.ground(shown.eye[-1:, 0], shown.eye[-1:, 1])[1]
    assert shown.eye[-1, 2] - ground[0] < 2.0 * CLEAR_M


def test_what_falls_away_is_in_the_picture_with_the_vehicle():
    shown = Shown(history(synthetic_flight()))
    for place, when in ((shown.motion.heat_shield, SHIELD), (shown.motion.backshell, SHELL)):
        near = (shown.motion.t > when + 0.05) & (shown.motion.t < when + SEPARATION_S - 0.05)
        assert near.sum() > 50
        assert np.all(shown.off_axis(place)[near] < 0.5 * FIELD_DEG)


def test_the_tour_is_in_every_recording(tmp_path: Path):
    write_replay([history(synthetic_flight())], tmp_path / "replay.rrd", page=TOUR)
    assert "/site/tour" in entities(tmp_path / "replay.rrd")
