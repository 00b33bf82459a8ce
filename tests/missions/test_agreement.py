"""Statistics of predicted and flown values, against made-up missions whose dispersions are known."""

from __future__ import annotations

from math import erf, exp, pi, sqrt

import numpy as np
import pytest

from edl6dof.missions.agreement import coverage, distance, is_calibrated, percentile, score

FLIGHTS, VALUES = 200, 400


def places(spread: float, sigma: float = 0.6) -> list[float]:
    """Percentiles of flown values (truth N(0, 1), measured with an error ``sigma``) among flights whose
    standard deviation is ``spread``.
    """
    chance = np.random.default_rng(5)
    truth = chance.normal(size=VALUES) + sigma * chance.normal(size=VALUES)
    flights = spread * chance.normal(size=(VALUES, FLIGHTS))
    return [percentile(values, flown, sigma) for values, flown in zip(flights, truth, strict=True)]


def test_right_dispersions_give_uniform_percentiles():
    found = places(1.0)
    # four standard deviations of a share among so many values
    for level in (0.5, 0.68, 0.95):
        allowed = 4.0 * sqrt(level * (1.0 - level) / VALUES)
        assert coverage(found, level).value == pytest.approx(level, abs=allowed)
    counts, _ = np.histogram(found, bins=10, range=(0.0, 1.0))
    assert np.sum((counts - VALUES / 10) ** 2) / (VALUES / 10) < 27.9  # chi-squared with 9 d.o.f., 0.1 %
    assert is_calibrated(found)


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_dispersions_wrong_by_a_factor_of_two_fail(factor):
    assert not is_calibrated(places(factor, sigma=0.2)[:100])


def test_a_flown_value_without_an_error_is_ranked_among_the_flights():
    flights = np.array([1.0, 2.0, 3.0, 4.0])
    assert [percentile(flights, x, 0.0) for x in (0.0, 2.5, 3.0, 9.0)] == [0.0, 0.5, 0.625, 1.0]
    assert np.isnan(percentile(np.array([]), 1.0, 0.0)) and not is_calibrated([])
    assert coverage([0.16, 0.17, 0.83, 0.85, float("nan")], 0.68).successes == 3


def test_score_of_a_normal_prediction_is_that_in_closed_form():
    """Gneiting and Raftery (2007), equation 21, for a normal distribution."""
    flights, z = 3.0 * np.random.default_rng(2).normal(size=4000) + 10.0, 0.8
    density, cumulative = exp(-0.5 * z * z) / sqrt(2.0 * pi), 0.5 * (1.0 + erf(z / sqrt(2.0)))
    exact = 3.0 * (z * (2.0 * cumulative - 1.0) + 2.0 * density - 1.0 / sqrt(pi))
    assert score(flights, 10.0 + 3.0 * z) == pytest.approx(exact, rel=0.03)
    assert score(np.array([4.0]), 6.0) == 2.0


def test_distance_counts_correlated_values_once():
    chance = np.random.default_rng(3)
    common, own = chance.normal(size=(2000, 1)), chance.normal(size=(2000, 3))
    flights = common + 0.1 * own  # three values that nearly repeat each other
    along = distance(flights, np.array([2.0, 2.0, 2.0]), np.zeros(3))
    assert along.values == 3 and along.squared == pytest.approx(4.0, rel=0.1)
    across = distance(flights, np.array([0.5, -0.5, 0.0]), np.zeros(3))
    assert across.squared == pytest.approx(0.5 / 0.1**2, rel=0.1) and across.farther < 1e-6
    # an uncertain published value: variance 1 + 0.01 of a flight, and 3 of the value
    (squared, _, farther) = distance(flights[:, :1], np.array([2.0]), np.array([sqrt(3.0)]))
    assert squared == pytest.approx(4.0 / 4.01, rel=0.1)
    assert farther == pytest.approx(1.0 - erf(sqrt(0.5 * squared)), rel=1e-9)


def test_a_distance_requires_flights_that_reached_every_value():
    flights = np.random.default_rng(4).normal(size=(20, 3))
    flights[:9, 1] = np.nan
    assert distance(flights, np.zeros(3), np.ones(3)) is None
    assert distance(flights[:, ::2], np.zeros(2), np.ones(2)).values == 2
    assert distance(np.empty((0, 0)), np.empty(0), np.empty(0)) is None
