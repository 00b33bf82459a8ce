"""The whitened residual of diagnosis, and the signatures of faults in it, against numpy."""

import numpy as np
import pytest
from scipy.linalg import solve_toeplitz

from edl6dof.config.dtype import in_si
from edl6dof.fsw.diagnosis.diagnose import DiagnosisParams
from edl6dof.fsw.diagnosis.hypotheses import (
    COMPONENTS,
    OUTLIER,
    SUMS,
    collect,
    trust,
)
from edl6dof.fsw.diagnosis.openings import expected_evidence, onset_evidence
from edl6dof.fsw.diagnosis.residual import (
    AXES,
    DELAY,
    ORDER,
    PLANE,
    PLANES,
    RESIDUAL,
    TAPS,
    WHITE,
    WINDOW,
    add_signature,
    compare_signature,
    predict_by_covariance,
    update_filter,
    whiten,
)
from edl6dof.fsw.estimation.registry import ACTIVITY

COUNT = 3  # thrusters
PARAMS = in_si(DiagnosisParams())


class Series:
    """Whitening of made-up unexplained wrenches and commands."""

    def __init__(self):
        self.memory, self.activity = np.zeros(1, RESIDUAL)[0], np.zeros(1, ACTIVITY)[0]

    def add(self, wrench, share=(0.0, 0.0, 0.0), commanded=0.0):
        self.activity["share"][:COUNT], self.activity["wrench"][1:] = share, commanded
        whiten(PARAMS, np.concatenate([[0.0], wrench]), self.activity, COUNT, self.memory)
        newest = (self.memory["taken"] - 1) % WINDOW
        return self.memory["value"][newest].copy(), self.memory["weight"][newest].copy()


def left_of(values, slope):
    """Innovations whose lateral torques are less their regression on the lateral forces."""
    y, z = values[..., 4] - slope[1] * values[..., 0], values[..., 3] - slope[0] * values[..., 1]
    return np.concatenate([values[..., :3], z[..., None], y[..., None]], axis=-1)


def by_plane(values):
    """Sums over the components of each plane."""
    return np.array([values[..., np.array(PLANE) == g].sum() for g in range(PLANES)])


def noise(cycles, seed=0):
    """Independent noise of 3 N and 1 N m."""
    return np.random.default_rng(seed).normal(0.0, [3.0, 3.0, 1.0, 1.0, 1.0], (cycles, AXES))


def test_predictor_solves_the_yule_walker_equations():
    x = np.random.default_rng(1).normal(size=4000)
    for k in range(2, len(x)):
        x[k] += 1.2 * x[k - 1] - 0.7 * x[k - 2]
    covariance = np.array([x[: len(x) - lag] @ x[lag:] for lag in range(ORDER + 1)]) / len(x)
    predictor = np.full(ORDER, np.nan)
    predict_by_covariance(covariance, predictor)
    column = covariance[:ORDER] * np.where(np.arange(ORDER) == 0, WHITE, 1.0)
    exact = solve_toeplitz(column, covariance[1:])
    assert predictor == pytest.approx(exact, rel=1e-9)


def test_innovation_is_the_filter_of_the_unexplained_wrench():
    """With the filter before the cycle, whatever it is."""
    series, wrench = Series(), np.cumsum(noise(200), axis=0)
    for k in range(200):
        taps, slope = series.memory["filter"].copy(), series.memory["slope"].copy()
        value, _ = series.add(wrench[k])
        if k > 10:
            past = wrench[k - TAPS + 1 : k + 1][::-1]
            assert value == pytest.approx(left_of(np.sum(taps * past, axis=0), slope), abs=1e-9)
    assert np.sum(taps, axis=0) == pytest.approx(np.zeros(AXES), abs=1e-12)  # a constant is no innovation


def test_weight_is_the_inverse_of_all_variances():
    """The part of the model error is that of the filtered commanded wrench."""
    series, rng, commanded = Series(), np.random.default_rng(3), np.zeros((TAPS, AXES))
    for wrench in noise(300):
        commanded = np.vstack([rng.normal(0.0, 200.0, AXES), commanded[:-1]])
        taps, slope = series.memory["filter"].copy(), series.memory["slope"].copy()
        variance = np.append(series.memory["variance"][:3], series.memory["left"])
        _, weight = series.add(wrench, commanded=commanded[0])
    error = PARAMS["model_error"] * left_of(np.sum(taps * commanded, axis=0), slope)
    least = np.repeat([PARAMS["force_noise"], PARAMS["torque_noise"]], [2, 3])
    assert 1.0 / weight == pytest.approx(variance + least**2 + error**2, rel=1e-9)


def test_a_swing_and_a_tone_far_above_the_noise_leave_innovations_of_the_size_of_the_noise():
    """350 N m at 0.5 Hz, and 40 N m at 12 Hz, as vibration of 63 Hz appears at 25 Hz."""
    t = 0.04 * np.arange(1500)
    swing = 350.0 * np.sin(2.0 * np.pi * 0.5 * t) + 40.0 * np.sin(2.0 * np.pi * 12.0 * t + 1.0)
    series, disturbed = Series(), noise(len(t)) + swing[:, None]
    left = np.array([series.add(wrench)[0] for wrench in disturbed])[500:].std(axis=0)
    assert np.all(left < 0.05 * disturbed.std(axis=0))
    assert np.sqrt(series.memory["variance"]) == pytest.approx(left, rel=0.3)


def test_torque_that_goes_with_a_lateral_force_leaves_no_innovation():
    """A gust on a lever of 3 m in one plane and of -2 m in the other, ten times the noise."""
    gust = 30.0 * np.random.default_rng(5).normal(size=(600, 2))
    pushed = np.column_stack([gust, np.zeros(600), -2.0 * gust[:, 1], 3.0 * gust[:, 0]])
    series = Series()
    left = np.array([series.add(wrench)[0] for wrench in noise(600) + pushed])[300:]
    assert series.memory["slope"] == pytest.approx([-2.0, 3.0], rel=0.1)
    assert np.all(left[:, 3:].std(axis=0) < 0.2 * pushed[300:, 3:].std(axis=0))
    assert np.sqrt(series.memory["left"]) == pytest.approx(left[:, 3:].std(axis=0), rel=0.3)


def test_a_fault_does_not_change_the_model_that_judges_it():
    """A step of a hundred standard deviations: not for ``DELAY`` cycles, and little after that."""
    one, other, wrench = Series(), Series(), noise(400)
    for k in range(300):
        one.add(wrench[k])
        other.add(wrench[k])
    for k in range(300, 320):
        one.add(wrench[k])
        other.add(wrench[k] + 200.0)
        if k < 300 + DELAY:
            assert np.array_equal(one.memory["filter"], other.memory["filter"])
    assert np.all(other.memory["variance"] < 2.0 * one.memory["variance"])


def test_the_model_follows_when_the_noise_becomes_a_hundred_times_larger():
    series = Series()
    for wrench in noise(200):
        series.add(wrench)
    for wrench in 100.0 * noise(250, seed=1):
        series.add(wrench)
    assert np.all(np.sqrt(series.memory["variance"]) > 50.0 * np.array([3.0, 3.0, 1.0, 1.0, 1.0]))


def settled(seed=0):
    """A series of noise with a filter that is known."""
    series = Series()
    for wrench in noise(200, seed):
        series.add(wrench)
    return series


def test_signature_is_the_filter_of_the_missing_thrust():
    series, effect = settled(), np.array([9.0, 250.0, -3.0, 100.0, 20.0, -270.0])
    shares = [0.35, 1.0, 0.0, 0.65, 0.0, 0.2]
    for share, wrench in zip(shares, noise(len(shares), 2), strict=True):
        value, weight = series.add(wrench, share=(0.0, share, 0.0))
    series.memory["signature"][:] = 0.0
    add_signature(1, effect, series.memory)
    exact = -np.array(shares[::-1]) @ series.memory["filter"][: len(shares)] * effect[1:]
    assert series.memory["signature"] == pytest.approx(exact, abs=1e-9)
    series.memory["product"][:] = 0.0
    compare_signature(series.memory["taken"] - 1, series.memory)
    exact = left_of(exact, series.memory["slope"])
    assert series.memory["product"][0] == pytest.approx(by_plane(weight * value * exact))
    assert series.memory["product"][1] == pytest.approx(by_plane(weight * exact**2))
    assert np.array_equal(series.memory["idle"][:COUNT], [206, 0, 206])


@pytest.mark.parametrize("open_share", [0.0, 0.3, 1.0])
def test_onset_evidence_is_the_likelihood_ratio_of_the_best_step(open_share):
    """A valve that opens within a cycle, for ``open_share`` of it, while its thruster is commanded for a part
    of some cycles; against numpy, at the best of five shares.  Planes count by themselves.
    """
    series, effect = settled(), np.array([0.0, 5.0, 2.0, 27.0, -3.0, 8.0])
    share = np.array([0.2, 0.0, 0.35, 0.0])
    level = np.array([open_share, 1.0, 1.0, 1.0]) * (1.0 - share)
    for k, wrench in enumerate(noise(WINDOW, 4)):
        series.add(wrench + level[k] * effect[1:], share=(share[k], 0.0, 0.0))
    memory = series.memory
    rows = (memory["taken"] - WINDOW + np.arange(WINDOW)) % WINDOW
    value, weight = memory["value"][rows], memory["weight"][rows]

    def left(opened):
        part = np.array([opened, 1.0, 1.0, 1.0]) * (1.0 - share)
        step = np.array([part[j::-1] @ memory["filter"][: j + 1] for j in range(WINDOW)]) * effect[1:]
        return by_plane(weight * (value - left_of(step, memory["slope"])) ** 2)

    floor, every = COMPONENTS * WINDOW, by_plane(weight * value**2)
    found = [np.log((every + floor) / (left(opened) + floor)).sum() for opened in np.linspace(0.0, 1.0, 5)]
    exact = 0.5 * floor * max(found)
    assert exact > 5.0
    assert onset_evidence(0, effect, memory) == pytest.approx(exact, rel=1e-3)
    assert onset_evidence(0, -effect, memory) < 0.0


def test_a_shock_in_one_plane_hides_no_opening_from_another():
    """A roll thruster opens while the canopy jerks the vehicle with a thousand times the noise."""
    roll, pitch = np.array([0.0, 0.0, 0.0, 27.0, 0.0, 0.0]), np.array([0.0, 0.0, 0.0, 0.0, 190.0, 0.0])
    found = []
    for jerk in (0.0, 1000.0):
        series = settled()
        for wrench in noise(WINDOW, 4):
            series.add(wrench + roll[1:] + jerk * np.array([1.0, 1.0, 0.0, 3.0, -3.0]))
            jerk *= -0.7
        found.append([onset_evidence(0, effect, series.memory) for effect in (roll, pitch)])
    assert found[1][0] == pytest.approx(found[0][0]) and found[0][0] > 5.0
    assert found[0][1] < -5.0 and abs(found[1][1]) < 1.0  # excluded, and hidden


def test_expected_evidence_is_that_of_the_step_over_the_disturbance_of_each_plane():
    series, effect, cycles = settled(), np.array([0.0, 5.0, 2.0, 27.0, -3.0, 8.0]), 3
    step = np.cumsum(series.memory["filter"][:cycles] * effect[1:], axis=0)
    newest = (series.memory["taken"] - 1) % WINDOW
    square = by_plane(series.memory["weight"][newest] * left_of(step, series.memory["slope"]) ** 2)
    now = cycles / WINDOW * series.memory["square"].sum(axis=0) + COMPONENTS * cycles
    exact = 0.5 * COMPONENTS * cycles * np.log(1.0 + square / now).sum()
    assert expected_evidence(cycles, effect, series.memory) == pytest.approx(exact)


def test_a_cycle_counts_the_less_the_more_of_its_innovation_stays_unexplained():
    assert trust(10.0, 20.0, 30.0) == pytest.approx(1.0 / (1.0 + (30.0 - 5.0) / OUTLIER))
    # a loss of more than all is none
    assert trust(40.0, 20.0, 90.0) == pytest.approx(1.0 / (1.0 + (90.0 - 60.0) / OUTLIER))
    assert trust(-10.0, 20.0, 30.0) == pytest.approx(1.0 / (1.0 + 30.0 / OUTLIER))
    sums = np.zeros(1, SUMS)[0]
    sums["cross"], sums["own"], sums["all"], sums["cycles"] = 1.0, 2.0, 3.0, 4.0
    collect(sums, 0.5, 10.0, 20.0, 30.0, share=0.25)
    assert tuple(sums) == pytest.approx((0.5 + 2.5, 1.0 + 5.0, 1.5 + 7.5, 2.0 + 0.25))


def test_filter_begins_with_the_first_difference_of_the_predictor():
    memory = np.zeros(1, RESIDUAL)[0]
    memory["covariance"][2] = [2.0, 1.0, 0.3, 0.1, 0.0]
    update_filter(2, memory)
    taps = np.convolve([1.0, -1.0], np.concatenate([[1.0], -memory["predictor"][2]]))
    assert memory["filter"][:, 2] == pytest.approx(taps)
