"""Unit numbers and distributions against scipy, and their independence of order."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from scipy import stats
from scipy.stats import qmc

from edl6dof.campaign.design.distributions import Discrete, LogNormal, Normal, TruncatedNormal, Uniform
from edl6dof.campaign.design.sampling import unit_numbers

PLANS = ("monte_carlo", "latin_hypercube", "sobol")
NAMES = ["truth.a", "truth.b", "both.c"]
N = 3000


@pytest.mark.parametrize("plan", PLANS)
def test_any_piece_is_that_of_the_whole(plan):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        whole = unit_numbers(plan, 4, NAMES, N, 0, N)
        for first, last in ((0, 1), (1, 2), (1000, 1100), (1023, 1025), (1024, 2049), (2999, 3000), (7, 7)):
            assert np.array_equal(unit_numbers(plan, 4, NAMES, N, first, last), whole[first:last])


@pytest.mark.parametrize("plan", PLANS)
def test_numbers_are_uniform_and_uncorrelated(plan):
    unit = unit_numbers(plan, 4, NAMES, N, 0, N)
    assert unit.min() >= 0.0 and unit.max() < 1.0
    for column in unit.T:
        assert stats.kstest(column, "uniform").pvalue > 1e-3
    assert np.abs(np.corrcoef(unit.T) - np.eye(3)).max() < 4.0 / np.sqrt(N)


def test_latin_hypercube_has_one_case_in_each_stratum():
    unit = unit_numbers("latin_hypercube", 4, NAMES, N, 0, N)
    assert all(np.array_equal(np.sort(np.floor(column * N)), np.arange(N)) for column in unit.T)


def test_sobol_fills_space_better_than_chance():
    sobol, chance = (
        qmc.discrepancy(unit_numbers(plan, 4, NAMES, 1024, 0, 1024)) for plan in ("sobol", "monte_carlo")
    )
    assert sobol < 0.1 * chance


@pytest.mark.parametrize("plan", ["monte_carlo", "latin_hypercube"])
def test_a_quantity_keeps_its_numbers_when_another_is_added(plan):
    """Common random numbers between campaigns that differ in one dispersion."""
    few, more = (
        unit_numbers(plan, 4, NAMES[:2], N, 0, N),
        unit_numbers(plan, 4, [NAMES[2], *NAMES[:2]], N, 0, N),
    )
    assert np.array_equal(few, more[:, 1:])


def test_seeds_differ():
    for plan in PLANS:
        assert not np.array_equal(
            unit_numbers(plan, 4, NAMES, 64, 0, 64), unit_numbers(plan, 5, NAMES, 64, 0, 64)
        )


UNIT = (np.arange(20000) + 0.5) / 20000


@pytest.mark.parametrize(
    "distribution, nominal, expected",
    [
        (Normal(kind="normal", three_sigma=15.0), 1285.0, stats.norm(1285.0, 5.0)),
        (Normal(kind="normal", three_sigma_pct=5.0), -250.0, stats.norm(-250.0, 250.0 * 0.05 / 3.0)),
        (Normal(kind="normal", sigma=2.0, mean=7.0), 1285.0, stats.norm(7.0, 2.0)),
        (Uniform(kind="uniform", low=-1.0, high=3.0), 9.0, stats.uniform(-1.0, 4.0)),
        (Uniform(kind="uniform", half_width=0.5), 9.0, stats.uniform(8.5, 1.0)),
        (LogNormal(kind="log_normal", sigma_ln=0.3), 2.0, stats.lognorm(0.3, scale=2.0)),
        (TruncatedNormal(kind="truncated_normal", sigma=1.0, low=0.5), 0.0, stats.truncnorm(0.5, np.inf)),
        (
            TruncatedNormal(kind="truncated_normal", sigma=2.0, low=-1.0, high=4.0),
            1.0,
            stats.truncnorm(-1.0, 1.5, 1.0, 2.0),
        ),
    ],
)
def test_distribution_is_that_of_scipy(distribution, nominal, expected):
    assert distribution.values(UNIT, nominal) == pytest.approx(expected.ppf(UNIT), rel=1e-9, abs=1e-9)


def test_a_tail_far_out_keeps_its_shape_and_its_bounds():
    """Beyond six sigma the excess over the bound is exponential, of mean 1 / bound up to its square."""
    tail = TruncatedNormal(kind="truncated_normal", sigma=1.0, low=5.9, high=20.0).values(UNIT, 0.0)
    assert tail.min() >= 5.9 and tail.max() <= 20.0
    assert np.mean(tail - 5.9) == pytest.approx(1.0 / 5.9, rel=2.0 / 5.9**2)


def test_discrete_values_come_with_their_weights():
    values = Discrete(kind="discrete", choices=["a", "b", 3], weights=[1.0, 2.0, 1.0]).values(UNIT, None)
    assert [list(values).count(choice) for choice in ("a", "b", 3)] == [5000, 10000, 5000]


def test_the_ends_of_the_unit_interval_stay_finite():
    for distribution in (Normal(kind="normal", sigma=1.0), LogNormal(kind="log_normal", sigma_ln=1.0)):
        assert np.isfinite(distribution.values(np.array([0.0, 1.0]), 1.0)).all()
