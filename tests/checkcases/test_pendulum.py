"""The check case ``pendulum`` passes, and fails for each of these planted errors, which change what flies and
not what is expected:

* normal force of the canopy 1 % too large
* bridle 1 cm too long
* apparent mass of the canopy left out
"""

from __future__ import annotations

import pytest

from edl6dof.verify.cases import pendulum

PLANTED = [
    pytest.param(["vehicle.parachutes.main.normal_slope=0.2525"], "pendulum", id="slope"),
    pytest.param(
        ["vehicle.parachutes.main.confluence_m=[-3.91, 0, 0]"], "wrist", id="bridle", marks=pytest.mark.long
    ),
    pytest.param(
        ["vehicle.parachutes.main.apparent_mass_factor=0"], "pendulum", id="apparent", marks=pytest.mark.long
    ),
]


def test_passes():
    assert pendulum.run().passed


@pytest.mark.parametrize(("planted", "quantity"), PLANTED)
def test_planted_error_is_caught(planted, quantity):
    caught = [result.quantity for result in pendulum.run(planted).results if not result.passed]
    assert any(quantity in name for name in caught), caught
