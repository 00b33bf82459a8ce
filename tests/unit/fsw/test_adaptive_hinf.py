"""Adaptive H-infinity drag-velocity tracking: every part against finite differences, scipy's Riccati solver
and integrated flights.
"""

from math import asin, cos, exp, inf, radians, sin, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import solve_continuous_are

from edl6dof.fsw.guidance.entry.drag_dynamics import drag_dynamics, uncertain_drag
from edl6dof.fsw.guidance.entry.drag_velocity import (
    DRAG_VELOCITY,
    ceiling,
    corridor,
    integrate_range,
    path_sine,
    profile_drag,
    profile_range,
)
from edl6dof.fsw.guidance.entry.laws.adaptive_hinf import AdaptiveHinfParams, adapt, feedback, riccati
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS
from edl6dof.scenario.loading import load_scenario
from edl6dof.sim.flight import fly

RADIUS, MU, SCALE_HEIGHT = 3397.2e3, 4.2828376212e13, 10e3
GRAVITY = MU / RADIUS**2
A, B, C = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]]), np.array([[1.0, 0.0]])


# ---- drag dynamics with parameters -------------------------------------------------------------------------


@pytest.mark.parametrize(
    "altitude, speed, gamma_deg", [(40e3, 5000.0, -12.0), (20e3, 2500.0, -8.0), (10e3, 800.0, -15.0)]
)
@pytest.mark.parametrize("u", [0.12, -0.2])
def test_uncertain_drag_dynamics_hold_along_an_integrated_flight(altitude, speed, gamma_deg, u):
    """Lu & Bayard eq. 12 with a changing C_D and an unmodelled density rate; five-point differences of the
    integrated drag.
    """
    gamma, size, frequency = radians(gamma_deg), 0.01, 0.3

    def drag_at(t, h, v):
        # delta = size cos(frequency t)
        density = 0.00078 * exp(-(h - 31.8e3) / SCALE_HEIGHT + size / frequency * sin(frequency * t))
        return 0.5 * density * v**2 / 120.0 * (1.0 + 0.002 * t + 1e-4 * t * t)

    def rates(t, s):
        h, v, g = s
        drag = drag_at(t, h, v)
        return [
            v * sin(g),
            -drag - GRAVITY * sin(g),
            drag * u / v + (v / (RADIUS + h) - GRAVITY / v) * cos(g),
        ]

    step = 0.25
    m2, m1, p1, p2 = (
        drag_at(
            k * step,
            *solve_ivp(rates, (0.0, k * step), [altitude, speed, gamma], rtol=1e-12, atol=1e-9).y[:2, -1],
        )
        for k in (-2, -1, 1, 2)
    )
    drag = drag_at(0.0, altitude, speed)
    first = (8.0 * (p1 - m1) - (p2 - m2)) / (12.0 * step)
    second = (16.0 * (p1 + m1) - (p2 + m2) - 30.0 * drag) / (12.0 * step * step)

    free, unknown, per_u = uncertain_drag(drag, first, speed, GRAVITY, RADIUS, SCALE_HEIGHT)
    unknown = np.array(unknown) + [0.0, 0.0, 0.0, per_u * u, 0.0]
    rate = 0.002
    theta = [
        rate,
        2e-4 - rate**2,
        1.0 - RADIUS / (RADIUS + altitude) * cos(gamma) ** 2,
        1.0 - cos(gamma),
        sin(gamma) ** 2,
    ]
    potential = GRAVITY * SCALE_HEIGHT
    # delta' is zero at t = 0
    w = drag**2 / speed * (speed**2 - 4.0 * potential) / (speed**2 + 2.0 * potential) * size
    assert second == pytest.approx(-free - unknown @ theta + w + per_u * u, rel=1e-5)


# ---- Riccati equation and feedback -------------------------------------------------------------------------


@pytest.mark.parametrize("gain, weight", [(2.0, 1.0), (100.0, 2500.0), (60.0, 2500.0), (1.001, 1.0)])
def test_riccati_solution_is_scipys(gain, weight):
    p11, p12, p22 = riccati(gain, weight)
    expected = solve_continuous_are(A, np.hstack([B, B]), C.T @ C, np.diag([-(gain**2), weight]))
    assert np.array([[p11, p12], [p12, p22]]) == pytest.approx(expected, rel=1e-6)
    assert np.all(np.linalg.eigvalsh([[p11, p12], [p12, p22]]) > 0.0)


@pytest.mark.parametrize(
    "gain, weight",
    [
        pytest.param(2.0, 1.0, marks=pytest.mark.long),
        (100.0, 2500.0),
        pytest.param(60.0, 2500.0, marks=pytest.mark.long),
    ],
)
def test_feedback_keeps_the_gain_from_disturbance_to_error_below_lambda(gain, weight):
    """The peak of the frequency response, and the Lyapunov equation of section 3.4."""
    f = np.array([feedback(gain, weight)])
    closed = A + B @ f
    assert np.all(np.linalg.eigvals(closed).real < 0.0)
    frequencies = np.geomspace(1e-4, 1e3, 4000)
    response = [abs((C @ np.linalg.solve(1j * w * np.eye(2) - closed, B))[0, 0]) for w in frequencies]
    assert max(response) <= gain
    p11, p12, p22 = riccati(gain, weight)
    p = np.array([[p11, p12], [p12, p22]])
    assert p @ closed + closed.T @ p + p @ B @ B.T @ p / gain**2 + C.T @ C == pytest.approx(
        np.zeros((2, 2)), abs=1e-9 * p22
    )


def test_a_gain_that_the_riccati_equation_cannot_give_is_refused():
    with pytest.raises(ValueError, match="disturbance_gain must be above"):
        AdaptiveHinfParams(disturbance_gain=40.0, control_weight=2500.0)


def test_adaptation_stays_in_its_box_and_goes_down_the_gradient():
    low, high = np.array([-1.0, 0.0, -2.0]), np.array([1.0, 0.5, 2.0])
    theta = np.array([0.0, 0.25, 0.0])
    adapt(theta, low, high, (1.0, -2.0, 0.0), 0.01, 1.0, 0.1)
    assert theta == pytest.approx([-0.1 * 3 * 4.0 * 0.01, 0.25 + 0.1 * 3 * 0.25 * 2.0 * 0.01, 0.0])
    rng = np.random.default_rng(5)
    for _ in range(500):
        adapt(theta, low, high, tuple(rng.normal(size=3)), float(rng.normal()), 1.0, 1.0)
        assert np.all((theta >= low) & (theta <= high))
    q = np.diag(1.0 / (3.0 * (high - low) ** 2))  # the bound that the adaptation energy promises
    assert (high - low) @ q @ (high - low) == pytest.approx(1.0)


# ---- corridor and profile ----------------------------------------------------------------------------------


def test_corridor_bounds_are_those_of_heat_load_pressure_and_lift(onboard):
    record = onboard[0]
    limits, vehicle = record["guidance"]["entry"]["limits"], record["vehicle"]
    gravity = record["planet"]["mu"] / record["planet"]["equatorial_radius"] ** 2
    for speed in (4800.0, 3000.0, 900.0):
        heat, load, pressure, glide = corridor(record, speed)
        per_pascal = vehicle["drag_area"] / vehicle["entry_mass"]
        density = 2.0 * heat / (per_pascal * speed**2)
        assert 1.9027e-4 * sqrt(density / limits["nose_radius"]) * speed**3 == pytest.approx(
            limits["heat_rate"]
        )
        assert np.hypot(load, vehicle["lift_to_drag"] * load) == pytest.approx(limits["load"])
        assert pressure / per_pascal == pytest.approx(limits["dynamic_pressure"])
        lift = vehicle["lift_to_drag"] * glide  # level flight: lift and centrifugal force carry the weight
        assert lift + speed**2 / record["planet"]["equatorial_radius"] == pytest.approx(
            max(gravity, speed**2 / 3396190.0), rel=1e-4
        )
        assert ceiling(record, speed) == pytest.approx(0.9 * min(heat, load, pressure))
    vehicle["lift_to_drag"] = 0.0
    assert corridor(record, 1000.0)[3] == inf


@pytest.fixture
def planned(onboard, planned_rows):
    """Onboard record with the drag-velocity profile laid along the reference of the scenario."""
    ENTRY_LAWS.member("adaptive_hinf").plan(onboard, planned_rows)
    return onboard, onboard[0]["plan"]["adaptive_hinf"]


def test_profile_joins_its_segments_and_lies_in_the_corridor(planned, planned_rows):
    onboard, profile = planned
    c = profile["coefficient"]
    assert c[0, 2] < 0.0 and c[1, 2] == 0.0 and c[2, 1] == c[2, 2] == 0.0  # quadratic, linear, constant
    for joint in (profile["join"], profile["level"]):
        above, below = profile_drag(profile, joint + 1e-6), profile_drag(profile, joint - 1e-6)
        assert above[0] == pytest.approx(below[0], rel=1e-6)
    assert profile_drag(profile, profile["join"] + 1e-6)[1] == pytest.approx(c[1, 1], rel=1e-4)
    for speed in np.linspace(profile["final"], profile["start"], 100):
        assert 0.0 < profile_drag(profile, speed)[0] <= ceiling(onboard[0], speed)
    start = onboard[0]["guidance"]["entry"]["adaptive_hinf"]["start_drag"]
    first = np.argmax(planned_rows["drag"] >= start)
    assert profile["range"][-1] == pytest.approx(
        planned_rows["beyond"][-1] - planned_rows["beyond"][first], rel=0.01
    )


def test_a_load_limit_presses_the_profile_down_and_the_range_is_kept(planned, planned_rows):
    onboard, profile = planned
    before = profile.copy()
    peak = max(profile_drag(before, v)[0] for v in np.linspace(before["final"], before["start"], 200))
    onboard["guidance"]["entry"]["limits"]["load"] = 0.95 * peak
    ENTRY_LAWS.member("adaptive_hinf").plan(onboard, planned_rows)
    lowered = max(profile_drag(profile, v)[0] for v in np.linspace(profile["final"], profile["start"], 200))
    assert lowered < 0.97 * peak
    assert profile["range"][-1] == pytest.approx(before["range"][-1], rel=1e-3)


def exponential(onboard):
    """Give the record an exponential density, so that the oracle needs no table."""
    air = onboard[0]["atmosphere"]
    heights = air["bottom"] + air["spacing"] * np.arange(len(air["ln_density"]))
    air["ln_density"] = np.log(0.0158) - heights / 9354.0


@pytest.mark.parametrize("first", [4200.0, pytest.param(3000.0, marks=pytest.mark.long)])
def test_range_prediction_is_that_of_a_flight_held_on_the_profile(planned, first):
    """A point mass with whatever lift it takes to follow the profile, integrated by scipy from ``first`` to
    the end.
    """
    onboard, profile = planned
    exponential(onboard)
    integrate_range(onboard[0], profile)
    planet, vehicle = onboard[0]["planet"], onboard[0]["vehicle"]
    radius, mu = float(planet["equatorial_radius"]), float(planet["mu"])
    per_density = 0.5 * float(vehicle["drag_area"] / vehicle["entry_mass"])

    def rates(t, s):
        h, v, gamma, _ = s
        r = radius + h
        g = mu / r**2
        drag = per_density * 0.0158 * exp(-h / 9354.0) * v * v
        goal, slope, curvature = profile_drag(profile, v)
        # lift equal to drag: cos(bank) is L/D upwards
        rate, a, b = drag_dynamics(drag, v, gamma, r, g, drag, 9354.0)
        speed_rate = -drag - g * sin(gamma)
        wanted = (
            curvature * speed_rate**2
            + slope * -rate
            + 0.8 * (slope * speed_rate - rate)
            + 0.16 * (goal - drag)
        )
        up = (wanted - b) / a
        return [
            v * sin(gamma),
            speed_rate,
            drag * up / v + (v / r - g / v) * cos(gamma),
            v * cos(gamma) * radius / r,
        ]

    goal, slope, _ = profile_drag(profile, first)
    height = -9354.0 * np.log(goal / (per_density * 0.0158 * first**2))
    gamma = asin(path_sine(first, goal, slope, mu / (radius + height) ** 2, 9354.0))

    def slow(t, s):
        return s[1] - float(profile["final"])

    slow.terminal = True
    flown = solve_ivp(
        rates, (0.0, 900.0), [height, first, gamma, 0.0], events=slow, rtol=1e-8, atol=1e-6, max_step=0.2
    )
    assert flown.t_events[0].size == 1
    coast = profile["coast"] / profile_drag(profile, profile["final"])[0]
    assert profile_range(profile, first) == pytest.approx(flown.y[3, -1] + coast, rel=0.01)
    assert coast > 10e3


def test_range_goes_with_the_inverse_of_drag(planned):
    onboard, profile = planned
    more = np.zeros(1, DRAG_VELOCITY)[0]
    for name in profile.dtype.names:
        more[name] = profile[name]
    more["coefficient"] *= 1.1
    integrate_range(onboard[0], more)
    assert profile_range(more, 3500.0) == pytest.approx(profile_range(profile, 3500.0) / 1.1, rel=0.02)


# ---- closed loop -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "density_factor",
    [pytest.param(0.9, marks=pytest.mark.long), pytest.param(1.0, marks=pytest.mark.long), 1.1],
)
def test_law_flies_a_point_mass_to_the_parachute_target(density_factor):
    flight = fly(
        load_scenario(
            "tianwen1",
            [
                "dynamics=point_mass",
                "mission.goal=deployment",
                "flight_software.guidance.entry.law=adaptive_hinf",
                f"truth={{atmosphere.density_factor: {density_factor}}}",
            ],
        )
    )
    assert abs(flight.figures["parachute_downrange_m"]) < 4000.0
    assert (
        abs(flight.figures["parachute_crossrange_m"]) < 2500.0
    )  # a side wind of 40 m/s drives it 1.7 km off
    memory = flight.fsw["guidance"]["entry"]["law"]["adaptive_hinf"][0]
    assert np.all((memory["theta"] >= memory["low"]) & (memory["theta"] <= memory["high"]))
    middle = 0.5 * (memory["low"] + memory["high"])
    # it has learnt something
    assert np.any(np.abs(memory["theta"] - middle) > 0.01 * (memory["high"] - memory["low"]))
