"""Aerodynamic force and moment of capsule, bluff bodies and constant coefficients: symmetry, signs, limits,
damping, factors.
"""

from math import cos, radians, sin, sqrt

import numpy as np
import pytest
from aero_capsule import (
    AREA,
    DENSE,
    PARAMS,
    D,
    capsule_with,
    coefficients,
    gas_record,
    record,
    table_of,
    velocity,
    wrench,
)
from pydantic import ValidationError

from edl6dof.vehicle.aerodynamics.body import BODY_TABLE
from edl6dof.vehicle.aerodynamics.capsule import CapsuleParams, capsule_aero
from edl6dof.vehicle.aerodynamics.capsule_table import AERO_TABLE
from edl6dof.vehicle.aerodynamics.wrench import (
    AeroParams,
    BluffParams,
    ConstantAeroParams,
    aerodynamic_wrench,
    bluff_aero,
    constant_aero,
)
from edl6dof.vehicle.mass import CONFIG_BACKSHELL, CONFIG_CAPSULE, CONFIG_LANDER


def no_body():
    """The table of a body of any shape, of which there is none."""
    return np.zeros(1, BODY_TABLE).view(np.recarray)[0]


@pytest.fixture(scope="module")
def table():
    return table_of()


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


@pytest.mark.parametrize(
    "angle, mach, cmq",
    [
        (0, 2.0, 0.30),
        (2, 1.5, 0.35),
        (5, 2.5, 0.05),
        (10, 2.5, -0.2),
        (60, 0.8, -0.2),
        # fmt: skip
        (0, 0.8, -0.1),
        (3.5, 2.0, 0.2),
        (0, 20.0, -0.1),
        (10, 5.0, -0.135),
        # between the nodes of both: 5 and 10 deg, Mach 2 and 2.5
        (7.5, 2.25, 0.25 * (0.10 + 0.05 - 0.20 - 0.20)),
        (7.25, 2.125, 0.55 * (0.75 * 0.10 + 0.25 * 0.05) + 0.45 * -0.20),
    ],
)
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


#: No motion, no rotation.
STILL = (0.0, 0.0, 0.0)


def test_bluff_body():
    bluff = record().lander
    pure = BluffParams(drag_coefficient=1.2, normal_slope=1.2)
    aero = record(AeroParams(lander=pure))
    vel = np.array(velocity(37.0, 65.0, 50.0))
    force = np.array(bluff_aero(aero.lander, 10.0, tuple(vel), STILL))
    assert force[:3] == pytest.approx(-10.0 * 9.079 * 1.2 * vel / 50.0)  # pure drag
    assert np.array_equal(force[3:], np.zeros(3))
    spin = np.array(bluff_aero(bluff, 10.0, tuple(vel), (0.5, 0.1, -0.2)))
    arm = 10.0 * 5.0 * 2.5 * -0.2 * 2.5 / 100.0
    assert spin[3:] == pytest.approx([0.0, 0.1 * arm, -0.2 * arm])
    assert np.array_equal(bluff_aero(bluff, 0.0, STILL, STILL), np.zeros(6))


@pytest.mark.parametrize("configuration, cg_x", [(CONFIG_BACKSHELL, -1.0), (CONFIG_LANDER, -0.9)])
def test_bluff_bodies_are_statically_stable_about_a_forward_cg(configuration, cg_x):
    empty = np.zeros(1, AERO_TABLE).view(np.recarray)[0]  # not used by bluff bodies
    got = aerodynamic_wrench(
        record(),
        (empty, no_body()),
        (gas_record(), 1.0, 0.5, DENSE),
        configuration,
        velocity(10.0),
        STILL,
    )
    fx, fy, fz, mx, my, mz, x_ref = got
    bluff = PARAMS.backshell if configuration == CONFIG_BACKSHELL else PARAMS.lander
    assert x_ref == bluff.centre_of_pressure_x_m
    assert fx == pytest.approx(-bluff.drag_coefficient * bluff.reference_area_m2 * cos(radians(10.0)))
    assert my - (x_ref - cg_x) * fz < 0.0


def test_constant_aero_is_nesc_drag_and_rate_damping():
    damping = {"roll_damping": -1.0, "pitch_damping": -2.0, "yaw_damping": -3.0}
    params = ConstantAeroParams(
        drag_coefficient=0.1, reference_area_m2=0.5, span_m=0.4, chord_m=0.7, **damping
    )
    aero = record(AeroParams(model="constant", constant=params))
    got = np.array(constant_aero(aero, 100.0, (30.0, 40.0, 0.0), (0.1, 0.2, 0.3)))
    b, c = 0.4**2 / (2 * 50), 0.7**2 / (2 * 50)
    assert got == pytest.approx([-3.0, -4.0, 0.0, -50 * b * 0.1, -100 * c * 0.2, -150 * b * 0.3])
    assert np.array_equal(constant_aero(aero, 0.0, STILL, (1.0, 1.0, 1.0)), np.zeros(6))


def test_dispatch(table):
    tables, air = (table, no_body()), (gas_record(), 100.0, 5.0, DENSE)
    moving = velocity(8.0, 40.0, 900.0), (0.01, 0.02, 0.03)
    got = aerodynamic_wrench(record(), tables, air, CONFIG_CAPSULE, *moving)
    assert got[:6] == capsule_aero(record(), table, air, *moving) and got[6] == pytest.approx(-0.253 * D)
    assert (
        aerodynamic_wrench(record(AeroParams(model="none")), tables, air, CONFIG_CAPSULE, *moving)
        == (0.0,) * 7
    )
    constant = record(
        AeroParams(
            model="constant", constant=ConstantAeroParams(drag_coefficient=1.0, moment_reference_x_m=-0.5)
        )
    )
    got = aerodynamic_wrench(constant, tables, air, CONFIG_LANDER, *moving)
    assert sqrt(sum(f * f for f in got[:3])) == pytest.approx(100.0) and got[6] == -0.5


@pytest.mark.parametrize("wrong", [
    {"damping_mach": [1.0, 2.0]}, {"damping_angle_deg": [5.0, 2.0, 10.0]}, {"damping_angle_deg": [2.5, 5.0,
    10.0]},
    {"backshell_break_radius_m": 1.69}, {"nose_radius_m": 1.8}, {"diameter_m": -1.0}, {"unknown": 1.0},
])  # fmt: skip
def test_wrong_parameters_are_refused(wrong):
    with pytest.raises(ValidationError):
        CapsuleParams(**wrong)
