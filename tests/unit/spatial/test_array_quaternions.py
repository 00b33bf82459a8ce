"""Quaternions on whole histories against pyquaternion and scipy."""

from __future__ import annotations

import numpy as np
import pytest
from pyquaternion import Quaternion
from scipy.spatial.transform import Rotation

from edl6dof.spatial import rotations as turns

RNG = np.random.default_rng(11)


@pytest.fixture(scope="module")
def pair() -> tuple[np.ndarray, np.ndarray]:
    q = RNG.normal(size=(2, 40, 4))
    p, q = q / np.linalg.norm(q, axis=-1, keepdims=True)
    return p, q


def test_products_and_turned_vectors_agree_with_pyquaternion(pair):
    p, q = pair
    v = RNG.normal(size=(40, 3))
    both, turned = turns.multiply(p, q), turns.rotate(q, v)
    for k in range(40):
        assert np.allclose(both[k], (Quaternion(p[k]) * Quaternion(q[k])).elements, atol=1e-12)
        assert np.allclose(turned[k], Quaternion(q[k]).rotate(v[k]), atol=1e-12)
    assert np.allclose(turns.rotate(q[0], v), [Quaternion(q[0]).rotate(x) for x in v], atol=1e-12)


def test_axes_come_back_from_every_attitude_half_turns_included(pair):
    root = np.sqrt(0.5)
    half = np.array(
        [
            [0, 1, 0, 0],
            [0, 0, 1, 0],
            [0, 0, 0, 1],
            [0, root, root, 0],
            [0, 0, root, root],
            [0, root, 0, -root],
        ]
    )
    wanted = np.concatenate([pair[0], half])
    found = turns.from_axes(Rotation.from_quat(turns.xyzw(wanted)).as_matrix())
    assert np.allclose(np.abs((found * wanted).sum(axis=-1)), 1.0, atol=1e-12)


def test_turn_about_z_and_towards_a_direction():
    angle = np.array([-0.3, 0.0, 2.8])
    assert np.allclose(
        turns.rotate(turns.about_z(angle), np.array([1.0, 0.0, 0.0])),
        np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1),
    )
    ways = np.append(RNG.normal(size=(30, 3)), [[5.0, 0.0, 0.0], [-2.0, 0.0, 0.0]], axis=0)
    got = turns.rotate(turns.from_x_to(ways), np.array([1.0, 0.0, 0.0]))
    assert np.allclose(got, ways / np.linalg.norm(ways, axis=-1, keepdims=True), atol=1e-4)
    # no turn is shorter than the angle between the two
    for q, way in zip(turns.from_x_to(ways[:30]), ways[:30], strict=True):
        assert Quaternion(q).angle == pytest.approx(np.arccos(way[0] / np.linalg.norm(way)), abs=1e-9)
