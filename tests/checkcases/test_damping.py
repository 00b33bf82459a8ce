"""The check case ``damping`` passes, and fails for each of these planted errors, which change what flies and
not what is expected:

* damping 1 % too strong
"""

from __future__ import annotations

import pytest

from edl6dof.verify.cases import damping

PLANTED = [
    pytest.param(["vehicle.aero.capsule.damping_factor=1.01"], "growth rate", id="factor"),
]


def test_passes():
    assert damping.run().passed


@pytest.mark.parametrize(("planted", "quantity"), PLANTED)
def test_planted_error_is_caught(planted, quantity):
    caught = [result.quantity for result in damping.run(planted).results if not result.passed]
    assert any(quantity in name for name in caught), caught
