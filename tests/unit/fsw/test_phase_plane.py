"""Phase-plane control: capture, limit cycle and hysteresis on a double integrator with minimum-pulse thrusters."""

from math import radians

import numpy as np
import pytest

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.control.phase_plane import PhasePlaneParams, switch_axis

DT = 0.04


@pytest.fixture(scope="module")
def params():
    record = np.zeros(1, dtype_of(PhasePlaneParams))
    fill(record[0], PhasePlaneParams())
    return record[0]


def drive(p, error, rate, duration, disturbance=0.0, dt=DT):
    firing, history = 0, []
    for _ in range(int(duration / dt)):
        firing = switch_axis(p, firing, error, rate)
        history.append((error, rate, firing))
        a = firing * p["acceleration"] + disturbance
        error -= rate * dt + 0.5 * a * dt * dt
        rate += a * dt
    return np.array(history).T


def test_random_initial_errors_are_driven_into_the_deadband_and_stay(params):
    rng = np.random.default_rng(0)
    for _ in range(40):
        error, rate, _ = drive(params, radians(rng.uniform(-120, 120)), radians(rng.uniform(-4, 4)), 180.0)
        late = slice(int(100.0 / DT), None)
        assert np.max(np.abs(error[late])) <= 1.02 * params["deadband"]
        assert np.max(np.abs(rate[late])) <= radians(1.1) < params["rate_limit"]


@pytest.mark.parametrize("disturbance_deg_s2", [0.002, 0.01, -0.05])
def test_limit_cycle_under_a_disturbance_stays_within_the_deadband_and_balances_it(params, disturbance_deg_s2):
    push = radians(disturbance_deg_s2)
    error, _, firing = drive(params, 0.0, 0.0, 600.0, push)
    late = slice(int(200.0 / DT), None)
    assert np.max(np.abs(error[late])) < 1.1 * params["deadband"]
    assert np.mean(firing[late]) * params["acceleration"] == pytest.approx(-push, abs=2.0 * radians(1.0) / 400.0)


def test_free_limit_cycle_is_slow():
    """Without disturbance a deadband controller should drift between the edges with about the rate of its rate deadband."""
    p = np.zeros(1, dtype_of(PhasePlaneParams))
    fill(p[0], PhasePlaneParams())
    _, rate, firing = drive(p[0], radians(5.0), 0.0, 600.0)
    late = slice(int(200.0 / DT), None)
    assert np.max(np.abs(rate[late])) <= 2.0 * p[0]["rate_deadband"]
    assert np.mean(np.abs(firing[late])) < 0.02


def test_firing_goes_on_below_the_threshold_that_starts_it(params):
    threshold, lower = params["deadband"], params["hysteresis"] * params["deadband"]
    between = 0.5 * (threshold + lower)
    for sign in (1.0, -1.0):
        fast = -sign * 2.0 * params["rate_deadband"]  # outside the rate deadband, moving away
        gap = 0.5 * fast + fast * abs(fast) / (2.0 * params["acceleration"])
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
    """On the parabola e = w |w| / (2 a) full braking stops at zero error: there the law must not accelerate any more."""
    for rate in np.linspace(0.01, params["rate_limit"], 30):
        on_parabola = rate * rate / (2.0 * params["acceleration"])
        assert switch_axis(params, 0, on_parabola, rate) <= 0
        assert switch_axis(params, 0, on_parabola - 2.0 * params["deadband"], rate) == -1
