"""Disturbance torque and force estimators against the exponential, the rigid body and the continuous
observers of the paper.
"""

from math import exp

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.estimation.first_order import FirstOrderParams, estimate
from edl6dof.fsw.estimation.registry import DISTURBANCE, MEASURED, unexplained_force, unexplained_torque

J = np.array([[720.0, 12.0, -20.0], [12.0, 430.0, 8.0], [-20.0, 8.0, 490.0]])
SIX = (720.0, 430.0, 490.0, 12.0, -20.0, 8.0)


def settings(**changes):
    record = np.zeros(1, dtype_of(FirstOrderParams))
    fill(record[0], FirstOrderParams(**changes))
    return record[0]


def spin(applied, disturbance, w0, times):
    """Body rates at ``times`` by Euler's equation; ``applied(t)`` and ``disturbance(t)`` in N m."""

    def motion(t, w):
        return np.linalg.solve(J, applied(t) + disturbance(t) - np.cross(w, J @ w))

    return solve_ivp(
        motion, (times[0], times[-1]), w0, t_eval=times, rtol=1e-10, atol=1e-12, max_step=0.05
    ).y.T


def run_estimator(p, rates, applied, dt):
    """Estimates after each cycle; ``applied[k]`` acted between samples k and k+1."""
    memory = Estimator()
    found = [torque_from(p, SIX, rates[0], np.zeros(3), dt, memory)]
    for k in range(1, len(rates)):
        found.append(torque_from(p, SIX, rates[k], applied[k - 1], dt, memory))
    return np.array(found)


class Estimator:
    """The estimate, and the last sample that the next one is compared with."""

    def __init__(self):
        self.measured, self.out = np.zeros(1, MEASURED)[0], np.zeros(1, DISTURBANCE)[0]
        self.last = None

    def sample(self, p, sample, unexplained, rows, dt):
        """Estimate after one more ``sample``; ``unexplained(last)`` fills the ``rows`` of the wrench."""
        if self.last is not None:
            self.measured["unexplained"][rows] = unexplained(self.last)
            estimate(p, self.measured, dt, None, self.out)
        self.last = tuple(sample)


def torque_from(p, inertia, w, applied, dt, memory):
    """Torque estimate after one more sample of the rate, of a body that does not accelerate."""

    def unexplained(last):
        return unexplained_torque(inertia, tuple(w), last, tuple(applied), dt)

    memory.sample(p, w, unexplained, slice(3, 6), dt)
    return tuple(memory.out["torque"])


def force_from(p, mass, gain, applied, dt, memory):
    """Force estimate after one more sample of the velocity gained, of a body that does not turn."""

    def unexplained(last):
        return unexplained_force(mass, tuple(gain), last, tuple(applied), dt)

    memory.sample(p, gain, unexplained, slice(0, 3), dt)
    return tuple(memory.out["force"])


@pytest.mark.parametrize("pole", [0.5, 1.5, 8.0])
@pytest.mark.parametrize("dt", [0.01, 0.04, 0.2])
def test_step_response_is_the_exponential_of_the_pole_at_every_rate(pole, dt):
    """From rest about a principal axis there is no gyroscopic torque, so the samples lie on 1 - exp(-lambda
    t) exactly.
    """
    torque = 100.0
    memory = Estimator()
    p = settings(torque_pole_rad_s=pole)
    for k in range(60):
        t = k * dt
        found = torque_from(
            p, (700.0, 400.0, 500.0, 0.0, 0.0, 0.0), (torque * t / 700.0, 0.0, 0.0), np.zeros(3), dt, memory
        )
        assert found[0] == pytest.approx(torque * (1.0 - exp(-pole * t)), rel=1e-9, abs=1e-9)
        assert found[1:] == (0.0, 0.0)


def test_constant_torque_on_a_tumbling_body_is_found_on_all_axes_up_to_the_sampling():
    """Full tensor and gyroscopic coupling.  The rest is the curvature of the gyroscopic torque within a
    cycle: second order in dt.
    """
    d = np.array([90.0, -60.0, 30.0])
    worst = []
    for dt in (0.04, 0.02, 0.01):
        times = np.arange(0.0, 8.0 + dt / 2, dt)
        rates = spin(lambda t: np.zeros(3), lambda t: d, np.array([0.2, -0.25, 0.15]), times)
        found = run_estimator(settings(torque_pole_rad_s=3.0), rates, np.zeros((len(times), 3)), dt)
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
        rates.append(
            spin(lambda t, k=k: applied[k], lambda t: np.zeros(3), rates[-1], np.array([0.0, dt]))[-1]
        )
    found = run_estimator(settings(), np.array(rates), applied, dt)
    assert np.max(np.abs(found)) < 3.0  # of 250 N m applied; what is left is the sampled gyroscopic torque


def test_estimate_follows_the_continuous_observer_of_the_paper():
    """S1 eq. 9, d = xi + lambda J w and xi' = -lambda (-w x J w + T + d), integrated by scipy for a varying
    disturbance.
    """
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
    answer = solve_ivp(
        both, (0, times[-1]), np.concatenate([w0, -pole * J @ w0]), t_eval=times, rtol=1e-10, atol=1e-10
    ).y.T
    continuous = answer[:, 3:] + pole * answer[:, :3] @ J
    mean = np.array([applied(t + dt / 2) for t in times])
    found = run_estimator(settings(torque_pole_rad_s=pole), answer[:, :3], mean, dt)
    assert np.max(np.abs(found - continuous)) < 1.0
    assert np.max(np.abs(continuous)) > 80.0


def test_estimate_is_limited_and_recovers():
    p = settings(torque_limit_nm=50.0, torque_pole_rad_s=2.0)
    memory = Estimator()
    w = 0.0
    for _ in range(200):
        found = torque_from(p, SIX, (w, 0.0, 0.0), np.zeros(3), 0.04, memory)
        w += 0.04 * 500.0 / 720.0
    assert found[0] == 50.0
    for _ in range(200):
        found = torque_from(p, SIX, (0.0, 0.0, 0.0), np.zeros(3), 0.04, memory)
    assert abs(found[0]) < 1e-3


def test_first_sample_only_sets_the_memory():
    memory = Estimator()
    assert torque_from(settings(), SIX, (0.5, 0.2, -0.3), np.array([10.0, 0.0, 0.0]), 0.04, memory) == (
        0.0,
        0.0,
        0.0,
    )
    assert memory.out["force"].tolist() == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("pole", [0.5, 8.0, 50.0])
@pytest.mark.parametrize("dt", [0.01, 0.04, 0.2])
def test_force_step_response_is_the_exponential_of_its_pole_at_every_rate(pole, dt):
    memory, push, mass = Estimator(), np.array([0.0, 250.0, -40.0]), 950.0
    p = settings(force_pole_rad_s=pole)
    for k in range(40):
        found = force_from(p, mass, push / mass * k * dt, np.zeros(3), dt, memory)
        assert found == pytest.approx(push * (1.0 - exp(-pole * k * dt)), rel=1e-9, abs=1e-9)


def test_force_estimate_follows_the_continuous_observer_of_the_paper():
    """S1 eqs. 10-12, F = eta + lambda_v m v_d and eta' = -lambda_v (F + F_c), integrated by scipy for a
    varying force.
    """
    pole, dt, mass = 4.0, 0.02, 900.0
    times = np.arange(0.0, 8.0, dt)

    def push(t):
        return 120.0 * np.sin(1.3 * t)

    def commanded(t):
        return 80.0 * np.cos(0.7 * t)

    def both(t, s):
        v, eta = s
        return [(push(t) + commanded(t)) / mass, -pole * (eta + pole * mass * v + commanded(t))]

    v, eta = solve_ivp(both, (0, times[-1]), [0.0, 0.0], t_eval=times, rtol=1e-10, atol=1e-10).y
    memory, found = Estimator(), []
    for k, t in enumerate(times):
        applied = np.array([0.0, 0.0, commanded(t - dt / 2)])
        found.append(
            force_from(settings(force_pole_rad_s=pole), mass, (0.0, 0.0, v[k]), applied, dt, memory)[2]
        )
    assert np.max(np.abs(np.array(found) - (eta + pole * mass * v))) < 1.0
    assert np.max(np.abs(found)) > 100.0


def test_torque_step_is_known_to_five_percent_within_half_a_second_as_flown():
    """100 N m appear at an arbitrary time, the readings are a base cycle old, thrusters pulse meanwhile;
    flown pole and rate.
    """
    dt, delay, onset = 0.04, 0.02, 0.213
    rng = np.random.default_rng(4)
    pulses = rng.choice([-180.0, 0.0, 180.0], (40, 3))
    step = np.array([0.0, 70.0, -100.0])
    starts = np.arange(-dt, 1.3, dt)  # control cycles; the body is at rest before the first

    def torque(t):
        return pulses[int((t + dt) / dt + 1e-9)] + step * (t >= onset)

    fine = np.arange(-dt, 1.3, 0.001)
    w, rates = np.zeros(3), {}
    for t in fine:
        rates[round(t, 3)] = w
        middle = torque(t + 0.0005)
        w = w + 0.001 * np.linalg.solve(J, middle - np.cross(w, J @ w))
    memory, p = Estimator(), settings()
    for t in starts[2:]:
        measured = rates[round(t - delay, 3)]
        # the measured cycle is half the last control cycle and half the one before
        applied = 0.5 * (torque_of(pulses, t - dt, dt) + torque_of(pulses, t - 2 * dt, dt))
        found = torque_from(p, SIX, measured, applied, dt, memory)
        if t >= onset + 0.5:
            assert np.max(np.abs(found - step)) < 0.05 * 100.0


def torque_of(pulses, start, dt):
    return pulses[int((start + dt) / dt + 1e-6)]
