"""The check case ``terminal_velocity`` passes, and fails for each of these planted errors in what flies, not
in what is expected:

* drag of the canopy 0.1 % too large
* canopy 0.2 kg too heavy
"""

from __future__ import annotations

import pytest

from edl6dof.verify.cases import terminal_velocity

PLANTED = [
    pytest.param(["vehicle.parachutes.main.drag_factor=1.001"], "speed", id="drag"),
    pytest.param(
        [
            "vehicle.parts.parachute_pack.mass_kg=38.2",
            "vehicle.mass.entry_kg=1100.2",
        ],
        "speed",
        id="weight",
        marks=pytest.mark.long,
    ),
]


def test_passes():
    assert terminal_velocity.run().passed


@pytest.mark.parametrize(("planted", "quantity"), PLANTED)
def test_planted_error_is_caught(planted, quantity):
    caught = [result.quantity for result in terminal_velocity.run(planted).results if not result.passed]
    assert any(quantity in name for name in caught), caught
