"""Bounds of quantiles: how often they hold, and what too few flights cannot tell."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from edl6dof.campaign.statistics import SHARES, bounded_shares, flights_needed, quantile

#: Campaigns flown in thought.
CAMPAIGNS = 1000


@pytest.mark.parametrize("share", SHARES)
def test_flights_needed_are_the_fewest_whose_extremes_bound_the_quantile(share):
    """n values lie all above the quantile with chance (1 - p)^n, all below with p^n: each is to be 2.5 %."""
    n = flights_needed(share)
    tail = max(share, 1.0 - share)
    assert tail**n <= 0.025 < tail ** (n - 1)
    values = np.linspace(0.0, 1.0, n)
    assert quantile(values, share) is not None and quantile(values[1:], share) is None


def test_a_quantile_of_what_was_flown_is_one_of_the_values_and_counts_failures_as_the_largest():
    values = np.arange(1.0, 369.0)
    assert quantile(values, 0.99, flown=True).value == 365.0  # one of them: 364.33 by interpolation
    assert quantile(values[1:], 0.99, flown=True) is None
    values[-4:] = np.inf
    failed = quantile(values, 0.99, flown=True)
    assert failed.value == failed.high == np.inf and failed.low < 365.0
    assert quantile(values, 0.95, flown=True).value == 350.0
    assert quantile(np.append(values, np.nan), 0.95, flown=True) == quantile(values, 0.95, flown=True)


def test_three_sigma_is_refused_from_a_hundred_flights():
    values = np.random.default_rng(1).standard_normal(100)
    assert quantile(values, 0.9987) is None and quantile(values, 0.0013) is None
    assert flights_needed(0.9987) == 2836
    assert bounded_shares(100) == (0.05, 0.5, 0.95)


@pytest.mark.parametrize(
    "flights, share",
    [
        (6, 0.5),
        *(pytest.param(100, share, marks=pytest.mark.long) for share in (0.05, 0.5, 0.95)),
        (400, 0.99),
        pytest.param(2836, 0.9987, marks=pytest.mark.long),
    ],
)
@pytest.mark.parametrize(
    "figure",
    [
        pytest.param(stats.norm(), id="normal", marks=pytest.mark.long),
        pytest.param(stats.expon(), id="skew", marks=pytest.mark.long),
        pytest.param(stats.t(2), id="heavy"),
    ],
)
def test_bounds_hold_in_95_of_100_campaigns(flights, share, figure):
    rng = np.random.default_rng(flights)
    true, held = figure.ppf(share), 0
    for _ in range(CAMPAIGNS):
        found = quantile(figure.ppf(rng.random(flights)), share)
        held += found.low <= true <= found.high
    assert held / CAMPAIGNS >= 0.95 - 2.5 * np.sqrt(0.95 * 0.05 / CAMPAIGNS)


def test_bounds_are_not_wider_than_ranks_allow():
    """Brought in by one value on either side they no longer hold in 97.5 of 100 there."""
    n, share = 1000, 0.95
    found = quantile(np.arange(1.0, n + 1.0), share)
    below = stats.binom(n, share).cdf
    assert below(found.low - 1.0) <= 0.025 < below(found.low)
    assert 1.0 - below(found.high - 1.0) <= 0.025 < 1.0 - below(found.high - 2.0)


def test_bounds_of_stratified_flights_are_on_the_safe_side():
    """Latin hypercube: quantiles of a sum that rises with each input stray less than the bounds say."""
    held = 0
    for seed in range(400):
        inputs = stats.qmc.LatinHypercube(5, rng=np.random.default_rng(seed)).random(100)
        found = quantile(stats.norm.ppf(inputs).sum(axis=1), 0.95)
        held += found.low <= np.sqrt(5.0) * stats.norm.ppf(0.95) <= found.high
    assert held / 400 >= 0.95


def test_flights_without_the_figure_do_not_count():
    values = np.append(np.arange(100.0), np.full(50, np.nan))
    assert quantile(values, 0.5) == quantile(values[:100], 0.5)
    assert quantile(np.append(np.arange(5.0), np.full(50, np.nan)), 0.5) is None
