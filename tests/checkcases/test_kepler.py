"""The check case ``kepler`` passes, and fails for each of these planted errors, which change what flies and
not what is expected:

* gravitational parameter 1e-8 too large
* a trace of air: 1e-15 kg/m3 with a drag area of 9 m2
"""

from __future__ import annotations

import pytest

from edl6dof.verify.cases import kepler

PLANTED = [
    pytest.param(["planet.gravity.mu_m3_s2=4.28283732824714625e13"], "position", id="mu"),
    pytest.param(
        [
            "atmosphere.model=exponential",
            "atmosphere.exponential={density_kg_m3: 1e-15, scale_height_m: 1e15, temperature_k: 214}",
            "vehicle.aero.model=constant",
            "vehicle.aero.constant={drag_coefficient: 1, reference_area_m2: 9}",
        ],
        "position",
        id="drag",
        marks=pytest.mark.long,
    ),
]


def test_passes():
    assert kepler.run().passed


@pytest.mark.parametrize(("planted", "quantity"), PLANTED)
def test_planted_error_is_caught(planted, quantity):
    caught = [result.quantity for result in kepler.run(planted).results if not result.passed]
    assert any(quantity in name for name in caught), caught
