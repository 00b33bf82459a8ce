"""The check case ``capsule_trim`` passes, and fails for each of these planted errors, which change what flies
and not what is expected:

* centre of mass 0.1 mm too far off the axis
* static moment 1 % too large
* moment of inertia 0.5 % too large
"""

from __future__ import annotations

import pytest

from edl6dof.verify.cases import capsule_trim

PLANTED = [
    pytest.param(["vehicle.mass.entry_centre_m=[-0.85, 0, -0.0391]"], "trim angle", id="offset"),
    pytest.param(
        ["vehicle.aero.capsule.moment_factor=1.01"], "pitch frequency", id="moment", marks=pytest.mark.long
    ),
    pytest.param(
        ["vehicle.mass.entry_inertia_kg_m2=[1150, 904.5, 950]"],
        "pitch frequency",
        id="inertia",
        marks=pytest.mark.long,
    ),
]


def test_passes():
    assert capsule_trim.run().passed


@pytest.mark.parametrize(("planted", "quantity"), PLANTED)
def test_planted_error_is_caught(planted, quantity):
    caught = [result.quantity for result in capsule_trim.run(planted).results if not result.passed]
    assert any(quantity in name for name in caught), caught
