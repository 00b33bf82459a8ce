"""Lu & Bayard's theorem in its own setting: drag, drag rate and speed under eqs. 15 and 16 with constant
theta and unlimited control, integrated by RK4, under disturbances that know nothing of the error.

The energy of the drag error stays below lambda^2 times that of the disturbance and what the start adds.
"""

from collections.abc import Callable
from functools import lru_cache
from math import sin
from typing import NamedTuple

import numpy as np
import pytest
from scipy.integrate import simpson, solve_ivp
from scipy.interpolate import CubicSpline

from edl6dof.fsw.guidance.entry.drag_velocity import path_sine, profile_drag
from edl6dof.fsw.guidance.entry.laws.adaptive_hinf import MEMORY, adapt, begin, feedback, riccati
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.records import build_onboard
from edl6dof.studies.lu_bayard import FLOWN, SCENARIO, START_ERROR, Design, Response

#: True theta, inside the law's set; length and step of the integration, s.
THETA, DURATION_S, STEP_S = np.array([1e-3, -5e-5, 0.06, 0.03, 0.05]), 110.0, 0.05


class Setting(NamedTuple):
    design: Design
    low: np.ndarray
    high: np.ndarray
    profile: np.void


class Reply(NamedTuple):
    response: Response
    theta: np.ndarray

    def storage(self, setting):
        """W = z' P z + (p - theta)' Q (p - theta) of each row, which without disturbance must not rise."""
        off = (self.theta - THETA) / (setting.high - setting.low)
        one, (p11, p12, p22) = self.response, riccati(setting.design.gain, setting.design.weight)
        state = p11 * one.error**2 + 2.0 * p12 * one.error * one.rate + p22 * one.rate**2
        return state + setting.design.energy / 5.0 * np.sum(off**2, axis=1)


@pytest.fixture(scope="module")
def setting():
    onboard = build_onboard(load_scenario(SCENARIO, FLOWN).scenario)
    memory = np.zeros(1, MEMORY)[0]
    begin(onboard[0]["guidance"]["entry"]["adaptive_hinf"], memory)
    profile = onboard[0]["plan"]["adaptive_hinf"]
    return Setting(Design.of(onboard), memory["low"].copy(), memory["high"].copy(), profile)


def nothing(t):
    return 0.0


def dying_out(t):
    """Near the resonance of the drag loop, m/s4."""
    return float(0.05 * sin(0.11 * t) * np.exp(-t / 30.0))


def gust(t):
    """One half wave, m/s4."""
    return 0.08 * sin(np.pi * (t - 30.0) / 10.0) if 30.0 < t < 40.0 else 0.0


def along(setting):
    """Drag of the profile and its derivatives as a function of time."""
    design, profile = setting.design, setting.profile

    def slowing(t, v):
        drag, slope, _ = profile_drag(profile, v[0])
        sine = path_sine(v[0], drag, slope, design.gravity, design.scale_height)
        return [-drag - design.gravity * sine]

    t = np.arange(0.0, DURATION_S + 1.0, 0.5)
    speed = solve_ivp(slowing, (0.0, t[-1]), [profile["start"]], t_eval=t, rtol=1e-9).y[0]
    drag = CubicSpline(t, [profile_drag(profile, v)[0] for v in speed])
    parts = (drag, drag.derivative(), drag.derivative(2))
    return lru_cache(maxsize=2)(lambda now: tuple(float(part(now)) for part in parts))


def respond(setting, w: Callable[[float], float], *, adaptive=True, **changes):
    """Response along the profile, from a wrong drag and a wrong theta; ``changes`` of what is integrated."""
    design, low, high, profile = setting
    about = {
        "reference": changes.get("reference") or along(setting),
        "start": (START_ERROR, 0.0, float(profile["start"])),
        "duration": DURATION_S,
        "theta": THETA,
    } | changes
    reference, theta = about["reference"], about["theta"]
    (f1, f2), (_, p12, p22) = feedback(design.gain, design.weight), riccati(design.gain, design.weight)
    estimate = 0.5 * (low + high)

    def rates(t, state):
        drag, rate, speed = state
        free, unknown, per_u = design.dynamics(drag, rate, speed)
        goal, goal_rate, goal_acceleration = reference(t)
        wanted = goal_acceleration + f1 * (drag - goal) + f2 * (rate - goal_rate)
        u = (wanted + free + np.dot(unknown, estimate)) / ((1.0 - estimate[3]) * per_u)
        regressor = (*unknown[:3], per_u * u, unknown[4])
        k = 1.0 + 2.0 * design.gravity * design.scale_height / speed**2
        climb = -design.scale_height / k * (rate / drag + 2.0 * drag / speed - theta[0])
        acceleration = per_u * u - free - np.dot(regressor, theta) + w(t)
        return np.array([rate, acceleration, -drag - design.gravity * climb / speed]), regressor

    goal, goal_rate, _ = reference(0.0)
    error, error_rate, speed = about["start"]
    state = np.array([goal + error, goal_rate + error_rate, speed])
    t = STEP_S * np.arange(round(about["duration"] / STEP_S) + 1)
    rows = []
    for now in t:
        goal, goal_rate, _ = reference(now)
        error, error_rate = state[0] - goal, state[1] - goal_rate
        rows.append((error, error_rate, w(now), *estimate))
        first, regressor = rates(now, state)
        second, _ = rates(now + 0.5 * STEP_S, state + 0.5 * STEP_S * first)
        third, _ = rates(now + 0.5 * STEP_S, state + 0.5 * STEP_S * second)
        fourth, _ = rates(now + STEP_S, state + STEP_S * third)
        if adaptive:
            adapt(estimate, low, high, regressor, p12 * error + p22 * error_rate, design.energy, STEP_S)
        state = state + STEP_S / 6.0 * (first + 2.0 * (second + third) + fourth)
    errors, error_rates, disturbance, *theta = np.array(rows).T
    return Reply(Response(design, t, errors, error_rates, disturbance), np.array(theta).T)


@pytest.mark.parametrize("w", [nothing, dying_out, gust])
def test_error_energy_keeps_its_bound(setting, w):
    assert respond(setting, w).response.over_bound < 1.0


def test_error_converges_without_disturbance_and_adaptation_is_why(setting):
    ends = {}
    for adaptive in (True, False):
        response = respond(setting, nothing, adaptive=adaptive).response
        ends[adaptive] = np.max(np.abs(response.error[response.t > DURATION_S - 5.0]))
    assert ends[True] < 1e-3 * START_ERROR and ends[False] > 10.0 * ends[True]


def test_storage_falls_under_the_law_and_rises_when_adaptation_goes_the_wrong_way(setting):
    storage = respond(setting, nothing).storage(setting)
    assert storage[-1] < 0.999 * storage[0] and np.max(np.diff(storage)) < 1e-3 * storage[0]
    wrong = setting._replace(design=setting.design._replace(energy=-setting.design.energy))
    rising = respond(wrong, nothing).storage(wrong)
    assert np.max(rising) > 1.01 * rising[0]


def steady(t):
    """A reference that stands still."""
    return 60.0, 0.0, 0.0


def test_worst_disturbance_of_the_theory_comes_near_the_bound_and_not_past_it(setting):
    """With theta known, w of one frequency at the peak of the gain: energy ratio close to lambda squared of
    that frequency.
    """
    frequency, known = 0.05, np.zeros(5)
    design = setting.design._replace(energy=1e9, gravity=0.0)
    reply = respond(
        Setting(design, known - 1e-12, known + 1e-12, setting.profile),
        lambda t: 0.02 * np.sin(frequency * t),
        reference=steady,
        theta=known,
        start=(0.0, 0.0, 50e3),
        duration=600.0,
    ).response
    ratio = simpson(reply.error**2, x=reply.t) / simpson(reply.disturbance**2, x=reply.t)
    a = np.array([[0.0, 1.0], [-0.5 * 32.02563 / 625.0, -0.5 * 256.3078 / 625.0]])  # A + B F by hand
    gain = abs(np.linalg.solve(1j * frequency * np.eye(2) - a, [0.0, 1.0])[0])
    assert ratio == pytest.approx(gain**2, rel=0.1)
    assert 0.7 * design.gain**2 < ratio < design.gain**2


def test_estimates_stay_in_the_set_under_a_disturbance_far_too_large(setting):
    start = (0.0, 0.0, 4000.0)
    push = lambda t: 3.0 * np.sin(0.2 * t)  # noqa: E731
    theta = respond(setting, push, reference=steady, start=start, duration=40.0).theta
    assert np.all((theta >= setting.low) & (theta <= setting.high))
    assert np.any(theta == setting.low) or np.any(theta == setting.high)
