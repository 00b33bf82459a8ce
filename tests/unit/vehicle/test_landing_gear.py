"""Footpads against statics, Coulomb friction, the work they can do and a drop integrated with scipy.

The lander stands on x of B pointing down; heights and motion are worked out in the ground's axes (up, two
along the ground).
"""

from math import exp, pi, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from edl6dof.config.dtype import fill
from edl6dof.vehicle.landing_gear import LANDING_GEAR, LandingGearParams, contact_point, contacts, leg_force
from edl6dof.vehicle.landing_gear import contact as one_contact

MASS, G, STIFFNESS, DAMPING = 780.0, 3.72, 60000.0, 6000.0
PADS = [(0.9, 1.5, 0.0), (0.9, 0.0, 1.5), (0.9, -1.5, 0.0), (0.9, 0.0, -1.5)]
CENTRE, HEIGHT = (0.2, 0.0, 0.0), 0.7
UP = (-1.0, 0.0, 0.0)
REST = (0.0, 0.0, 0.0)


def gear(pads=PADS, **changes):
    record = np.zeros(1, LANDING_GEAR).view(np.recarray)[0]
    fill(record, LandingGearParams(footpads_m=pads, **changes))
    return record


def contact(record, centre, clearance, up, v, w):
    """Of all points, over one plane: force, moment about the origin of B, and how many touch."""
    parts = [
        one_contact(record, contact_point(record, k), centre, (up, clearance), (v, w))
        for k in range(contacts(record))
    ]
    force, moment = (np.sum([part[i] for part in parts], axis=0) if parts else np.zeros(3) for i in (0, 1))
    return force, moment, sum(part[2] for part in parts)


def fly(record, clearance, v_up, v_side, duration):
    """Motion of the upright lander: rows height above first contact, climb rate, distance and speed along the
    ground.
    """

    def motion(t, y):
        force, _, _ = contact(record, CENTRE, HEIGHT + y[0], UP, (-y[1], y[3], 0.0), REST)
        return [y[1], -force[0] / MASS - G, y[3], force[1] / MASS]

    return solve_ivp(
        motion, (0.0, duration), [clearance, v_up, 0.0, v_side], rtol=1e-8, atol=1e-10, max_step=0.01
    )


@pytest.mark.parametrize("pads", [PADS, PADS[:3]], ids=["four legs", "three legs"])
def test_static_sink_depth_is_weight_over_all_springs(pads):
    sink = MASS * G / (len(pads) * STIFFNESS)
    force, _, touching = contact(gear(pads), CENTRE, HEIGHT - sink, UP, REST, REST)
    assert force == pytest.approx((-MASS * G, 0.0, 0.0)) and touching == len(pads)


def test_a_dropped_lander_comes_to_rest_at_the_static_height():
    end = fly(gear(), 0.5, -1.0, 0.0, 5.0).y[:, -1]
    assert end[0] == pytest.approx(-MASS * G / (4 * STIFFNESS), abs=1e-5) and end[1] == pytest.approx(
        0.0, abs=1e-4
    )


def test_without_damping_it_bounces_back_to_its_speed_and_with_damping_it_does_not():
    speeds = {}
    for damping in (0.0, 500.0, 1000.0):
        path = fly(gear(damping_n_s_m=damping), 1e-9, -2.0, 0.0, 0.5)
        speeds[damping] = path.y[1][path.y[0] > -1e-9][1:].max(initial=0.0)  # on leaving the ground
    assert speeds[0.0] == pytest.approx(2.0, abs=0.01 * G)  # steps of 10 ms at most
    assert 0.5 < speeds[1000.0] < speeds[500.0] < 1.7


def test_a_lightly_damped_bounce_keeps_the_energy_of_a_damped_oscillator():
    """Weightless: from touch to lift-off, with the pull-free end, speed ratio close to exp(-z pi / sqrt(1 -
    z^2)).
    """
    record = gear(damping_n_s_m=60.0)
    omega = sqrt(4 * STIFFNESS / MASS)
    ratio = 4 * 60.0 / (2.0 * MASS * omega)

    def motion(t, y):
        return [y[1], -contact(record, CENTRE, HEIGHT + y[0], UP, (-y[1], 0.0, 0.0), REST)[0][0] / MASS]

    path = solve_ivp(motion, (0.0, 0.5), [-1e-12, -1.0], rtol=1e-9, atol=1e-12, max_step=1e-3)
    assert path.y[1, -1] == pytest.approx(exp(-ratio * pi / sqrt(1.0 - ratio**2)), abs=2e-4)


@pytest.mark.parametrize("friction", [pytest.param(0.3, marks=pytest.mark.long), 0.6])
def test_sliding_stops_with_the_deceleration_of_coulomb(friction):
    """From 3 m/s at the static height: speed falls by mu g t while it is far above the smoothing speed, and
    it stops.
    """
    sink = MASS * G / (4 * STIFFNESS)
    path = fly(gear(friction=friction), -sink, 0.0, 3.0, 8.0)
    fast = path.y[3] > 0.8
    assert path.y[3][fast] == pytest.approx(3.0 - friction * G * path.t[fast], abs=0.01)
    assert path.y[2, -1] == pytest.approx(9.0 / (2.0 * friction * G), rel=0.02)
    assert abs(path.y[3, -1]) < 1e-3


def test_friction_pulls_against_the_slip_whatever_its_direction():
    record = gear(friction=0.6)
    for angle in np.linspace(0.0, 6.0, 7):
        slip = np.array([0.0, 2.0 * np.cos(angle), 2.0 * np.sin(angle)])
        force, _, _ = contact(record, CENTRE, HEIGHT - 0.01, UP, tuple(slip), REST)
        assert np.array(force[1:]) == pytest.approx(-0.6 * -force[0] * slip[1:] / 2.0, rel=1e-3)


def test_the_ground_pushes_but_never_pulls():
    record = gear()
    assert leg_force(record, -0.001, -5.0, 1.0) == (0.0, 0.0)
    assert leg_force(record, 0.02, 9.0, 1.0)[0] == 0.0  # rising faster than the spring follows
    for depth, climb in np.random.default_rng(5).uniform((-0.1, -5.0), (0.2, 5.0), size=(500, 2)):
        normal, drag = leg_force(record, depth, climb, 0.7)
        assert normal >= 0.0 and drag <= 0.0


def test_the_gear_never_gives_back_more_than_its_springs_hold():
    """Power on the vehicle (force on velocity, moment on rate) plus growth of the spring energy: never
    positive, any motion.
    """
    record, rng = gear(), np.random.default_rng(6)
    pressed = 0
    for _ in range(300):
        turn = Rotation.from_rotvec(rng.normal(size=3) * 0.2)
        up, v, w = turn.apply(UP), rng.normal(size=3) * 2.0, rng.normal(size=3)
        clearance = HEIGHT + rng.uniform(-0.2, 0.2)
        force, moment, _ = (
            np.array(x) for x in contact(record, CENTRE, clearance, tuple(up), tuple(v), tuple(w))
        )
        arms = np.array(PADS) - CENTRE
        depth = np.maximum(-(clearance + arms @ up), 0.0)
        climb = (v + np.cross(w, arms)) @ up
        power = force @ v + (moment - np.cross(CENTRE, force)) @ w
        pressed += depth.any()
        assert power + np.sum(STIFFNESS * depth * -climb) <= 1e-9
    assert pressed > 200


def test_a_tilted_lander_is_pushed_upright_by_its_lower_leg():
    """Tilted about y so that the +z leg is low: only it touches, and its moment about the centre is arm cross
    force.
    """
    up = Rotation.from_euler("y", 0.2).apply(UP)
    arms = np.array(PADS) - CENTRE
    low = int(np.argmin(arms @ up))
    depth = 0.01
    clearance = -arms[low] @ up - depth
    force, moment, touching = contact(gear(), CENTRE, clearance, tuple(up), REST, REST)
    assert touching == 1 and np.array(force) == pytest.approx(STIFFNESS * depth * up)
    about_centre = np.array(moment) - np.cross(CENTRE, force)
    assert about_centre == pytest.approx(np.cross(arms[low], force), abs=1e-9)
    assert np.cross(about_centre, arms[low]) @ up > 0.0  # the low leg is lifted


def test_underside_is_pushed_where_it_meets_the_ground_and_is_no_footpad():
    record = gear(underside_m=[(0.5, 0.0, 0.0), (0.5, 0.4, 0.0)])
    assert contacts(record) == 6 and contact_point(record, 5) == (0.5, 0.4, 0.0)
    one = one_contact(record, contact_point(record, 5), CENTRE, (UP, 0.28), (REST, REST))
    assert one[2] and np.array(one[0]) == pytest.approx((-STIFFNESS * 0.02, 0.0, 0.0))
    assert np.array(one[1]) == pytest.approx(np.cross((0.5, 0.4, 0.0), one[0]))
    assert not one_contact(record, contact_point(record, 5), CENTRE, (UP, 0.31), (REST, REST))[2]


def test_without_points_nothing_pushes():
    force, moment, touching = contact(gear([]), CENTRE, -5.0, UP, REST, REST)
    assert not force.any() and not moment.any() and touching == 0
