"""Position fixes from landmarks: Cramer-Rao bound, error of the map, wrong matches, and delay."""

import numpy as np
import pytest
from scipy.stats import binom, chi2

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.navigation.landmark_fix import (
    LANDMARK_CAMERA,
    LANDMARK_FIXES,
    LandmarkFixParams,
    consensus,
    draw_pair,
    locate,
    note_exposure,
    read_landmarks,
)
from edl6dof.fsw.navigation.solution import MOTION, POSITION_FIX, SOLUTION
from edl6dof.fsw.onboard import ONBOARD
from edl6dof.interface.sensed import SENSED

HEIGHT, FOCAL, NOISE_PX, MAP_NOISE = 2000.0, 512.0, 0.5, 3.0
#: Axes of B in I: the camera looks along x, 20 deg off the vertical -z.
LEAN = np.radians(20.0)
FRAME = np.array([[np.sin(LEAN), 0.0, -np.cos(LEAN)], [0.0, 1.0, 0.0], [np.cos(LEAN), 0.0, np.sin(LEAN)]])
AXES = tuple(tuple(map(float, axis)) for axis in FRAME)
GRID = np.linspace(-1200.0, 1200.0, 6)
LANDMARKS = np.array([[x + 700.0, y, -HEIGHT + 0.02 * x] for x in GRID for y in GRID])
COUNT = len(LANDMARKS)


def settings(**given):
    out = np.zeros(1, dtype_of(LandmarkFixParams))
    fill(out[0], LandmarkFixParams(**given))
    return out[0]


def camera(**given):
    out = np.zeros(1, LANDMARK_CAMERA)
    out["focal"], out["noise"], out["map_noise"] = FOCAL, NOISE_PX, MAP_NOISE
    for name, value in given.items():
        out[name] = value
    return out[0]


def seen_from(position, places):
    to_place = (places - position) @ FRAME.T
    return to_place[:, 1:] / to_place[:, :1]


def matches(position, rng, pixel=NOISE_PX, drawn=MAP_NOISE):
    memory = np.zeros(1, LANDMARK_FIXES)[0]
    memory["seen"][:COUNT] = seen_from(position, LANDMARKS) + pixel / FOCAL * rng.standard_normal((COUNT, 2))
    memory["place"][:COUNT] = LANDMARKS + drawn * rng.standard_normal((COUNT, 3))
    return memory


def fixed(memory, draw=0, known=None, params=None):
    params, known = params or settings(), known or camera()
    found, agreed = consensus(params, known, AXES, COUNT, draw, memory)
    fix = np.zeros(1, POSITION_FIX)[0]
    if agreed >= params["least_matches"]:
        locate(params, known, AXES, COUNT, found, memory, fix)
    return fix


def information(known, here):
    """Fisher information of pixels and places, from derivatives by differences."""
    total = np.zeros((3, 3))
    slopes = np.stack(
        [(seen_from(here + d, LANDMARKS) - seen_from(here - d, LANDMARKS)) / 0.2 for d in 0.1 * np.eye(3)], -1
    )
    of_place = -slopes  # moving a landmark is moving the camera the other way
    for a, b in zip(slopes, of_place, strict=True):
        spread = (known["noise"] / FOCAL) ** 2 * np.eye(2) + known["map_noise"] ** 2 * b @ b.T
        total += a.T @ np.linalg.inv(spread) @ a
    return total


@pytest.mark.parametrize("drawn", [0.0, MAP_NOISE])
def test_fixes_reach_the_bound_of_cramer_and_rao(drawn):
    rng, known, count = np.random.default_rng(1), camera(map_noise=drawn), 600
    truth = np.array([40.0, -70.0, 25.0])
    fixes = [fixed(matches(truth, rng, drawn=drawn), n * 64, known) for n in range(count)]
    assert all(fix["matches"] >= COUNT - 4 for fix in fixes)
    errors = np.array([fix["error"] for fix in fixes]) - truth
    bound = np.linalg.inv(information(known, truth))
    root = np.linalg.cholesky(np.linalg.inv(bound))
    white = errors @ root
    low, high = chi2.interval(0.999, count)
    assert np.all((low < np.sum(white**2, axis=0)) & (np.sum(white**2, axis=0) < high))
    assert np.all(np.abs(np.mean(white, axis=0)) < 4.0 / np.sqrt(count))
    assert np.mean([fix["covariance"] for fix in fixes], axis=0) == pytest.approx(bound, rel=0.04, abs=0.01)


def test_displacement_of_the_map_appears_one_to_one():
    rng, moved = np.random.default_rng(2), np.array([31.0, -17.0, 9.0])
    memory = matches(np.zeros(3), rng, 0.01, 0.0)
    memory["place"][:COUNT] += moved
    assert fixed(memory)["error"] == pytest.approx(moved, abs=0.1)


def test_attitude_error_appears_with_the_sensitivity_of_the_fix():
    memory, turn = matches(np.zeros(3), np.random.default_rng(3), 0.0, 0.0), np.array([2e-4, -3e-4, 1e-4])
    plain = fixed(memory)
    turned = LANDMARKS - np.cross(turn, LANDMARKS)  # as the truly turned camera sees them
    memory["seen"][:COUNT] = seen_from(np.zeros(3), turned)
    change = fixed(memory)["error"] - plain["error"]
    assert np.linalg.norm(change) > 0.2
    assert change == pytest.approx(plain["turn"] @ turn, abs=0.01)


@pytest.mark.parametrize(("right", "draws"), [(18, 4), (12, 10)])
def test_consensus_fails_as_often_as_the_closed_form(right, draws):
    """Without replacement, both of a pair are right with m (m - 1) / (n (n - 1)), close to (1 - eps)^2."""
    rng, trials, failed = np.random.default_rng(4), 2400, 0
    params = settings(draws=draws)
    for n in range(trials):
        memory = matches(np.zeros(3), rng, 0.02, 0.0)
        wrong = rng.permutation(COUNT)[right:]
        memory["seen"][wrong] = rng.uniform(-1.0, 1.0, (len(wrong), 2))
        _, agreed = consensus(params, camera(), AXES, COUNT, n * 64, memory)
        failed += agreed < right
    share = right * (right - 1) / (COUNT * (COUNT - 1))
    assert share == pytest.approx((right / COUNT) ** 2, rel=0.07)
    low, high = binom.interval(0.999, trials, (1.0 - share) ** draws)
    assert low <= failed <= high


def test_pairs_are_of_two_different_matches_and_all_are_drawn():
    drawn = [draw_pair(n, 5) for n in range(2000)]
    assert {pair for pair in drawn} == {(i, j) for i in range(5) for j in range(5) if i != j}


def test_too_few_matches_give_no_fix():
    memory = matches(np.zeros(3), np.random.default_rng(5))
    memory["seen"][5:] = np.random.default_rng(6).uniform(-1.0, 1.0, (LANDMARK_FIXES["seen"].shape[0] - 5, 2))
    assert fixed(memory)["matches"] == 0


@pytest.mark.parametrize("speed", [0.0, 120.0])
def test_delay_leaves_no_error_in_proportion_to_speed(speed):
    """The vehicle flies at a constant speed while the matches are found, and the solution is 200 m off."""
    onboard, sensed = np.zeros(1, ONBOARD)[0], np.zeros(1, SENSED)[0]
    motion, solution = np.zeros(1, MOTION)[0], np.zeros(1, SOLUTION)[0]
    memory = np.zeros(1, LANDMARK_FIXES)[0]
    onboard["instruments"]["landmarks"] = camera(place=(1.0, 0.5, -0.2))
    fill(onboard["navigation"]["landmarks"], LandmarkFixParams())
    q = np.array([np.cos(0.5 * (np.pi / 2 - LEAN)), 0.0, np.sin(0.5 * (np.pi / 2 - LEAN)), 0.0])
    solution["q_I2B"] = q
    v, error, start = (
        np.array([0.3 * speed, 0.0, -speed]),
        np.array([200.0, -80.0, 30.0]),
        np.array([5.0, 7.0, 0.0]),
    )
    solution["v_I"], solution["r_I"], solution["t"] = v, start - error, 10.0
    arm = FRAME.T @ np.array([1.0, 0.5, -0.2])
    sensed["t"], sensed["landmarks"]["shutter"] = 10.02, 1
    note_exposure(onboard, sensed, motion, solution, memory)
    exposed = start + 0.02 * v
    sensed["landmarks"]["pixel"][:COUNT] = FOCAL * seen_from(exposed + arm, LANDMARKS)[:, ::-1]
    sensed["landmarks"]["map_F"][:COUNT] = LANDMARKS
    sensed["landmarks"]["count"], sensed["landmarks"]["fresh"] = COUNT, 1
    solution["t"] = 11.0
    solution["r_I"] += v
    memory["way"] += v
    read_landmarks(onboard, sensed, solution, memory, motion["position_fix"])
    assert motion["position_fix"]["matches"] == COUNT
    assert motion["position_fix"]["error"] == pytest.approx(error, abs=1e-3)
    assert motion["position_fix"]["age"] == pytest.approx(0.98)
