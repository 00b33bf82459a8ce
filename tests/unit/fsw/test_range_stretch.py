"""Range stretched where the smallest bank angle ends short: what is flown in its place, and what it buys."""

from math import cos, pi, radians, sin

import numpy as np
import pytest

import edl6dof
from edl6dof.fsw.guidance.entry.predictor import held, linear, planned_bank, predict
from edl6dof.fsw.guidance.entry.reach import straight_bank, stretched
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.navigation.derived import NAV

ENTRY = "flight_software.guidance.entry"
LEAST = radians(15.0)
TURNS = 2700.0, 1500.0


@pytest.fixture
def entry_at(onboard):
    """``(onboard, nav, out)`` of Tianwen-1 on its way 40 km up, the aim point ``farther_km`` farther away
    than the smallest bank angle with its reversals leads.
    """

    def there(farther_km):
        record, nav, out = onboard[0].copy(), np.zeros(1, NAV)[0], np.zeros(1, GUIDE)[0]
        nav["latitude"], nav["longitude"], nav["altitude"] = radians(31.0), radians(109.93), 40e3
        gamma, psi = radians(-8.0), pi
        nav["speed"], nav["bank"] = 4500.0, LEAST
        nav["v_N"] = 4500.0 * np.array([cos(gamma) * cos(psi), cos(gamma) * sin(psi), -sin(gamma)])
        out["drag_ratio"] = out["lift_ratio"] = 1.0
        record["guidance"]["entry"]["bank_min"] = LEAST
        for _ in range(3):
            reach = predict(record, nav, out, linear(LEAST, LEAST, 4500.0, 1.0, *TURNS))[0]
            record["site"]["aim_latitude"] -= (reach + 1e3 * farther_km) / record["planet"][
                "equatorial_radius"
            ]
        return record, nav, out

    return there


def test_held_bank_angle_has_a_sign_and_no_smallest_magnitude(onboard):
    onboard[0]["guidance"]["entry"]["bank_min"] = LEAST
    for bank in (0.1, -0.1, 0.0, -1.2):
        assert planned_bank(onboard[0], held(bank), 3000.0) == bank


def test_straight_bank_angle_takes_out_crossrange_and_flies_farther_than_the_smallest(entry_at):
    record, nav, out = entry_at(0.0)
    straight = straight_bank(record, nav, out)
    down, aside, _, _ = predict(record, nav, out, held(straight))
    right, left = (predict(record, nav, out, held(bank)) for bank in (LEAST, -LEAST))
    assert abs(straight) < LEAST
    assert abs(aside) < 0.05 * (right[1] - left[1])
    assert down > max(right[0], left[0]) + 1e3


def test_smallest_bank_is_kept_in_reach_and_let_go_by_the_reserve_of_range(entry_at):
    """All of it where the reserve is what letting go buys, nothing where the smallest ends short."""
    banks = {}
    for farther_km in (-40.0, -2.0, 0.5, 40.0):
        record, nav, out = entry_at(farther_km)
        banks[farther_km] = stretched(record, nav, out, 1.0, *TURNS)
    assert banks[-40.0] == pytest.approx(LEAST)
    record, nav, out = entry_at(40.0)
    assert banks[40.0] == straight_bank(record, nav, out)
    assert abs(banks[0.5]) < abs(banks[-2.0]) < LEAST


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_reserve_of_range_keeps_the_side_of_the_smallest_bank(entry_at, side):
    record, nav, out = entry_at(-40.0)
    assert stretched(record, nav, out, side, *TURNS) == pytest.approx(side * LEAST)


def test_steep_entry_in_dense_air_comes_within_reach_by_letting_the_smallest_bank_go():
    """On instruments: 15 deg to one side and the other spends 5 km of range."""
    truth = "truth={initial.flight_path_angle_deg: -11.9, atmosphere.density_factor: 1.09}"
    own = [f"{ENTRY}.law=fnpeg", f"{ENTRY}.reversal.logic=own_sign", "mission.goal=deployment", truth]
    kept = edl6dof.fly("tianwen1", [*own, f"{ENTRY}.fnpeg.stretch=false"])
    let_go = edl6dof.fly("tianwen1", own)
    assert kept.figures["parachute_downrange_m"] < -4e3
    assert let_go.figures["parachute_miss_m"] < 2e3
