"""Strapdown integration: closed forms of coning and sculling drift, and a long fall against scipy."""

from math import cos, pi, radians, sin

import numpy as np
import pytest
from inertial_units import DT
from pyquaternion import Quaternion
from scipy.integrate import solve_ivp

import edl6dof
from edl6dof.fsw.navigation.solution import MOTION, SOLUTION
from edl6dof.fsw.navigation.strapdown import (
    gain_in_first_axes,
    gravity_I,
    integrate,
    rotation_vector_of,
    turn_ahead,
    turn_by,
)
from edl6dof.kernels import kernel
from edl6dof.scenario.records import build_records

A, B = radians(0.2), radians(0.3)


@pytest.fixture(scope="module")
def planet():
    return build_records(edl6dof.load("tianwen1")).onboard[0]["planet"]


def motions(angles, gains, dt):
    """``MOTION`` record of each cycle."""
    record = np.zeros(len(angles), MOTION)
    record["dt"], record["angle"], record["gain"] = dt, angles, gains
    record["last_angle"][1:], record["last_gain"][1:] = angles[:-1], gains[:-1]
    return record


@pytest.mark.parametrize("angle", [1e-9, 3e-3, 0.99e-2, 1.01e-2, 1.0, 3.0])
def test_turn_is_that_of_pyquaternion(angle):
    axis = np.array([0.6, -0.64, 0.48])
    q = Quaternion(0.5, -0.5, 0.7, 0.1).normalised
    expected = q * Quaternion(axis=axis, radians=angle)
    assert np.allclose(turn_by(tuple(q.elements), tuple(angle * axis)), expected.elements, atol=1e-15)


@pytest.mark.parametrize("frequency", [1.0, 3.0, 8.0])
def test_coning_drift_is_pi_f_a_b_less_what_two_samples_see(frequency):
    """Rates a W cos(W t), b W sin(W t) about y and z drift by pi f a b about x; one increment sees of it the
    share sin(x) / x, x = W dt, and the two-sample term adds sin(x) (1 - cos(x)) / (3 x).
    """
    w, x, cycles = 2.0 * pi * frequency, 2.0 * pi * frequency * DT, 500
    t = DT * np.arange(cycles + 1)
    angles = np.diff(np.column_stack([0.0 * t, A * np.sin(w * t), -B * np.cos(w * t)]), axis=0)
    plain = coned = np.zeros(3)
    for motion in motions(angles, 0.0 * angles, DT)[1:]:
        plain, coned = plain + motion["angle"], coned + rotation_vector_of(motion)
    seen = (coned - plain)[0] / (DT * (cycles - 1))
    drift = pi * frequency * A * B
    assert seen == pytest.approx(drift * sin(x) * (1.0 - cos(x)) / (3.0 * x), rel=1e-9)
    if frequency == 1.0:  # what is left is of the fifth order
        assert seen == pytest.approx(drift * (1.0 - sin(x) / x), rel=1e-2)


@pytest.mark.parametrize("age", [0.5 * DT, DT, 2.0 * DT])
def test_turn_ahead_of_a_steady_angular_acceleration_is_exact(age):
    """At rate w + a t about one axis, the angle turned from t = 2 dt on is (w + 2 a dt) age + a age^2 / 2."""
    w, a = 0.3, 5.0
    angle = np.diff(w * DT * np.arange(3) + 0.5 * a * (DT * np.arange(3)) ** 2)
    record = motions(np.outer(angle, (0.6, 0.0, -0.8)), np.zeros((2, 3)), DT)[1]
    record["rate"], record["rate_known"] = (w + 2.0 * a * DT) * np.array([0.6, 0.0, -0.8]), 1
    expected = ((w + 2.0 * a * DT) * age + 0.5 * a * age**2) * np.array([0.6, 0.0, -0.8])
    assert turn_ahead(record, age) == pytest.approx(expected, rel=1e-12)
    record["rate_known"] = 0
    assert turn_ahead(record, age) == pytest.approx(age * record["rate"], rel=1e-12)


def test_attitude_of_a_coning_motion_stays():
    """The true attitude of a classical coning motion comes back after each period."""
    frequency, half, period = 2.0, radians(1.0), 25
    w = 2.0 * pi * frequency
    fine = 2000
    t = np.arange(period * fine + 1) * DT / fine
    # of a body whose x axis goes round a cone, attitude exp(half (0, cos(w t), sin(w t)))
    rate = np.column_stack(
        [
            -w * (1.0 - cos(half)) * np.ones_like(t),
            -w * sin(half) * np.sin(w * t),
            w * sin(half) * np.cos(w * t),
        ]
    )
    sums = np.vstack([np.zeros(3), np.cumsum(0.5 * (rate[1:] + rate[:-1]) * DT / fine, axis=0)])[::fine]
    angles = np.tile(np.diff(sums, axis=0), (40, 1))
    q_plain = q_coned = (1.0, 0.0, 0.0, 0.0)
    record = motions(angles, 0.0 * angles, DT)
    record["last_angle"][0] = angles[-1]
    for motion in record:
        q_plain, q_coned = (
            turn_by(q_plain, tuple(motion["angle"])),
            turn_by(q_coned, rotation_vector_of(motion)),
        )
    left = [2.0 * np.linalg.norm(q[1:]) for q in (q_plain, q_coned)]
    x = w * DT
    drift = pi * frequency * half**2 * len(angles) * DT
    assert left[0] == pytest.approx(drift * (1.0 - sin(x) / x), rel=0.02)
    assert left[1] < 0.05 * left[0]


@pytest.mark.parametrize("frequency", [1.0, 3.0, 8.0])
def test_sculling_drift_is_half_the_product_of_the_amplitudes(frequency):
    """Angle a sin(W t) about x and force c sin(W t) along y give a c / 2 along z."""
    w, c, cycles = 2.0 * pi * frequency, 5.0, 500
    x = w * DT
    t = DT * np.arange(cycles + 1)
    angles = np.diff(np.column_stack([A * np.sin(w * t), 0.0 * t, 0.0 * t]), axis=0)
    gains = np.diff(np.column_stack([0.0 * t, -c / w * np.cos(w * t), 0.0 * t]), axis=0)
    record = motions(angles, gains, DT)[1:]
    heading, total, uncorrected = 0.0, np.zeros(3), np.zeros(3)
    for k, motion in enumerate(record):
        heading = A * sin(w * t[k + 1])
        first = np.array([[1, 0, 0], [0, cos(heading), -sin(heading)], [0, sin(heading), cos(heading)]])
        total += first @ gain_in_first_axes(motion)
        uncorrected += first @ (motion["gain"] + 0.5 * np.cross(motion["angle"], motion["gain"]))
    span = DT * len(record)
    sculling = A * c / 2.0
    missed = sculling * (1.0 - sin(x) / x)  # by the increments of one cycle
    assert uncorrected[2] / span == pytest.approx(sculling - missed, abs=0.02 * sculling * x)
    seen = (total - uncorrected)[2] / span
    assert seen == pytest.approx(sculling * sin(x) * (1.0 - cos(x)) / (3.0 * x), rel=1e-3)


def test_gravity_is_the_gradient_of_the_potential(planet):
    mu, j2, a = (float(planet[name]) for name in ("mu", "j2", "gravity_radius"))
    assert j2 == pytest.approx(1.956607e-3)

    def potential(r):
        d = np.linalg.norm(r)
        return mu / d * (1.0 - j2 * (a / d) ** 2 * (1.5 * (r[2] / d) ** 2 - 0.5))

    for r in (np.array([2.1e6, -1.3e6, 2.4e6]), np.array([0.0, 3.4e6, 0.0]), np.array([10.0, 0.0, 3.4e6])):
        numeric = [(potential(r + step) - potential(r - step)) / 200.0 for step in 100.0 * np.eye(3)]
        assert np.allclose(gravity_I(planet, tuple(r)), numeric, atol=2e-9)


def cross(a, b):
    """Cross product, ten times as fast as numpy's for many arrays."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def rate_B(t):
    """Roll reversals of 20 deg/s and a wobble of 0.7 Hz."""
    return np.array(
        [
            radians(20.0) * np.sin(2.0 * pi * t / 60.0) ** 3,
            radians(4.0) * np.sin(4.4 * t),
            radians(3.0) * np.cos(4.4 * t + 0.3),
        ]
    )


def force_B(t):
    """Entry deceleration up to 90 m/s2 with lift."""
    peak = 90.0 * np.exp(-(((t - 130.0) / 45.0) ** 2)) + 3.0 * (t > 300.0) * (1.0 - np.exp((300.0 - t) / 5.0))
    return np.array([-peak, 0.02 * peak * np.sin(4.4 * t), -0.15 * peak])


@kernel
def integrate_all(planet, motions, solutions):
    """Strapdown over all cycles."""
    for k in range(len(motions)):
        integrate(planet, motions[k], solutions[0])


@pytest.mark.parametrize("duration", [40.0, pytest.param(400.0, marks=pytest.mark.long)])
def test_entry_at_100_hz_against_scipy(planet, duration):
    """An MSL-like task: the public one asks for 50 m and 1 m/s after 400 s; the algorithm alone is far
    better, and errors grow no faster than with time, that of position with its square.
    """
    dt, share = 0.01, duration / 400.0
    mu, j2, a = (float(planet[name]) for name in ("mu", "j2", "gravity_radius"))

    def field(r):
        d = np.linalg.norm(r)
        s, q = 5.0 * (r[2] / d) ** 2, 1.5 * j2 * (a / d) ** 2
        return -mu / d**3 * r * (1.0 + q * (np.array([1.0, 1.0, 3.0]) - s))

    def derivative(t, y):
        a, b = y[6], y[7:10]
        w, f = rate_B(t), force_B(t)
        turned = f + 2.0 * cross(b, cross(b, f) + a * f) / (a * a + b @ b)
        return np.concatenate(
            [y[3:6], turned + field(y[:3]), [-0.5 * b @ w], 0.5 * (a * w + cross(b, w)), w, f]
        )

    start = np.concatenate([[3.52e6, 1e5, 2e5], [-1000.0, 4000.0, 2600.0], [1, 0, 0, 0], np.zeros(6)])
    t = np.arange(round(duration / dt) + 1) * dt
    flown = solve_ivp(
        derivative, (0.0, duration), start, method="DOP853", rtol=1e-10, atol=1e-9, max_step=0.2, t_eval=t
    ).y
    counts = flown[10:].T
    solution = np.zeros(1, SOLUTION)
    solution["r_I"], solution["v_I"], solution["q_I2B"] = start[:3], start[3:6], start[6:10]
    increments = np.diff(counts, axis=0)
    integrate_all(planet, motions(increments[:, :3], increments[:, 3:], dt), solution)
    off_r = np.linalg.norm(solution["r_I"][0] - flown[:3, -1])
    off_v = np.linalg.norm(solution["v_I"][0] - flown[3:6, -1])
    turned = Quaternion(solution["q_I2B"][0]).inverse * Quaternion(flown[6:10, -1]).normalised
    assert off_r < 0.5 * share**2 and off_v < 0.01 * share
    assert abs(turned.radians) < radians(0.001) * share
    assert solution["t"][0] == pytest.approx(duration)
