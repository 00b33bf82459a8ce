"""Trim wing: force and moment of the plate, and the trim angles it has to produce together with the capsule's
CG offset.
"""

from math import cos, pi, radians, sin

import numpy as np
import pytest
from aero_capsule import gas_record, table_of
from scipy.optimize import brentq

from edl6dof.config.dtype import fill
from edl6dof.vehicle.aerodynamics.capsule import capsule_aero
from edl6dof.vehicle.aerodynamics.surfaces import SURFACE, SurfaceParams, wing_force, wing_opening
from edl6dof.vehicle.aerodynamics.wrench import AERO, AeroParams

D, AREA = 3.4, pi / 4 * 3.4**2
CG = (-0.25 * D, 0.0, -0.0100 * D)  # above the axis: lift up at alpha -10 deg


WING = {
    "name": "wing",
    "area_m2": 0.16,
    "force_coefficient": 1.7,
    "position_x_m": -0.95,
    "position_z_m": -1.904,
    "deploy_time_s": 0.7,
}


def wing_record(**changes):
    wing = np.zeros(1, SURFACE)
    fill(wing[0], SurfaceParams(**WING | changes))
    return wing.view(np.recarray)[0]


@pytest.fixture(scope="module")
def capsule():
    params = AeroParams()
    aero = np.zeros(1, AERO)
    fill(aero[0], params)
    return aero.view(np.recarray)[0], table_of(params)


def pitching_moment(capsule, mach, alpha_deg, deflection, cg=CG, **wing):
    """Cm about the CG of capsule and wing, from the kernels' wrenches by r x F."""
    u, w = cos(radians(alpha_deg)), sin(radians(alpha_deg))
    aero, table = capsule
    v_air, air = (u, 0.0, w), (gas_record(), 1.0, mach, 1e-3)
    body = np.array(capsule_aero(aero, table, air, v_air, (0.0, 0.0, 0.0)))
    plate = np.array(wing_force(wing_record(**wing), deflection, 1.0, v_air))
    moment = body[3:] + np.cross((table.moment_reference_x - cg[0], -cg[1], -cg[2]), body[:3])
    moment = moment + plate[3:] + np.cross((-cg[0], -cg[1], -cg[2]), plate[:3])
    return moment[1] / (AREA * D)


def trim(capsule, mach, deflection, **wing):
    return brentq(lambda a: pitching_moment(capsule, mach, a, deflection, **wing), -14.0, 9.0)


@pytest.mark.parametrize("mach", [1.8, 2.0, 2.4, 2.8, 4.0, 6.0, 8.8, 12.0, 16.0, 18.1, 20.0, 22.4, 25.0])
def test_closed_wing_trims_near_minus_ten_and_is_stable(capsule, mach):
    alpha = trim(capsule, mach, 0.0)
    assert -10.5 <= alpha <= -8.9
    slope = (
        pitching_moment(capsule, mach, alpha + 0.2, 0.0) - pitching_moment(capsule, mach, alpha - 0.2, 0.0)
    ) / 0.4
    assert -0.0035 < slope < -0.0014  # per degree


@pytest.mark.parametrize("mach", [2.0, 2.4, 2.8])
def test_open_wing_trims_near_zero_and_is_stable(capsule, mach):
    alpha = trim(capsule, mach, 1.0)
    assert abs(alpha) < 1.0
    assert pitching_moment(capsule, mach, alpha + 0.2, 1.0) < pitching_moment(capsule, mach, alpha - 0.2, 1.0)
    assert -10.0 < trim(capsule, mach, 0.5) < -1.0  # half open lies between
    assert trim(capsule, mach, 1.0, moment_factor=0.0) == pytest.approx(trim(capsule, mach, 0.0))


def test_cg_on_the_other_side_trims_at_plus_ten(capsule):
    mirrored = (CG[0], 0.0, -CG[2])
    alpha = brentq(lambda a: pitching_moment(capsule, 2.4, a, 0.0, cg=mirrored), -9.0, 14.0)
    assert alpha == pytest.approx(-trim(capsule, 2.4, 0.0), abs=1e-9)


def test_required_increment_of_the_reference(capsule):
    """tianwen1.md 1.4: the wing must supply Cm 0.0165 about the axis at alpha 0; here 0.16 m2 x 1.7 at 0.56
    D.
    """
    plate = wing_force(wing_record(), 1.0, 1.0, (1.0, 0.0, 0.0))
    assert plate[4] / (AREA * D) == pytest.approx(0.0165, abs=4e-4)


def test_force_direction_size_and_moment():
    wing = wing_record(normal_tilt_deg=20.0)
    vel = np.array([300.0, 40.0, -60.0])
    # away from the axis: the wing is on the -z side
    n = np.array([cos(radians(20.0)), 0.0, -sin(radians(20.0))])
    got = np.array(wing_force(wing, 0.6, 500.0, tuple(vel)))
    share = n @ vel / np.linalg.norm(vel)
    force = -0.6 * 500.0 * 0.16 * 1.7 * share**2 * n
    assert got[:3] == pytest.approx(force)
    assert got[3:] == pytest.approx(np.cross((-0.95, 0.0, -1.904), force))


def test_closed_leeward_or_at_rest_it_gives_nothing():
    wing = wing_record()
    for deflection, vel in ((0.0, (300.0, 0.0, 0.0)), (1.0, (-300.0, 10.0, 5.0)), (1.0, (0.0, 0.0, 0.0))):
        assert np.array_equal(wing_force(wing, deflection, 500.0, tuple(vel)), np.zeros(6))


def test_opening_is_monotone_and_takes_the_deploy_time():
    wing = wing_record()
    times = np.linspace(-0.2, 1.0, 61)
    opening = np.array([wing_opening(wing, t) for t in times])
    assert opening[times <= 0.0].max() == 0.0 and opening[times >= 0.7].min() == 1.0
    assert np.all(np.diff(opening) >= 0.0)
    assert wing_opening(wing, 0.35) == pytest.approx(0.5)


def test_opening_is_a_cubic_that_starts_and_stops_at_rest():
    """3 s^2 - 2 s^3: 5/32 after a quarter of the time, 27/32 after three."""
    wing = wing_record()
    assert wing_opening(wing, 0.25 * 0.7) == pytest.approx(5.0 / 32.0, rel=1e-12)
    assert wing_opening(wing, 0.75 * 0.7) == pytest.approx(27.0 / 32.0, rel=1e-12)
