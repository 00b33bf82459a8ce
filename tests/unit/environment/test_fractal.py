"""Fractal relief: how an area lays the tiles."""

import numpy as np
import pytest

from edl6dof.environment.landing_area.fractal import in_tiles


@pytest.mark.parametrize("turn", range(8))
def test_tiles_are_turned_and_mirrored_in_eight_ways(turn):
    """Bit 1 exchanges the axes of the tiles, 2 and 4 turn them around."""
    area = np.zeros(1, [("turn", "i8")])
    area["turn"] = turn
    found = np.array([in_tiles(area[0], i, j) for i, j in ((1, 0), (0, 1), (3, 5))])
    matrix = np.diag([-1 if turn & 2 else 1, -1 if turn & 4 else 1]) @ (
        np.eye(2)[::-1] if turn & 1 else np.eye(2)
    )
    np.testing.assert_array_equal(found, np.array([(1, 0), (0, 1), (3, 5)]) @ matrix.T)
