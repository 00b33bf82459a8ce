"""Compiled and plain Python agree bit for bit over half a second of flight in each kind of phase, flight
software included.

Exempt is the integrator's scratch.

Started from saved states: coasting, in lift, while the parachute inflates, below it, right after ignition,
hovering.  Planted error: a roll rate one bit off in the state that is started from shows in the comparison.
"""

from __future__ import annotations

import numpy as np
import pytest
from plain_python import differing, fly_cycles, in_plain_python, setting

import edl6dof
from edl6dof.sim.flight import fly

CYCLES = 25


@pytest.fixture(scope="module")
def loaded():
    return edl6dof.load("tianwen1")


@pytest.mark.parametrize(
    "t",
    [
        pytest.param(281.0, marks=pytest.mark.long),
        500.0,
        *(pytest.param(t, marks=pytest.mark.long) for t in (20.0, 150.0, 420.0, 449.0)),
    ],
)
def test_compiled_and_plain_python_agree_bit_for_bit(loaded, t):
    state = fly(loaded, save_at_s=t).saved
    compiled = fly_cycles(setting(loaded, state), CYCLES)
    plain = in_plain_python(setting(loaded, state), "fly_cycles", CYCLES)
    assert len(compiled["log"]) == len(plain["log"]) == CYCLES
    assert {name: differing(compiled[name], plain[name]) for name in compiled} == dict.fromkeys(compiled, [])


@pytest.mark.long
def test_point_mass_agrees_too():
    loaded = edl6dof.load("zheng2015")
    state = fly(loaded, save_at_s=90.0).saved
    compiled, plain = (
        fly_cycles(setting(loaded, state), CYCLES),
        in_plain_python(setting(loaded, state), "fly_cycles", CYCLES),
    )
    assert {name: differing(compiled[name], plain[name]) for name in compiled} == dict.fromkeys(compiled, [])


def test_one_bit_of_difference_is_caught(loaded):
    state = fly(loaded, save_at_s=150.0).saved
    compiled, other = fly_cycles(setting(loaded, state), 2), setting(loaded, state)
    rates = other.arrays["plant"]["y"]
    rates[0, 10] = np.nextafter(rates[0, 10], 1.0)
    assert "y" in differing(compiled["plant"], fly_cycles(other, 2)["plant"])
