"""Fractal relief: how an area lays the tiles."""

import numpy as np
import pytest

from edl6dof.environment.landing_area.fractal import fractal_at, fractal_row, fractal_tiles, in_tiles
from edl6dof.environment.landing_area.relief import LANDING_AREA


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


@pytest.mark.parametrize("turn", range(8))
def test_a_row_has_the_heights_of_its_nodes(turn):
    """A row of 100 nodes passes six cells of the coarse tile, either way along either of its axes."""
    area, tiles, heights = np.zeros(1, LANDING_AREA)[0], fractal_tiles(0.8), np.zeros(100)
    area["turn"], area["roughness"], area["offset"] = turn, 1.0, (3, 5, 9, 13)
    fractal_row(area, tiles, -7, -11, heights)
    assert heights == pytest.approx([fractal_at(area, tiles, -7, -11 + k) for k in range(100)], abs=1e-12)
    assert np.ptp(heights) > 0.0
