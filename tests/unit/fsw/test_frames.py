"""Attitude errors against pyquaternion, and the turning of the path against an integrated trajectory."""

from math import pi, radians

import numpy as np
import pytest
from pyquaternion import Quaternion
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from edl6dof.fsw.control.attitude_error import (
    decoupled_error,
    goal_attitude,
    path_rate,
    shortest_path_error,
    velocity_axes,
    wind_attitude_error,
)
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.navigation.derived import NAV

X, Y, Z = np.eye(3)


def unit(v):
    return np.asarray(v) / np.linalg.norm(v)


def any_attitude(rng):
    return Quaternion(axis=rng.normal(size=3), radians=rng.uniform(0.0, 2.0 * pi))


def turned(q, rotation_vector_B):
    """Attitude after a rotation given in body axes."""
    angle = np.linalg.norm(rotation_vector_B)
    return q * (Quaternion(axis=rotation_vector_B, radians=angle) if angle > 0.0 else Quaternion())


def towards(q, wanted, roll=0.0):
    """A goal attitude whose thrust axis is ``wanted``: the shortest rotation of the thrust axis, then
    ``roll`` about it.
    """
    thrust = q.rotate(-X)
    across = np.cross(thrust, wanted)
    angle = np.arctan2(np.linalg.norm(across), thrust @ wanted)
    turn = Quaternion(axis=across, radians=angle) if np.linalg.norm(across) > 0.0 else Quaternion()
    return turn * q * Quaternion(axis=X, radians=roll)


@pytest.mark.parametrize("roll_deg", [0.0, 1e-3, -75.0, 179.0])
@pytest.mark.parametrize(
    "angle_deg",
    [
        1e-5,
        pytest.param(1e-3, marks=pytest.mark.long),
        pytest.param(0.5, marks=pytest.mark.long),
        30.0,
        pytest.param(89.0, marks=pytest.mark.long),
        pytest.param(90.0, marks=pytest.mark.long),
        pytest.param(135.0, marks=pytest.mark.long),
        pytest.param(179.0, marks=pytest.mark.long),
        179.99,
    ],
)
def test_decoupled_error_is_the_shortest_rotation_of_the_thrust_axis_and_the_roll_that_is_left(
    angle_deg, roll_deg
):
    rng = np.random.default_rng(1)
    for _ in range(20):
        q = any_attitude(rng)
        thrust = q.rotate(-X)
        across = unit(np.cross(thrust, rng.normal(size=3)))
        wanted = Quaternion(axis=across, degrees=angle_deg).rotate(thrust)
        goal = towards(q, wanted, radians(roll_deg))
        error = np.array(decoupled_error(tuple(q.elements), tuple(goal.elements)))
        lateral = np.array([0.0, error[1], error[2]])
        assert np.linalg.norm(lateral) == pytest.approx(radians(angle_deg), rel=1e-5, abs=1e-9)
        assert np.allclose(q.rotate(lateral), radians(angle_deg) * across, atol=1e-6)  # the axis itself, in I
        assert error[0] == pytest.approx(radians(roll_deg), abs=1e-6)
        reached = turned(turned(q, lateral), error[0] * X)
        assert abs(reached.elements @ goal.elements) == pytest.approx(1.0, abs=1e-9)


def test_thrust_axis_exactly_opposite_turns_half_a_revolution_about_a_lateral_axis():
    for q in (Quaternion(), Quaternion(axis=[1, 2, 3], degrees=77.0)):
        goal = q * Quaternion(axis=Y, degrees=180.0)
        error = np.array(decoupled_error(tuple(q.elements), tuple(goal.elements)))
        assert np.hypot(error[1], error[2]) == pytest.approx(pi, abs=1e-5)


def test_decoupled_error_follows_equations_5_to_7_of_the_paper_for_small_angles():
    """S1 writes actual minus goal in frame c (x and z of B reversed), with 2 sin(phi / 2) for the angle."""
    rng = np.random.default_rng(4)
    to_c = np.diag([-1.0, 1.0, -1.0])
    for angle in (0.01, 0.2, 0.5):
        q = any_attitude(rng)
        wanted = Quaternion(axis=unit(np.cross(q.rotate(X), rng.normal(size=3))), radians=angle).rotate(
            q.rotate(-X)
        )
        s_1, s_d = X, to_c @ q.inverse.rotate(wanted)
        s_v = unit(np.cross(s_d, s_1))
        phi = np.arccos(s_d[0])
        printed = 2.0 * s_v * np.sin(phi / 2.0)
        own = to_c @ np.array(decoupled_error(tuple(q.elements), tuple(towards(q, wanted).elements)))
        assert -own == pytest.approx(printed, abs=angle**3 / 24.0 * 1.01 + 1e-9)


def test_goal_attitude_has_the_thrust_axis_along_the_command_and_no_roll_but_that_of_the_shortest_path():
    """S1 eqs. 2 and 3; q_g has x of c up and y south."""
    rng = np.random.default_rng(5)
    north, east, up = X, Y, -Z
    for _ in range(50):
        wanted = unit(rng.normal(size=3) + np.array([0.0, 0.0, -2.0]))
        goal = Quaternion(goal_attitude(tuple(north), tuple(east), tuple(up), tuple(wanted)))
        assert goal.rotate(-X) == pytest.approx(wanted, abs=1e-12)
        phi = np.arccos(np.clip(up @ wanted, -1.0, 1.0))
        turn = Quaternion(axis=unit(np.cross(up, wanted)), radians=phi)
        assert goal.rotate(Y) == pytest.approx(turn.rotate(-north), abs=1e-9)


def test_shortest_path_error_is_the_whole_rotation():
    rng = np.random.default_rng(6)
    for _ in range(50):
        q, goal = any_attitude(rng), any_attitude(rng)
        error = np.array(shortest_path_error(tuple(q.elements), tuple(goal.elements)))
        assert np.linalg.norm(error) <= pi + 1e-12
        assert abs(turned(q, error).elements @ goal.elements) == pytest.approx(1.0, abs=1e-12)


def test_velocity_axes_are_the_direction_cosines_of_the_wind_angles():
    """Columns of C_cv (S1 eq. 1) against scipy's rotations: V to B is -beta about z, then alpha about y."""
    rng = np.random.default_rng(7)
    for alpha, beta in rng.uniform(-1.2, 1.2, (30, 2)):
        v_to_b = (
            Rotation.from_euler("y", alpha).inv().as_matrix()
            @ Rotation.from_euler("z", -beta).inv().as_matrix()
        )
        assert np.column_stack(velocity_axes(alpha, beta)) == pytest.approx(v_to_b, abs=1e-12)


def state(rng, speed=3000.0):
    """A random position-free flight state: vertical, velocity, and records for the kernels."""
    up = unit(rng.normal(size=3))
    v = speed * unit(rng.normal(size=3))
    nav, guide = np.zeros(1, NAV)[0], np.zeros(1, GUIDE)[0]
    nav["up_I"], nav["v_rel_I"], nav["speed"], nav["gravity"] = up, v, speed, 3.7
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
    """Blunt body at alpha < 0: the nose points below the velocity; its lift, along the tail side of the nose,
    points up.
    """
    up, v, _, _ = state(np.random.default_rng(4))
    v = v - up * (v @ up)
    right = unit(np.cross(v, up))
    nose = commanded(up, v, 0.0, radians(-10.0)).rotate(X)
    assert nose @ up < 0.0
    banked = commanded(up, v, radians(60.0), radians(-10.0)).rotate(X)
    assert banked @ right < 0.0  # nose to the left, lift to the right


def test_path_rate_is_the_turning_of_an_integrated_velocity():
    """Point mass over a non-rotating sphere with a force fixed in inertial space; finite difference of the
    direction.
    """
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
        nav["up_I"], nav["v_rel_I"], nav["speed"] = unit(r), v, np.linalg.norm(v)
        nav["gravity"], nav["specific_force_B"] = mu / (r @ r), force_B
        set_attitude(nav, q)
        assert q.rotate(np.array(path_rate(nav))) == pytest.approx(turning, abs=1e-6)
