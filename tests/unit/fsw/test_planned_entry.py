"""The planned entry against an independently integrated flight at its commanded bank angles, and against its
limits.
"""

from math import asin, atan2, cos, exp, radians, sin, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from edl6dof.fsw.guidance.entry.airframe import mach_nodes
from edl6dof.fsw.guidance.entry.reference import reference_bank
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.planned_entry import planned_again
from edl6dof.scenario.records import build_onboard
from edl6dof.scenario.schema import start_of

ENTRY = "flight_software.guidance.entry"
FITTED = f"{ENTRY}.reference_bank.fit_range=true"


def ellipsoid(planet, r):
    """Geodetic latitude, longitude and height by fixed-point iteration (not the product's)."""
    a, e2 = float(planet["equatorial_radius"]), float(planet["flattening"] * (2.0 - planet["flattening"]))
    p, latitude = np.hypot(r[0], r[1]), atan2(r[2], np.hypot(r[0], r[1]))
    for _ in range(8):
        prime = a / sqrt(1.0 - e2 * sin(latitude) ** 2)
        latitude = atan2(r[2] + e2 * prime * sin(latitude), p)
    return latitude, atan2(r[1], r[0]), p / cos(latitude) - prime


def cross(a, b):
    """Cross product, ten times as fast as numpy's for many arrays."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def flown(record, start, rows):
    """Vinh, Busemann & Culp 1980, chapter 2, with J2 and wind, in the inertial frame, by RK45, rolling at
    the bank rate to each commanded bank angle of the plan.
    """
    planet, vehicle, air = record["planet"], record["vehicle"], record["atmosphere"]
    nodes = air["bottom"] + air["spacing"] * np.arange(len(air["ln_density"]))
    table, logs = vehicle["airframe"], np.log(mach_nodes())
    mu, spin, j2, size0 = (float(planet[name]) for name in ("mu", "rotation_rate", "j2", "gravity_radius"))

    def rates(t, s, begun, before, goal):
        bank = before + np.clip(goal - before, -roll * (t - begun), roll * (t - begun))
        r, v = s[:3], s[3:]
        omega = np.array([0.0, 0.0, spin])
        relative = v - cross(omega, r)
        turned = spin * t
        back = np.array([[cos(turned), sin(turned), 0.0], [-sin(turned), cos(turned), 0.0], [0.0, 0.0, 1.0]])
        lat, lon, height = ellipsoid(planet, back @ r)
        north = back.T @ np.array([-sin(lat) * cos(lon), -sin(lat) * sin(lon), cos(lat)])
        east = back.T @ np.array([-sin(lon), cos(lon), 0.0])
        wind = (
            np.interp(height, nodes, air["wind_north"]) * north
            + np.interp(height, nodes, air["wind_east"]) * east
        )
        u = relative - wind
        speed = np.linalg.norm(u)
        mach = np.linalg.norm(relative) / np.interp(height, nodes, air["speed_of_sound"])
        closed = mach >= table["wing_mach"] and np.linalg.norm(relative) >= table["wing_speed"]
        area = vehicle["drag_area"] * np.interp(
            np.log(mach), logs, table["drag" if closed else "drag_with_wing"]
        )
        ratio = vehicle["lift_to_drag"] * np.interp(np.log(mach), logs, table["lift"]) if closed else 0.0
        drag = (
            0.5 * exp(np.interp(height, nodes, air["ln_density"])) * speed**2 * area / vehicle["entry_mass"]
        )
        along = u / speed
        right = cross(along, r)
        right /= np.linalg.norm(right)
        lift = ratio * drag * (cos(bank) * cross(right, along) + sin(bank) * right)
        size = np.linalg.norm(r)
        k = 1.5 * j2 * (size0 / size) ** 2
        s2 = (r[2] / size) ** 2
        gravity = -mu / size**3 * r * np.array([1.0 + k * (1 - 5 * s2)] * 2 + [1.0 + k * (3 - 5 * s2)])
        return np.concatenate([v, gravity + lift - drag * along])

    r, v = np.array(start[:3]), np.array(start[3:])
    s = np.concatenate([r, v + cross([0.0, 0.0, spin], r)])
    bank, roll = 0.0, float(record["guidance"]["entry"]["bank_rate"])
    for here, after in zip(rows, rows[1:], strict=False):
        span, goal = (here["t"], after["t"]), here["bank"]
        s = solve_ivp(rates, span, s, args=(span[0], bank, goal), rtol=1e-6, atol=1e-2).y[:, -1]
        most = roll * (span[1] - span[0])
        bank += np.clip(goal - bank, -most, most)
    turned = -spin * rows["t"][-1]
    back = np.array([[cos(turned), -sin(turned), 0.0], [sin(turned), cos(turned), 0.0], [0.0, 0.0, 1.0]])
    return back @ s[:3]


@pytest.mark.parametrize("name", ["tianwen1", pytest.param("msl", marks=pytest.mark.long)])
def test_plan_is_the_flight_of_independent_equations(name):
    scenario = load_scenario(name).scenario
    onboard = build_onboard(scenario)
    start = start_of(scenario)
    rows = planned_again(onboard, scenario)
    record, planet = onboard[0], onboard[0]["planet"]
    r = flown(record, start, rows)
    _, _, height = ellipsoid(planet, r)
    site = record["site"]
    squeeze = (1.0 - float(planet["flattening"])) ** 2
    lat, lon = float(site["aim_latitude"]), float(site["aim_longitude"])
    target = np.array([cos(lat) * cos(lon), cos(lat) * sin(lon), squeeze * sin(lat)])
    target, here, there = (x / np.linalg.norm(x) for x in (target, np.array(start[:3]), r))
    ahead = target - (target @ here) * here
    ahead /= np.linalg.norm(ahead)
    radius = float(planet["equatorial_radius"])
    beyond = radius * (atan2(there @ ahead, there @ here) - atan2(target @ ahead, target @ here))
    assert beyond == pytest.approx(rows["beyond"][-1], abs=30.0)
    assert radius * asin(there @ cross(ahead, here)) == pytest.approx(rows["aside"][-1], abs=30.0)
    assert height == pytest.approx(rows["altitude"][-1], abs=20.0)


@pytest.mark.parametrize(
    "name",
    [
        "tianwen1",
        pytest.param("msl", marks=pytest.mark.long),
        pytest.param("zheng2015", marks=pytest.mark.long),
    ],
)
def test_plan_ends_at_the_aim_point_at_the_speed_of_the_mission(name):
    scenario = load_scenario(name, [FITTED]).scenario
    onboard = build_onboard(scenario)
    rows = planned_again(onboard, scenario)
    entry = scenario.flight_software.guidance.entry
    assert abs(rows["beyond"][-1]) < 20.0 and abs(rows["aside"][-1]) < 1000.0
    assert rows["speed"][-1] == pytest.approx(entry.final_speed_m_s, abs=10.0)


def test_plan_banks_as_the_steering_does(scenario, planned_rows):
    """Inside the limits, at the bank rate through zero, level below the alignment speed."""
    entry = scenario.flight_software.guidance.entry
    steered = (planned_rows["side"] != 0.0) & (planned_rows["speed"] > entry.align_speed_m_s + 5.0)
    t, bank = planned_rows["t"], np.degrees(planned_rows["bank"])
    assert np.max(np.abs(np.diff(bank[planned_rows["side"] != 0.0]))) <= entry.bank_rate_deg_s * 0.2 + 1e-9
    assert np.max(np.abs(bank[steered])) <= entry.bank_max_deg
    reversals = np.flatnonzero(np.diff(planned_rows["side"][steered]))
    assert len(reversals) >= 3
    rolling = np.abs(bank[steered]) < entry.bank_min_deg - 1e-9
    assert 0.0 < np.sum(np.diff(t[steered])[rolling[1:]]) < 2.5 * len(reversals)
    assert np.all(bank[planned_rows["speed"] < entry.align_speed_m_s - 40.0] == 0.0)


def test_slower_banking_costs_the_plan_lift_that_it_makes_up_for():
    """Rolling through zero bank lifts; at 3 deg/s a reversal takes so long that the plan banks more."""
    slow = build_onboard(load_scenario("tianwen1", [FITTED, f"{ENTRY}.bank_rate_deg_s=3"]).scenario)
    usual = build_onboard(load_scenario("tianwen1", [FITTED]).scenario)
    banks = [reference_bank(o[0], float(o[0]["reference"]["shift"]), 3000.0) for o in (slow, usual)]
    assert banks[0] > banks[1] + radians(1.0)


@pytest.mark.parametrize("degrees_back, bound", [(4.0, "bank_min"), (-6.0, "bank_max")])
def test_out_of_reach_the_plan_goes_to_the_nearer_limit(degrees_back, bound):
    """Tianwen-1 flies south: with an entry farther north all lift is too little, farther south too much."""
    scenario = load_scenario("tianwen1", [FITTED, f"initial.latitude_deg={37.953 + degrees_back}"]).scenario
    record = build_onboard(scenario)[0]
    bank = reference_bank(record, float(record["reference"]["shift"]), 3000.0)
    assert bank == pytest.approx(float(record["guidance"]["entry"][bound]), abs=1e-9)
