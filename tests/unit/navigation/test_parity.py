"""Parity-space test: its tail is that of chi-square, and it isolates the instrument that has failed."""

import numpy as np
import pytest
from inertial_units import DT, cone, redundant
from numba import njit
from scipy.stats import chi2

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.navigation.parity_test import (
    NONE,
    PARITY,
    ParityParams,
    chi_square_limit,
    chi_square_tail,
    isolate,
    parity_test,
    restart_parity_test,
)

ALL = 0b111111
SIGMA = 3e-7


@pytest.mark.parametrize("degrees", [1, 2, 3, 4, 5])
def test_tail_and_limit_are_those_of_scipy(degrees):
    for value in (0.01, 1.0, 5.0, 40.0, 300.0):
        assert chi_square_tail(degrees, value) == pytest.approx(chi2.sf(value, degrees), rel=1e-10)
    for tail in (0.5, 1e-3, 1e-10, 1e-30):
        assert chi_square_limit(degrees, tail) == pytest.approx(chi2.isf(tail, degrees), rel=1e-10)


def parity_params(**settings):
    record = np.zeros(1, dtype_of(ParityParams))
    fill(record[0], ParityParams(**settings))
    return record


class Unit:
    """Six instruments of one kind under test."""

    def __init__(self, in_use=ALL, **settings):
        self.params = parity_params(**settings)
        self.set, self.memory = redundant(cone(), in_use), np.zeros(1, PARITY)
        restart_parity_test(self.params[0], self.set[0]["n_parity"], self.memory[0])

    def look(self, increments, lasting=0.0):
        self.set["increment"][0, :6] = increments
        return parity_test(self.params[0], SIGMA**2, lasting, DT, self.set[0], 6, self.memory[0])

    def alarms(self, increments):
        """Whether the fast and the slow look are beyond their limit after each, shape (looks, 2)."""
        alarms = np.zeros((len(increments), 2), bool)
        look_each(self.params, self.set, self.memory, increments, alarms)
        return alarms


@njit
def look_each(params, units, memory, increments, alarms):
    """A hundred thousand looks, compiled."""
    for k in range(len(increments)):
        for i in range(6):
            units[0].increment[i] = increments[k, i]
        parity_test(params[0], SIGMA**2, 0.0, DT, units[0], 6, memory[0])
        alarms[k, 0] = memory[0].fast.statistic > memory[0].limit
        alarms[k, 1] = memory[0].slow.statistic > memory[0].limit


@pytest.mark.parametrize("in_use, degrees", [(ALL, 3), (0b111110, 2), (0b011110, 1)])
def test_alarms_of_one_look_are_as_frequent_as_the_tail_says(in_use, degrees):
    unit, rng, tail, looks = Unit(in_use, false_alarm=0.01), np.random.default_rng(3), 0.01, 100_000
    turn = cone() @ np.array([0.3, -0.1, 0.2])
    alarms = np.sum(unit.alarms(turn + SIGMA * rng.normal(size=(looks, 6)))[:, 0])
    assert unit.set["n_parity"][0] == degrees
    assert alarms / looks == pytest.approx(tail, abs=4.0 * (tail / looks) ** 0.5)


def test_low_passed_look_has_the_same_tail():
    """Looks one window apart hardly depend on each other; those of many units are independent."""
    rng, tail, units, alarms = np.random.default_rng(4), 0.05, 3000, 0
    for noise in SIGMA * rng.normal(size=(units, 60, 6)):
        unit = Unit(false_alarm=tail, window_s=0.4)
        alarms += unit.alarms(noise)[-1, 1]
    assert alarms / units == pytest.approx(tail, abs=4.0 * (tail / units) ** 0.5)


def test_false_exclusions_in_a_thousand_sound_flights():
    """Union over all looks of both kinds of instruments: the slow look needs no help from its persistence,
    the fast one would have to err five times on end.
    """
    cycles = 1000 * 27_000 * 2
    params = ParityParams()
    assert cycles * params.false_alarm < 0.01
    assert cycles * params.false_alarm**params.persistence_cycles < 1e-40


@pytest.mark.parametrize("i", range(6))
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_fast_look_names_the_failed_one_at_once_and_excludes_it_after_its_persistence(i, sign):
    unit, rng = Unit(), np.random.default_rng(10 * i)
    found = [unit.look(SIGMA * rng.normal(size=6) + sign * 30.0 * SIGMA * np.eye(6)[i]) for _ in range(5)]
    assert [left_out for left_out, _ in found] == [i] * 5
    assert [failed for _, failed in found] == [NONE] * 4 + [i]


@pytest.mark.parametrize("i", range(6))
def test_slow_look_finds_a_bias_below_the_noise_of_a_cycle(i):
    unit, rng = Unit(), np.random.default_rng(20 + i)
    bias = 0.7 * SIGMA * np.eye(6)[i]
    for _ in range(1250):  # 25 s
        left_out, failed = unit.look(SIGMA * rng.normal(size=6) + bias)
        assert left_out == NONE
        if failed != NONE:
            break
    assert failed == i


def test_second_failure_is_named_among_five():
    for second in range(1, 6):
        unit = Unit(0b111110)
        assert unit.look(40.0 * SIGMA * np.eye(6)[second])[0] == second


def test_among_four_a_failure_is_detected_and_not_isolated():
    unit = Unit(0b011110)
    assert unit.look(40.0 * SIGMA * np.eye(6)[1]) == (NONE, NONE)
    assert unit.memory["fast"]["statistic"][0] > unit.memory["limit"][0]


def test_relative_errors_of_a_fast_turn_raise_no_alarm():
    rng = np.random.default_rng(5)
    turn = np.array([5.0, 1.0, -1.0]) * DT
    for _ in range(200):
        unit = Unit()
        wrong = 5e-5 * np.linalg.norm(turn) * rng.normal(size=6)
        for _ in range(30):
            found = unit.look(
                cone() @ turn + wrong + SIGMA * rng.normal(size=6), (5e-5 * np.linalg.norm(turn)) ** 2
            )
            assert found == (NONE, NONE)


def test_isolation_agrees_with_the_one_whose_removal_leaves_least():
    unit, rng = Unit(), np.random.default_rng(6)
    V = unit.set["parity"][0, :3, :6]
    for _ in range(200):
        z = rng.normal(size=6)
        left = [np.linalg.lstsq(np.delete(cone(), i, 0), np.delete(z, i), rcond=None)[1][0] for i in range(6)]
        vector = np.append(V @ z, [0.0, 0.0])
        assert isolate(vector, unit.set[0], 6) == int(np.argmin(left))
