"""Coefficients of the capsule against the published table, between its nodes, beyond its end, and in thin
air.
"""

import csv
from math import cos, log10, pi, radians, sin, sqrt

import numpy as np
import pytest
from aero_capsule import (
    AREA,
    DENSE,
    PARAMS,
    RARE,
    D,
    coefficients,
    gas_record,
    table_of,
    velocity,
    wrench,
)

from edl6dof.vehicle.aerodynamics.capsule import free_molecular_weight
from edl6dof.vehicle.aerodynamics.capsule_table import PACKAGED, read_static_table
from edl6dof.vehicle.aerodynamics.newtonian import (
    capsule_rings,
    stagnation_pressure_coefficient,
    surface_integrals,
)


@pytest.fixture(scope="module")
def table():
    return table_of()


def phoenix_rows():
    with (PACKAGED / "phoenix_70deg_static_aero.csv").open() as stream:
        return [
            tuple(map(float, row.values()))
            for row in csv.DictReader(line for line in stream if line[0] != "#")
        ]


def test_phoenix_nodes_are_reproduced_as_lift_and_drag(table):
    rows = phoenix_rows()
    assert len(rows) == 33 * 6
    for mach, alpha, cd, cl, cm, ca, cn in rows:
        fx, fy, fz, mx, my, mz = wrench(table, velocity(alpha), mach) / AREA
        c, s = cos(radians(alpha)), sin(radians(alpha))
        assert -(fx * c + fz * s) == pytest.approx(cd, abs=1e-9)
        assert fx * s - fz * c == pytest.approx(cl, abs=1e-9)  # lift along (sin, -cos): up for positive alpha
        assert my / D == pytest.approx(cm, abs=1e-9)
        assert (-fx, -fz) == pytest.approx((ca, cn), abs=1.1e-4)  # the file's own rounded columns
        assert (fy, mx, mz) == pytest.approx((0.0, 0.0, 0.0), abs=1e-15)


def test_mach_is_interpolated_linearly_and_clamped(table):
    middle = 0.5 * (coefficients(table, 3.0, 8.0) + coefficients(table, 4.0, 8.0))
    assert coefficients(table, 3.5, 8.0) == pytest.approx(middle, abs=1e-12)
    assert np.array_equal(coefficients(table, 0.1, 8.0), coefficients(table, 0.4, 8.0))
    assert np.array_equal(coefficients(table, 80.0, 8.0), coefficients(table, 30.0, 8.0))


@pytest.mark.parametrize("mach", [0.4, 1.2, 2.0, 5.0, 17.0, 30.0])
def test_no_overshoot_between_the_nodes(table, mach):
    """A cubic spline would overshoot in CN and Cm where Phoenix is nearly flat; every value must lie between
    its neighbours.
    """
    nodes = [0.0, 2.0, 4.0, 6.0, 11.0, 16.0]
    for low, high in zip(nodes, nodes[1:], strict=False):
        ends = np.sort([coefficients(table, mach, low)[:3], coefficients(table, mach, high)[:3]], axis=0)
        for angle in np.linspace(low, high, 12):
            value = coefficients(table, mach, angle)[:3]
            assert np.all(value >= ends[0] - 1e-12) and np.all(value <= ends[1] + 1e-12)


@pytest.mark.parametrize("rho", [DENSE, 1e-7, RARE])
def test_value_and_slope_are_continuous_everywhere(table, rho):
    """C1 in angle, through every node, 16 deg (end of the table), 40 deg (end of the fade), 90 and nearly 180
    deg.
    """
    h = 1e-4
    for mach in (0.4, 1.2, 2.3, 10.8, 30.0):
        for angle in (1.0, 2.0, 6.0, 11.0, 16.0, 17.0, 40.0, 41.0, 90.0, 179.0):
            left, here, right = (coefficients(table, mach, angle + d, rho)[:3] for d in (-h, 0.0, h))
            assert right - left == pytest.approx(np.zeros(3), abs=3e-5)
            assert (right - here) / h == pytest.approx((here - left) / h, abs=2e-5)
    assert coefficients(table, 5.0, 180.0, rho)[1:3] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_beyond_the_fade_it_is_newtonian(table):
    x_ref = -0.253 * D
    newton, _ = surface_integrals(capsule_rings(PARAMS.capsule), np.radians([40.0, 65.0, 120.0]), D, x_ref)
    for angle, row in zip((40.0, 65.0, 120.0), newton, strict=True):
        assert coefficients(table, 5.0, angle)[:3] == pytest.approx(
            stagnation_pressure_coefficient(5.0, 1.33) * row, rel=1e-9
        )
    assert coefficients(table, 5.0, 28.0)[0] != pytest.approx(
        stagnation_pressure_coefficient(5.0, 1.33) * newton[0, 0], rel=1e-3
    )


def test_stored_slopes_belong_to_the_values(table):
    """Between whole degrees the curve must not ripple: slopes agree with central differences of the
    values.
    """
    values, slopes = table.continuum[: table.n_mach, :, 0:6:2], table.continuum[: table.n_mach, :, 1:6:2]
    centred = 0.5 * (values[:, 2:] - values[:, :-2])
    assert slopes[:, 17:-1] == pytest.approx(centred[:, 16:], abs=2e-3)  # 1.6e-3: curvature jump at 40 deg


def test_bridging_limits_and_middle(table):
    path = 7.308e-26 / (sqrt(2) * pi * 4.59e-10**2)  # mean free path times density
    for kn, weight in ((9e-4, 0.0), (1e-3, 0.0), (1e-1, 0.5), (10.0, 1.0), (11.0, 1.0)):
        assert free_molecular_weight(gas_record(), path / (kn * D), D) == pytest.approx(weight, abs=1e-9)
    assert free_molecular_weight(gas_record(), 0.0, D) == 1.0
    for kn in (1.5e-3, 8.0, 0.03):
        got = free_molecular_weight(gas_record(), path / (kn * D), D)
        assert got == pytest.approx(sin(pi / 8 * (3 + log10(kn))) ** 2, abs=1e-12)
    dense, rare = coefficients(table, 20.0, 30.0), coefficients(table, 20.0, 30.0, RARE)
    mixed = coefficients(table, 20.0, 30.0, path / (kn * D))
    assert mixed[:3] == pytest.approx((dense + got * (rare - dense))[:3], abs=1e-12)
    assert np.all(np.abs(rare - dense)[:3] > 0.01)


def test_unknown_and_incomplete_tables_are_refused(tmp_path):
    with pytest.raises(ValueError, match="neither a file nor a name"):
        read_static_table("missing.csv")
    path = tmp_path / "half.csv"
    path.write_text("mach,alpha_deg,CD,CL,Cm\n1,0,1,0,0\n1,10,1,0,0\n2,0,1,0,0\n")
    with pytest.raises(ValueError, match="not a complete"):
        read_static_table(str(path))
