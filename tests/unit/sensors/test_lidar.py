"""Scanning lidar: true ranges, noise, what does not come back, motion, and the course of a scan."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from hovering import Hovering, area, bare
from scipy.spatial.transform import Rotation
from scipy.stats import binom

from edl6dof.interface.capacities import SCAN_BLOCK, SCAN_ROWS
from edl6dof.vehicle.plant import ATTITUDE

EXACT = {
    "misalignment_deg": 0.0,
    "dropout": 0.0,
    "range_noise_m": 0.0,
    "range_bias_m": 0.0,
    "quantum_m": 1e-6,
    "incidence_deg": 89.0,
}
ROUGH, PLAIN = area(), bare()


@pytest.mark.parametrize(
    "place, turns",
    [pytest.param((0.0, 0.0), (0.0, 0.0, 0.0), marks=pytest.mark.long), ((430.0, -260.0), (2.0, -3.0, 40.0))],
    ids=str,
)
def test_ranges_end_on_the_ground(place, turns):
    bench = Hovering("lidar", ROUGH, EXACT, height=80.0, place=place, turns=turns)
    ranges, eye, looks = bench.scan(), bench.eye(), bench.looks(SCAN_ROWS)
    some = [(i, j) for i in range(0, SCAN_ROWS, 15) for j in range(0, SCAN_ROWS, 15)]
    met = [(i, j) for i, j in some if ranges[i, j] > 0.0]
    assert len(met) > 0.8 * len(some)
    over = [bench.clearance(eye + float(ranges[i, j]) * looks[i, j]) for i, j in met]
    assert np.max(np.abs(over)) < 1e-3
    # and on the way there is no ground: nothing was passed through
    for i, j in met[::7]:
        for share in np.linspace(0.9, 0.9999, 60):
            assert bench.clearance(eye + share * float(ranges[i, j]) * looks[i, j]) > 0.0


def test_noise_bias_and_quantum_are_what_the_parameters_say():
    settings = EXACT | {"range_noise_m": 0.05, "range_bias_m": 0.1, "quantum_m": 0.01}
    exact = Hovering("lidar", PLAIN, EXACT).scan()
    errors, biases = [], []
    for seed in range(12):
        bench = Hovering("lidar", PLAIN, settings, seed=seed)
        told = bench.scan()
        assert np.allclose(np.round(told / 0.01), told / 0.01, atol=2e-3)
        error = (told.astype(float) - exact)[exact > 0.0]
        assert np.mean(error) == pytest.approx(float(bench.unit["bias"]), abs=2e-3)
        errors.append(np.std(error))
        biases.append(float(bench.unit["bias"]))
    assert np.mean(errors) == pytest.approx(np.hypot(0.05, 0.01 / np.sqrt(12.0)), rel=0.01)
    assert 0.05 < np.std(biases) < 0.17


def test_as_many_rays_are_lost_as_the_parameters_say_others_in_each_scan():
    bench = Hovering("lidar", PLAIN, EXACT | {"dropout": 0.02}, height=60.0)
    lost = [bench.scan() == 0.0 for _ in range(3)]
    for one in lost:
        assert (
            binom.interval(1.0 - 1e-6, one.size, 0.02)[0]
            <= one.sum()
            <= binom.interval(1.0 - 1e-6, one.size, 0.02)[1]
        )
    assert np.sum(lost[0] & lost[1]) < 0.1 * np.sum(lost[0])


def test_nothing_comes_back_from_too_far_or_from_ground_met_too_flat():
    assert np.all(Hovering("lidar", PLAIN, EXACT | {"longest_m": 80.0}).scan() == 0.0)
    near = Hovering("lidar", PLAIN, EXACT | {"longest_m": 101.5}).scan() > 0.0
    assert near[128, 128] and not near[0, 0]
    steep = bare(slope_deg=30.0)
    bench = Hovering("lidar", steep, EXACT | {"incidence_deg": 31.0}, height=40.0)
    seen = bench.scan() > 0.0
    eye, looks = bench.eye(), bench.looks(SCAN_ROWS)
    normal = np.array([bench.clearance(eye + axis) - bench.clearance(eye) for axis in np.eye(3)])
    angle = np.degrees(np.arccos(-looks @ normal / np.linalg.norm(normal)))
    assert np.all(seen[angle < 30.9]) and not np.any(seen[angle > 31.1])
    assert 0.2 < np.mean(angle < 31.0) < 0.8


def test_each_block_of_rows_is_shot_from_where_the_vehicle_is_then():
    bench, still = Hovering("lidar", PLAIN, EXACT), Hovering("lidar", PLAIN, EXACT).scan()
    up = bench.plant["y"][:3] / np.linalg.norm(bench.plant["y"][:3])
    moved = []
    for k in range(SCAN_ROWS // SCAN_BLOCK):
        bench.plant["imagers"]["scan"] = 1 if k == 0 else 0
        told = bench.measure()["lidar"]
        assert (told["fresh"], told["row"]) == (1, SCAN_BLOCK * k)
        moved.append(told["range"].copy())
        bench.plant["y"][:3] -= 0.05 * up
    fall = still - np.vstack(moved)
    expected = (
        0.05
        * (np.arange(SCAN_ROWS) // SCAN_BLOCK)[:, None]
        / np.cos(np.arccos(np.clip(100.0 / np.maximum(still, 1.0), -1.0, 1.0)))
    )
    met = (still > 0.0) & (np.vstack(moved) > 0.0)
    assert met.mean() > 0.95
    assert np.max(np.abs(fall - expected)[met]) < 0.02


def test_a_scan_runs_once_and_begins_anew_when_told():
    bench = Hovering("lidar", PLAIN, EXACT)
    bench.plant["imagers"]["scan"] = 0
    assert bench.measure()["lidar"]["fresh"] == 0
    bench.scan()
    assert bench.measure()["lidar"]["fresh"] == 0
    bench.plant["imagers"]["scan"] = 1
    rows = [int(bench.measure()["lidar"]["row"])]
    bench.plant["imagers"]["scan"] = 0
    rows += [int(bench.measure()["lidar"]["row"]) for _ in range(3)]
    bench.plant["imagers"]["scan"] = 1
    rows.append(int(bench.measure()["lidar"]["row"]))
    assert rows == [0, 4, 8, 12, 0]


def test_misalignment_turns_the_scan_against_what_is_believed():
    steep = bare(slope_deg=20.0)
    for seed in range(6):
        bench = Hovering("lidar", steep, EXACT | {"misalignment_deg": 1.0}, seed=seed)
        middle = bench.scan()[127:129, 127:129].astype(float)
        turned = Rotation.from_rotvec(bench.unit["turn"]).apply([1.0, 0.0, 0.0])
        w, *v = bench.plant["y"][ATTITUDE : ATTITUDE + 4]
        ray = Rotation.from_quat([*v, w]).apply(turned)
        assert abs(bench.clearance(bench.eye() + middle.mean() * ray)) < 0.01
        assert abs(bench.clearance(bench.eye() + middle.mean() * bench.looks(2).mean(axis=(0, 1)))) > 0.05


def test_same_scan_again_and_in_any_thread():
    def one(seed):
        return Hovering("lidar", ROUGH, {}, seed=seed).scan().tobytes()

    alone = [one(seed) for seed in range(4)]
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(one, range(4))) == alone
    assert len(set(alone)) == 4
