"""Every float gets an index within the table, correct where it is finite; the cubic interpolation equals
a cubic Hermite spline of scipy with the slopes of central differences.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from edl6dof.spatial.table_index import (
    between,
    catmull_rom,
    cell,
    cell_among,
    endless_cell,
    held_cell,
    wrapped,
)

CELLS = 7
VALUES = np.array([3.0, -1.0, 4.0, -1.5, 9.0, -2.0, 6.5, 3.25])
NODES = np.array([-4.0, -1.0, 0.0, 1e-300, 0.5, 3.0, 1e3, 1e200])
TINY = 5e-324


def around(nodes):
    return [x for node in nodes for x in (np.nextafter(node, -np.inf), node, np.nextafter(node, np.inf))]


EXTREME = [
    np.inf,
    -np.inf,
    1e300,
    -1e300,
    9.3e18,
    -9.3e18,
    2.0**63,
    -(2.0**63),
    2.0**31,
    TINY,
    -TINY,
    0.0,
    -0.0,
]
EVEN = [*around(np.arange(CELLS + 1.0)), *np.linspace(-3.0, CELLS + 3.0, 101), *EXTREME]
UNEVEN = [*around(NODES), *np.linspace(-10.0, 10.0, 101), *EXTREME]


@pytest.mark.parametrize("position", EVEN)
def test_even_table_agrees_with_numpy(position):
    index, share = held_cell(position, CELLS)
    assert 0 <= index < CELLS
    assert 0.0 <= share <= 1.0
    assert between(VALUES, index, share) == pytest.approx(
        np.interp(position, np.arange(CELLS + 1.0), VALUES), rel=1e-12, abs=1e-12
    )


@pytest.mark.parametrize("position", [*EVEN, np.nan])
def test_index_is_within_the_table_and_the_position_is_kept(position):
    index, beyond = cell(position, CELLS)
    assert 0 <= index < CELLS
    assert index + beyond == position or np.isnan(position) and np.isnan(beyond)


@pytest.mark.parametrize("value", UNEVEN)
def test_uneven_table_agrees_with_numpy(value):
    index, share = cell_among(NODES, len(NODES), value)
    assert 0 <= index < len(NODES) - 1
    assert between(VALUES, index, share) == pytest.approx(
        np.interp(value, NODES, VALUES), rel=1e-12, abs=1e-12
    )


def test_only_the_given_number_of_nodes_counts():
    assert cell_among(NODES, 2, 1e9) == (0, 1.0)
    assert cell_among(NODES, 3, -0.5) == (1, 0.5)


def test_what_is_not_a_number_stays_none():
    for index, share in (
        held_cell(np.nan, CELLS),
        cell(np.nan, CELLS),
        cell_among(NODES, len(NODES), np.nan),
    ):
        assert 0 <= index < CELLS
        assert np.isnan(share)
        assert np.isnan(between(VALUES, index, share))


def test_one_cell_is_a_table_too():
    assert [held_cell(x, 1) for x in (-1.0, 0.25, 2.0)] == [(0, 0.0), (0, 0.25), (0, 1.0)]


@pytest.mark.parametrize("position, index", [(0.0, 0), (-0.1, -1), (-7.0, -7), (1e9 + 0.5, 10**9)])
def test_cell_of_a_lattice_without_end(position, index):
    assert endless_cell(position) == index


@pytest.mark.parametrize("nowhere", [np.nan, np.inf, -np.inf, 1e300])
def test_what_is_no_place_on_the_lattice_is_in_cell_0(nowhere):
    assert endless_cell(nowhere) == 0


@pytest.mark.parametrize("angle", [0.0, 359.0, 360.0, 721.5, -0.25, -360.0, 1e6])
def test_angle_less_whole_turns(angle):
    assert wrapped(angle, 360.0) == pytest.approx(angle % 360.0)


def test_angle_that_is_not_finite_stays_so():
    assert not any(np.isfinite(wrapped(angle, 360.0)) for angle in (np.nan, np.inf, -np.inf))


PROFILE = np.array([1.0, -2.0, 0.5, 4.0, 3.0, 7.0])


def test_cubic_has_the_slope_of_the_neighbours_at_each_row():
    rows = len(PROFILE)
    padded = np.pad(PROFILE, 1, mode="edge")
    spline = CubicHermiteSpline(np.arange(rows), PROFILE, 0.5 * (padded[2:] - padded[:-2]))
    for row in range(rows - 1):
        for share in (0.0, 0.13, 0.5, 0.71, 1.0):
            assert catmull_rom(PROFILE, rows, row, share) == pytest.approx(spline(row + share), abs=1e-12)


def test_parabola_is_exact_between_its_rows():
    x = np.arange(8.0)
    parabola = 3.0 - 2.0 * x + 0.7 * x**2
    for at in (1.3, 3.75, 5.9):
        exact = 3.0 - 2.0 * at + 0.7 * at**2
        assert catmull_rom(parabola, 8, int(at), at % 1.0) == pytest.approx(exact, rel=1e-12)
