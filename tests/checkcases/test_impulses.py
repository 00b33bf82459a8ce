"""The check case ``impulses`` passes, and fails for each of these planted errors, which change what flies and
not what is expected:

* valves 1 % slower in opening
* specific impulse 0.001 % too large
"""

from __future__ import annotations

import pytest

from edl6dof.verify.cases import impulses

PLANTED = [
    pytest.param(["vehicle.rcs.thrusters.0.rise_s=0.01212"], "propellant", id="rise"),
    pytest.param(
        ["vehicle.rcs.thrusters.0.specific_impulse_s=270.0027"], "speed", id="isp", marks=pytest.mark.long
    ),
]


def test_passes():
    assert impulses.run().passed


@pytest.mark.parametrize(("planted", "quantity"), PLANTED)
def test_planted_error_is_caught(planted, quantity):
    caught = [result.quantity for result in impulses.run(planted).results if not result.passed]
    assert any(quantity in name for name in caught), caught
