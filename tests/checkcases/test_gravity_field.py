"""The check case ``gravity_field`` passes, and fails for each of these planted errors, which change what
flies and not what is expected:

* harmonics cut off at degree 3
* J2 wrong in the sixth digit
"""

from __future__ import annotations

import pytest

from edl6dof.verify.cases import gravity_field

PLANTED = [
    pytest.param(["planet.gravity.degree=3"], "degree 4", id="degree", marks=pytest.mark.long),
    pytest.param(["planet.gravity.j2=1.956617e-03"], "J2", id="j2"),
]


def test_passes():
    assert gravity_field.run().passed


@pytest.mark.parametrize(("planted", "quantity"), PLANTED)
def test_planted_error_is_caught(planted, quantity):
    caught = [result.quantity for result in gravity_field.run(planted).results if not result.passed]
    assert any(quantity in name for name in caught), caught
