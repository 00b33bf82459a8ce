"""The check case ``point_mass`` passes, and fails for each of these planted errors, which change what flies
and not what is expected:

* bank angle 1e-4 deg larger
* planet turning by a part in 10^5 faster
* lift-to-drag ratio 1e-6 larger
"""

from __future__ import annotations

import pytest

from edl6dof.verify.cases import point_mass

PLANTED = [
    pytest.param(["initial.bank_deg=55.0001"], id="bank"),
    pytest.param(["planet.rotation_rate_rad_s=7.0883e-5"], id="spin", marks=pytest.mark.long),
    pytest.param(["vehicle.aero.lift_drag.lift_to_drag=0.200001"], id="lift", marks=pytest.mark.long),
]


@pytest.mark.exact_start  # its tolerances are below a millimetre
def test_passes():
    assert point_mass.run().passed


@pytest.mark.parametrize("planted", PLANTED)
def test_planted_error_is_caught(planted):
    assert not point_mass.run(planted).passed
