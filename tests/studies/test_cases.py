"""Dispersed flights of the paper studies: draws that do not depend on the number of runs."""

from __future__ import annotations

import numpy as np
import pytest

from edl6dof.studies.cases import Spread, draw


def test_draws_have_the_wanted_spread_and_a_longer_series_begins_like_a_shorter_one():
    spreads = (Spread("a.b", 10.0, 3.0), Spread("c", -1.0, 0.0))
    many = draw(spreads, 4000, 1)
    assert draw(spreads, 3, 1) == many[:3]
    first = np.array([row["a.b"] for row in many])
    assert (first.mean(), first.std()) == (pytest.approx(10.0, abs=0.05), pytest.approx(1.0, abs=0.04))
    assert {row["c"] for row in many} == {-1.0}
