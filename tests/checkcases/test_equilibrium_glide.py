"""The check case ``equilibrium_glide`` passes, and fails for each of these planted errors in what flies, not
in what is expected:

* axial force 3 % too large
* glide begun 5 % too fast
* lift turned by 15 deg
"""

from __future__ import annotations

import pytest

from edl6dof.verify.cases import equilibrium_glide

PLANTED = [
    pytest.param(["vehicle.aero.capsule.axial_factor=1.03"], "range", id="drag"),
    pytest.param(["initial.speed_m_s=3340"], "lift", id="density", marks=pytest.mark.long),
    pytest.param(["initial.bank_deg=15"], "lift", id="bank", marks=pytest.mark.long),
]


def test_passes():
    assert equilibrium_glide.run().passed


@pytest.mark.parametrize(("planted", "quantity"), PLANTED)
def test_planted_error_is_caught(planted, quantity):
    caught = [result.quantity for result in equilibrium_glide.run(planted).results if not result.passed]
    assert any(quantity in name for name in caught), caught
