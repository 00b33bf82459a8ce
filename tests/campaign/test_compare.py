"""Paired differences: intervals against scipy, and how often chance alone is called clear."""

from __future__ import annotations

import numpy as np
import pyarrow as pa
import pytest
from scipy import stats

from edl6dof.campaign.statistics import _differences, mcnemar

PAIRS, FIGURES = 100, 60


def tables(rng: np.random.Generator, shift: float) -> tuple[pa.Table, pa.Table]:
    """Two campaigns of the same cases; ``shift`` is what the second adds to the first figure."""
    shared = rng.standard_normal((FIGURES, PAIRS))
    a, b = (shared + 0.5 * rng.standard_normal((FIGURES, PAIRS)) for _ in "ab")
    b[0] += shift
    return tuple(pa.table({f"figure_{k}": column for k, column in enumerate(values)}) for values in (a, b))


def test_chance_is_called_clear_in_at_most_5_of_100_comparisons():
    false = sum(
        any(d.clear for d in _differences(*tables(np.random.default_rng(k), 0.0))) for k in range(100)
    )
    assert false <= 5


def test_a_difference_is_called_clear_and_its_interval_is_that_of_students_t():
    a, b = tables(np.random.default_rng(1), 0.5)
    found = _differences(a, b)
    assert [one.figure for one in found if one.clear] == ["figure_0"]
    apart = b["figure_0"].to_numpy() - a["figure_0"].to_numpy()
    low, high = stats.ttest_1samp(apart, 0.0).confidence_interval(0.95)
    assert found[0].difference - found[0].half_width == pytest.approx(low)
    assert found[0].difference + found[0].half_width == pytest.approx(high)


def test_figures_that_never_differ_are_not_clear():
    same = pa.table({"figure": np.arange(10.0), "other": np.full(10, np.nan)})
    (found,) = _differences(same, same)
    assert found.figure == "figure" and not found.clear


@pytest.mark.parametrize(("only_a", "only_b"), [(0, 0), (3, 3), (1, 9), (12, 2), (0, 40), (250, 310)])
def test_uneven_single_successes_have_the_p_value_of_the_binomial_test(only_a, only_b):
    expected = stats.binomtest(only_a, only_a + only_b).pvalue if only_a + only_b else 1.0
    assert mcnemar(only_a, only_b) == pytest.approx(expected, rel=1e-12)
