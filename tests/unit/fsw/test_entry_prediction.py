"""The onboard prediction against Vinh's equations in spherical coordinates, and what the corrector makes of
it.
"""

from math import acos, asin, atan2, cos, degrees, exp, radians, sin, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from edl6dof.fsw.guidance.entry.laws.npc import MEMORY as NPC_MEMORY
from edl6dof.fsw.guidance.entry.laws.npc import PLAN, miss_of, next_turns, solve
from edl6dof.fsw.guidance.entry.predictor import in_plane_shifted, predict, shifted
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.navigation.derived import NAV


def out_record(drag_ratio=1.0, lift_ratio=1.0):
    out = np.zeros(1, GUIDE)[0]
    out["drag_ratio"], out["lift_ratio"] = drag_ratio, lift_ratio
    return out


def state(latitude_deg, longitude_deg, altitude, speed, gamma_deg, azimuth_deg, bank_deg=0.0):
    nav = np.zeros(1, NAV)[0]
    nav["latitude"], nav["longitude"], nav["altitude"] = (
        radians(latitude_deg),
        radians(longitude_deg),
        altitude,
    )
    gamma, psi = radians(gamma_deg), radians(azimuth_deg)
    nav["v_N"] = speed * np.array([cos(gamma) * cos(psi), cos(gamma) * sin(psi), -sin(gamma)])
    nav["speed"], nav["bank"] = speed, radians(bank_deg)
    return nav


@pytest.fixture
def sphere(onboard):
    """A spherical planet, for which geodetic and geocentric agree, in still air, one airframe for all Mach
    numbers, no trim wing.
    """
    record = onboard[0]
    record["planet"]["flattening"] = record["planet"]["j2"] = 0.0
    record["atmosphere"]["wind_north"] = record["atmosphere"]["wind_east"] = 0.0
    for name in ("drag", "lift", "drag_with_wing"):
        record["vehicle"]["airframe"][name] = 1.0
    record["vehicle"]["airframe"]["wing_mach"] = 0.0
    entry = record["guidance"]["entry"]
    entry["final_mach"], entry["final_speed"], entry["bank_min"], entry["bank_max"] = (
        0.0,
        420.0,
        0.0,
        radians(120.0),
    )
    entry["bank_rate"] = radians(1e4)  # Vinh's equations bank at once
    return record


def vinh(record, nav, cos_bank, side, drag_ratio, lift_ratio):
    """Vinh, Busemann & Culp 1980, chapter 2, heading from north, by scipy: latitude, longitude, altitude and
    time at the final speed.
    """
    planet, vehicle, air, entry = (record[k] for k in ("planet", "vehicle", "atmosphere", "guidance"))
    entry = entry["entry"]
    nodes = air["bottom"] + air["spacing"] * np.arange(len(air["ln_density"]))
    mu, radius, w = float(planet["mu"]), float(planet["equatorial_radius"]), float(planet["rotation_rate"])
    north, east, down = nav["v_N"]

    def rates(t, s):
        r, lon, lat, v, gamma, psi = s
        density = exp(np.interp(r - radius, nodes, air["ln_density"]))
        drag = drag_ratio * 0.5 * density * v * v * vehicle["drag_area"] / vehicle["entry_mass"]
        lift = lift_ratio * drag * vehicle["lift_to_drag"]
        cb = cos_bank if v > entry["align_speed"] else 1.0
        sb = side * sqrt(1.0 - cb * cb)
        g = mu / r**2
        sg, cg, sp, cp, sl, cl = sin(gamma), cos(gamma), sin(psi), cos(psi), sin(lat), cos(lat)
        return [
            v * sg,
            v * cg * sp / (r * cl),
            v * cg * cp / r,
            -drag - g * sg + w * w * r * cl * (sg * cl - cg * sl * cp),
            (
                lift * cb
                + (v * v / r - g) * cg
                + 2 * w * v * cl * sp
                + w * w * r * cl * (cg * cl + sg * cp * sl)
            )
            / v,
            (
                lift * sb / cg
                + v * v / r * cg * sp * sl / cl
                - 2 * w * v * (sg / cg * cp * cl - sl)
                + w * w * r / cg * sp * sl * cl
            )
            / v,
        ]

    def slow(t, s):
        return s[3] - 420.0

    slow.terminal = True
    start = [
        radius + nav["altitude"],
        nav["longitude"],
        nav["latitude"],
        nav["speed"],
        asin(-down / nav["speed"]),
        atan2(east, north),
    ]
    out = solve_ivp(rates, (0.0, 900.0), start, events=slow, rtol=1e-9, atol=1e-6, max_step=1.0)
    r, lon, lat = out.y[:3, -1]
    return lat, lon, r - radius, out.t[-1]


def point(lat, lon):
    return np.array([cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)])


@pytest.mark.parametrize(
    "start, cos_bank, side, drag_ratio, lift_ratio",
    [
        ((37.9, 110.3, 120e3, 4800.0, -11.5, 181.4), 0.6, 0.0, 1.0, 1.0),
        ((37.9, 110.3, 120e3, 4800.0, -11.5, 181.4), 0.2, 1.0, 1.15, 0.9),
        ((28.0, 108.0, 35e3, 3000.0, -8.0, 140.0), 0.9, -1.0, 0.9, 1.1),
        ((26.0, 112.0, 20e3, 1500.0, -14.0, 240.0), 0.5, 0.0, 1.0, 1.0),
    ],
)
def test_prediction_ends_where_vinhs_equations_end(sphere, start, cos_bank, side, drag_ratio, lift_ratio):
    nav = state(*start, bank_deg=degrees(acos(cos_bank)) * (side if side else 1.0))
    shift = cos_bank - cos(sphere["guidance"]["entry"]["reference_bank"]["points"]["bank"][0])
    plan = shifted(shift, side, 0.0, 0.0) if side else in_plane_shifted(shift, 0.0, 0.0)
    down, cross, altitude, time = predict(sphere, nav, out_record(drag_ratio, lift_ratio), plan)
    lat, lon, expected_altitude, expected_time = vinh(sphere, nav, cos_bank, side, drag_ratio, lift_ratio)
    here, there = point(nav["latitude"], nav["longitude"]), point(lat, lon)
    target = point(sphere["site"]["aim_latitude"], sphere["site"]["aim_longitude"])
    ahead = target - (target @ here) * here
    ahead /= np.linalg.norm(ahead)
    radius = sphere["planet"]["equatorial_radius"]
    expected = radius * (atan2(there @ ahead, there @ here) - atan2(target @ ahead, target @ here))
    assert down == pytest.approx(expected, abs=150.0)
    assert cross == pytest.approx(radius * asin(there @ np.cross(ahead, here)), abs=150.0)
    assert altitude == pytest.approx(expected_altitude, abs=100.0)
    assert time == pytest.approx(expected_time, abs=0.5)


def test_aim_point_that_is_passed_is_missed_by_as_much_more(sphere):
    """The end stays where it is while the aim point moves from 3 km ahead to 3 km behind."""
    nav = state(26.0, 110.0, 12e3, 700.0, -10.0, 180.0)
    radius, site = float(sphere["planet"]["equatorial_radius"]), sphere["site"]
    site["aim_longitude"] = nav["longitude"]
    ends = []
    for ahead in (3e3, 1e3, -1e3, -3e3):
        site["aim_latitude"] = nav["latitude"] - ahead / radius
        down, *_ = predict(sphere, nav, out_record(), in_plane_shifted(0.0, 0.0, 0.0))
        ends.append(ahead + down)
    assert min(ends) > 5e3
    assert np.ptp(ends) < 5.0


def test_prediction_to_a_mach_number_ends_at_it(sphere):
    """At Mach 1.8 of the believed air instead of 420 m/s: later by the speed still to be lost, and lower."""
    nav = state(26.0, 110.0, 20e3, 1500.0, -14.0, 181.0)
    *_, altitude, time = predict(sphere, nav, out_record(), in_plane_shifted(0.5, 0.0, 0.0))
    sphere["guidance"]["entry"]["final_mach"] = 1.8
    *_, lower, later = predict(sphere, nav, out_record(), in_plane_shifted(0.5, 0.0, 0.0))
    air = sphere["atmosphere"]
    sound = np.interp(
        lower, air["bottom"] + air["spacing"] * np.arange(len(air["speed_of_sound"])), air["speed_of_sound"]
    )
    assert later > time and lower < altitude
    assert (420.0 - 1.8 * sound) / (later - time) == pytest.approx(8.0, abs=4.0)  # deceleration there, m/s2


@pytest.fixture(scope="module")
def at_65_km(nominal):
    """Where the vehicle passes 65 km on its way."""
    names = (
        "latitude_deg",
        "longitude_deg",
        "altitude_m",
        "speed_m_s",
        "flight_path_angle_deg",
        "azimuth_deg",
    )
    table = nominal.telemetry
    row = np.argmax(table["truth.altitude_m"] < 65e3)
    return state(*(table[f"truth.{name}"][row] for name in names))


@pytest.mark.parametrize(
    "drag_ratio", [pytest.param(0.9, marks=pytest.mark.long), pytest.param(1.0, marks=pytest.mark.long), 1.1]
)
def test_predicted_range_grows_without_jumps(onboard, at_65_km, drag_ratio):
    """Wherever among the steps the parachute's Mach number is met: 70 to 100 m for each 5e-4 of cos(bank),
    200 m where alignment moves by a step.
    """
    air = out_record(drag_ratio)
    ends = [miss_of(onboard[0], at_65_km, air, shift, 0.0, 0.0) for shift in np.arange(0.65, 0.87, 5e-4)]
    assert np.diff(ends).min() > 0.0 and np.diff(ends).max() < 300.0


def test_trend_of_drag_is_air_with_another_scale_height(onboard, at_65_km):
    """The same end as in a table of the air that has the trend in its densities."""
    record, out, plan = onboard[0], out_record(1.05), shifted(0.1, 1.0, 0.0, 0.0)
    out["drag_trend"] = -2e-6
    followed = predict(record, at_65_km, out, plan)
    still = predict(record, at_65_km, out_record(1.05), plan)
    air = record["atmosphere"]
    heights = air["bottom"] + air["spacing"] * np.arange(len(air["ln_density"]))
    air["ln_density"] += np.log(1.05 - 2e-6 * (heights - at_65_km["altitude"]))
    told = predict(record, at_65_km, out_record(), plan)
    assert abs(still[0] - told[0]) > 5e3
    assert followed[0] == pytest.approx(told[0], abs=0.05 * abs(still[0] - told[0]))
    assert followed[2] == pytest.approx(told[2], abs=100.0)


@pytest.mark.parametrize("drag_ratio", [0.9, 1.0, 1.1])
def test_solution_of_the_corrector_is_predicted_to_hit(onboard, at_65_km, drag_ratio):
    """From 65 km on the way that the vehicle flies, within reach of the target in all three airs; to the
    200 m by which the predicted range jumps where alignment moves by a step.
    """
    record, entry = onboard[0], onboard[0]["guidance"]["entry"]
    nav, out, memory = at_65_km, out_record(drag_ratio), np.zeros(1, NPC_MEMORY)[0]
    memory["shift"] = record["reference"]["shift"]
    for _ in range(2):  # a call stops after a few steps; the next one goes on from there
        low, high = cos(entry["bank_max"]), cos(entry["bank_min"])
        solve(entry["npc"], record, nav, out, low, high, 0.0, 0.0, memory)
    assert abs(miss_of(record, nav, out, memory["shift"], 0.0, 0.0)) < 200.0
    assert memory["iterations"] <= 1
    assert 20.0 < degrees(acos(memory["shift"])) < 100.0


@pytest.mark.parametrize("ahead_deg, bound", [(40.0, "bank_min"), (5.0, "bank_max")])
def test_corrector_goes_to_the_nearer_limit_when_the_target_is_out_of_reach(onboard, ahead_deg, bound):
    record, entry = onboard[0], onboard[0]["guidance"]["entry"]
    nav, memory = state(25.1 + ahead_deg, 110.2, 65e3, 4820.0, -9.3, 181.4), np.zeros(1, NPC_MEMORY)[0]
    for _ in range(3):
        low, high = cos(entry["bank_max"]), cos(entry["bank_min"])
        solve(entry["npc"], record, nav, out_record(), low, high, 0.0, 0.0, memory)
    assert memory["shift"] == pytest.approx(cos(entry[bound]), abs=1e-9)


# ---- reversals that the prediction foresees ----------------------------------------------------------------


def test_reversal_in_the_plane_adds_the_range_of_lift_up_and_no_crossrange(onboard):
    """More at a slower bank rate, as much in time as it is slower."""
    record, nav = onboard[0], state(32.2, 110.2, 65e3, 4820.0, -9.3, 180.0, 60.0)
    added = []
    for rate_deg_s in (20.0, 5.0):
        record["guidance"]["entry"]["bank_rate"] = radians(rate_deg_s)
        straight, turned = (
            predict(record, nav, out_record(), in_plane_shifted(0.0, turn, 0.0))[0] for turn in (0.0, 3500.0)
        )
        added.append(turned - straight)
    assert 0.0 < 2.0 * added[0] < added[1]


def test_bank_of_a_reversal_under_way_counts_from_the_side_that_is_left(onboard):
    """Rolling from 60 deg right to the left, lift up is still to come; past it the range is smaller."""
    record, out = onboard[0], out_record()
    record["guidance"]["entry"]["bank_rate"] = radians(5.0)
    out["side"] = -1.0
    before, after = (
        predict(
            record, state(32.2, 110.2, 65e3, 4820.0, -9.3, 180.0, bank), out, in_plane_shifted(0.0, 0.0, 0.0)
        )[0]
        for bank in (60.0, -60.0)
    )
    assert before > after + 1e3


def test_npc_foresees_the_reversals_of_its_plan_by_the_number_of_those_begun(onboard):
    memory, plan, out = np.zeros(1, NPC_MEMORY)[0], np.zeros(1, PLAN)[0], out_record()
    plan["turn"][:3] = 4800.0, 3100.0, 1500.0
    seen = []
    for out["side"] in (0.0, 1.0, 1.0, -1.0, -1.0, 1.0, -1.0):
        seen.append(next_turns(plan, memory, out))
    first, second, third = (4800.0, 3100.0), (3100.0, 1500.0), (1500.0, 0.0)
    assert seen == [first, first, first, second, second, third, (0.0, 0.0)]
