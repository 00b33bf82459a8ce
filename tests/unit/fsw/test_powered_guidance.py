"""Powered guidance and terminal laws flown on point masses."""

from math import acos, atan, cos, exp, hypot, radians, sin, tan

import numpy as np
import pytest
from powered_flight import G, Guided, PointMass
from pyquaternion import Quaternion

from edl6dof.fsw.control.attitude_error import shortest_arc
from edl6dof.fsw.estimation.registry import DISTURBANCE
from edl6dof.fsw.functions import chosen
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.guidance.phase_guidance import GUIDANCE, descend_by_engine
from edl6dof.fsw.guidance.powered.target import POWERED_TARGET, choose_target
from edl6dof.fsw.guidance.powered.terminal_descent import (
    LATERAL_BIAS,
    TERMINAL,
    avoid,
    command_thrust,
    descend,
    hover,
    lateral_bias,
    start_or_throttle,
    throttle,
)
from edl6dof.fsw.hazard.site_selection import LANDING_POINT
from edl6dof.fsw.mission import G_POWERED
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.fsw.vehicle_state import ENGINE_ABILITY, VEHICLE_STATE
from edl6dof.interface.effectors import ENGINE_FULL, ENGINE_THROTTLE

STILL = np.zeros(2)
#: Nothing chosen by hazard detection.
NO_POINT = np.zeros(1, LANDING_POINT)[0]


def terminal(onboard):
    """Settings and believed engine that a terminal law gets."""
    return onboard[0]["guidance"]["powered"]["terminal"], onboard[0]["vehicle"]["engines"][0]


@pytest.mark.parametrize(
    "height, descent, north, east",
    [
        pytest.param(1200.0, 70.0, 0.0, 0.0, marks=pytest.mark.long),
        (1500.0, 85.0, 12.0, -8.0),
        pytest.param(800.0, 60.0, -15.0, 3.0, marks=pytest.mark.long),
    ],
)
def test_polynomial_law_follows_a_cubic_down_and_a_quartic_sideways_that_ends_upright(
    onboard, height, descent, north, east
):
    """The polynomials with r(T) = r_f, v(T) = 0, and sideways a(T) = 0 as well, solved here as linear
    equations.
    """
    record = onboard[0]
    p = record["guidance"]["powered"]["polynomial"]
    p["time_floor"] = p["lateral_time_floor"] = 0.3
    body = PointMass(height, (north, east, descent))
    law = Guided(record, "polynomial", body)
    dt, seen, pushes = 0.02, [], []
    law(body)
    duration, goal = float(body.out["time_to_go"]), law.goal
    start = body.r.copy(), body.v * (1.0, 1.0, -1.0)
    while body.out["time_to_go"] > 0.35:
        n, e, u, limit = law(body)
        assert limit == pytest.approx(p["tilt_limit"])
        seen.append((body.t, *body.r))
        pushes.append(hypot(n, e))
        body.move(n, e, u, dt)
    t, path = np.array(seen)[:, 0], np.array(seen)[:, 1:]
    for axis, conditions in enumerate((3, 3, 2)):
        curve = braking_polynomial(start[0][axis], start[1][axis], goal[axis], duration, conditions)
        assert np.max(np.abs(path[:, axis] - curve(t))) < 2.0
    assert max(pushes[-5:]) < 0.1 * max(pushes)
    assert np.linalg.norm(body.v) < 2.5
    assert body.r == pytest.approx(goal, abs=1.0)
    assert body.t == pytest.approx(duration, abs=0.4)


def braking_polynomial(r, v, goal, duration, conditions):
    """The polynomial of lowest order with this start that at ``duration`` is at ``goal``, at rest, and with
    three ``conditions`` without acceleration.
    """
    powers = np.arange(2, 2 + conditions)
    rows = [powers**0 * duration**powers, powers * duration ** (powers - 1)]
    rows.append(powers * (powers - 1) * duration ** (powers - 2))
    wanted = [goal - r - v * duration, -v, 0.0]
    return np.polynomial.Polynomial((r, v, *np.linalg.solve(rows[:conditions], wanted[:conditions])))


def test_thrust_axis_is_kept_until_the_engine_burns(onboard):
    """Hung like this the thrust points 12 deg from the vertical towards the north-east: that is asked for."""
    body, memory = PointMass(1200.0, (8.0, 5.0, 58.0)), np.zeros(1, GUIDANCE)[0]
    state, tilt, azimuth = np.zeros(1, VEHICLE_STATE)[0], radians(12.0), radians(40.0)
    body.nav["north_I"], body.nav["east_I"], body.nav["up_I"] = np.eye(3)
    held = (sin(tilt) * cos(azimuth), sin(tilt) * sin(azimuth), cos(tilt))
    body.nav["q_I2B"] = shortest_arc((-1.0, 0.0, 0.0), held)
    quiet, law = np.zeros(1, DISTURBANCE)[0], chosen("powered_law", onboard[0])
    descend_by_engine(law, onboard[0], G_POWERED, body.nav, state, quiet, NO_POINT, 0.1, memory, body.out)
    assert body.out["thrust_direction_N"] == pytest.approx((held[0], held[1], -held[2]), abs=1e-12)
    assert memory["target"]["set"] == 0  # chosen where the engine lights
    state["ignited"], state["mass"], state["engine"] = 1, 950.0, onboard[0]["vehicle"]["engines"][0]
    descend_by_engine(law, onboard[0], G_POWERED, body.nav, state, quiet, NO_POINT, 0.1, memory, body.out)
    assert memory["target"]["set"] == 1
    assert body.out["thrust_direction_N"][:2] @ held[:2] < 0.0  # against the drift


@pytest.mark.parametrize("drift", [(-10.0, 0.0), (3.0, 4.0), (0.0, 0.3)])
def test_target_lies_ahead_by_a_share_of_the_drift_less_a_divert_away_from_the_backshell(onboard, drift):
    p = onboard[0]["guidance"]["powered"]["target"]
    body, target = PointMass(1300.0, (*drift, 80.0), east=70.0), np.zeros(1, POWERED_TARGET)[0]
    choose_target(p, body.nav, NO_POINT, target)
    duration = p["time_factor"] * 2.0 * (1300.0 - p["height"]) / 80.0
    speed = hypot(*drift)
    against = np.array(drift) / -speed if speed > 0.5 else np.array([-1.0, 0.0])
    north, east = p["drift_share"] * duration * np.array(drift) + p["divert"] * against
    assert target["point_L"] == pytest.approx((70.0 + east, north))
    assert (target["arrival"], target["height"]) == pytest.approx((duration, p["height"]))
    before = target.copy()
    body.move(5.0, -3.0, 6.0, 1.0)
    choose_target(p, body.nav, NO_POINT, target)
    assert target == before  # once only


@pytest.mark.parametrize(
    "velocity", [pytest.param((0.0, 0.0, 80.0), marks=pytest.mark.long), (20.0, -10.0, 75.0)]
)
def test_gravity_turn_reaches_the_final_height_slowly_with_thrust_against_the_velocity(onboard, velocity):
    body = PointMass(1400.0, velocity)
    law = Guided(onboard[0], "gravity_turn", body)
    final = law.goal[2]
    braking = []
    while body.r[2] > final + 2.0 and body.t < 120.0:
        n, e, u, _ = law(body)
        thrust = np.array([n, e, -(u - G)])
        assert np.cross(thrust, body.v) == pytest.approx(np.zeros(3), abs=1e-9)
        assert thrust @ body.v < 0.0
        braking.append(np.linalg.norm(thrust))
        body.move(n, e, u, 0.02)
    assert body.r[2] == pytest.approx(final, abs=2.1)
    assert np.linalg.norm(body.v) < 6.0
    if velocity[0] == 0.0:  # straight down: constant deceleration v^2 / 2 h, as eq. of uniform motion
        assert np.array(braking) == pytest.approx(80.0**2 / 2.0 / 1300.0, rel=0.03)
        assert np.linalg.norm(body.v) == pytest.approx((2.0 * 80.0**2 / 2.0 / 1300.0 * 2.0) ** 0.5, rel=0.1)


@pytest.mark.parametrize("tilt_limit_deg", [0.0, 0.6, 4.0, 25.0])
def test_commanded_thrust_keeps_its_vertical_part_and_the_tilt_limit(tilt_limit_deg):
    rng = np.random.default_rng(1)
    out, mass = np.zeros(1, GUIDE)[0], 900.0
    for _ in range(100):
        n, e, u = *rng.uniform(-6.0, 6.0, 2), rng.uniform(0.5, 15.0)
        command_thrust(mass, (n, e, u), radians(tilt_limit_deg), out)
        d = out["thrust_direction_N"]
        force = out["thrust"] * d
        assert np.linalg.norm(d) == pytest.approx(1.0)
        assert force[2] == pytest.approx(-mass * u)
        side = min(hypot(n, e), u * tan(radians(tilt_limit_deg)))
        assert np.hypot(force[0], force[1]) == pytest.approx(mass * side, abs=1e-6)
        assert acos(min(-d[2], 1.0)) <= radians(tilt_limit_deg) + 1e-6
        assert force[0] * e == pytest.approx(force[1] * n, abs=1e-6)  # azimuth unchanged
        assert force[0] * n + force[1] * e >= -1e-9
        assert atan(side / u) == pytest.approx(acos(min(-d[2], 1.0)), abs=1e-6)


@pytest.mark.parametrize("up", [-0.01, -0.3, -3.0])
def test_wish_to_fall_faster_than_free_fall_does_not_turn_the_lander_over(up):
    """In hover 16 m too high at rest the law wants 3.71 - 4.0 m/s2 upwards; the thrust axis must stay within
    the tilt limit.
    """
    out = np.zeros(1, GUIDE)[0]
    command_thrust(900.0, (0.3, 0.0, up), radians(4.0), out)
    assert acos(np.clip(-out["thrust_direction_N"][2], -1.0, 1.0)) <= radians(4.0) + 1e-9


@pytest.mark.parametrize("height, descent", [(100.0, 0.0), (118.0, 0.0), (112.0, -1.0)])
def test_hover_keeps_the_thrust_axis_near_the_vertical_from_any_start(onboard, height, descent):
    body = PointMass(height, (0.5, 0.0, descent))
    hover(*terminal(onboard), body.nav, 900.0, STILL, body.out)
    assert acos(np.clip(-body.out["thrust_direction_N"][2], -1.0, 1.0)) < radians(6.0)


def test_throttle_band_is_respected_and_full_thrust_is_only_the_start(onboard):
    engine = onboard[0]["vehicle"]["engines"][0]
    out = np.zeros(1, GUIDE)[0]
    for wish in (-100.0, 0.0, 1499.0, 3000.0, 5001.0, 9000.0):
        out["thrust"] = wish
        throttle(engine, out)
        assert out["thrust"] == min(max(wish, 1500.0), 5000.0)
        # S1
        assert (engine["throttle_min"], engine["throttle_max"], engine["full_thrust"]) == (
            1500.0,
            5000.0,
            7500.0,
        )
        assert out["engine_mode"] == ENGINE_THROTTLE
    full_time, full_again = (onboard[0]["guidance"]["powered"][name] for name in ("full_time", "full_again"))
    out["engine_mode"] = ENGINE_FULL
    sequence = []
    for elapsed, wish in (
        (0.0, 3000.0),
        (0.9 * full_time, 3000.0),
        (1.1 * full_time, 6000.0),
        (2.0 * full_time, 4900.0),
        (9.0, 0.99 * full_again * 5000.0),
        (9.1, 1.01 * full_again * 5000.0),
        (9.2, 5001.0),
        (9.3, 4000.0),
    ):
        out["thrust"] = wish
        start_or_throttle(engine, False, full_time, full_again, elapsed, out)
        sequence.append((int(out["engine_mode"]), float(out["thrust"])))
    full, band = (ENGINE_FULL, 7500.0), [(ENGINE_THROTTLE, thrust) for thrust in (4900.0, 5000.0, 4000.0)]
    assert sequence == [full, full, full, band[0], band[1], full, full, band[2]]


def test_weak_engine_gives_the_level_nearer_to_the_demand_and_any_engine_what_the_law_asks_for(onboard):
    engine, out = np.zeros(1, ENGINE_ABILITY)[0], np.zeros(1, GUIDE)[0]
    engine["full_thrust"], engine["throttle_min"], engine["throttle_max"] = 6000.0, 1200.0, 4000.0
    for wish, mode in ((4990.0, ENGINE_THROTTLE), (5010.0, ENGINE_FULL), (3990.0, ENGINE_THROTTLE)):
        out["thrust"], out["engine_mode"] = wish, ENGINE_THROTTLE
        start_or_throttle(engine, True, 1.0, 1.5, 9.0, out)
        assert int(out["engine_mode"]) == mode
    out["thrust"], out["engine_mode"], out["full_wanted"] = 3000.0, ENGINE_THROTTLE, 1
    start_or_throttle(engine, False, 1.0, 1.5, 9.0, out)
    assert (int(out["engine_mode"]), float(out["thrust"])) == (ENGINE_FULL, 6000.0)


def fly_terminal(step, body, mass, duration, dt=0.1, wind=STILL):
    """Fly a terminal law, its lateral force delivered, with a lateral force ``wind`` (N) beside."""
    for _ in range(int(duration / dt)):
        step(body)
        force = body.out["thrust"] * body.out["thrust_direction_N"]
        side = wind + (body.out["force_N"] if body.out["translating"] else 0.0)
        assert 1500.0 <= body.out["thrust"] <= 5000.0
        body.move((force[0] + side[0]) / mass, (force[1] + side[1]) / mass, -force[2] / mass, dt)


def test_hover_settles_at_its_height_and_stops_lateral_motion(onboard):
    body, mass = PointMass(108.0, (1.5, -1.0, 3.0)), 850.0
    fly_terminal(lambda b: hover(*terminal(onboard), b.nav, mass, STILL, b.out), body, mass, 40.0)
    assert body.r[2] == pytest.approx(onboard[0]["guidance"]["powered"]["terminal"]["hover_height"], abs=0.5)
    assert np.linalg.norm(body.v) < 0.1


def test_avoidance_reaches_the_safe_spot_upright_at_limited_lateral_speed(onboard):
    p = onboard[0]["guidance"]["powered"]["terminal"]
    p["avoidance_rate"], p["touchdown_rate"] = 2.0, 0.5  # long enough to see it settle
    body, mass, memory = (
        PointMass(100.0, (0.0, 0.0, 0.5), east=7.0, north=-4.0),
        850.0,
        np.zeros(1, TERMINAL)[0],
    )
    fastest = 0.0

    def step(b):
        nonlocal fastest
        avoid(*terminal(onboard), b.nav, mass, STILL, NO_POINT, memory, b.out)
        assert b.out["thrust_direction_N"] == pytest.approx((0.0, 0.0, -1.0))
        fastest = max(fastest, np.hypot(b.v[0], b.v[1]))

    fly_terminal(step, body, mass, 45.0)
    assert body.r[:2] == pytest.approx((-4.0 + p["safe_spot_north"], 7.0 + p["safe_spot_east"]), abs=0.3)
    assert fastest <= p["lateral_speed"] + 0.05
    assert np.hypot(body.v[0], body.v[1]) < 0.05


def test_descent_comes_down_at_the_touchdown_rate_without_lateral_speed(onboard):
    p = onboard[0]["guidance"]["powered"]["terminal"]
    body, mass = PointMass(60.0, (0.2, 0.1, 2.5)), 850.0
    fly_terminal(lambda b: descend(*terminal(onboard), b.nav, mass, STILL, NO_POINT, b.out), body, mass, 20.0)
    assert body.v[2] == pytest.approx(p["touchdown_rate"], abs=0.02)
    assert np.hypot(body.v[0], body.v[1]) < 0.15


def test_chosen_spot_is_flown_to_and_held_in_the_slow_descent(onboard):
    p = onboard[0]["guidance"]["powered"]["terminal"]
    p["avoidance_rate"], p["touchdown_rate"] = 2.0, 0.5
    point, memory, mass = np.zeros(1, LANDING_POINT)[0], np.zeros(1, TERMINAL)[0], 850.0
    point["fine_known"], point["fine_L"] = 1, (12.0, 3.0)
    body = PointMass(100.0, (0.0, 0.0, 0.5), east=7.0, north=-4.0)
    fly_terminal(
        lambda b: avoid(*terminal(onboard), b.nav, mass, STILL, point, memory, b.out), body, mass, 45.0
    )
    assert body.r[:2] == pytest.approx((3.0, 12.0), abs=0.3)
    pushed = PointMass(40.0, (0.3, -0.3, 0.5), east=12.5, north=2.5)
    fly_terminal(lambda b: descend(*terminal(onboard), b.nav, mass, STILL, point, b.out), pushed, mass, 30.0)
    assert pushed.r[:2] == pytest.approx((3.0, 12.0), abs=0.1)


def test_target_of_powered_descent_is_that_of_coarse_avoidance_where_there_is_one(onboard):
    point, target = np.zeros(1, LANDING_POINT)[0], np.zeros(1, POWERED_TARGET)[0]
    point["coarse_known"], point["coarse_L"] = 1, (321.0, -123.0)
    choose_target(
        onboard[0]["guidance"]["powered"]["target"], PointMass(1200.0, (5.0, 5.0, 60.0)).nav, point, target
    )
    assert target["set"] == 1 and target["height"] == 100.0 and target["arrival"] > 20.0
    assert tuple(target["point_L"]) == (321.0, -123.0)


def test_known_standing_force_moves_the_vehicle_in_none_of_the_terminal_phases(onboard):
    """An engine of 3.5 kN that is 2 deg out of line pushes with 120 N; not told of it, guidance drifts."""
    wind, mass, memory = np.array([120.0, -90.0]), 900.0, np.zeros(1, TERMINAL)[0]
    laws = (
        lambda b, known: hover(*terminal(onboard), b.nav, mass, known, b.out),
        lambda b, known: avoid(*terminal(onboard), b.nav, mass, known, NO_POINT, memory, b.out),
        lambda b, known: descend(*terminal(onboard), b.nav, mass, known, NO_POINT, b.out),
    )
    for law in laws:
        drifts = []
        for known in (wind, STILL):
            body = PointMass(60.0, (0.0, 0.0, 1.0))
            memory["target_set"] = 1  # at the origin: the vehicle is there already
            fly_terminal(lambda b, law=law, known=known: law(b, known), body, mass, 20.0, wind=wind)
            drifts.append(np.hypot(body.r[0], body.r[1]))
        assert drifts[0] < 0.05 and drifts[1] > 0.5


def test_lateral_force_that_is_asked_for_stays_within_what_a_pair_of_thrusters_can_give(onboard):
    body, limit = (
        PointMass(10.0, (9.0, -9.0, 1.0)),
        onboard[0]["guidance"]["powered"]["terminal"]["lateral_force"],
    )
    descend(*terminal(onboard), body.nav, 900.0, np.array([300.0, -300.0]), NO_POINT, body.out)
    assert body.out["translating"] == 1
    assert body.out["force_N"] == pytest.approx([-limit, limit])


def test_horizontal_thrusters_rest_shortly_before_touchdown(onboard):
    height = onboard[0]["guidance"]["powered"]["terminal"]["rest_height"]
    for above, translating in ((0.1, 1), (-0.1, 0)):
        body = PointMass(height + above, (0.3, 0.0, 1.7))
        descend(*terminal(onboard), body.nav, 900.0, STILL, NO_POINT, body.out)
        assert body.out["translating"] == translating


@pytest.mark.parametrize("time_constant", [0.5, 2.0])
def test_standing_force_is_the_lateral_disturbance_in_north_and_east_smoothed(time_constant):
    rng = np.random.default_rng(6)
    nav, disturbance = np.zeros(1, NAV)[0], np.zeros(1, DISTURBANCE)[0]
    memory, dt = np.zeros(1, LATERAL_BIAS)[0], 0.1
    attitude = Quaternion(rng.normal(size=4)).normalised
    nav["q_I2B"], nav["north_I"], nav["east_I"] = attitude.elements, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    smoothed = None
    for _ in range(60):
        disturbance["force"] = rng.normal(size=3) * (4000.0, 60.0, 60.0)
        seen = np.array(attitude.rotate([0.0, *disturbance["force"][1:]])[:2])
        found = lateral_bias(time_constant, nav, disturbance, dt, memory)
        smoothed = seen if smoothed is None else smoothed + (1 - exp(-dt / time_constant)) * (seen - smoothed)
        assert found == pytest.approx(smoothed, abs=1e-9)
