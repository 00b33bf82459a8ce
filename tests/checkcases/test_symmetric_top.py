"""The check case ``symmetric_top`` passes, and fails for each of these planted errors, which change what
flies and not what is expected:

* moment of inertia about x 10 g m2 too large
* moment of inertia about y 10 g m2 too large
"""

from __future__ import annotations

import pytest

from edl6dof.verify.cases import symmetric_top

PLANTED = [
    pytest.param(["vehicle.mass.entry_inertia_kg_m2=[1150.01, 900, 900]"], "rate in the body", id="inertia"),
    pytest.param(
        ["vehicle.mass.entry_inertia_kg_m2=[1150, 900.01, 900]"],
        "rate in space",
        id="asymmetry",
        marks=pytest.mark.long,
    ),
]


def test_passes():
    assert symmetric_top.run().passed


@pytest.mark.parametrize(("planted", "quantity"), PLANTED)
def test_planted_error_is_caught(planted, quantity):
    caught = [result.quantity for result in symmetric_top.run(planted).results if not result.passed]
    assert any(quantity in name for name in caught), caught
