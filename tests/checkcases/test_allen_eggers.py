"""The check case ``allen_eggers`` passes, and fails for each of these planted errors, which change what flies
and not what is expected:

* scale height 1 mm too large
* path 0.1 deg off the vertical
* mass 0.1 kg too large
"""

from __future__ import annotations

import pytest

from edl6dof.verify.cases import allen_eggers

PLANTED = [
    pytest.param(["atmosphere.exponential.scale_height_m=9354.001"], "speed", id="scale"),
    pytest.param(["initial.flight_path_angle_deg=-89.9"], "speed", id="path", marks=pytest.mark.long),
    pytest.param(["vehicle.mass.entry_kg=400.1"], "speed", id="mass", marks=pytest.mark.long),
]


def test_passes():
    assert allen_eggers.run().passed


@pytest.mark.parametrize(("planted", "quantity"), PLANTED)
def test_planted_error_is_caught(planted, quantity):
    caught = [result.quantity for result in allen_eggers.run(planted).results if not result.passed]
    assert any(quantity in name for name in caught), caught
