"""Coefficients of a capsule from its shape alone: base pressure, biconic forebody, derivatives, and the
published table of a 70-degree one.
"""

from math import cos, pi, radians, sin

import numpy as np
import pytest
from aero_capsule import GAS_PARAMS, RARE, D, capsule_with, coefficients
from pydantic import ValidationError

from edl6dof.vehicle.aerodynamics.capsule import CapsuleParams
from edl6dof.vehicle.aerodynamics.capsule_table import aero_inputs, build_aero_table, read_static_table
from edl6dof.vehicle.aerodynamics.newtonian import (
    base_pressure_coefficient,
    capsule_rings,
    newtonian_coefficients,
    stagnation_pressure_coefficient,
    surface_integrals,
    windward_integrals,
)

RATIO = GAS_PARAMS.shock_layer_heat_capacity_ratio
#: Phoenix's own shape: 2.65 m, nose D/4, shoulder D/40.
PHOENIX = CapsuleParams(
    coefficients="newtonian",
    diameter_m=2.65,
    nose_radius_m=0.6638,
    shoulder_radius_m=0.0662,
    backshell_break_radius_m=0.8,
    backshell_base_radius_m=0.35,
)


def table_of_shape(capsule):
    return build_aero_table(aero_inputs(capsule, RATIO)).view(np.recarray)[0]


def test_base_pressure_is_continuous_at_mach_one_and_tends_to_a_vacuum():
    below, above = base_pressure_coefficient(np.array([1.0 - 1e-9, 1.0 + 1e-9]), 1.4)
    assert below == pytest.approx(above, abs=1e-7)
    # p = 0 behind: Cp = -2 / (g M^2)
    assert base_pressure_coefficient(30.0, 1.4) == pytest.approx(-2.0 / (1.4 * 900.0), rel=0.1)
    assert base_pressure_coefficient(0.0, 1.4) == pytest.approx(-0.2)


def test_pressure_all_around_has_no_resultant():
    """The lee is the rest of a closed surface: its integral, by panels, is the opposite of the windward's."""
    rings, x_ref, count = capsule_rings(CapsuleParams()), -0.7, 3000
    phi = (np.arange(count) + 0.5) * 2 * pi / count
    n = np.stack(
        [rings.nx[:, None] + 0 * phi, rings.nr[:, None] * np.sin(phi), rings.nr[:, None] * np.cos(phi)]
    )
    x, z = (rings.x - x_ref)[:, None] + 0 * phi, rings.r[:, None] * np.cos(phi)
    area = rings.weight[:, None] * 2 * pi / count
    for angle in (0.0, 0.4, 1.3, 2.6):
        lee = (n[0] * cos(angle) + n[2] * sin(angle) <= 0.0) * area
        push = -np.array([(lee * n[0]).sum(), (lee * n[2]).sum(), (lee * (x * n[2] - z * n[0])).sum() / -D])
        ca, cn, cm = windward_integrals(rings, np.array([angle]), D, x_ref)[0] * pi / 4 * D**2
        assert push[:2] == pytest.approx([ca, cn], abs=2e-2)
        assert push[2] == pytest.approx(-cm, abs=2e-2)


def test_biconic_forebody_against_the_closed_form():
    """Each piece adds its sin^2 times its frontal area: nose sphere, first cone, second cone."""
    rn, one, two, r_break = 0.4, radians(25.0), radians(55.0), 0.9
    capsule = CapsuleParams(
        shoulder_radius_m=0.0,
        nose_radius_m=rn,
        cone_half_angle_deg=25.0,
        forebody_break_radius_m=r_break,
        forebody_second_cone_angle_deg=55.0,
    )
    newton, _ = surface_integrals(capsule_rings(capsule), np.array([0.0]), D, 0.0)
    r1, rmax = rn * cos(one), 0.5 * D
    nose = 0.5 * rn**2 * (1.0 - sin(one) ** 4)
    cones = sin(one) ** 2 * (r_break**2 - r1**2) + sin(two) ** 2 * (rmax**2 - r_break**2)
    assert newton[0] == pytest.approx([(nose + cones) / rmax**2, 0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize(
    "wrong", [{"forebody_break_radius_m": 1.0}, {"forebody_second_cone_angle_deg": 50.0}]
)
def test_half_a_biconic_is_refused(wrong):
    with pytest.raises(ValidationError, match="needs both"):
        CapsuleParams(**wrong)


def test_break_inside_the_nose_is_refused():
    narrow = CapsuleParams(forebody_break_radius_m=0.1, forebody_second_cone_angle_deg=60.0)
    with pytest.raises(ValueError, match="no room for the first cone"):
        capsule_rings(narrow)


def test_table_of_a_shape_is_the_integral_and_its_slopes_are_differences():
    """Axial force at zero angle is closed form; CN_alpha and Cm_alpha of the look-up against the integral."""
    capsule = CapsuleParams(coefficients="newtonian", shoulder_radius_m=0.0)
    table, aero = table_of_shape(capsule), capsule_with(coefficients="newtonian", shoulder_radius_m=0.0)
    mach, k, s, c = 10.0, (0.85 / 1.7) ** 2, sin(radians(70.0)), cos(radians(70.0))
    closed = 0.5 * k * (1 - s**4) + s * s * (1 - k * c * c)
    stagnation, base = (f(mach, RATIO) for f in (stagnation_pressure_coefficient, base_pressure_coefficient))
    assert coefficients(table, mach, 0.0, aero=aero)[0] == pytest.approx(stagnation * closed - base, rel=1e-6)
    h, size = 0.25, (D, -0.253 * D)
    angles = np.radians([5.0 - h, 5.0 + h])
    down, up = newtonian_coefficients(capsule_rings(capsule), angles, np.array([mach]), RATIO, size)[0]
    low, high = (coefficients(table, mach, 5.0 + d, aero=aero)[:3] for d in (-h, h))
    assert high - low == pytest.approx(up - down, abs=2e-6)
    assert coefficients(table, mach, 0.0, RARE, aero)[0] == pytest.approx(2.0, abs=1e-9)


def test_published_table_of_phoenix_is_met_as_closely_as_newtonian_flow_meets_it():
    """Largest errors of CA by Mach regime, at all angles of the table: the bounds are what
    docs/aerodynamics.md tells, and a forebody without base pressure breaks them.
    """
    mach, alpha, published = read_static_table("phoenix_70deg_static_aero.csv")
    rings, size = capsule_rings(PHOENIX), (2.65, -0.253 * 2.65)
    own = newtonian_coefficients(rings, np.radians(alpha), mach, RATIO, size)
    error = own[..., 0] / published[..., 0] - 1.0
    worst = {
        "subsonic": np.abs(error[mach < 1.0]).max(),
        "supersonic": np.abs(error[(mach >= 1.0) & (mach < 5.0)]).max(),
        "hypersonic": np.abs(error[mach >= 5.0]).max(),
    }
    assert worst["subsonic"] < 0.095 and worst["supersonic"] < 0.075 and worst["hypersonic"] < 0.075
    bare = (
        stagnation_pressure_coefficient(mach, RATIO)[:, None, None]
        * surface_integrals(rings, np.radians(alpha), *size)[0]
    )
    error = np.abs(bare[..., 0] / published[..., 0] - 1.0)
    assert error[(mach >= 1.0) & (mach < 5.0)].max() > 0.12
