"""Noise in flight: quantiles of the normal distribution against scipy's, and tests of chance."""

import numpy as np
import pytest
from scipy import stats
from scipy.special import ndtri

from edl6dof.spatial.random_numbers import normal_pair, normal_quantile, random_bits_at, uniform

N = 40_000


@pytest.fixture(scope="module")
def pairs():
    return np.array([normal_pair(987654321, k) for k in range(N)])


def test_quantiles_are_those_of_the_normal_distribution():
    shares = np.concatenate([np.geomspace(1.2e-10, 0.5, 300), 1.0 - np.geomspace(1.2e-10, 0.5, 300)])
    found = np.array([normal_quantile(share) for share in shares])
    np.testing.assert_allclose(found, ndtri(shares), rtol=2e-7, atol=1e-8)


def test_noise_is_normal(pairs):
    for values in (pairs[:, 0], pairs[:, 1], pairs.sum(axis=1) / np.sqrt(2.0)):
        assert stats.kstest(values, "norm").pvalue > 1e-4
        assert abs(stats.kurtosis(values)) < 5.0 * np.sqrt(24.0 / N)


def test_noise_is_independent_within_a_pair_in_time_and_between_keys(pairs):
    other = np.array([normal_pair(987654322, k) for k in range(N)])
    limit = 5.0 / np.sqrt(N)
    for a, b in (
        *((pairs[:, 0], pairs[:, 1]), (pairs[:, 0], other[:, 0]), (pairs[:, 1], other[:, 1])),
        *((pairs[1:, 0], pairs[:-1, 0]), (pairs[1:, 0], pairs[:-1, 1]), (pairs[8:, 0], pairs[:-8, 0])),
    ):
        assert abs(np.mean(a * b)) < limit
        assert abs(np.mean((a * a - 1.0) * (b * b - 1.0))) < 2.0 * limit


def test_uniform_is_even():
    values = np.array([uniform(42, k) for k in range(N)])
    assert values.min() >= 0.0 and values.max() < 1.0
    assert stats.kstest(values, "uniform").pvalue > 1e-4


def test_same_key_and_counter_give_the_same_noise():
    assert normal_pair(5, 7) == normal_pair(5, 7) != normal_pair(7, 5)


def test_bits_of_a_place_are_even_and_do_not_know_their_neighbours():
    bits = np.array(
        [[int(random_bits_at(77, i, j)) for j in range(-100, 100)] for i in range(-100, 100)], float
    )
    share = bits / 2.0**64
    assert stats.kstest(share.ravel(), "uniform").pvalue > 1e-4
    other = (share[1:, 1:], share[:-1, :-1]), (share[1:], share[:-1]), (share[:, 1:], share[:, :-1])
    for a, b in other:
        assert abs(np.mean((a - 0.5) * (b - 0.5))) < 5.0 / 12.0 / np.sqrt(a.size)
    assert random_bits_at(77, 1, 2) == random_bits_at(77, 1 + 2**32, 2)
