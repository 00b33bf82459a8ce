"""Landmark camera: projection, delay, pixel noise, wrong matches, displaced map, lost images."""

import numpy as np
import pytest
from hovering import Hovering, bare
from pyquaternion import Quaternion
from scipy.stats import binom

from edl6dof.vehicle.plant import ATTITUDE

EXACT = {
    "misalignment_deg": 0.0, "noise_px": 1e-9, "wrong_share": 0.0, "map_noise_m": 0.0,
    "map_offset_m": (0.0, 0.0, 0.0), "delay_s": 0.0,
}  # fmt: skip
HEIGHT, PIXELS, WIDTH_DEG = 1500.0, 1024, 90.0


def bench(seed=1, **changes):
    view = {"pixels": PIXELS, "field_of_view_deg": WIDTH_DEG}
    turns = (25.0, 8.0, -5.0)
    given = EXACT | view | changes
    camera = Hovering("landmark_camera", bare(3.0), given, height=HEIGHT, turns=turns, seed=seed)
    camera.outputs["height"] = HEIGHT
    return camera


def matches(camera):
    """Pixels and places on the map of an image, which arrives in the next cycle."""
    assert camera.measure()["landmarks"]["shutter"] == 1
    found = camera.measure()["landmarks"]
    assert found["fresh"] == 1
    count = int(found["count"])
    return found["pixel"][:count].copy(), found["map_F"][:count].copy()


def projected(camera, places):
    """Row and column at which places (F, which coincides with I) lie in the image."""
    to_B = Quaternion(*camera.plant["y"][ATTITUDE : ATTITUDE + 4]).rotation_matrix.T
    look = (places - camera.eye()) @ to_B.T
    focal = 0.5 * PIXELS / np.tan(np.radians(0.5 * WIDTH_DEG))
    return focal * look[:, [2, 1]] / look[:, :1]


def test_exact_matches_lie_where_their_places_are_projected():
    camera = bench()
    pixel, places = matches(camera)
    assert len(pixel) > 15 and abs(pixel).max() <= 0.5 * PIXELS
    assert np.ptp(pixel, axis=0).min() > 0.4 * PIXELS, "spread over the image"
    assert pixel == pytest.approx(projected(camera, places), abs=1e-4)
    assert [camera.clearance(place) for place in places] == pytest.approx(np.zeros(len(places)), abs=1e-3)


def test_matches_arrive_after_the_delay():
    camera = bench(delay_s=0.3, interval_s=1.0)
    assert camera.measure()["landmarks"]["shutter"] == 1
    for t, fresh in ((0.1, 0), (0.29, 0), (0.3, 1), (0.5, 0)):
        camera.plant["t"] = t
        assert camera.measure()["landmarks"]["fresh"] == fresh, t


def test_pixel_noise_and_wrong_matches_are_as_frequent_as_given():
    off = []
    for seed in range(60):
        camera = bench(seed=seed, noise_px=0.5, wrong_share=0.2)
        pixel, places = matches(camera)
        off.append(pixel - projected(camera, places))
    off = np.concatenate(off)
    wrong = np.abs(off).max(axis=1) > 4.0
    low, high = binom.interval(0.999, len(off), 0.2)
    assert low < wrong.sum() < high
    assert off[~wrong].std() == pytest.approx(0.5, rel=4.0 / np.sqrt(2.0 * 2.0 * (~wrong).sum()))


def test_map_is_displaced_as_a_whole_and_each_landmark_by_itself():
    """Per axis: 5 m that all landmarks of a case share, and 2 m of each."""
    means, rests = [], []
    for seed in range(60):
        exact, camera = bench(seed=seed), bench(seed=seed, map_offset_m=(5.0, 5.0, 5.0), map_noise_m=2.0)
        error = matches(camera)[1] - matches(exact)[1]
        means.append(error.mean(axis=0))
        rests.append(error - error.mean(axis=0))
    assert np.concatenate(rests).std() == pytest.approx(2.0, rel=0.1)
    assert np.std(means) == pytest.approx(5.0, rel=0.25)


def test_lost_images_bring_no_matches_and_drop_those_under_way():
    camera = bench(delay_s=0.3)
    assert camera.measure()["landmarks"]["shutter"] == 1
    camera.plant["instruments"]["landmarks_lost"] = 1
    for t in (0.3, 1.0, 2.0):
        camera.plant["t"] = t
        found = camera.measure()["landmarks"]
        assert found["fresh"] == 0 and found["shutter"] == 0
