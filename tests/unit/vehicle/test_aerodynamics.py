"""Capsule, bluff and constant aerodynamics against the published table, closed forms, symmetry and continuity."""

import csv
from math import cos, log10, pi, radians, sin, sqrt

import numpy as np
import pytest
from pydantic import ValidationError

from edl6dof.config.dtype import fill
from edl6dof.vehicle.aerodynamics import (
    AERO,
    CONFIG_BACKSHELL,
    CONFIG_CAPSULE,
    CONFIG_LANDER,
    AeroParams,
    BluffParams,
    CapsuleParams,
    ConstantAeroParams,
    aerodynamic_wrench,
    bluff_aero,
    capsule_aero,
    capsule_coefficients,
    constant_aero,
    free_molecular_weight,
)
from edl6dof.vehicle.aerotable import (
    AERO_TABLE,
    PACKAGED,
    build_aero_table,
    capsule_rings,
    read_static_table,
    stagnation_pressure_coefficient,
    surface_integrals,
)

D, AREA = 3.4, pi / 4 * 3.4**2
DENSE, RARE = 1e-2, 1e-12  # kg/m3: Kn < 1e-3 and Kn > 10
PARAMS = AeroParams()


def record(params=PARAMS):
    aero = np.zeros(1, AERO)
    fill(aero[0], params)
    return aero.view(np.recarray)[0]


@pytest.fixture(scope="module")
def table():
    return build_aero_table(PARAMS.capsule).view(np.recarray)[0]


def capsule_with(**changes):
    return record(AeroParams(capsule=CapsuleParams(**changes)))


def velocity(angle_deg, roll_deg=90.0, speed=1.0):
    """Velocity at a total angle; roll 0 is sideslip to the right, roll 90 is positive alpha."""
    a, f = radians(angle_deg), radians(roll_deg)
    return speed * cos(a), speed * sin(a) * cos(f), speed * sin(a) * sin(f)


def coefficients(table, mach, angle_deg, rho=DENSE, aero=None):
    return np.array(capsule_coefficients((aero or record()).capsule, table, mach, rho, radians(angle_deg)))


def wrench(table, vel, mach=5.0, rho=DENSE, rates=(0.0, 0.0, 0.0), aero=None):
    return np.array(capsule_aero(aero or record(), table, 1.0, mach, rho, *vel, *rates))


def phoenix_rows():
    with (PACKAGED / "phoenix_70deg_static_aero.csv").open() as stream:
        return [tuple(map(float, row.values())) for row in csv.DictReader(line for line in stream if line[0] != "#")]


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
    """A cubic spline would overshoot in CN and Cm where Phoenix is nearly flat; every value must lie between its neighbours."""
    nodes = [0.0, 2.0, 4.0, 6.0, 11.0, 16.0]
    for low, high in zip(nodes, nodes[1:], strict=False):
        ends = np.sort([coefficients(table, mach, low)[:3], coefficients(table, mach, high)[:3]], axis=0)
        for angle in np.linspace(low, high, 12):
            value = coefficients(table, mach, angle)[:3]
            assert np.all(value >= ends[0] - 1e-12) and np.all(value <= ends[1] + 1e-12)


@pytest.mark.parametrize("rho", [DENSE, 1e-7, RARE])
def test_value_and_slope_are_continuous_everywhere(table, rho):
    """C1 in angle, through every node, 16 deg (end of the table), 40 deg (end of the fade), 90 and nearly 180 deg."""
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
        assert coefficients(table, 5.0, angle)[:3] == pytest.approx(stagnation_pressure_coefficient(5.0) * row, rel=1e-9)
    assert coefficients(table, 5.0, 28.0)[0] != pytest.approx(stagnation_pressure_coefficient(5.0) * newton[0, 0], rel=1e-3)


def test_stored_slopes_belong_to_the_values(table):
    """Between whole degrees the curve must not ripple: slopes agree with central differences of the values."""
    values, slopes = table.continuum[: table.n_mach, :, 0:6:2], table.continuum[: table.n_mach, :, 1:6:2]
    centred = 0.5 * (values[:, 2:] - values[:, :-2])
    assert slopes[:, 17:-1] == pytest.approx(centred[:, 16:], abs=2e-3)  # 1.6e-3: curvature jump at 40 deg


def test_stagnation_pressure():
    """Rayleigh's formula against the normal-shock and isentropic relations applied one after the other; isentropic at Mach 1."""
    g, m = 1.33, 4.0
    behind = sqrt((1 + 0.5 * (g - 1) * m**2) / (g * m**2 - 0.5 * (g - 1)))
    pressure = (1 + 2 * g / (g + 1) * (m**2 - 1)) * (1 + 0.5 * (g - 1) * behind**2) ** (g / (g - 1))
    assert stagnation_pressure_coefficient(m) == pytest.approx((pressure - 1) / (0.5 * g * m**2), rel=1e-12)
    below, above = stagnation_pressure_coefficient(np.array([1 - 1e-9, 1 + 1e-9]))
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
    """Sharp cone, alpha < half angle: CN/Cp_max = cos^2(d) sin(2 alpha)/2, acting 2/3 length / cos^2(d) from the tip."""
    d, alpha = radians(45.0), radians(10.0)
    rings = capsule_rings(sharp_capsule(cone_half_angle_deg=45.0, nose_radius_m=1e-6))
    newton, _ = surface_integrals(rings, np.array([alpha]), D, 0.0)
    cn = 0.5 * cos(d) ** 2 * sin(2 * alpha)
    assert newton[0, 1] == pytest.approx(cn, rel=1e-5)
    assert newton[0, 2] / newton[0, 1] == pytest.approx(-2 / 3 * 0.5 / cos(d) ** 2, rel=1e-5)  # length is D/2 at 45 deg


def test_integrals_against_brute_force_panels():
    """The closed form in azimuth against flat panels in three dimensions, n.v < 0 dropped, r x F for the moment."""
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
        for got, force in zip(pair, (-(wet**2) * area * n, -2 * wet * area * flow[:, None, None]), strict=True):
            fx, _, fz = force.sum(axis=(1, 2))
            my = (r[2] * force[0] - r[0] * force[2]).sum()
            assert got[0] == pytest.approx([-fx / AREA, -fz / AREA, my / AREA / D], abs=2e-6)


def test_free_molecular_drag_is_twice_the_projected_area(table):
    ca, cn, cm, _ = coefficients(table, 20.0, 0.0, RARE)
    assert (ca, cn, cm) == pytest.approx((2.0, 0.0, 0.0), abs=1e-9)
    assert coefficients(table, 20.0, 180.0, RARE)[0] == pytest.approx(-2.0, abs=1e-9)
    side = coefficients(table, 20.0, 90.0, RARE)
    rings = capsule_rings(PARAMS.capsule, 400)
    order = np.argsort(-rings.x)
    projected = 2 * np.trapezoid(rings.r[order], -rings.x[order])  # the silhouette seen from the side
    assert side[:2] == pytest.approx([0.0, 2 * projected / AREA], abs=2e-3)


def test_sphere_has_the_same_drag_from_everywhere():
    node, weight = np.polynomial.legendre.leggauss(400)
    s = node * pi / 2
    rings = type(capsule_rings(PARAMS.capsule))(np.sin(s), np.cos(s), np.sin(s), np.cos(s), np.cos(s) * weight * pi / 2)
    angle = np.radians([0.0, 20.0, 90.0, 151.0])
    newton, rare = surface_integrals(rings, angle, 2.0, 0.0)
    for values, drag in ((newton, 0.5), (rare, 2.0)):  # Cp_max/2 and 2
        along = values[:, 0] * np.cos(angle) + values[:, 1] * np.sin(angle)
        across = values[:, 0] * np.sin(angle) - values[:, 1] * np.cos(angle)
        assert along == pytest.approx(np.full(4, drag), abs=1e-4)
        assert across == pytest.approx(np.zeros(4), abs=1e-4)
        assert values[:, 2] == pytest.approx(np.zeros(4), abs=1e-4)


@pytest.mark.parametrize("angle", [3.0, 25.0, 100.0])
def test_rolling_the_wind_rolls_force_and_moment(table, angle):
    rates = (0.1, 0.3, -0.2)
    for roll in (10.0, 75.0, 200.0):
        c, s = cos(radians(roll)), sin(radians(roll))
        turn = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
        vel = np.array(velocity(angle, 20.0, 500.0))
        first = wrench(table, vel, 2.2, rates=rates)
        second = wrench(table, turn @ vel, 2.2, rates=tuple(turn @ rates))
        assert second == pytest.approx(np.concatenate((turn @ first[:3], turn @ first[3:])), abs=1e-10)


def test_left_right_mirror(table):
    u, v, w = velocity(14.0, 33.0, 700.0)
    right = wrench(table, (u, v, w), 3.0, rates=(0.1, 0.2, 0.3))
    left = wrench(table, (u, -v, w), 3.0, rates=(-0.1, 0.2, -0.3))
    assert left == pytest.approx(right * [1, -1, 1, -1, 1, -1], abs=1e-14)
    assert abs(right[1]) > 0.0 and abs(right[5]) > 0.0


def test_signs_of_a_blunt_stable_body(table):
    """alpha > 0: force up is negative lift, moment nose down; sideslip to the right: nose to the right."""
    fx, fy, fz, mx, my, mz = wrench(table, velocity(10.0, 90.0))
    assert fx < 0 and fz < 0 and my < 0
    lift = fx * sin(radians(10)) - fz * cos(radians(10))
    assert lift < 0
    fx, fy, fz, mx, my, mz = wrench(table, velocity(10.0, 0.0))
    assert fy < 0 and fz == 0 and mz > 0 and my == pytest.approx(0.0, abs=1e-14)


def test_zero_lateral_velocity_is_finite_and_the_limit(table):
    exact = wrench(table, (500.0, 0.0, 0.0))
    assert np.all(np.isfinite(exact)) and np.array_equal(exact[1:], np.zeros(5))
    for lateral in (1e-300, 1e-12, 1e-6):
        assert wrench(table, (500.0, lateral, -lateral)) == pytest.approx(exact, abs=1e-7)
    assert np.array_equal(wrench(table, (0.0, 0.0, 0.0), rho=0.0), np.zeros(6))
    assert np.all(np.isfinite(wrench(table, (-500.0, 0.0, 0.0))))


def test_bridging_limits_and_middle(table):
    capsule = record().capsule
    path = 7.308e-26 / (sqrt(2) * pi * 4.59e-10**2)  # mean free path times density
    for kn, weight in ((9e-4, 0.0), (1e-3, 0.0), (1e-1, 0.5), (10.0, 1.0), (11.0, 1.0)):
        assert free_molecular_weight(capsule, path / (kn * D)) == pytest.approx(weight, abs=1e-9)
    assert free_molecular_weight(capsule, 0.0) == 1.0
    for kn in (1.5e-3, 8.0, 0.03):
        got = free_molecular_weight(capsule, path / (kn * D))
        assert got == pytest.approx(sin(pi / 8 * (3 + log10(kn))) ** 2, abs=1e-12)
    dense, rare = coefficients(table, 20.0, 30.0), coefficients(table, 20.0, 30.0, RARE)
    mixed = coefficients(table, 20.0, 30.0, path / (kn * D))
    assert mixed[:3] == pytest.approx((dense + got * (rare - dense))[:3], abs=1e-12)
    assert np.all(np.abs(rare - dense)[:3] > 0.01)


@pytest.mark.parametrize("angle, mach, cmq", [(0, 2.0, 0.30), (2, 1.5, 0.35), (5, 2.5, 0.05), (10, 2.5, -0.2), (60, 0.8, -0.2),
                                              (0, 0.8, -0.1), (3.5, 2.0, 0.2), (0, 20.0, -0.1), (10, 5.0, -0.135)])  # fmt: skip
def test_damping_table_and_sign_of_the_moment(table, angle, mach, cmq):
    assert coefficients(table, mach, angle)[3] == pytest.approx(cmq, abs=1e-12)
    speed = 400.0
    vel = velocity(angle, 30.0, speed)
    still = wrench(table, vel, mach)
    moving = wrench(table, vel, mach, rates=(0.7, 0.2, -0.1))
    expected = AREA * D * cmq * D / (2 * speed)
    assert moving - still == pytest.approx([0, 0, 0, 0, 0.2 * expected, -0.1 * expected], abs=1e-12)


def test_uncertainty_factors(table):
    vel = velocity(12.0, 50.0, 300.0)
    base = wrench(table, vel)
    axial = wrench(table, vel, aero=capsule_with(axial_factor=1.1))
    assert axial == pytest.approx(base * [1.1, 1, 1, 1, 1, 1])
    normal = wrench(table, vel, aero=capsule_with(normal_factor=0.8))
    assert normal[1:3] == pytest.approx(0.8 * base[1:3]) and normal[0] == base[0]
    moment = wrench(table, vel, aero=capsule_with(moment_factor=0.9, moment_bias=0.01))
    assert moment[4] == pytest.approx(0.9 * base[4] + 0.01 * AREA * D)
    assert moment[5] == pytest.approx(0.9 * base[5])
    spin = wrench(table, vel, aero=capsule_with(damping_factor=2.0), rates=(0, 0.3, 0)) - base
    assert spin[4] == pytest.approx(2 * (wrench(table, vel, rates=(0, 0.3, 0)) - base)[4])


def test_bluff_body():
    bluff = record().lander
    pure = BluffParams(drag_coefficient=1.2, normal_slope=1.2)
    aero = record(AeroParams(lander=pure))
    vel = np.array(velocity(37.0, 65.0, 50.0))
    force = np.array(bluff_aero(aero.lander, 10.0, *vel, 0.0, 0.0, 0.0))
    assert force[:3] == pytest.approx(-10.0 * 9.079 * 1.2 * vel / 50.0)  # pure drag
    assert np.array_equal(force[3:], np.zeros(3))
    spin = np.array(bluff_aero(bluff, 10.0, *vel, 0.5, 0.1, -0.2))
    arm = 10.0 * 5.0 * 2.5 * -0.2 * 2.5 / 100.0
    assert spin[3:] == pytest.approx([0.0, 0.1 * arm, -0.2 * arm])
    assert np.array_equal(bluff_aero(bluff, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), np.zeros(6))


@pytest.mark.parametrize("configuration, cg_x", [(CONFIG_BACKSHELL, -1.0), (CONFIG_LANDER, -0.9)])
def test_bluff_bodies_are_statically_stable_about_a_forward_cg(configuration, cg_x):
    empty = np.zeros(1, AERO_TABLE).view(np.recarray)[0]  # not used by bluff bodies
    got = aerodynamic_wrench(record(), empty, configuration, 1.0, 0.5, DENSE, *velocity(10.0), 0.0, 0.0, 0.0)
    fx, fy, fz, mx, my, mz, x_ref = got
    bluff = PARAMS.backshell if configuration == CONFIG_BACKSHELL else PARAMS.lander
    assert x_ref == bluff.centre_of_pressure_x_m
    assert fx == pytest.approx(-bluff.drag_coefficient * bluff.reference_area_m2 * cos(radians(10.0)))
    assert my - (x_ref - cg_x) * fz < 0.0


def test_constant_aero_is_nesc_drag_and_rate_damping():
    damping = {"roll_damping": -1.0, "pitch_damping": -2.0, "yaw_damping": -3.0}
    params = ConstantAeroParams(drag_coefficient=0.1, reference_area_m2=0.5, span_m=0.4, chord_m=0.7, **damping)
    aero = record(AeroParams(model="constant", constant=params))
    got = np.array(constant_aero(aero, 100.0, 30.0, 40.0, 0.0, 0.1, 0.2, 0.3))
    b, c = 0.4**2 / (2 * 50), 0.7**2 / (2 * 50)
    assert got == pytest.approx([-3.0, -4.0, 0.0, -50 * b * 0.1, -100 * c * 0.2, -150 * b * 0.3])
    assert np.array_equal(constant_aero(aero, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0), np.zeros(6))


def test_dispatch(table):
    arguments = (100.0, 5.0, DENSE, *velocity(8.0, 40.0, 900.0), 0.01, 0.02, 0.03)
    got = aerodynamic_wrench(record(), table, CONFIG_CAPSULE, *arguments)
    assert got[:6] == capsule_aero(record(), table, *arguments) and got[6] == pytest.approx(-0.253 * D)
    assert aerodynamic_wrench(record(AeroParams(model="none")), table, CONFIG_CAPSULE, *arguments) == (0.0,) * 7
    constant = record(AeroParams(model="constant", constant=ConstantAeroParams(drag_coefficient=1.0, moment_reference_x_m=-0.5)))
    got = aerodynamic_wrench(constant, table, CONFIG_LANDER, *arguments)
    assert sqrt(sum(f * f for f in got[:3])) == pytest.approx(100.0) and got[6] == -0.5


@pytest.mark.parametrize("wrong", [
    {"damping_mach": [1.0, 2.0]}, {"damping_angle_deg": [5.0, 2.0, 10.0]}, {"damping_angle_deg": [2.5, 5.0, 10.0]},
    {"backshell_break_radius_m": 1.69}, {"nose_radius_m": 1.8}, {"diameter_m": -1.0}, {"unknown": 1.0},
])  # fmt: skip
def test_wrong_parameters_are_refused(wrong):
    with pytest.raises(ValidationError):
        CapsuleParams(**wrong)


def test_unknown_and_incomplete_tables_are_refused(tmp_path):
    with pytest.raises(ValueError, match="neither a file nor a name"):
        read_static_table("missing.csv")
    path = tmp_path / "half.csv"
    path.write_text("mach,alpha_deg,CD,CL,Cm\n1,0,1,0,0\n1,10,1,0,0\n2,0,1,0,0\n")
    with pytest.raises(ValueError, match="not a complete"):
        read_static_table(str(path))
