"""Stereo cameras: true ranges, an error that grows with the square of the range, ground without texture."""

import numpy as np
import pytest
from hovering import Hovering, area, bare
from scipy.stats import binom

from edl6dof.interface.capacities import STEREO_CELLS

EXACT = {
    "misalignment_deg": 0.0,
    "textureless": 0.0,
    "disparity_noise_px": 0.0,
    "disparity_bias_px": 0.0,
    "incidence_deg": 89.0,
}
ROUGH, PLAIN = area(), bare()
FOCAL_PX = 1024.0 / np.tan(np.radians(14.0))


def pair(bench):
    bench.plant["imagers"]["scan"] = 1
    told = bench.measure()["stereo"]
    assert told["fresh"] == 1
    return told["range"].astype(float)


def test_ranges_end_on_the_ground():
    bench = Hovering("stereo", ROUGH, EXACT, height=70.0, place=(120.0, 80.0), turns=(1.0, 2.0, -30.0))
    ranges, eye, looks = pair(bench), bench.eye(), bench.looks(STEREO_CELLS)
    met = [(i, j) for i in range(0, 128, 9) for j in range(0, 128, 9) if ranges[i, j] > 0.0]
    assert len(met) > 180
    assert max(abs(bench.clearance(eye + ranges[i, j] * looks[i, j])) for i, j in met) < 1e-3


@pytest.mark.parametrize("height", [20.0, 50.0, 100.0])
def test_error_grows_with_the_square_of_the_range(height):
    exact = pair(Hovering("stereo", PLAIN, EXACT, height=height))
    bench = Hovering("stereo", PLAIN, EXACT | {"disparity_noise_px": 0.2, "baseline_m": 1.2}, height=height)
    error = (pair(bench) - exact)[40:88, 40:88]
    sigma = (height + 0.5) ** 2 * 0.2 / (FOCAL_PX * 1.2)
    assert np.std(error) == pytest.approx(sigma, rel=0.06)
    assert abs(np.mean(error)) < 5.0 * sigma / np.sqrt(error.size)
    biased = Hovering("stereo", PLAIN, EXACT | {"disparity_bias_px": 0.3, "baseline_m": 1.2}, height=height)
    shift = np.mean((pair(biased) - exact)[60:68, 60:68])
    assert shift == pytest.approx(
        (height + 0.5) ** 2 * float(biased.unit["bias"]) / (FOCAL_PX * 1.2), rel=0.02
    )


def test_ground_without_texture_lies_in_blocks_elsewhere_in_each_pair():
    bench = Hovering("stereo", PLAIN, EXACT | {"textureless": 0.1}, height=60.0)
    first, second = pair(bench) == 0.0, pair(bench) == 0.0
    blocks = first.reshape(32, 4, 32, 4)
    assert np.array_equal(blocks.all(axis=(1, 3)), blocks.any(axis=(1, 3)))
    for lost in (first, second):
        low, high = binom.interval(1.0 - 1e-6, 1024, 0.1)
        assert low <= lost.sum() / 16 <= high
    assert not np.array_equal(first, second)


def test_takes_a_pair_when_told_alone():
    bench = Hovering("stereo", PLAIN, EXACT)
    bench.plant["imagers"]["scan"] = 0
    assert bench.measure()["stereo"]["fresh"] == 0
    pair(bench)
    bench.plant["imagers"]["scan"] = 0
    assert bench.measure()["stereo"]["fresh"] == 0
