"""FNPEG: its bank plan, the convergence of its corrections, the time that a reversal takes, and the limits it
keeps.
"""

from math import cos, degrees, pi, radians, sin

import numpy as np
import pytest

import edl6dof
from edl6dof.fsw.guidance.entry.energy_plan import (
    ENERGY_PLAN,
    bank_plan,
    correct,
    correct_turn,
    ends,
    reverse_when_due,
    start,
    within_limits,
)
from edl6dof.fsw.guidance.entry.predictor import linear, planned_bank, predict, shifted
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.navigation.derived import NAV

ENTRY = "flight_software.guidance.entry"
OWN = [f"{ENTRY}.law=fnpeg", f"{ENTRY}.reversal.logic=own_sign"]


def on_the_way(bank_deg=50.0, off_deg=0.0):
    """65 km up, 420 km before the aim point of Tianwen-1, heading ``off_deg`` to the right of south."""
    nav = np.zeros(1, NAV)[0]
    nav["latitude"], nav["longitude"], nav["altitude"] = radians(32.2), radians(109.9), 65e3
    gamma, psi = radians(-9.3), radians(180.0 + off_deg)
    nav["speed"], nav["drag"], nav["bank"] = 4820.0, 0.5, radians(bank_deg)
    nav["v_N"] = 4820.0 * np.array([cos(gamma) * cos(psi), cos(gamma) * sin(psi), -sin(gamma)])
    nav["flight_path_angle"] = gamma
    return nav


def as_believed():
    out = np.zeros(1, GUIDE)[0]
    out["drag_ratio"] = out["lift_ratio"] = 1.0
    return out


def test_plan_is_linear_in_energy_and_changes_side_at_each_reversal(onboard):
    record = onboard[0]
    entry = record["guidance"]["entry"]
    entry["bank_min"], entry["bank_max"], entry["final_speed"] = 0.0, pi, 400.0
    plan = linear(1.2, 0.4, 4000.0, -1.0, 3000.0, 1000.0)
    assert planned_bank(record, plan, 4000.0) == pytest.approx(-1.2)
    middle = np.sqrt(0.5 * (4000.0**2 + 400.0**2))
    assert planned_bank(record, plan, middle) == pytest.approx(0.8)
    assert planned_bank(record, plan, 1000.5) > 0.0 > planned_bank(record, plan, 999.5)
    assert planned_bank(record, plan, 300.0) == pytest.approx(-0.4)
    entry["bank_max"] = 1.0
    assert planned_bank(record, plan, 4000.0) == pytest.approx(-1.0)


def test_corrections_end_at_the_aim_point_in_range_and_crossrange(onboard):
    """From a first guess tens of kilometres off, within a second's worth of calls, to the tolerance."""
    record, nav, out, memory = onboard[0], on_the_way(), as_believed(), np.zeros(1, ENERGY_PLAN)[0]
    params = record["guidance"]["entry"]["fnpeg"]
    out["crossrange"] = 1.0
    start(params, record, nav, memory, out, record["guidance"]["entry"]["align_speed"])
    first = ends(params, record, nav, memory, out, memory["bank"], memory["turn"])
    for _ in range(8):
        correct(params, record, nav, memory, out, record["guidance"]["entry"]["align_speed"])
    down, aside = ends(params, record, nav, memory, out, memory["bank"], memory["turn"])
    assert max(abs(x) for x in first) > 5e3
    assert abs(down) < params["tolerance"] and abs(aside) < params["tolerance"]


def test_bank_beyond_the_largest_raises_the_last_one(onboard):
    """So a plan that asks for more than the limit is flown at the limit for longer, and is predicted so."""
    record, nav, memory = onboard[0], on_the_way(), np.zeros(1, ENERGY_PLAN)[0]
    entry = record["guidance"]["entry"]
    params, most = entry["fnpeg"], entry["bank_max"]
    memory["side"] = 1.0
    for bank, now, last in ((1.0, 1.0, 0.0), (most, most, 0.0), (most + 0.3, most, 0.3)):
        plan = bank_plan(params, record, nav, memory, bank, 0.0)
        assert planned_bank(record, plan, nav["speed"]) == pytest.approx(now)
        end = min(params["last_bank"] + last, most)
        assert planned_bank(record, plan, entry["final_speed"]) == pytest.approx(end)


def test_out_of_reach_the_reversal_takes_both_misses_into_account(onboard):
    """Rolling at 5 deg/s to an aim point 60 km too near: reversed sooner or later it ends farther."""
    record, nav, out, memory = onboard[0], on_the_way(60.0), as_believed(), np.zeros(1, ENERGY_PLAN)[0]
    record["site"]["aim_latitude"] += 60e3 / record["planet"]["equatorial_radius"]
    entry = record["guidance"]["entry"]
    params, slowest = entry["fnpeg"], float(entry["align_speed"])
    entry["bank_rate"], entry["bank_max"] = radians(5.0), radians(90.0)
    out["crossrange"] = 1.0
    start(params, record, nav, memory, out, slowest)
    for _ in range(20):
        correct(params, record, nav, memory, out, slowest)
    assert memory["left"] == 1 and memory["miss"] > params["tolerance"]
    turns = memory["turn"] + np.linspace(-600.0, 600.0, 13)
    around = [np.hypot(*ends(params, record, nav, memory, out, memory["bank"], turn)) for turn in turns]
    here = np.hypot(memory["miss"], memory["aside"])
    assert here < 1.001 * min(around)
    assert here < 0.99 * min(around[0], around[-1])
    assert abs(memory["aside"]) > 1e3  # range and crossrange are bought from each other


def low_and_slow(aside_deg):
    """25 km up, 90 km before the aim point of Tianwen-1, heading ``aside_deg`` to the right of south."""
    nav = on_the_way(40.0)
    nav["latitude"], nav["altitude"], nav["speed"], nav["drag"] = radians(26.9), 25e3, 1140.0, 10.0
    gamma, psi = radians(-1.5), radians(180.0 + aside_deg)
    nav["v_N"] = 1140.0 * np.array([cos(gamma) * cos(psi), cos(gamma) * sin(psi), -sin(gamma)])
    return nav


@pytest.mark.parametrize("aside_deg", [-1.0, -0.5, 0.0, 0.5, 1.0])
def test_correction_of_a_reversal_brings_the_predicted_end_no_farther_aside(onboard, aside_deg):
    """Low down a late reversal does little: by its slope alone the last one would be made at once."""
    record, nav, out, memory = onboard[0], low_and_slow(aside_deg), as_believed(), np.zeros(1, ENERGY_PLAN)[0]
    params = record["guidance"]["entry"]["fnpeg"]
    slowest = float(record["guidance"]["entry"]["align_speed"])
    for side in (1.0, -1.0):
        for turn in (slowest, 800.0, 1000.0, 1140.0):
            memory["side"], memory["turn"], memory["bank"], memory["left"] = side, turn, radians(40.0), 1
            before = ends(params, record, nav, memory, out, memory["bank"], turn)
            memory["miss"], memory["aside"] = before
            correct_turn(params, record, nav, memory, out, slowest)
            after = ends(params, record, nav, memory, out, memory["bank"], memory["turn"])
            assert abs(after[1]) <= abs(before[1])
            assert memory["turn"] >= slowest


def test_next_reversal_stays_where_it_was_foreseen_and_where_it_still_does_something(onboard):
    record, nav, memory = onboard[0], low_and_slow(0.0), np.zeros(1, ENERGY_PLAN)[0]
    params = record["guidance"]["entry"]["fnpeg"]
    memory["side"], memory["left"], memory["turn"], memory["later"] = 1.0, 2, 1150.0, 990.0
    reverse_when_due(params, nav, memory, 660.0)
    assert (memory["side"], memory["left"], memory["turn"], memory["later"]) == (-1.0, 1, 990.0, 0.0)
    memory["left"], memory["turn"], memory["later"] = 2, 1150.0, 630.0
    reverse_when_due(params, nav, memory, 660.0)
    assert memory["turn"] == 660.0
    memory["left"], memory["turn"], memory["later"] = (
        3,
        1150.0,
        990.0,
    )  # later: in proportion
    reverse_when_due(params, nav, memory, 660.0)
    assert (memory["turn"], memory["later"]) == (990.0, params["spacing"] * 990.0)
    memory["left"], memory["turn"], memory["later"] = 1, 1150.0, 0.0
    reverse_when_due(params, nav, memory, 660.0)
    assert memory["turn"] == 0.0


def test_slow_reversal_is_predicted_to_fly_farther(onboard):
    """Through zero bank the lift points up: the slower the roll, the longer the range, smoothly."""
    record, nav, out = onboard[0], on_the_way(70.0), as_believed()
    record["guidance"]["entry"]["bank_max"] = pi
    plan = shifted(0.35, 1.0, 3500.0, 0.0)
    reached = []
    for rate in (1e4, 40.0, 20.0, 10.0, 5.0):
        record["guidance"]["entry"]["bank_rate"] = radians(rate)
        reached.append(predict(record, nav, out, plan)[0])
    assert np.all(np.diff(reached) > 0.0)
    assert reached[-1] - reached[0] > 5e3


def test_bank_is_left_alone_far_from_the_limits_and_lift_goes_up_at_them(onboard):
    record, nav = onboard[0], on_the_way()
    limits, params = record["guidance"]["entry"]["limits"], record["guidance"]["entry"]["fnpeg"]
    nav["drag"], nav["lift"], nav["gravity"], nav["altitude"] = 80.0, 12.0, 3.7, 30e3
    limits["load"], limits["heat_rate"] = 1e4, 1e12
    assert within_limits(params, record, nav, -1.1) == -1.1
    limits["load"] = 80.0
    held = within_limits(params, record, nav, -1.1)
    assert -1.1 < held <= 0.0


# ---- closed loop -------------------------------------------------------------------------------------------


def fly(*sets):
    return edl6dof.fly("zheng2015", [*OWN, *sets])


@pytest.mark.parametrize(
    "density", [pytest.param(0.85, marks=pytest.mark.long), pytest.param(1.0, marks=pytest.mark.long), 1.4]
)
def test_point_mass_ends_at_the_aim_point_in_any_air(density):
    flight = fly(f"truth={{atmosphere.density_factor: {density}}}")
    assert flight.success
    assert flight.figures["parachute_miss_m"] < 100.0


def test_load_keeps_its_limit_at_the_price_of_altitude():
    free = fly()
    held = fly(f"{ENTRY}.limits.load_g0=12", f"{ENTRY}.limits.margin=0")
    assert free.figures["peak_load_g0"] > 12.2
    assert held.figures["peak_load_g0"] < 12.0
    assert held.figures["parachute_miss_m"] < 1000.0


@pytest.mark.parametrize("rate, most_km", [pytest.param(20.0, 0.5, marks=pytest.mark.long), (10.0, 1.0)])
def test_slow_roll_is_foreseen(rate, most_km):
    """One reversal, begun early enough and made up for by the bank before and after it."""
    flight = fly(f"{ENTRY}.bank_rate_deg_s={rate}", f"{ENTRY}.fnpeg.reversals=1")
    assert flight.success
    assert flight.figures["parachute_miss_m"] < 1e3 * most_km
    bank = flight.telemetry["guide.bank_deg"]
    assert degrees(np.abs(np.diff(np.radians(bank[np.abs(bank) < 60.0]))).max()) < 1.0
