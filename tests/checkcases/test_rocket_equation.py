"""The check case ``rocket_equation`` passes, and fails for each of these planted errors, which change what
flies and not what is expected:

* specific impulse at full thrust 1 ms too large
* thrust tilted by 0.001 deg
* flow 1e-4 too small for the thrust
"""

from __future__ import annotations

import pytest

from edl6dof.verify.cases import rocket_equation

PLANTED = [
    pytest.param(
        ["vehicle.engines.main.full_specific_impulse_s=300.001"], "speed", id="isp", marks=pytest.mark.long
    ),
    pytest.param(
        ["vehicle.engines.main.misalignment_y_deg=0.001"], "speed", id="tilt", marks=pytest.mark.long
    ),
    pytest.param(["vehicle.engines.main.specific_impulse_factor=1.0001"], "mass", id="factor"),
]


def test_passes():
    assert rocket_equation.run().passed


@pytest.mark.parametrize(("planted", "quantity"), PLANTED)
def test_planted_error_is_caught(planted, quantity):
    caught = [result.quantity for result in rocket_equation.run(planted).results if not result.passed]
    assert any(quantity in name for name in caught), caught
