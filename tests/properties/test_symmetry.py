"""Symmetries of the physics: the planet turned about its axis turns the answer, and a mirror mirrors the
flight.

Turning: gravity J2, winds and air depend on latitude and height only, so a start at another longitude flies
the same flight there.  The
parachute stays packed: its snatch magnifies rounding (1e-9 m) up to a metre in a wild deployment, too much
for a tolerance of 1e-6 m.
Mirroring in the plane of the pole and longitude 0: a mirror image of a planet turns the other way, so the
rotation rate changes sign with longitude, azimuth, bank, sideslip, roll and yaw rate, wind towards east, and
every lateral offset of masses and bridle.  Every operation has its mirror image, so even the roundings agree
and the answer is exact, parachute and all.  The thrusters stay shut; their layout is mirrored by pairs and
not exactly (F1 to F4).
Planted error: in the mirror the rotation of the planet is left as it was; in the turn the wind changes.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from symmetry import apart, end_state, scene

from edl6dof.vehicle.plant import ATTITUDE, CANOPY_POSITION, CANOPY_VELOCITY, POSITION, RATE, VELOCITY

LIMITS = settings(max_examples=10, deadline=None, derandomize=True)
DRAWN = (st.floats(-60, 60), st.floats(-170, 170), st.floats(-170, 170), st.floats(-80, 80), st.floats(-5, 5))
RATES = (st.floats(-5, 5), st.floats(-5, 5), st.floats(-20, 20))
ONE = (25.0, 40.0, 70.0, 30.0, 3.0, 4.0, -2.0, 10.0)


def turned(y, angle_deg):
    turn = Rotation.from_euler("z", angle_deg, degrees=True)
    out = y.copy()
    for k in (POSITION, VELOCITY, CANOPY_POSITION, CANOPY_VELOCITY):
        out[k : k + 3] = turn.apply(y[k : k + 3])
    out[6:10] = (turn * Rotation.from_quat(y[6:10], scalar_first=True)).as_quat(scalar_first=True)
    return out


def mirrored(y):
    out = y.copy()
    out[[POSITION + 1, VELOCITY + 1, CANOPY_POSITION + 1, CANOPY_VELOCITY + 1]] *= -1.0
    out[[ATTITUDE + 1, ATTITUDE + 3, RATE, RATE + 2]] *= -1.0
    return out


@LIMITS
@given(*DRAWN, *RATES, st.floats(-180, 180))
def test_turning_the_planet_turns_the_flight(latitude, longitude, azimuth, bank, beta, p, r, east, angle):
    given_scene = (azimuth, bank, beta, p, r, east)
    there = np.remainder(longitude + angle + 180.0, 360.0) - 180.0
    first, second = (
        end_state(scene(latitude, x, *given_scene), parachute=False) for x in (longitude, float(there))
    )
    assert apart(turned(first, there - longitude), second) < 1e-6


@pytest.mark.exact_start  # the nudge has no mirror image
@LIMITS
@given(*DRAWN, *RATES)
def test_a_mirror_mirrors_the_flight(latitude, longitude, azimuth, bank, beta, p, r, east):
    values = (latitude, longitude, azimuth, bank, beta, p, r, east)
    assert apart(mirrored(end_state(scene(*values))), end_state(scene(*values, side=-1.0))) < 1e-9


def test_planted_errors_are_caught():
    first = end_state(scene(*ONE))
    wrong_spin = end_state(scene(*ONE, side=-1.0, spin=-7.088218066304e-05))
    assert apart(mirrored(first), wrong_spin) > 1.0
    calm, other_wind = (
        end_state(s, parachute=False) for s in (scene(*ONE), scene(25.0, 50.0, *ONE[2:7], 10.001))
    )
    assert apart(turned(calm, 10.0), other_wind) > 1e-4


def test_the_comparison_itself_is_exact():
    y = end_state(scene(*ONE))
    assert apart(mirrored(mirrored(y)), y) == 0.0
    assert apart(turned(turned(y, 30.0), -30.0), y) == pytest.approx(0.0, abs=1e-8)
