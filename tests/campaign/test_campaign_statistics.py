"""Intervals and ellipses against closed forms and scipy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from edl6dof.campaign.statistics import Proportion, Until, ellipse


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
