"""Quaternions against pyquaternion, scipy's Rotation and finite differences.

The convention under test, in the module's words: ``q_A2B`` carries the axes of A onto the axes of B
(pyquaternion's rotation) and ``to_frame`` gives components in B.  scipy's Rotation is the second witness, for
sequences and rotation vectors.
"""

from math import cos, pi, radians, sin, sqrt

import numpy as np
import pytest
from pyquaternion import Quaternion
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from edl6dof.spatial import quaternion as kernels

RNG = np.random.default_rng(2)
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
RANDOM = [tuple(map(float, q / np.linalg.norm(q))) for q in RNG.normal(size=(40, 4))]
HALF_TURNS = [
    (0.0, *X),
    (0.0, *Y),
    (0.0, *Z),
    (0.0, 0.6, 0.0, 0.8),
    (0.0, sqrt(1 / 3), -sqrt(1 / 3), sqrt(1 / 3)),
]
SPECIAL = [(1.0, 0.0, 0.0, 0.0), (-1.0, 0.0, 0.0, 0.0), *HALF_TURNS, (cos(1e-9), sin(1e-9), 0.0, 0.0)]
ALL = RANDOM + SPECIAL


def scipy_of(q):
    return Rotation.from_quat(q, scalar_first=True)


def same_attitude(q, p, tolerance=1e-14):
    """Two quaternions of one attitude, sign aside."""
    q, p = np.asarray(q), np.asarray(p)
    return min(np.abs(q - p).max(), np.abs(q + p).max()) < tolerance


def test_product_conjugate_and_length_are_those_of_pyquaternion():
    for p, q in zip(ALL, reversed(ALL), strict=True):
        assert kernels.multiply(p, q) == pytest.approx((Quaternion(p) * Quaternion(q)).elements, abs=1e-15)
        assert kernels.conjugate(q) == pytest.approx(Quaternion(q).inverse.elements, abs=1e-15)
        stretched = tuple(7.3 * x for x in q)
        assert kernels.normalise(stretched) == pytest.approx(
            Quaternion(stretched).normalised.elements, abs=1e-15
        )


def test_components_in_the_turned_frame_follow_the_stated_convention():
    for q in ALL:
        v = tuple(RNG.normal(size=3))
        assert kernels.to_frame(q, v) == pytest.approx(Quaternion(q).inverse.rotate(v), abs=1e-14)
        assert kernels.from_frame(q, v) == pytest.approx(scipy_of(q).apply(v), abs=1e-14)


def test_a_yaw_of_90_degrees_makes_east_from_north():
    """By hand, no library: after yawing right (positive about down) the old x direction lies to the left, at
    -y.
    """
    q = kernels.about_axis(Z, pi / 2)
    assert kernels.to_frame(q, X) == pytest.approx((0.0, -1.0, 0.0), abs=1e-15)
    assert kernels.axes(q)[0] == pytest.approx(Y, abs=1e-15)


def test_attitudes_chain_from_a_over_b_to_c():
    for q_ab, q_bc in zip(RANDOM, RANDOM[1:], strict=False):
        v = tuple(RNG.normal(size=3))
        stepwise = scipy_of(q_bc).inv().apply(scipy_of(q_ab).inv().apply(v))
        assert kernels.to_frame(kernels.multiply(q_ab, q_bc), v) == pytest.approx(stepwise, abs=1e-14)


def test_quaternion_rate_is_the_derivative_of_a_body_turning_about_its_own_axes():
    """Central difference of the exact motion R(t) = R0 expm([w]x t), w in B."""
    h = 1e-4
    for q in RANDOM[:15]:
        w = RNG.normal(size=3) * 2.0
        skew = np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])
        late, early = (
            Rotation.from_matrix(scipy_of(q).as_matrix() @ expm(skew * dt)).as_quat(scalar_first=True)
            for dt in (h, -h)
        )
        late, early = (e * np.sign(e @ np.array(q)) for e in (late, early))
        assert kernels.rate(q, tuple(w)) == pytest.approx((late - early) / (2.0 * h), abs=2e-7)


@pytest.mark.parametrize("axis", [X, Y, Z, (0.6, 0.0, -0.8)])
@pytest.mark.parametrize("angle_deg", [-200.0, -90.0, 0.0, 1e-7, 30.0, 180.0, 359.0])
def test_rotation_about_an_axis(axis, angle_deg):
    expected = Quaternion(axis=axis, angle=radians(angle_deg))
    assert same_attitude(kernels.about_axis(axis, radians(angle_deg)), expected.elements)


@pytest.mark.parametrize("q", ALL)
def test_attitude_and_its_axes_are_two_forms_of_one_thing(q):
    matrix = scipy_of(q).as_matrix()  # columns: axes of B in A
    rows = kernels.axes(q)
    assert np.array(rows) == pytest.approx(matrix.T, abs=1e-14)
    rebuilt = kernels.from_axes(*(tuple(column) for column in matrix.T))
    assert same_attitude(rebuilt, q, 1e-14) and np.linalg.norm(rebuilt) == pytest.approx(1.0, abs=1e-15)


def test_axes_near_half_a_turn_lose_no_digits():
    """Where the trace is -1 the textbook formula divides by nothing: 2000 axes, angle 180 deg -+ 1e-8 ..
    1e-2.
    """
    for axis in RNG.normal(size=(500, 3)):
        for deficit in (0.0, 1e-8, 1e-5, -1e-2):
            truth = Rotation.from_rotvec(axis / np.linalg.norm(axis) * (pi - deficit))
            rebuilt = kernels.from_axes(*(tuple(column) for column in truth.as_matrix().T))
            assert same_attitude(rebuilt, truth.as_quat(scalar_first=True), 1e-14)


@pytest.mark.parametrize("q", ALL)
def test_rotation_vector_is_the_shortest_turn(q):
    got, expected = np.array(kernels.rotation_vector(q)), scipy_of(q).as_rotvec()
    assert np.linalg.norm(got) <= pi + 1e-15
    if np.linalg.norm(expected) > pi - 1e-9:
        expected *= np.sign(expected @ got)  # half a turn either way is the same
    assert got == pytest.approx(expected, abs=1e-14)


@pytest.mark.parametrize("angle", [1e-18, 1e-13, 3e-12, 1e-9, 1e-5, 0.1, 3.1, pi - 1e-9])
def test_rotation_vector_keeps_its_relative_precision_at_any_size(angle):
    q = kernels.about_axis((0.0, 0.6, 0.8), angle)
    assert kernels.rotation_vector(q) == pytest.approx((0.0, 0.6 * angle, 0.8 * angle), rel=1e-14, abs=1e-30)


def test_yaw_pitch_roll_is_the_aerospace_sequence():
    for yaw, pitch, roll in RNG.uniform((-pi, -pi / 2, -pi), (pi, pi / 2, pi), size=(60, 3)):
        truth = Rotation.from_euler("ZYX", (yaw, pitch, roll))
        q = kernels.from_euler_321(yaw, pitch, roll)
        assert same_attitude(q, truth.as_quat(scalar_first=True))
        assert kernels.euler_321(q) == pytest.approx(truth.as_euler("ZYX"), abs=1e-12)


def test_a_nose_up_pitch_lifts_the_x_axis():
    """In north-east-down, pitch 30 deg puts the nose 30 deg above the horizon: down component -sin 30."""
    nose = kernels.axes(kernels.from_euler_321(0.0, radians(30.0), 0.0))[0]
    assert nose == pytest.approx((cos(radians(30.0)), 0.0, -0.5), abs=1e-15)


@pytest.mark.parametrize("pitch_deg", [90.0, -90.0])
def test_gimbal_lock_stays_finite_and_keeps_the_pitch(pitch_deg):
    angles = kernels.euler_321(kernels.from_euler_321(0.7, radians(pitch_deg), 0.0))
    assert np.all(np.isfinite(angles)) and angles[1] == pytest.approx(radians(pitch_deg), abs=3e-8)


def test_angle_between_attitudes_ignores_the_sign_of_the_quaternion():
    for p, q in zip(RANDOM, RANDOM[1:], strict=False):
        expected = (scipy_of(p).inv() * scipy_of(q)).magnitude()
        assert kernels.angle_between(p, q) == pytest.approx(expected, abs=1e-9)
        assert kernels.angle_between(p, tuple(-x for x in q)) == pytest.approx(expected, abs=1e-9)
    assert kernels.angle_between(RANDOM[0], RANDOM[0]) < 1e-7


def test_angle_between_resolves_a_nanoradian():
    assert kernels.angle_between(
        RANDOM[0], kernels.multiply(RANDOM[0], kernels.about_axis(X, 1e-9))
    ) == pytest.approx(1e-9, rel=1e-3)
