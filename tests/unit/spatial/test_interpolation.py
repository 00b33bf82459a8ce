"""Smooth interpolation against a cubic Hermite spline of scipy with the slopes of central differences."""

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from edl6dof.spatial.interpolation import smooth

PROFILE = np.array([1.0, -2.0, 0.5, 4.0, 3.0, 7.0])


def test_cubic_has_the_slope_of_the_neighbours_at_each_row():
    rows = len(PROFILE)
    padded = np.pad(PROFILE, 1, mode="edge")
    spline = CubicHermiteSpline(np.arange(rows), PROFILE, 0.5 * (padded[2:] - padded[:-2]))
    for row in range(rows - 1):
        for share in (0.0, 0.13, 0.5, 0.71, 1.0):
            assert smooth(PROFILE, rows, row, share) == pytest.approx(spline(row + share), abs=1e-12)


def test_parabola_is_exact_between_its_rows():
    x = np.arange(8.0)
    parabola = 3.0 - 2.0 * x + 0.7 * x**2
    for at in (1.3, 3.75, 5.9):
        exact = 3.0 - 2.0 * at + 0.7 * at**2
        assert smooth(parabola, 8, int(at), at % 1.0) == pytest.approx(exact, rel=1e-12)
