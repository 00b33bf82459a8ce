"""Phase-plane control: capture, limit cycle and hysteresis on a double integrator with minimum-pulse
thrusters.
"""

from math import radians

import numpy as np
import pytest
from numba import njit

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.control import phase_plane
from edl6dof.fsw.control.phase_plane import PhasePlaneParams, switch_axis

DT = 0.04


def settings(**changes):
    record = np.zeros(1, dtype_of(PhasePlaneParams))
    fill(record[0], PhasePlaneParams(**changes))
    return record[0]


@pytest.fixture(scope="module")
def params():
    return settings()


def drive(p, error, rate, duration, disturbance=0.0, dt=DT):
    history = np.zeros((3, int(duration / dt)))
    drive_each(np.asarray(p).reshape(1), error, rate, disturbance, dt, history)
    return history


@njit
def drive_each(params, error, rate, disturbance, dt, history):
    """A double integrator under the law, compiled with it."""
    p, firing = params[0], 0
    for k in range(history.shape[1]):
        firing = switch_axis(p, firing, error, rate)
        history[0, k], history[1, k], history[2, k] = error, rate, firing
        a = firing * p.acceleration + disturbance
        error -= rate * dt + 0.5 * a * dt * dt
        rate += a * dt


def test_random_initial_errors_are_driven_into_the_deadband_and_stay(params):
    rng = np.random.default_rng(0)
    for _ in range(40):
        error, rate, _ = drive(params, radians(rng.uniform(-120, 120)), radians(rng.uniform(-4, 4)), 180.0)
        late = slice(int(100.0 / DT), None)
        assert np.max(np.abs(error[late])) <= 1.02 * params["deadband"]
        assert np.max(np.abs(rate[late])) <= radians(1.1) < params["rate_limit"]


@pytest.mark.parametrize("disturbance_deg_s2", [0.002, 0.01, -0.05])
def test_limit_cycle_under_a_disturbance_stays_within_the_deadband_and_balances_it(
    params, disturbance_deg_s2
):
    push = radians(disturbance_deg_s2)
    error, _, firing = drive(params, 0.0, 0.0, 600.0, push)
    late = slice(int(200.0 / DT), None)
    assert np.max(np.abs(error[late])) < 1.1 * params["deadband"]
    assert np.mean(firing[late]) * params["acceleration"] == pytest.approx(
        -push, abs=2.0 * radians(1.0) / 400.0
    )


def predicted_rate(p):
    """Positive root of 2 T w + w^2 / a = (1 - h) d, derived in the module's docstring."""
    lead, a = p["lead"], p["acceleration"]
    return a * (np.sqrt(lead**2 + (1.0 - p["hysteresis"]) * p["deadband"] / a) - lead)


def predicted_period(p):
    """Two firings of 2 w / a and two coasts between the errors at which they end and begin."""
    w, a = predicted_rate(p), p["acceleration"]
    ends = p["deadband"] - w * w / (2.0 * a) - p["lead"] * w
    return 2.0 * (2.0 * w / a + 2.0 * ends / w)


@pytest.mark.parametrize(
    "deadband_deg, hysteresis, lead, acceleration",
    [
        *((2.0, 0.96, 0.5, 1.2), (2.0, 0.9, 1.0, 1.2), (4.0, 0.95, 1.0, 1.2), (1.0, 0.9, 0.5, 1.2)),
        (2.0, 0.5, 0.1, 0.05),  # a firing takes a fifth of the period
    ],
)
def test_free_limit_cycle_has_the_amplitude_rate_and_period_of_the_switching_lines(
    deadband_deg, hysteresis, lead, acceleration
):
    p = settings(
        deadband_deg=deadband_deg, hysteresis=hysteresis, lead_s=lead, acceleration_deg_s2=acceleration
    )
    dt, d = 0.001, p["deadband"]
    w, period = predicted_rate(p), predicted_period(p)
    error, rate, firing = drive(p, 0.0, w, 3.2 * period, dt=dt)
    assert np.ptp(rate) == pytest.approx(2.0 * w, rel=0.05)
    assert np.max(np.abs(error)) == pytest.approx(d - lead * w, rel=0.005)
    begins = np.flatnonzero((firing[1:] > 0) & (firing[:-1] <= 0)) * dt
    assert np.diff(begins) == pytest.approx(period, rel=0.06)


def test_the_defaults_cycle_as_the_docstring_says(params):
    w, text = predicted_rate(params), phase_plane.__doc__
    assert f"w = {np.degrees(w):.3f} deg/s" in text
    assert f"amplitude {np.degrees(params['deadband'] - params['lead'] * w):.2f} deg" in text
    assert f"period {predicted_period(params):.0f} s" in text


@pytest.mark.parametrize("pulse", [0.2, pytest.param(0.4, marks=pytest.mark.long)])
def test_a_coarse_minimum_pulse_sets_the_rates_of_the_limit_cycle(params, pulse):
    """A pulse that changes the rate by more than the switching lines do: the rates before and after it differ
    by just that.
    """
    p, dt = params, 0.004
    error, rate, left, firing, rates = 0.0, radians(0.08), 0, 0, []
    for _ in range(int(600.0 / dt)):
        if left == 0:
            firing = switch_axis(p, 0, error, rate)
            left = round(pulse / dt) if firing else 0
        a = (firing if left else 0) * p["acceleration"]
        left = max(left - 1, 0)
        error -= rate * dt + 0.5 * a * dt * dt
        rate += a * dt
        rates.append(rate)
        assert abs(error) < 1.02 * p["deadband"]
    quantum = p["acceleration"] * pulse
    assert quantum > 2.0 * predicted_rate(p)
    assert np.ptp(rates) == pytest.approx(quantum, rel=0.03)


def test_firing_goes_on_below_the_threshold_that_starts_it(params):
    threshold, lower = params["deadband"], params["hysteresis"] * params["deadband"]
    between = 0.5 * (threshold + lower)
    for sign in (1.0, -1.0):
        fast = -sign * radians(0.3)  # moving away
        gap = params["lead"] * fast + fast * abs(fast) / (2.0 * params["acceleration"])
        assert switch_axis(params, 0, sign * between + gap, fast) == 0
        assert switch_axis(params, int(sign), sign * between + gap, fast) == sign
        assert switch_axis(params, 0, sign * 1.01 * threshold + gap, fast) == sign
        assert switch_axis(params, int(sign), sign * 0.99 * lower + gap, fast) == 0


def test_capture_coasts_at_the_rate_limit(params):
    error, rate, firing = drive(params, radians(100.0), 0.0, 60.0)
    assert np.max(np.abs(rate)) <= params["rate_limit"] + params["acceleration"] * DT + 1e-12
    assert np.mean(firing[np.abs(rate) > params["rate_limit"]] == 0) > 0.9
    assert np.min(error) > -1.05 * params["deadband"]


def test_switching_is_odd(params):
    rng = np.random.default_rng(1)
    for error, rate in rng.uniform(-0.3, 0.3, (500, 2)):
        for firing in (-1, 0, 1):
            assert switch_axis(params, firing, error, rate) == -switch_axis(params, -firing, -error, -rate)


def test_braking_begins_no_later_than_the_minimum_time_parabola_plus_deadband(params):
    """On the parabola e = w |w| / (2 a) full braking stops at zero error: there the law must not accelerate
    any more.
    """
    for rate in np.linspace(0.01, params["rate_limit"], 30):
        on_parabola = rate * rate / (2.0 * params["acceleration"])
        assert switch_axis(params, 0, on_parabola, rate) <= 0
        assert switch_axis(params, 0, on_parabola - 2.0 * params["deadband"], rate) == -1
