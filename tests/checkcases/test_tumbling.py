"""The check case ``tumbling`` passes, and fails for each of these planted errors, which change what flies and
not what is expected:

* moment of inertia about x 1 g m2 too large
* a trace of rate damping in a trace of air
"""

from __future__ import annotations

import pytest

from edl6dof.verify.cases import tumbling

PLANTED = [
    pytest.param(["vehicle.mass.entry_inertia_kg_m2=[1150.001, 900, 1000]"], "body rates", id="inertia"),
    pytest.param(
        [
            "atmosphere.model=exponential",
            "atmosphere.exponential={density_kg_m3: 1e-7, scale_height_m: 1e15, temperature_k: 214}",
            "vehicle.aero.model=constant",
            (
                "vehicle.aero.constant={roll_damping: -1, pitch_damping: -1, yaw_damping: -1, "
                "drag_coefficient: 0, reference_area_m2: 9, span_m: 3, chord_m: 3}"
            ),
            "wind.model=constant",
            "wind.constant.east_m_s=100",
        ],
        "energy",
        id="damping",
        marks=pytest.mark.long,
    ),
]


def test_passes():
    assert tumbling.run().passed


@pytest.mark.parametrize(("planted", "quantity"), PLANTED)
def test_planted_error_is_caught(planted, quantity):
    caught = [result.quantity for result in tumbling.run(planted).results if not result.passed]
    assert any(quantity in name for name in caught), caught
