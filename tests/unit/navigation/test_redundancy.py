"""Least squares and parity matrix of redundant instruments against numpy."""

import numpy as np
import pytest
from inertial_units import cone, redundant

from edl6dof.fsw.navigation.redundancy import least_squares, usable, without_one

ALL = 0b111111


def used(in_use, number=6):
    return [i for i in range(number) if in_use >> i & 1]


@pytest.mark.parametrize("in_use", [ALL, 0b111110, 0b101111, 0b011011, 0b110101, 0b010101])
def test_matrices_are_those_of_the_definition(in_use):
    axes, rows = cone(), used(in_use)
    memory = redundant(axes, in_use)[0]
    H = axes[rows]
    assert np.allclose(memory["inverse"][:, rows], np.linalg.pinv(H), atol=1e-14)
    n = memory["n_parity"]
    V = memory["parity"][:n][:, rows]
    assert n == len(rows) - 3
    assert np.allclose(V @ H, 0.0, atol=1e-14)
    assert np.allclose(V @ V.T, np.eye(n), atol=1e-13)
    assert np.allclose(V, np.triu(V))
    left_out = [i for i in range(8) if i not in rows]
    assert not memory["inverse"][:, left_out].any() and not memory["parity"][:n][:, left_out].any()


def test_cone_of_six_has_two_of_each_axis():
    assert np.allclose(cone().T @ cone(), 2.0 * np.eye(3))


def test_vector_is_the_one_of_least_squares():
    axes, rng = cone(), np.random.default_rng(1)
    readings = rng.normal(size=8)
    memory = redundant(axes, 0b110111)
    expected = np.linalg.lstsq(axes[used(0b110111)], readings[used(0b110111)], rcond=None)[0]
    assert np.allclose(least_squares(memory[0], 6, readings), expected, atol=1e-14)


@pytest.mark.parametrize("i", range(6))
def test_leaving_one_out_equals_least_squares_without_it(i):
    axes, rng = cone(), np.random.default_rng(2)
    readings = rng.normal(size=6)
    memory = redundant(axes, ALL)[0]
    rest = [k for k in range(6) if k != i]
    expected = np.linalg.lstsq(axes[rest], readings[rest], rcond=None)[0]
    vector = least_squares(memory, 6, readings)
    assert np.allclose(without_one(axes, memory, i, readings, vector), expected, atol=1e-13)


@pytest.mark.parametrize("in_use", [0, 0b000011])
def test_fewer_than_three_solve_nothing(in_use):
    memory = redundant(cone(), in_use)[0]
    assert memory["solvable"] == 0 and memory["n_parity"] == 0


def test_axes_in_one_plane_solve_nothing():
    flat = np.array([[1.0, 0.0, 0.0], [0.6, 0.8, 0.0], [0.0, 1.0, 0.0], [0.8, -0.6, 0.0]])
    assert redundant(flat, 0b1111)[0]["solvable"] == 0


def test_axis_without_another_to_check_it_adds_no_row():
    """Three orthogonal axes and a second x: only the two along x are redundant."""
    memory = redundant(np.vstack([np.eye(3), [1.0, 0.0, 0.0]]), 0b1111)[0]
    assert memory["n_parity"] == 1
    assert np.allclose(np.abs(memory["parity"][0, :4]), [0.5**0.5, 0.0, 0.0, 0.5**0.5])


def test_saturated_and_failed_are_left_out():
    healthy, saturated = np.ones(8, int), np.zeros(8, int)
    healthy[1], saturated[4] = 0, 1
    assert usable(6, healthy, saturated) == 0b101101
