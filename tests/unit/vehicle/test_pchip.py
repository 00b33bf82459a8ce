"""The monotone cubic of table building against scipy's PchipInterpolator, on random and on monotone data."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from edl6dof.vehicle.aerodynamics.capsule_table import curve


@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(n, marks=pytest.mark.long) for n in range(2, 5))])
@pytest.mark.parametrize("monotone", [False, True])
def test_curve_and_derivative_are_those_of_scipy(seed, monotone):
    rng = np.random.default_rng(seed)
    x = np.sort(rng.uniform(-16.0, 16.0, 11))
    y = rng.normal(size=(4, 3, 11))
    y[0] = 0.0
    if monotone:
        y = np.cumsum(np.abs(y), axis=-1)
    at = np.linspace(x[0], x[-1], 301)
    reference = PchipInterpolator(x, y, axis=-1)
    values, derivative = curve(x, y, at)
    assert values == pytest.approx(reference(at), abs=1e-12)
    # at a node with a kink in the third derivative both sides agree in slope
    assert derivative == pytest.approx(reference.derivative()(at), abs=1e-10)
