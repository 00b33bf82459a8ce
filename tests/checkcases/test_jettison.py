"""The check case ``jettison`` passes, and fails for each of these planted errors, which change what flies and
not what is expected:

* heat shield 10 mg heavier than its momentum counts
* inertia of the backshell 1 g m2 larger
* a little gravity
"""

from __future__ import annotations

import pytest

from edl6dof.verify.cases import jettison

PLANTED = [
    pytest.param(["vehicle.parts.heat_shield.mass_kg=150.00001"], "heat shield", id="mass"),
    pytest.param(
        ["vehicle.parts.backshell.inertia_kg_m2=[190.001, 115, 115]"],
        "backshell",
        id="inertia",
        marks=pytest.mark.long,
    ),
    pytest.param(
        ["planet.gravity.model=central", "planet.gravity.mu_m3_s2=100"],
        "mortar",
        id="gravity",
        marks=pytest.mark.long,
    ),
]


@pytest.mark.exact_start  # its tolerances are below a millimetre
def test_passes():
    assert jettison.run().passed


@pytest.mark.parametrize(("planted", "quantity"), PLANTED)
def test_planted_error_is_caught(planted, quantity):
    caught = [result.quantity for result in jettison.run(planted).results if not result.passed]
    assert any(quantity in name for name in caught), caught
