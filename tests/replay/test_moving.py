"""Moving means and maxima against scipy's filters."""

import numpy as np
import pytest
from scipy.ndimage import maximum_filter1d, uniform_filter1d

from edl6dof.replay.views.cameras import moving_largest, moving_mean


@pytest.mark.parametrize("rows, width", [(5, 63), (40, 1), (200, 7), (3000, 63)])
def test_they_are_those_of_scipy(rows, width):
    values = 100.0 * np.random.default_rng(rows).normal(size=(rows, 3))
    wanted = uniform_filter1d(values, width, axis=0, mode="nearest")
    assert moving_mean(values, width) == pytest.approx(wanted, abs=1e-11)
    wanted = maximum_filter1d(values[:, 0], width, mode="nearest")
    assert np.array_equal(moving_largest(values[:, 0], width), wanted)
