"""Laws of powered deceleration against rewrites, integration and optimisation by others."""

from math import cos, exp, radians, sin

import numpy as np
import pytest
from powered_flight import MASS, G, Guided, PointMass, fly_on_the_engine
from scipy.integrate import quad, solve_ivp
from scipy.optimize import minimize_scalar

from edl6dof.config.units import G0
from edl6dof.fsw.guidance.powered.apollo import quadratic
from edl6dof.fsw.guidance.powered.constant_thrust import against_velocity, too_fast
from edl6dof.fsw.guidance.powered.e_guidance import optimal_time, zem_zev
from edl6dof.fsw.guidance.powered.registry import POWERED_LAWS
from edl6dof.fsw.guidance.powered.target import planned_upward, root

WITH_A_POINT = [name for name in POWERED_LAWS.names if name != "gravity_turn"]  # which has none
PLANNING = ("e_guidance", "apollo")


def cherry(miss, velocity, gravity, t_go):
    """E-guidance as Cherry wrote it: thrust acceleration c1 + c2 t whose two integrals meet position and
    velocity.
    """
    integrals = np.array([[t_go, t_go**2 / 2.0], [t_go**2 / 2.0, t_go**3 / 6.0]])
    wanted = [-velocity - gravity * t_go, miss - velocity * t_go - gravity * t_go**2 / 2.0]
    return np.linalg.solve(integrals, wanted)


def test_zem_zev_is_e_guidance():
    rng = np.random.default_rng(2)
    for _ in range(200):
        miss, velocity, gravity = rng.uniform(-1500, 1500), rng.uniform(-100, 100), rng.uniform(-10, 10)
        t_go = rng.uniform(2.0, 60.0)
        size = abs(miss) / t_go**2 + abs(velocity) / t_go + abs(gravity)
        assert abs(zem_zev(miss, velocity, gravity, t_go) - cherry(miss, velocity, gravity, t_go)[0]) < (
            1e-12 * 6.0 * size
        )


@pytest.mark.parametrize("miss, velocity, t_go", [(-1100.0, -62.0, 33.0), (150.0, 8.0, 40.0)])
def test_e_guidance_is_the_least_integral_of_the_squared_acceleration(miss, velocity, t_go):
    """Of all accelerations that are constant within each of 4,000 steps and meet the target at rest, the one
    of least norm, by the pseudo-inverse.
    """
    n = 4000
    dt = t_go / n
    rest = t_go - (np.arange(n) + 0.5) * dt
    meets = np.array([np.full(n, dt), rest * dt])
    wanted = [-velocity + G * t_go, miss - velocity * t_go + G * t_go**2 / 2.0]
    best = np.linalg.pinv(meets) @ wanted
    c1, c2 = cherry(miss, velocity, -G, t_go)
    assert zem_zev(miss, velocity, -G, t_go) == pytest.approx(best[0], rel=1e-3)
    assert best == pytest.approx(c1 + c2 * (t_go - rest), abs=1e-4 * np.max(np.abs(best)))


@pytest.mark.parametrize(
    "position, velocity, gravity",
    [
        ((0.0, 0.0, 1100.0), (0.0, 0.0, -62.0), G),
        ((-160.0, 80.0, 1400.0), (12.0, -9.0, -80.0), G),
        ((2000.0, 300.0, 1500.0), (100.0, 0.0, -75.0), 3.7114),
        ((-5000.0, 0.0, 3000.0), (200.0, 0.0, -40.0), 1.62),
    ],
)
def test_time_to_go_is_where_the_integral_is_least(position, velocity, gravity):
    def cost(t):
        total = 0.0
        for r, v, g in zip(position, velocity, (0.0, 0.0, -gravity), strict=True):
            c1, c2 = cherry(-r, v, g, t)
            total += quad(lambda s, c1=c1, c2=c2: (c1 + c2 * s) ** 2, 0.0, t)[0]
        return total

    found = optimal_time(gravity, position, velocity)
    best = minimize_scalar(cost, bounds=(0.5 * found, 1.5 * found), method="bounded", options={"xatol": 1e-7})
    assert found == pytest.approx(best.x, rel=1e-5)
    rr, rv, vv = np.dot(position, position), np.dot(position, velocity), np.dot(velocity, velocity)
    roots = np.roots([gravity**2 / 2.0, 0.0, -2.0 * vv, -12.0 * rv, -18.0 * rr])
    assert min(z.real for z in roots if z.real > 0 and abs(z.imag) < 1e-9) == pytest.approx(found, rel=1e-9)


def test_of_several_minima_the_shortest_is_taken_that_does_not_pass_the_target():
    """Straight at the target and hardly any gravity: to come back from beyond it costs still less."""
    found, gravity, speed = optimal_time(0.3, (0.0, 0.0, 1000.0), (0.0, 0.0, -60.0)), 0.3, 60.0
    roots = np.roots([gravity**2 / 2.0, 0.0, -2.0 * speed**2, 12.0 * speed * 1000.0, -18.0 * 1000.0**2])
    times = sorted(z.real for z in roots if z.real > 0 and abs(z.imag) < 1e-9)
    assert len(times) == 3 and found == pytest.approx(times[0], rel=1e-9)
    c1, c2 = cherry(-1000.0, -speed, -gravity, found)
    t = np.linspace(0.0, found, 1000)
    assert np.all(1000.0 - speed * t + (c1 - gravity) * t**2 / 2.0 + c2 * t**3 / 6.0 > -1e-6)


@pytest.mark.parametrize("law", ["e_guidance", "apollo"])
@pytest.mark.parametrize(
    "miss, velocity, final", [(-1100.0, -62.0, 1.4), (90.0, 14.0, 0.0), (-300.0, 5.0, 0.0)]
)
def test_closed_loop_in_constant_gravity_ends_at_the_target_at_rest(law, miss, velocity, final):
    """Feedback at every instant, integrated by scipy to a hundredth of a second before arrival."""
    duration = 36.0

    def rate(t, y):
        left = duration - t
        if law == "apollo":
            return y[1], quadratic(miss - y[0], y[1], final, left)
        return y[1], zem_zev(miss - y[0], y[1], -G, left) - G

    way = solve_ivp(rate, (0.0, duration - 0.01), (0.0, velocity), rtol=1e-10, atol=1e-10)
    assert way.y[0, -1] == pytest.approx(miss, abs=2e-3)
    assert way.y[1, -1] == pytest.approx(0.0, abs=0.2)
    ends = rate(way.t[-1], way.y[:, -1])[1]
    if law == "apollo":
        assert ends == pytest.approx(final, abs=1e-2)
    else:
        c1, c2 = cherry(miss, velocity, -G, duration)
        assert ends == pytest.approx(c1 + c2 * duration - G, abs=1e-2)


@pytest.mark.parametrize("height", [150.0, 600.0, 1200.0])
def test_constant_thrust_burns_until_a_constant_deceleration_within_the_band_does_the_rest(onboard, height):
    """Whenever it is asked: a burn time that was planned once stopped the lander high above the target."""
    body = PointMass(height, (0.0, 0.0, 60.0))
    guided, settings = Guided(onboard[0], "constant_thrust", body), onboard[0]["guidance"]["powered"]
    p = settings["constant_thrust"]
    for speed, burns in ((0.99, False), (1.01, True)):
        body.v[2] = 40.0
        for _ in range(50):  # what the band gives depends on the speed itself, by the propellant for it
            body.see()
            weak = planned_upward(p["thrust_reserve"], guided.state, body.nav, guided.target)
            body.v[2] = speed * (2.0 * weak * (height - guided.target["height"])) ** 0.5
        body.see()
        assert too_fast(p, guided.state, body.nav, guided.target) == burns
    body.v[2] = -1.0
    body.see()
    assert not too_fast(p, guided.state, body.nav, guided.target)


@pytest.mark.parametrize("velocity", [(0.0, 0.0, 60.0), (12.0, -5.0, 70.0)])
@pytest.mark.parametrize("offset", [0.0, 10.0, 20.0])
def test_constant_thrust_points_at_its_offset_from_the_anti_velocity_towards_the_target(
    onboard, velocity, offset
):
    body = PointMass(1200.0, velocity)
    target = Guided(onboard[0], "constant_thrust", body).target
    pushes = np.array(against_velocity(radians(offset), 8.0, body.nav, target))
    back = -np.array(velocity) * (1.0, 1.0, -1.0) / np.linalg.norm(velocity)
    assert np.linalg.norm(pushes) == pytest.approx(8.0)
    assert pushes @ back == pytest.approx(8.0 * cos(radians(offset)))
    beside = pushes - pushes @ back * back
    to_target = np.array([target["point_L"][1], target["point_L"][0], 0.0])
    across = to_target - to_target @ back * back
    assert beside @ across == pytest.approx(8.0 * sin(radians(offset)) * np.linalg.norm(across), abs=1e-9)


@pytest.mark.parametrize("a, s, d", [(1.4, 120.0, 6600.0), (0.3, -50.0, 900.0), (2.0, 0.0, 100.0)])
def test_planned_time_solves_its_equation(a, s, d):
    t = root(a, s, d)
    assert t > 0.0
    assert a * t * t + s * t - d == pytest.approx(0.0, abs=1e-9 * d)


@pytest.mark.parametrize("law", PLANNING)
def test_planned_arrival_stays_where_it_is_if_nothing_disturbs_the_law(onboard, law):
    body = PointMass(1250.0, (9.0, -6.0, 64.0))
    guided, dt, arrivals = Guided(onboard[0], law, body), 0.01, []
    floor = onboard[0]["guidance"]["powered"][law]["lateral_time_floor"]
    while not arrivals or body.out["time_to_go"] > floor:
        north, east, up, _ = guided(body)
        arrivals.append(body.t + float(body.out["time_to_go"]))
        body.move(north, east, up, dt)
    assert np.ptp(arrivals) < 0.02


@pytest.mark.parametrize(
    "reserve", [pytest.param(0.0, marks=pytest.mark.long), pytest.param(0.1, marks=pytest.mark.long), 0.2]
)
@pytest.mark.parametrize("law", PLANNING)
def test_plan_ends_on_the_throttle_band_less_the_reserve(onboard, law, reserve):
    """Straight down on an ideal engine, whose mass is that of the rocket equation with what it has truly
    given.
    """
    settings = onboard[0]["guidance"]["powered"][law]
    settings["thrust_reserve"], settings["time_floor"] = reserve, 0.5
    onboard[0]["guidance"]["powered"]["target"]["divert"] = 0.0
    body, dt, spent = PointMass(1220.0, (0.0, 0.0, 66.0)), 0.005, 0.0
    guided = Guided(onboard[0], law, body)
    engine = guided.state["engine"]
    while not spent or body.out["time_to_go"] > 0.5:
        north, east, up, _ = guided(body)
        body.move(north, east, up, dt)
        spent += up * dt
    mass = MASS * exp(-spent / (G0 * engine["specific_impulse"]))
    assert mass * up == pytest.approx((1.0 - reserve) * engine["throttle_max"], rel=0.015)


@pytest.mark.parametrize("law", WITH_A_POINT)
@pytest.mark.parametrize(
    "height, velocity, divert",
    [
        pytest.param(*start, divert, marks=[] if i == k else pytest.mark.long)
        for i, start in enumerate(
            [(1200.0, (5.0, 3.0, 62.0)), (1230.0, (-12.0, 8.0, 70.0)), (1190.0, (0.0, 1.0, 55.0))]
        )
        for k, divert in enumerate([0.0, 170.0, 400.0])
    ],
)
def test_law_brings_the_lander_to_rest_at_the_target_on_the_engine_it_has(
    onboard, law, height, velocity, divert
):
    """With throttle band, full level at the start and tilt limit; propellant makes the lander lighter."""
    onboard[0]["guidance"]["powered"]["target"]["divert"] = divert
    onboard[0]["guidance"]["powered"]["target"]["time_factor"] = 1.04
    body = PointMass(height, velocity)
    guided, thrust = fly_on_the_engine(onboard[0], law, body)
    assert body.r == pytest.approx(guided.goal, abs=2.0)
    assert np.linalg.norm(body.v) < 2.0
    engine = guided.state["engine"]
    gap = (thrust[:, 1] > engine["throttle_max"]) & (thrust[:, 1] < engine["full_thrust"])
    assert not np.any(gap) and np.all(thrust[:, 1] >= engine["throttle_min"])
    # thrust has taken the descent rate away, and what gravity has added to it
    upwards = velocity[2] - body.v[2] + G * body.t
    spent = MASS - guided.state["mass"]
    assert spent > MASS * (1.0 - exp(-upwards / (G0 * engine["specific_impulse"])))


@pytest.mark.parametrize(
    ("law", "wrong"),
    [
        pytest.param(law, wrong, marks=pytest.mark.long if law == "convex" and wrong != "velocity" else [])
        for law in POWERED_LAWS.names
        for wrong in ("mass", "engine", "velocity")
    ],
)
def test_a_call_ends_even_where_what_it_is_given_is_not_finite_or_not_there(onboard, law, wrong):
    """What comes out is looked at in every cycle of a flight; a call that never returned would not be."""
    body = PointMass(1200.0, (5.0, 3.0, 62.0))
    guided = Guided(onboard[0], law, body)
    if wrong == "mass":
        guided.state["mass"] = np.nan
    elif wrong == "engine":
        guided.state["engine"] = np.zeros(1, guided.state["engine"].dtype)[0]
    else:
        body.nav["v_N"] = np.nan
    guided(body)
