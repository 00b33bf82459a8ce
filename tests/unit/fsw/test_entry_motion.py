"""The flight computer's equations of motion against independent ones: inertial axes, geodetic heights, and
the wind at the place, integrated by scipy's DOP853.
"""

from math import cos, exp, pi, radians, sin, sqrt

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from edl6dof.fsw.guidance.entry.predictor import AS_BELIEVED, acceleration, roll, step

RATIOS = (1.1, 0.9, 0.0, 0.0)
BANK = radians(-50.0)


def state(latitude_deg, longitude_deg, height, speed, gamma_deg, azimuth_deg, radius):
    """Position and planet-relative velocity in F above a sphere of ``radius``."""
    lat, lon, gamma, psi = (radians(x) for x in (latitude_deg, longitude_deg, gamma_deg, azimuth_deg))
    up = np.array([cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)])
    north = np.array([-sin(lat) * cos(lon), -sin(lat) * sin(lon), cos(lat)])
    east = np.array([-sin(lon), cos(lon), 0.0])
    v = speed * (cos(gamma) * (cos(psi) * north + sin(psi) * east) + sin(gamma) * up)
    return (radius + height) * up, v


def fly_inertial(record, r, v, seconds):
    """End position and planet-relative velocity in F, by Newton's law in inertial axes.

    The figure is the ellipsoid of the record, its height taken along the radius.
    """
    planet, air, vehicle = record["planet"], record["atmosphere"], record["vehicle"]
    w = np.array([0.0, 0.0, float(planet["rotation_rate"])])
    nodes = air["bottom"] + air["spacing"] * np.arange(len(air["ln_density"]))
    polar = planet["equatorial_radius"] * (1.0 - planet["flattening"])

    def rates(t, s):
        r, v = s[:3], s[3:]
        size = np.linalg.norm(r)
        up = r / size
        surface = 1.0 / sqrt(
            (up[0] ** 2 + up[1] ** 2) / planet["equatorial_radius"] ** 2 + up[2] ** 2 / polar**2
        )
        h = size - surface
        east = np.cross([0.0, 0.0, 1.0], up)
        east /= np.linalg.norm(east)
        north = np.cross(up, east)
        wind = np.interp(h, nodes, air["wind_north"]) * north + np.interp(h, nodes, air["wind_east"]) * east
        relative = v - np.cross(w, r) - wind
        x = relative / np.linalg.norm(relative)
        lift_up = up - (up @ x) * x
        lift_up /= np.linalg.norm(lift_up)
        lift_right = np.cross(x, lift_up)
        density = exp(np.interp(h, nodes, air["ln_density"]))
        drag = (
            RATIOS[0] * 0.5 * density * (relative @ relative) * vehicle["drag_area"] / vehicle["entry_mass"]
        )
        lift = RATIOS[1] * vehicle["lift_to_drag"] * drag

        def potential(p):
            d, z = np.linalg.norm(p), p[2]
            oblate = planet["j2"] * (planet["gravity_radius"] / d) ** 2 * (1.5 * (z / d) ** 2 - 0.5)
            return planet["mu"] / d * (1.0 - oblate)

        nudge = 10.0 * np.eye(3)
        gravity = np.array([(potential(r + d) - potential(r - d)) / 20.0 for d in nudge])
        air_force = lift * (cos(BANK) * lift_up + sin(BANK) * lift_right) - drag * x
        return np.concatenate([v, air_force + gravity])

    start = np.concatenate([r, v + np.cross(w, r)])
    end = solve_ivp(rates, (0.0, seconds), start, method="DOP853", rtol=1e-11, atol=1e-6, max_step=1.0).y[
        :, -1
    ]
    angle = -w[2] * seconds
    back = np.array([[cos(angle), -sin(angle), 0.0], [sin(angle), cos(angle), 0.0], [0.0, 0.0, 1.0]])
    return back @ end[:3], back @ (end[3:] - np.cross(w, end[:3]))


def fly(record, r, v, seconds, dt):
    r, v = tuple(r), tuple(v)
    for _ in range(round(seconds / dt)):
        a, _, _ = acceleration(record, RATIOS, r, v, (cos(BANK), sin(BANK)))
        r, v = step(record, RATIOS, r, v, a, (cos(BANK), sin(BANK)), dt)
    return np.array(r), np.array(v)


@pytest.fixture
def windy(onboard):
    """One airframe for all Mach numbers; a wind that turns with height; air whose logarithm is smooth, as its
    table's corners would limit the order.
    """
    record = onboard[0]
    for name in ("drag", "lift", "drag_with_wing"):
        record["vehicle"]["airframe"][name] = 1.0
    record["vehicle"]["airframe"]["wing_mach"] = 0.0
    air = record["atmosphere"]
    nodes = air["bottom"] + air["spacing"] * np.arange(len(air["ln_density"]))
    air["ln_density"] = np.log(0.0158) - nodes / 9354.0
    air["wind_north"], air["wind_east"] = 40.0 + 5e-4 * nodes, 70.0 - 8e-4 * nodes
    return record


STARTS = [(24.0, 110.0, 60e3, 4700.0, -9.0, 181.0), (-4.5, 137.0, 25e3, 2500.0, -8.0, 93.0)]


@pytest.mark.parametrize(
    "start", [STARTS[0], *(pytest.param(other, marks=pytest.mark.long) for other in STARTS[1:])]
)
def test_motion_is_newtons_law_in_inertial_axes(windy, start):
    """Lift left or right, Coriolis and centrifugal force, J2 and wind, for 60 s."""
    r, v = state(*start, windy["planet"]["equatorial_radius"])
    expected_r, expected_v = fly_inertial(windy, r, v, 60.0)
    found_r, found_v = fly(windy, r, v, 60.0, 0.1)
    assert np.linalg.norm(found_r - expected_r) < 0.2
    assert np.linalg.norm(found_v - expected_v) < 0.01


def test_steps_are_of_fourth_order(windy):
    r, v = state(*STARTS[0], windy["planet"]["equatorial_radius"])
    exact, _ = fly(windy, r, v, 64.0, 0.0625)
    errors = [np.linalg.norm(fly(windy, r, v, 64.0, dt)[0] - exact) for dt in (4.0, 2.0, 1.0)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all((orders > 3.5) & (orders < 4.7)), (errors, orders)


def test_air_that_moves_with_the_vehicle_makes_no_drag(windy):
    """A wind of the vehicle's own velocity, level flight due east: gravity and rotation alone are left."""
    air = windy["atmosphere"]
    r, v = state(10.0, 30.0, 20e3, 300.0, 0.0, 90.0, windy["planet"]["equatorial_radius"])
    air["wind_north"], air["wind_east"] = 0.0, 300.0
    _, drag, _ = acceleration(windy, AS_BELIEVED, tuple(r), tuple(v), (1.0, 0.0))
    assert drag < 1e-9
    air["wind_east"] = 0.0
    _, still, _ = acceleration(windy, AS_BELIEVED, tuple(r), tuple(v), (1.0, 0.0))
    air["wind_east"] = -300.0
    _, against, _ = acceleration(windy, AS_BELIEVED, tuple(r), tuple(v), (1.0, 0.0))
    assert against == pytest.approx(4.0 * still, rel=1e-12)


@pytest.mark.parametrize("dt", [0.05, 1.0, 4.0, 12.0])
@pytest.mark.parametrize("bank, goal", [(60.0, -75.0), (-20.0, -110.0), (45.0, 45.0), (30.0, 30.001)])
def test_roll_is_the_mean_lift_of_a_ramp_of_bank(bank, goal, dt):
    rate = radians(20.0)
    bank, goal = radians(bank), radians(goal)

    def at(t):
        return bank + np.clip(goal - bank, -rate * t, rate * t)

    after, up, right = roll(bank, goal, rate, dt)
    done = min(abs(goal - bank) / rate, dt)
    mean = [
        (quad(lambda t, f=f: f(at(t)), 0.0, done)[0] + (dt - done) * f(at(dt))) / dt for f in (np.cos, np.sin)
    ]
    assert after == pytest.approx(at(dt), abs=1e-12)
    assert (up, right) == pytest.approx(tuple(mean), abs=1e-9)
    assert up * up + right * right <= 1.0 + 1e-12


def test_reversal_passes_lift_up():
    """From 75 deg right to 75 deg left in one step: the mean lift points up, and no side is left over."""
    _, up, right = roll(radians(75.0), radians(-75.0), radians(20.0), 7.5)
    assert up == pytest.approx(sin(radians(75.0)) / radians(75.0), rel=1e-12)
    assert abs(right) < 1e-12
    assert 0.0 < up < pi
