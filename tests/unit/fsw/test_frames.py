"""Attitude errors against pyquaternion, and the turning of the path against an integrated trajectory."""

from math import pi, radians

import numpy as np
import pytest
from pyquaternion import Quaternion
from scipy.integrate import solve_ivp

from edl6dof.fsw.control.frames import path_rate, thrust_direction_error, wind_attitude_error
from edl6dof.fsw.guidance.command import GUIDE
from edl6dof.fsw.navigation import NAV

X, Y, Z = np.eye(3)


def unit(v):
    return np.asarray(v) / np.linalg.norm(v)


def any_attitude(rng):
    return Quaternion(axis=rng.normal(size=3), radians=rng.uniform(0.0, 2.0 * pi))


def turned(q, rotation_vector_B):
    """Attitude after a rotation given in body axes."""
    angle = np.linalg.norm(rotation_vector_B)
    return q * (Quaternion(axis=rotation_vector_B, radians=angle) if angle > 0.0 else Quaternion())


@pytest.mark.parametrize("angle_deg", [1e-7, 1e-3, 0.5, 30.0, 89.0, 90.0, 135.0, 179.0, 179.9999])
def test_thrust_direction_error_is_the_shortest_rotation_of_the_thrust_axis(angle_deg):
    rng = np.random.default_rng(1)
    for _ in range(20):
        q = any_attitude(rng)
        thrust = q.rotate(-X)
        across = unit(np.cross(thrust, rng.normal(size=3)))
        wanted = Quaternion(axis=across, degrees=angle_deg).rotate(thrust)
        error = np.array(thrust_direction_error(tuple(q.elements), tuple(wanted), 0.0))
        assert np.linalg.norm(error) == pytest.approx(radians(angle_deg), rel=1e-6, abs=1e-12)
        assert error[0] == 0.0
        assert turned(q, error).rotate(-X) == pytest.approx(wanted, abs=1e-9)
        assert np.allclose(q.rotate(error), radians(angle_deg) * across, atol=1e-8)  # the axis itself, in I


def test_thrust_axis_exactly_opposite_turns_nearly_half_a_revolution_about_a_lateral_axis():
    for q in (Quaternion(), Quaternion(axis=[1, 2, 3], degrees=77.0)):
        error = np.array(thrust_direction_error(tuple(q.elements), tuple(q.rotate(X)), 0.0))
        assert error[0] == 0.0
        assert pi - 0.15 < np.linalg.norm(error) < pi + 1e-9


def test_thrust_axis_on_target_leaves_only_the_roll_error_it_is_given():
    q = any_attitude(np.random.default_rng(8))
    assert thrust_direction_error(tuple(q.elements), tuple(q.rotate(-X)), 0.3) == pytest.approx((0.3, 0.0, 0.0), abs=1e-9)


def state(rng, speed=3000.0):
    """A random position-free flight state: vertical, velocity, and records for the kernels."""
    up = unit(rng.normal(size=3))
    v = speed * unit(rng.normal(size=3))
    nav, guide = np.zeros(1, NAV)[0], np.zeros(1, GUIDE)[0]
    nav["up_I"], nav["v_I"], nav["speed"], nav["gravity"] = up, v, speed, 3.7
    return up, v, nav, guide


def commanded(up, v, bank, alpha):
    """Attitude by pyquaternion: zero-bank path axes, bank about the velocity, alpha about the pitch axis."""
    x = unit(v)
    y = unit(np.cross(x, up))
    path = Quaternion(matrix=np.column_stack([x, y, np.cross(x, y)]))
    return path * Quaternion(axis=X, radians=bank) * Quaternion(axis=Y, radians=alpha)


def set_attitude(nav, q):
    nav["q_I2B"] = q.elements


def test_wind_attitude_error_is_zero_at_the_commanded_attitude_and_rate():
    rng = np.random.default_rng(2)
    for _ in range(30):
        up, v, nav, guide = state(rng)
        guide["bank"], guide["alpha"] = rng.uniform(-pi, pi), rng.uniform(-0.4, 0.4)
        set_attitude(nav, commanded(up, v, guide["bank"], guide["alpha"]))
        nav["specific_force_B"] = rng.normal(size=3) * 30.0
        nav["w_B"] = path_rate(nav)
        error, rate = wind_attitude_error(nav, guide)
        assert error == pytest.approx((0.0, 0.0, 0.0), abs=1e-7)
        assert rate == pytest.approx((0.0, 0.0, 0.0), abs=1e-15)


def test_wind_attitude_error_is_the_rotation_that_leads_back_to_the_command():
    rng = np.random.default_rng(3)
    for _ in range(30):
        up, v, nav, guide = state(rng)
        guide["bank"], guide["alpha"] = rng.uniform(-pi, pi), rng.uniform(-0.4, 0.4)
        offset = unit(rng.normal(size=3)) * rng.uniform(0.01, 3.0)
        set_attitude(nav, turned(commanded(up, v, guide["bank"], guide["alpha"]), offset))
        error, _ = wind_attitude_error(nav, guide)
        assert error == pytest.approx(tuple(-offset), abs=1e-7)


def test_command_lifts_up_at_zero_bank_with_negative_alpha_and_to_the_right_at_positive_bank():
    """Blunt body at alpha < 0: the nose points below the velocity; its lift, along the tail side of the nose, points up."""
    up, v, _, _ = state(np.random.default_rng(4))
    v = v - up * (v @ up)
    right = unit(np.cross(v, up))
    nose = commanded(up, v, 0.0, radians(-10.0)).rotate(X)
    assert nose @ up < 0.0
    banked = commanded(up, v, radians(60.0), radians(-10.0)).rotate(X)
    assert banked @ right < 0.0  # nose to the left, lift to the right


def test_path_rate_is_the_turning_of_an_integrated_velocity():
    """Point mass over a non-rotating sphere with a force fixed in inertial space; finite difference of the direction."""
    rng = np.random.default_rng(5)
    mu = 4.2828e13
    for _ in range(10):
        r = unit(rng.normal(size=3)) * 3.43e6
        v = rng.normal(size=3) * 1500.0
        q = any_attitude(rng)
        force_B = rng.normal(size=3) * 40.0
        force = q.rotate(force_B)

        def motion(t, s, force=force):
            return np.concatenate([s[3:], force - mu * s[:3] / np.linalg.norm(s[:3]) ** 3])

        h = 0.05
        ahead = solve_ivp(motion, (0, h), np.concatenate([r, v]), rtol=1e-12, atol=1e-9).y[3:, -1]
        behind = solve_ivp(motion, (0, -h), np.concatenate([r, v]), rtol=1e-12, atol=1e-9).y[3:, -1]
        turning = np.cross(unit(v), (unit(ahead) - unit(behind)) / (2 * h))
        nav = np.zeros(1, NAV)[0]
        nav["up_I"], nav["v_I"], nav["speed"] = unit(r), v, np.linalg.norm(v)
        nav["gravity"], nav["specific_force_B"] = mu / (r @ r), force_B
        set_attitude(nav, q)
        assert q.rotate(np.array(path_rate(nav))) == pytest.approx(turning, abs=1e-6)
