"""The observers of dob_sliding, ftc_dob and pd_dob on plants whose disturbance is known, at fast and slow
guidance rates.
"""

from math import atan, cos, exp, sin

import numpy as np
import pytest

import edl6dof
from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.guidance.entry.disturbance_observers import PATH_OBSERVER, PathObserverParams, observe_path
from edl6dof.fsw.guidance.entry.drag_dynamics import drag_dynamics
from edl6dof.fsw.guidance.entry.laws.dob_sliding import MEMORY as SLIDING_MEMORY
from edl6dof.fsw.guidance.entry.laws.dob_sliding import DobSlidingParams, observe
from edl6dof.fsw.guidance.entry.laws.ftc_dob import power
from edl6dof.fsw.guidance.entry.laws.pd_dob import MEMBER as PD_DOB
from edl6dof.fsw.guidance.entry.laws.pd_dob import PdDobParams
from edl6dof.fsw.navigation.derived import NAV


def params(model, **changes):
    record = np.zeros(1, dtype_of(model))
    fill(record[0], model(**changes))
    return record[0]


# ---- linear observer of the lumped disturbance -------------------------------------------------------------


def surface_after(disturbance, dt, seconds, tau):
    """Fly s' = d + v_fb with v_fb = -d^ - k_s s held between samples; returns the estimate and the surface at
    the end.

    The drag error is taken as s / k_e with no rate, so that the surface of the law is s itself.
    """
    p = params(DobSlidingParams, filter_time_s=tau)
    memory = np.zeros(1, SLIDING_MEMORY)[0]
    memory["decay"], s, t = 2.0, 0.3, 0.0
    for _ in range(round(seconds / dt)):
        observe(p, memory, dt, s / p["error_gain"], 0.0, memory["input"])
        assert memory["surface"] == pytest.approx(s)
        memory["feedback"] = -memory["disturbance"] - p["surface_gain"] * s
        steps = np.linspace(t, t + dt, 21)
        s += np.trapezoid([disturbance(x) for x in steps], steps) + memory["feedback"] * dt
        t += dt
    return float(memory["disturbance"]), s


@pytest.mark.parametrize("dt", [0.02, 0.2, 1.0])
@pytest.mark.parametrize("tau", [0.1, pytest.param(1.0, marks=pytest.mark.long)])
def test_constant_disturbance_is_found_and_the_surface_dies_out_at_any_rate(dt, tau):
    estimate, surface = surface_after(lambda t: 0.7, dt, 80.0, tau)
    assert estimate == pytest.approx(0.7, rel=1e-3)
    assert surface == pytest.approx(0.0, abs=1e-3)


def test_estimate_follows_a_ramp_by_the_time_of_its_filter_and_half_a_sample():
    """Error of a first-order filter on a ramp: slope times tau; the mean of a past interval adds half of it,
    sampling the other half.
    """
    estimate, _ = surface_after(lambda t: 0.05 * t, 0.02, 20.0, 0.5)
    assert estimate == pytest.approx(0.05 * (20.0 - 0.02 - 0.5), abs=0.05 * 0.03)


def test_virtual_state_obeys_its_equation_under_constant_saturation():
    """zeta' = -c0 zeta + b delta, solved in closed form, whatever the sampling."""
    p = params(DobSlidingParams)
    for dt in (0.02, 0.2, 1.0):
        memory = np.zeros(1, SLIDING_MEMORY)[0]
        memory["started"], memory["decay"], memory["authority"], memory["input"] = 1, 2.0, -0.08, 1.9
        for _ in range(round(2.0 / dt)):
            observe(p, memory, dt, 0.0, 0.0, 1.0)
        assert memory["virtual"] == pytest.approx(-0.08 * (1.0 - 1.9) / 2.0 * (1.0 - exp(-4.0)), rel=1e-12)


def test_eta_grows_with_the_surface_only():
    p = params(DobSlidingParams, adaptation=0.5)
    memory = np.zeros(1, SLIDING_MEMORY)[0]
    memory["started"], memory["decay"] = 1, 2.0
    observe(p, memory, 0.1, 0.0, -0.4, 0.0)
    assert memory["eta"] == pytest.approx(0.5 * 0.4 * 0.1)
    observe(p, memory, 0.1, 0.0, 0.0, 0.0)
    assert memory["eta"] == pytest.approx(0.02)


# ---- observer of the flight-path rate ----------------------------------------------------------------------


def path_estimates(gain, dt, disturbance, seconds=10.0):
    """Feed the observer a flight path with known disturbance, exactly integrated; returns times and
    estimates.
    """
    p, memory, nav = params(PathObserverParams, gain=gain), np.zeros(1, PATH_OBSERVER)[0], np.zeros(1, NAV)[0]
    nav["speed"], nav["radius"], nav["gravity"], nav["bank"] = 4000.0, 3.42e6, 3.66, 1.1
    lift, times, found, gamma = 12.0, [], [], -0.2
    for k in range(round(seconds / dt)):
        nav["t"], nav["flight_path_angle"] = k * dt, gamma
        found.append(observe_path(p, memory, nav, lift))
        times.append(k * dt)
        for j in range(100):
            free = (4000.0 / 3.42e6 - 3.66 / 4000.0) * cos(gamma)
            gamma += dt / 100 * (lift / 4000.0 * cos(1.1) + free + disturbance(k * dt + (j + 0.5) * dt / 100))
    return np.array(times), np.array(found)


def test_error_of_a_constant_disturbance_decays_as_the_source_says_whatever_the_rate():
    """e' = -l e (eq. 17), also where l dt > 2, where Euler steps would diverge."""
    for gain, dt in ((1.0, 0.02), (10.0, 0.02), (10.0, 0.2), (60.0, 0.2)):
        t, estimate = path_estimates(gain, dt, lambda _: 3e-3)
        assert estimate == pytest.approx(3e-3 * (1.0 - np.exp(-gain * t)), abs=3e-8)


def test_sine_is_followed_with_the_lag_of_a_first_order_filter():
    t, estimate = path_estimates(20.0, 0.02, lambda x: 0.01 * sin(x), 20.0)
    late = t > 5.0
    assert estimate[late] == pytest.approx(
        0.01 * cos(atan(1.0 / 20.0)) * np.sin(t[late] - atan(1.0 / 20.0)), abs=1e-5
    )
    assert np.max(np.abs(estimate[late] - 0.01 * np.sin(t[late]))) < 0.07 * 0.01


# ---- finite time and drag dynamics -------------------------------------------------------------------------


def test_power_keeps_the_sign_and_is_stronger_than_linear_near_zero():
    assert power(-0.04, 0.5) == pytest.approx(-0.2)
    assert power(4.0, 0.5) == pytest.approx(2.0)
    assert power(0.0, 0.5) == 0.0


def test_double_integrator_reaches_zero_in_finite_time():
    """Lemma 2: with alpha_2 = 2 alpha_1/(1 + alpha_1) both states vanish in finite time; linear feedback of
    the same gains only decays.
    """
    sizes = {}
    for name, exponent in (("finite", 0.6), ("linear", 1.0)):
        x, v, dt = 1.0, 0.0, 1e-3
        for _ in range(40000):
            u = -0.25 * power(x, exponent) - 0.8 * power(v, 2.0 * exponent / (1.0 + exponent))
            x, v = x + v * dt, v + u * dt
        sizes[name] = abs(x) + abs(v)
    assert sizes["finite"] < 1e-9
    assert sizes["linear"] > 100.0 * sizes["finite"]


@pytest.mark.parametrize(
    "drag, v, gamma, r",
    [(2.0, 6000.0, -0.25, 3.46e6), (90.0, 4000.0, -0.12, 3.41e6), (15.0, 900.0, -0.2, 3.4e6)],
)
def test_what_the_prints_have_otherwise_is_what_the_docstring_says(drag, v, gamma, r):
    """Zheng & Cui eqs. 13-14 and Yan, Sun & Guo eq. 14, with and without the corrections, against the derived
    dynamics.
    """
    g, h, s, c = 4.283e13 / r**2, 9354.0, sin(gamma), cos(gamma)
    rate, _, free = drag_dynamics(drag, v, gamma, r, g, 0.24 * drag, h)
    slowing, turning = drag + g * s, g - v * v / r
    assert rate == pytest.approx(-drag * v * s / h - 2.0 * drag * slowing / v, rel=1e-12)
    # eq. 14 as printed, solved for D'
    assert rate != pytest.approx((-2.0 * drag * slowing / v) / (1.0 + v * s / h), rel=0.1)
    shared = (
        -rate * v * s / h
        + drag * slowing * s / h
        + drag * c * c * turning / h
        - 2.0 * drag * slowing**2 / v**2
    )
    shared += -2.0 * drag * rate / v + 2.0 * drag * g * c * c * turning / v**2
    height = 4.0 * drag * g * s * s / r
    assert free == pytest.approx(shared + height - 2.0 * rate * slowing / v, rel=1e-9)
    # eq. 13 of Zheng & Cui as printed
    assert free != pytest.approx(shared + height + 2.0 * rate * slowing / v**2, rel=1e-3)
    # eq. 14 of Yan, Sun & Guo as printed
    assert free != pytest.approx(shared - 2.0 * rate * slowing / v, rel=1e-9)


def test_drag_dynamics_are_those_of_a_flown_trajectory():
    """First and second derivative of the accelerometer's drag in a flight of the simulator, by finite
    differences of its telemetry.
    """
    flight = edl6dof.fly(
        "zheng2015",
        ["mission={goal: time, phases: []}", "simulation.time_limit_s=140", "initial.bank_deg=60"],
    )
    rows = flight.telemetry
    t, drag = rows["t_s"], rows["nav.drag_m_s2"]
    radius = 3394500.0 + rows["truth.altitude_m"]
    gamma = np.radians(rows["truth.flight_path_angle_deg"])
    gravity = 4.283e13 / radius**2
    state = zip(drag, rows["truth.speed_m_s"], gamma, radius, gravity, 0.24 * drag, strict=True)
    rate, per_u, free = np.array([drag_dynamics(*values, 9354.0) for values in state]).T
    first, step = np.gradient(drag, t), t[1] - t[0]
    second = (drag[2:] - 2.0 * drag[1:-1] + drag[:-2]) / step**2
    felt = drag[1:-1] > 1.0
    scale = np.max(np.abs(second))
    assert rate[1:-1][felt] == pytest.approx(first[1:-1][felt], abs=1e-4 * np.max(np.abs(first)))
    assert (free + per_u * cos(np.radians(60.0)))[1:-1][felt] == pytest.approx(second[felt], abs=1e-3 * scale)


# ---- proportional-derivative law ---------------------------------------------------------------------------


@pytest.mark.parametrize("error, error_rate", [(1.5, -0.4), (-2.0, 0.7), (0.6, 0.9)])
def test_error_of_the_drag_obeys_its_second_order_equation(monkeypatch, error, error_rate):
    """e'' + k_D e' + k_P e = 0, with e'' = drift + authority cos(bank)."""
    guide, drift, authority = PD_DOB.kernels["guide"].py_func, 0.3, -4.0
    found = {
        "tracking": lambda *_: True,
        "disturbed_drag": lambda *_: (error, error_rate, drift, authority),
    }
    for name, kernel in found.items():
        monkeypatch.setitem(guide.__globals__, name, kernel)
    p = params(PdDobParams, error_gain=0.4, rate_gain=0.9).view(np.recarray)
    bank = guide(p, *[None] * 5)
    assert drift + authority * cos(bank) == pytest.approx(-0.4 * error - 0.9 * error_rate, abs=1e-12)
