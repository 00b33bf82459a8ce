"""Reversals at slow bank rates: the range that rolling through lift up adds is known before it is flown."""

import json
from itertools import product

import pytest

import edl6dof

ENTRY = "flight_software.guidance.entry"


def flown(rate_deg_s, law, *overrides):
    """Figures of the entry of Zheng & Cui with a bank angle that turns at a rate, down to its end."""
    sets = [
        "mission.goal=deployment",
        "point_mass.bank_response=rate_limited",
        f"point_mass.bank_rate_deg_s={rate_deg_s}",
        f"{ENTRY}.bank_rate_deg_s={rate_deg_s}",
        f"{ENTRY}.law={law}",
    ]
    return edl6dof.fly("zheng2015", [*sets, *overrides]).figures


def miss_of_one_reversal(rate_deg_s, speed):
    """Miss (km) at the largest bank angle all the way, with one reversal at ``speed`` (m/s)."""
    points = [{"at": speed - 1.0, "bank_deg": -90.0}, {"at": speed + 1.0, "bank_deg": 90.0}]
    sets = [f"{ENTRY}.reversal.logic=own_sign", f"{ENTRY}.bank_profile={json.dumps({'points': points})}"]
    return flown(rate_deg_s, "bank_profile", *sets)["parachute_miss_m"] / 1e3


@pytest.fixture(scope="module")
def floor():
    """Least miss (km) of all flights with one reversal at 5 deg/s."""
    return min(miss_of_one_reversal(5.0, speed) for speed in range(4400, 5801, 200))


def test_one_slow_reversal_at_the_largest_bank_ends_beyond_the_aim_point(floor):
    assert floor > 10.0


@pytest.mark.parametrize(
    "law",
    [
        "drag_tracking",
        "ehgo_fl",
        *(pytest.param(law, marks=pytest.mark.long) for law in ("npc", "etpc", "fl")),
    ],
)
def test_a_slow_bank_angle_ends_near_what_one_reversal_can_reach(law, floor):
    """Two reversals, as the corridor alone asks for, end 40 km beyond the aim point."""
    assert flown(5.0, law)["parachute_miss_m"] / 1e3 < 1.2 * floor < 30.0


@pytest.mark.parametrize(
    "law", ["drag_tracking", *(pytest.param(law, marks=pytest.mark.long) for law in ("npc", "etpc"))]
)
def test_at_10_deg_s_the_aim_point_is_in_reach(law):
    assert flown(10.0, law)["parachute_miss_m"] < 4e3


def test_fnpeg_moves_its_reversal_to_where_range_and_crossrange_together_are_least(floor):
    """For crossrange alone it ends 24 km away, and with all three reversals 60 km."""
    own = f"{ENTRY}.reversal.logic=own_sign"
    assert flown(5.0, "fnpeg", own)["parachute_miss_m"] / 1e3 < 1.1 * floor < 24.0
    assert flown(7.0, "fnpeg", own)["parachute_miss_m"] < 2e3


@pytest.mark.long
def test_at_5_deg_s_the_aim_point_of_yan2016_is_out_of_reach():
    """Why ``fnpeg`` misses it: flights around the nearest one that a search among 240 found, 5.9 km away."""
    rate = ["point_mass.bank_rate_deg_s=5.0", f"{ENTRY}.bank_rate_deg_s=5.0"]
    sets = ["mission.goal=deployment", "point_mass.bank_response=rate_limited", *rate]
    sets += [f"{ENTRY}.reversal.logic=own_sign", f"{ENTRY}.law=bank_profile"]
    misses = []
    for first, speed in product((155.0, 170.0), (5600.0, 5654.0)):
        points = [{"at": speed - 1.0, "bank_deg": -110.0}, {"at": speed + 1.0, "bank_deg": first}]
        own = f"{ENTRY}.bank_profile={json.dumps({'points': points})}"
        misses.append(edl6dof.fly("yan2016", [*sets, own]).figures["parachute_miss_m"])
    assert 5.5e3 < min(misses) < 7e3
