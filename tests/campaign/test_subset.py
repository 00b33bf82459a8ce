"""Subset simulation against closed forms, and its conditions."""

from __future__ import annotations

from math import sqrt

import numpy as np
import pytest
from scipy.stats import binom, norm

from edl6dof.campaign.subset import (
    LEAST,
    SHARE,
    Population,
    estimate,
    regions,
    simulate,
    threshold,
)

INPUTS = 46


def linear(beta):
    """Return the margin with failure probability Phi(-beta), of all inputs alike."""
    return lambda points: beta - points.deviates.sum(axis=1) / sqrt(INPUTS)


def estimated(margins, seed, size=155, populations=4):
    """Probability with its 90 % interval."""
    return estimate(simulate(margins, inputs=INPUTS, size=size, populations=populations, seed=seed), 0.9)


def covered(margins, p, repetitions):
    """Mean estimate over the truth, and number of 90 % intervals that contain the truth."""
    found = [estimated(margins, seed) for seed in range(repetitions)]
    hits = sum(one.low is not None and one.low <= p <= one.high for one in found)
    return np.mean([one.probability for one in found]) / p, hits


def enough(hits, repetitions):
    """Return whether so many hits occur in 99 of 100 tests of an interval of 90 %."""
    return hits >= binom(repetitions, 0.9).ppf(0.01)


def test_interval_contains_the_probability_of_a_linear_limit_state():
    mean, hits = covered(linear(-norm.ppf(1e-3)), 1e-3, 40)
    assert enough(hits, 40) and mean == pytest.approx(1.0, abs=0.2)


@pytest.mark.long
@pytest.mark.parametrize(
    "p, points, within",
    [(1e-3, 2590, 0.99), (1e-4, 3170, 0.96), (1e-5, 3980, 0.90), (1e-6, 4640, 0.86), (1e-7, 5390, 0.80)],
)
def test_interval_of_90_percent_contains_the_truth_in_84_to_95_percent_of_300_repetitions(p, points, within):
    """The numbers are those of the table in docs/howto/assure.md."""
    asked, margins = [], linear(-norm.ppf(p))
    found = [estimated(lambda some: asked.append(len(some.numbers)) or margins(some), k) for k in range(300)]
    hits = [one.low <= p <= one.high for one in found]
    ratios = np.array([one.probability for one in found]) / p
    assert 0.84 <= np.mean(hits) <= 0.95 and np.mean(ratios) == pytest.approx(1.0, abs=0.15)
    assert sum(asked) / 300 == pytest.approx(points, abs=10)
    assert np.mean(np.abs(np.log(ratios)) < np.log(2.0)) == pytest.approx(within, abs=0.02)


def test_a_second_failure_mode_is_found():
    """Failures at +4 and -4 standard deviations of an input: either alone has half of the probability."""

    def margins(points):
        return 4.0 - np.abs(points.deviates[:, 0])

    truth = 2.0 * norm.sf(4.0)
    found = simulate(margins, inputs=INPUTS, size=150, populations=4, seed=1)
    one = estimate(found, 0.9)
    assert one.low < truth < one.high
    sides = np.sign(np.concatenate([run.points.deviates[run.failed, 0] for run in found]))
    assert {-1.0, 1.0} == set(sides)
    first, *others = regions([run.points.deviates[run.failed] for run in found], [1.0] * 4)
    assert first.spread > 3.0 and first.difference > 5.0 * max(other.difference for other in others)


def test_a_series_system_fails_as_often_as_its_two_modes():
    """The first levels contain hardly any of the points near the second mode, which has most failures."""

    def margins(points):
        u = points.deviates
        return np.minimum(4.2 - u[:, :23].sum(axis=1) / sqrt(23.0), 8.0 - 2.0 * u[:, 45])

    mean, hits = covered(margins, 1.0 - norm.cdf(4.2) * norm.cdf(4.0), 20)
    assert enough(hits, 20) and mean == pytest.approx(1.0, abs=0.4)


def hidden(points):
    """Margin with a second mode of 70 % of the failures, but about 1 % of the points halfway to them."""
    u = points.deviates
    return np.minimum(4.2 - u[:, :23].sum(axis=1) / sqrt(23.0), 12.0 - 3.0 * u[:, 45])


def of_hidden_mode(size, repetitions):
    """Shares of the repetitions that find the second mode, and whose 90 % interval contains the truth."""
    truth, seen, hits = 1.0 - norm.cdf(4.2) * norm.cdf(4.0), 0, 0
    for seed in range(repetitions):
        found = simulate(hidden, inputs=INPUTS, size=size, populations=4, seed=seed)
        one = estimate(found, 0.9)
        hits += one.low <= truth <= one.high
        seen += any((run.points.deviates[run.failed, 45] > 4.0).any() for run in found)
    return seen / repetitions, hits / repetitions


def test_a_hidden_second_mode_is_found_with_1000_points():
    assert of_hidden_mode(1000, 10)[0] == 1.0


@pytest.mark.long
@pytest.mark.parametrize("size, seen, hits", [(150, 0.51, 0.61), (300, 0.69, 0.65), (1000, 0.99, 0.81)])
def test_a_hidden_second_mode_is_missed_with_few_points(size, seen, hits):
    """The numbers are those of docs/howto/assure.md."""
    assert of_hidden_mode(size, 100) == pytest.approx((seen, hits), abs=0.02)


def test_plateaus_of_the_margin():
    """Margins in steps of 0.5, so that most points of a level have equal margins."""

    def margins(points):
        u = points.deviates.sum(axis=1) / sqrt(INPUTS)
        return np.ceil(2.0 * (3.5 - u)) / 2.0 - 0.25

    mean, hits = covered(margins, norm.sf(3.5), 20)
    assert enough(hits, 20) and mean == pytest.approx(1.0, abs=0.4)


@pytest.mark.parametrize(
    "margins, below",
    [
        (np.arange(100.0) + 1.0, 21.0),  # a fifth of the points below
        (np.where(np.arange(100) < 15, 1.0, 2.0), 2.0),  # the plateau is whole
        (np.where(np.arange(100) < 3, -np.inf, np.arange(100.0) + 1.0), 21.0),
        (np.full(100, 3.0), None),
        (np.full(100, -np.inf), None),
        (np.where(np.arange(100) < 20, -1.0, np.arange(100.0)), None),  # enough failures
        (np.where(np.arange(100) < 1, -1.0, 0.0), None),  # a margin of 0 is no failure
    ],
)
def test_threshold(margins, below):
    assert threshold(margins) == below


def test_without_a_way_to_the_failure_there_is_no_interval():
    found = simulate(lambda points: np.ones(len(points.numbers)), inputs=3, size=50, populations=2, seed=1)
    assert [one.probability for one in found] == [0.0, 0.0] and found[0].levels == ()
    assert estimate(found, 0.9) == (0.0, None, None)
    far = simulate(linear(9.0), inputs=INPUTS, size=100, populations=2, seed=1)
    assert all(one.probability == 0.0 for one in far)
    assert LEAST * SHARE**2 < np.prod([level.share for level in far[0].levels]) < LEAST


def test_random_profiles_are_inputs_too():
    """Half of the margin depends on the number of the profile, by a hash."""

    def margins(points):
        own = norm.ppf(((points.profiles * 2654435761) % 2**32 + 0.5) / 2.0**32)
        return 3.0 - (own + points.deviates[:, 0]) / sqrt(2.0)

    mean, hits = covered(margins, norm.sf(3.0), 20)
    assert enough(hits, 20) and mean == pytest.approx(1.0, abs=0.3)


def test_numbers_are_unique_and_belong_to_their_deviates():
    seen = {}

    def margins(points):
        for number, profile, ancestor, deviates in zip(*points, strict=True):
            assert number not in seen and (profile == number or profile in seen)
            assert (ancestor == number) == (len(seen) < 300) and ancestor < 300
            seen[number] = deviates
        return linear(3.0)(points)

    runs = simulate(margins, inputs=INPUTS, size=100, populations=3, seed=5)
    assert sum(len(run.margins) for run in runs) == 300
    for k, run in enumerate(runs):
        assert isinstance(run, Population) and set(run.points.ancestors % 3) == {k}
        own = zip(run.points.numbers, run.points.deviates, strict=True)
        assert all(np.array_equal(seen[number], deviates) for number, deviates in own)
        assert np.array_equal(run.margins, linear(3.0)(run.points))


def test_variance_of_a_sample_is_that_of_the_binomial_distribution():
    """With a probability above one fifth there are no chains, and every failure is its own ancestor."""
    found = simulate(linear(0.0), inputs=INPUTS, size=400, populations=2, seed=4)
    for one in found:
        assert one.levels == () and one.variance == pytest.approx(1.0 / np.sum(one.failed))
    wide = estimate(found, 0.9)
    assert wide.low < 0.5 < wide.high < 0.6


def test_variance_between_populations_counts_if_it_is_larger():
    """Of four populations only one has found the failure."""
    found = simulate(linear(3.0), inputs=INPUTS, size=150, populations=1, seed=4)
    nothing = simulate(lambda points: np.ones(len(points.numbers)), inputs=1, size=50, populations=3, seed=1)
    one = estimate([*found, *nothing], 0.9)
    assert one.probability == pytest.approx(0.25 * found[0].probability)
    assert one.high / one.low > 1000.0


def test_region_of_a_linear_failure_is_the_known_conditional_distribution():
    """Above 3 sigma of one input, its mean is that of the truncated distribution."""
    found = simulate(lambda points: 3.0 - points.deviates[:, 2], inputs=5, size=1000, populations=4, seed=2)
    one = regions([run.points.deviates[run.failed] for run in found], [run.probability for run in found])
    mean = norm.pdf(3.0) / norm.sf(3.0)  # of the truncated normal distribution
    assert one[2].mean == pytest.approx(mean, abs=0.05)
    assert one[2].spread == pytest.approx(sqrt(1.0 + 3.0 * mean - mean**2), rel=0.2)
    assert one[2].lowest <= one[2].mean <= one[2].highest
    assert max(abs(one[k].mean) for k in (0, 1, 3, 4)) < 0.4
    assert one[2].difference == max(region.difference for region in one) > 4.0
