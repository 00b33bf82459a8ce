"""Disturbance-torque estimator against the exponential, the rigid body and the continuous observer of the paper."""

from math import exp

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.estimation.disturbance import DISTURBANCE, DisturbanceParams, estimate

J = np.array([[720.0, 12.0, -20.0], [12.0, 430.0, 8.0], [-20.0, 8.0, 490.0]])
SIX = (720.0, 430.0, 490.0, 12.0, -20.0, 8.0)


def settings(**changes):
    record = np.zeros(1, dtype_of(DisturbanceParams))
    fill(record[0], DisturbanceParams(**changes))
    return record[0]


def spin(applied, disturbance, w0, times):
    """Body rates at ``times`` by Euler's equation; ``applied(t)`` and ``disturbance(t)`` in N m."""

    def motion(t, w):
        return np.linalg.solve(J, applied(t) + disturbance(t) - np.cross(w, J @ w))

    return solve_ivp(motion, (times[0], times[-1]), w0, t_eval=times, rtol=1e-10, atol=1e-12, max_step=0.05).y.T


def run_estimator(p, rates, applied, dt):
    """Estimates after each cycle; ``applied[k]`` acted between samples k and k+1."""
    memory = np.zeros(1, DISTURBANCE)[0]
    found = [estimate(p, SIX, tuple(rates[0]), (0.0, 0.0, 0.0), dt, memory)]
    for k in range(1, len(rates)):
        found.append(estimate(p, SIX, tuple(rates[k]), tuple(applied[k - 1]), dt, memory))
    return np.array(found)


@pytest.mark.parametrize("pole", [0.5, 1.5, 8.0])
@pytest.mark.parametrize("dt", [0.01, 0.04, 0.2])
def test_step_response_is_the_exponential_of_the_pole_at_every_rate(pole, dt):
    """From rest about a principal axis there is no gyroscopic torque, so the samples lie on 1 - exp(-lambda t) exactly."""
    torque = 100.0
    memory = np.zeros(1, DISTURBANCE)[0]
    p = settings(pole_rad_s=pole)
    for k in range(60):
        t = k * dt
        found = estimate(p, (700.0, 400.0, 500.0, 0.0, 0.0, 0.0), (torque * t / 700.0, 0.0, 0.0), (0.0, 0.0, 0.0), dt, memory)
        assert found[0] == pytest.approx(torque * (1.0 - exp(-pole * t)), rel=1e-9, abs=1e-9)
        assert found[1:] == (0.0, 0.0)


def test_constant_torque_on_a_tumbling_body_is_found_on_all_axes_up_to_the_sampling():
    """Full tensor and gyroscopic coupling.  The remaining error is the gyroscopic torque half a cycle late: first order in dt."""
    d = np.array([90.0, -60.0, 30.0])
    worst = []
    for dt in (0.04, 0.02, 0.01):
        times = np.arange(0.0, 8.0 + dt / 2, dt)
        rates = spin(lambda t: np.zeros(3), lambda t: d, np.array([0.2, -0.25, 0.15]), times)
        found = run_estimator(settings(pole_rad_s=3.0), rates, np.zeros((len(times), 3)), dt)
        late = times > 4.0
        worst.append(np.max(np.abs(found[late] - d)))
        gyro = np.cross(rates, rates @ J)
        assert worst[-1] < 0.6 * dt * np.max(np.abs(np.gradient(gyro, dt, axis=0)))
        assert worst[-1] < 0.05 * dt / 0.04 * np.max(np.abs(gyro))
    assert worst[1] < 0.6 * worst[0]
    assert worst[2] < 0.6 * worst[1]


def test_own_thrusters_are_not_taken_for_a_disturbance():
    rng = np.random.default_rng(2)
    dt = 0.04
    times = np.arange(0.0, 6.0, dt)
    applied = rng.choice([-250.0, 0.0, 250.0], (len(times), 3))

    def torque(t):
        return applied[min(int(t / dt + 1e-9), len(times) - 1)]

    rates = [np.zeros(3)]
    for k in range(len(times) - 1):
        rates.append(spin(lambda t, k=k: applied[k], lambda t: np.zeros(3), rates[-1], np.array([0.0, dt]))[-1])
    found = run_estimator(settings(), np.array(rates), applied, dt)
    assert np.max(np.abs(found)) < 3.0  # of 250 N m applied; what is left is the sampled gyroscopic torque


def test_estimate_follows_the_continuous_observer_of_the_paper():
    """S1 eq. 9, d = xi + lambda J w and xi' = -lambda (-w x J w + T + d), integrated by scipy for a varying disturbance."""
    pole, dt = 1.5, 0.02
    times = np.arange(0.0, 10.0, dt)

    def disturbance(t):
        return np.array([80.0 + 20.0 * np.sin(0.8 * t), -40.0 * np.cos(0.5 * t), 30.0 * np.sin(1.1 * t)])

    def applied(t):
        return np.array([-60.0, 30.0 * np.cos(0.5 * t), -20.0])

    def both(t, s):
        w, xi = s[:3], s[3:]
        seen = xi + pole * J @ w
        w_dot = np.linalg.solve(J, applied(t) + disturbance(t) - np.cross(w, J @ w))
        return np.concatenate([w_dot, -pole * (-np.cross(w, J @ w) + applied(t) + seen)])

    w0 = np.array([0.1, -0.1, 0.05])
    answer = solve_ivp(both, (0, times[-1]), np.concatenate([w0, -pole * J @ w0]), t_eval=times, rtol=1e-10, atol=1e-10).y.T
    continuous = answer[:, 3:] + pole * answer[:, :3] @ J
    mean = np.array([applied(t + dt / 2) for t in times])
    found = run_estimator(settings(pole_rad_s=pole), answer[:, :3], mean, dt)
    assert np.max(np.abs(found - continuous)) < 1.0
    assert np.max(np.abs(continuous)) > 80.0


def test_estimate_is_limited_and_recovers():
    p = settings(limit_nm=50.0, pole_rad_s=2.0)
    memory = np.zeros(1, DISTURBANCE)[0]
    w = 0.0
    for _ in range(200):
        found = estimate(p, SIX, (w, 0.0, 0.0), (0.0, 0.0, 0.0), 0.04, memory)
        w += 0.04 * 500.0 / 720.0
    assert found[0] == 50.0
    for _ in range(200):
        found = estimate(p, SIX, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.04, memory)
    assert abs(found[0]) < 1e-3


def test_first_sample_only_sets_the_memory():
    memory = np.zeros(1, DISTURBANCE)[0]
    assert estimate(settings(), SIX, (0.5, 0.2, -0.3), (10.0, 0.0, 0.0), 0.04, memory) == (0.0, 0.0, 0.0)
