"""Reversals of the bank angle: from one side clearly to the other."""

import numpy as np
import pytest

from edl6dof.telemetry.reversals import reversal_rows


@pytest.mark.parametrize(
    ("bank", "rows"),
    [
        ([60.0, 20.0, -20.0, -60.0], [2]),
        ([60.0, 0.0, 0.0, -60.0], [3]),  # through wings level
        ([60.0, 3.0, -3.0, 3.0, 60.0], []),  # heading alignment about zero
        ([60.0, 3.0, -3.0, 3.0, -3.0, -60.0], [4]),  # the last crossing counts
        ([-60.0, 60.0, -60.0], [1, 2]),
        ([0.0, 60.0, 0.0], []),
        ([0.0, 0.0], []),
    ],
)
def test_reversal_goes_from_one_side_clearly_to_the_other(bank, rows):
    assert reversal_rows(np.array(bank)) == rows
