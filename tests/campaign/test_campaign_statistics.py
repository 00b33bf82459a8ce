"""Intervals, ellipses and sensitivities against closed forms and scipy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from edl6dof.campaign.statistics import Proportion, Until, drivers, ellipse


@pytest.mark.parametrize("successes, trials", [(0, 10), (10, 10), (97, 100), (995, 1000), (1, 3)])
def test_wilson_interval_is_that_of_scipy(successes, trials):
    expected = stats.binomtest(successes, trials).proportion_ci(0.95, method="wilson")
    assert Proportion(successes, trials).interval == pytest.approx((expected.low, expected.high), abs=1e-12)


def test_no_trials_say_nothing():
    assert Proportion(0, 0).interval == (0.0, 1.0)


@pytest.mark.parametrize(
    "text", ["p_success +- 0.5%", "p_success +/- 0.005", "p_success±0.5 %", " p_success  +-  5e-3 "]
)
def test_stop_rule_is_read(text):
    assert Until.parse(text).half_width == pytest.approx(0.005)


@pytest.mark.parametrize(
    "text", ["p_success", "0.5%", "p_success +- 0", "p_success +- 60%", "success +- 1%", "p_success +- .%"]
)
def test_other_stop_rules_are_refused(text):
    with pytest.raises(ValueError, match="must have the form"):
        Until.parse(text)


def test_stop_rule_waits_for_the_interval():
    until = Until.parse("p_success +- 1%")
    assert (
        not until.reached(Proportion(0, 0))
        and not until.reached(Proportion(150, 150))
        and until.reached(Proportion(200, 200))
    )


def test_ellipse_holds_the_share_of_a_normal_cloud():
    """In two dimensions k sigma hold 1 - exp(-k^2 / 2) of the points."""
    rng = np.random.default_rng(1)
    east, north = np.array([[3.0, 0.0], [1.0, 0.5]]) @ rng.standard_normal((2, 200_000)) + [[10.0], [-4.0]]
    covariance = np.linalg.inv(np.cov(np.stack([east, north])))
    for sigmas in (1, 2, 3):
        x, y = ellipse(east, north, sigmas)
        off = np.stack([x - east.mean(), y - north.mean()])
        assert np.einsum("ik,ij,jk->k", off, covariance, off) == pytest.approx(sigmas**2, rel=1e-6)
        cloud = np.stack([east - east.mean(), north - north.mean()])
        inside = np.mean(np.einsum("ik,ij,jk->k", cloud, covariance, cloud) <= sigmas**2)
        assert inside == pytest.approx(1.0 - np.exp(-(sigmas**2) / 2.0), abs=0.003)


def test_drivers_of_a_linear_model_are_its_coefficients():
    """y = 3 a + 4 b + noise of variance 1 with unit inputs: shares 9/26 and 16/26, explained 25/26."""
    rng = np.random.default_rng(2)
    inputs = {name: rng.standard_normal(50_000) for name in "abc"}
    found, explained = drivers(inputs, 3.0 * inputs["a"] + 4.0 * inputs["b"] + rng.standard_normal(50_000))
    assert [driver.name for driver in found] == ["b", "a", "c"]
    assert [driver.regression**2 for driver in found] == pytest.approx([16 / 26, 9 / 26, 0.0], abs=0.01)
    assert explained == pytest.approx(25 / 26, abs=0.005)


def test_rank_correlation_is_that_of_scipy_and_finds_curved_effects():
    rng = np.random.default_rng(3)
    a, b = rng.standard_normal((2, 400))
    figure = np.exp(3.0 * a) + 0.1 * b
    found, _ = drivers({"a": a, "b": b}, figure)
    assert found[0].name == "a" and found[0].rank_correlation == pytest.approx(
        stats.spearmanr(a, figure).statistic, abs=1e-12
    )


def test_flights_without_the_figure_are_left_out():
    rng = np.random.default_rng(4)
    a = rng.standard_normal(200)
    figure = np.where(np.arange(200) % 5 == 0, np.nan, 2.0 * a)
    found, explained = drivers({"a": a, "constant": np.ones(200)}, figure)
    assert [driver.name for driver in found] == ["a"] and explained == pytest.approx(1.0)
