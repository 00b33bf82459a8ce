"""Pressure on a body of revolution, Newtonian and free-molecular, against closed forms and flat panels."""

from math import cos, pi, radians, sin, sqrt

import numpy as np
import pytest
from aero_capsule import AREA, PARAMS, RARE, D, coefficients, table_of

from edl6dof.vehicle.aerodynamics.capsule import CapsuleParams
from edl6dof.vehicle.aerodynamics.newtonian import (
    capsule_rings,
    stagnation_pressure_coefficient,
    surface_integrals,
)


def test_stagnation_pressure():
    """Rayleigh's formula against the normal-shock and isentropic relations applied one after the other;
    isentropic at Mach 1.
    """
    g, m = 1.33, 4.0
    behind = sqrt((1 + 0.5 * (g - 1) * m**2) / (g * m**2 - 0.5 * (g - 1)))
    pressure = (1 + 2 * g / (g + 1) * (m**2 - 1)) * (1 + 0.5 * (g - 1) * behind**2) ** (g / (g - 1))
    assert stagnation_pressure_coefficient(m, g) == pytest.approx(
        (pressure - 1) / (0.5 * g * m**2), rel=1e-12
    )
    below, above = stagnation_pressure_coefficient(np.array([1 - 1e-9, 1 + 1e-9]), g)
    assert below == pytest.approx(above, abs=1e-7)


def sharp_capsule(**changes):
    return CapsuleParams(shoulder_radius_m=0.0, **changes)


@pytest.mark.parametrize("cone_deg, nose", [(70.0, 0.85), (45.0, 0.6), (60.0, 0.2)])
def test_newtonian_sphere_cone_against_the_closed_form(cone_deg, nose):
    rings = capsule_rings(sharp_capsule(cone_half_angle_deg=cone_deg, nose_radius_m=nose))
    newton, _ = surface_integrals(rings, np.array([0.0]), D, 0.0)
    k, s, c = (nose / (0.5 * D)) ** 2, sin(radians(cone_deg)), cos(radians(cone_deg))
    assert newton[0] == pytest.approx([0.5 * k * (1 - s**4) + s * s * (1 - k * c * c), 0.0, 0.0], abs=1e-9)


def test_newtonian_slope_of_a_cone_against_the_closed_form():
    """Sharp cone, alpha < half angle: CN/Cp_max = cos^2(d) sin(2 alpha)/2, acting 2/3 length / cos^2(d) from
    the tip.
    """
    d, alpha = radians(45.0), radians(10.0)
    rings = capsule_rings(sharp_capsule(cone_half_angle_deg=45.0, nose_radius_m=1e-6))
    newton, _ = surface_integrals(rings, np.array([alpha]), D, 0.0)
    cn = 0.5 * cos(d) ** 2 * sin(2 * alpha)
    assert newton[0, 1] == pytest.approx(cn, rel=1e-5)
    # length is D/2 at 45 deg
    assert newton[0, 2] / newton[0, 1] == pytest.approx(-2 / 3 * 0.5 / cos(d) ** 2, rel=1e-5)


def test_integrals_against_brute_force_panels():
    """The closed form in azimuth against flat panels in three dimensions, n.v < 0 dropped, r x F for the
    moment.
    """
    rings = capsule_rings(PARAMS.capsule)
    x_ref, count = -0.7, 4000
    phi = (np.arange(count) + 0.5) * 2 * pi / count
    n = np.stack(np.broadcast_arrays(rings.nx[:, None], 0 * phi, rings.nr[:, None] * np.cos(phi)))
    n[1] = rings.nr[:, None] * np.sin(phi)
    radius = rings.r[:, None]
    r = np.stack(np.broadcast_arrays((rings.x - x_ref)[:, None], radius * np.sin(phi), radius * np.cos(phi)))
    area = rings.weight[:, None] * 2 * pi / count
    for angle in np.radians([0.0, 12.0, 50.0, 90.0, 133.0, 180.0]):
        flow = np.array([cos(angle), 0.0, sin(angle)])
        wet = np.maximum(np.einsum("i,irp->rp", flow, n), 0.0)
        pair = surface_integrals(rings, np.array([angle]), D, x_ref)
        for got, force in zip(
            pair, (-(wet**2) * area * n, -2 * wet * area * flow[:, None, None]), strict=True
        ):
            fx, _, fz = force.sum(axis=(1, 2))
            my = (r[2] * force[0] - r[0] * force[2]).sum()
            assert got[0] == pytest.approx([-fx / AREA, -fz / AREA, my / AREA / D], abs=2e-6)


def test_free_molecular_drag_is_twice_the_projected_area():
    table = table_of()
    ca, cn, cm, _ = coefficients(table, 20.0, 0.0, RARE)
    assert (ca, cn, cm) == pytest.approx((2.0, 0.0, 0.0), abs=1e-9)
    assert coefficients(table, 20.0, 180.0, RARE)[0] == pytest.approx(-2.0, abs=1e-9)
    side = coefficients(table, 20.0, 90.0, RARE)
    rings = capsule_rings(PARAMS.capsule, 100)
    order = np.argsort(-rings.x)
    projected = 2 * np.trapezoid(rings.r[order], -rings.x[order])  # the silhouette seen from the side
    assert side[:2] == pytest.approx([0.0, 2 * projected / AREA], abs=2e-3)


def test_sphere_has_the_same_drag_from_everywhere():
    node, weight = np.polynomial.legendre.leggauss(240)
    s = node * pi / 2
    rings = type(capsule_rings(PARAMS.capsule))(
        np.sin(s), np.cos(s), np.sin(s), np.cos(s), np.cos(s) * weight * pi / 2
    )
    angle = np.radians([0.0, 20.0, 90.0, 151.0])
    newton, rare = surface_integrals(rings, angle, 2.0, 0.0)
    for values, drag in ((newton, 0.5), (rare, 2.0)):  # Cp_max/2 and 2
        along = values[:, 0] * np.cos(angle) + values[:, 1] * np.sin(angle)
        across = values[:, 0] * np.sin(angle) - values[:, 1] * np.cos(angle)
        assert along == pytest.approx(np.full(4, drag), abs=1e-4)
        assert across == pytest.approx(np.zeros(4), abs=1e-4)
        assert values[:, 2] == pytest.approx(np.zeros(4), abs=1e-4)
