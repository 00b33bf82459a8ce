"""Three-vectors and the inertia solve against numpy's linear algebra."""

import numpy as np
import pytest

from edl6dof.spatial import vector

RNG = np.random.default_rng(1)
PAIRS = [tuple(map(tuple, RNG.normal(size=(2, 3)) * 10.0 ** RNG.uniform(-6, 7))) for _ in range(50)]


def tensor(inertia):
    xx, yy, zz, xy, xz, yz = inertia
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def random_inertia():
    """Inertia of a random cloud of 4 point masses, 1 to 1e5 kg m2, elongated up to 1:30."""
    points = RNG.normal(size=(4, 3)) * RNG.uniform(0.1, 3.0, size=3)
    full = 10.0 ** RNG.uniform(0, 4) * sum(p @ p * np.eye(3) - np.outer(p, p) for p in points)
    return tuple(full[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]])


def test_vector_algebra_is_that_of_numpy():
    for a, b in PAIRS:
        an, bn = np.array(a), np.array(b)
        size = np.linalg.norm(an) * np.linalg.norm(bn)
        assert np.array_equal(vector.add(a, b), an + bn) and np.array_equal(vector.sub(a, b), an - bn)
        assert np.array_equal(vector.scale(-2.5, a), -2.5 * an)
        assert vector.dot(a, b) == pytest.approx(an @ bn, abs=1e-15 * size)
        assert vector.cross(a, b) == pytest.approx(np.cross(an, bn), abs=1e-15 * size)
        assert vector.norm(a) == pytest.approx(np.linalg.norm(an), rel=1e-15)
        assert vector.unit(a) == pytest.approx(an / np.linalg.norm(an), rel=1e-15)


def test_the_zero_vector_has_no_direction_and_stays_zero():
    assert vector.unit((0.0, 0.0, 0.0)) == (0.0, 0.0, 0.0)


def test_clamp_keeps_the_closed_interval():
    assert [vector.clamp(x, -1.0, 2.0) for x in (-3.0, -1.0, 0.5, 2.0, 9.0)] == [-1.0, -1.0, 0.5, 2.0, 2.0]


def test_take3_and_put3_touch_their_three_places_only():
    array = np.arange(7.0)
    assert vector.take3(array, 2) == (2.0, 3.0, 4.0)
    vector.put3(array, 3, (-1.0, -2.0, -3.0))
    assert array.tolist() == [0.0, 1.0, 2.0, -1.0, -2.0, -3.0, 6.0]


def test_angular_momentum_of_a_point_cloud():
    """I w against the sum of m r x (w x r), the definition."""
    points, masses, w = RNG.normal(size=(6, 3)), RNG.uniform(1.0, 9.0, 6), RNG.normal(size=3)
    full = sum(m * (p @ p * np.eye(3) - np.outer(p, p)) for m, p in zip(masses, points, strict=True))
    elements = tuple(full[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]])
    momentum = sum(m * np.cross(p, np.cross(w, p)) for m, p in zip(masses, points, strict=True))
    assert vector.inertia_times(elements, tuple(w)) == pytest.approx(momentum, rel=1e-12)


def test_angular_acceleration_solves_euler_for_any_body():
    for _ in range(200):
        inertia, moment = random_inertia(), tuple(RNG.normal(size=3) * 1e3)
        expected = np.linalg.solve(tensor(inertia), moment)
        condition = np.linalg.cond(tensor(inertia))
        assert vector.inertia_solve(inertia, moment) == pytest.approx(
            expected, abs=1e-14 * condition * np.linalg.norm(expected)
        )
