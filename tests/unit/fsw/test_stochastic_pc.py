"""The filter of stochastic_pc equals a Kalman filter with matrices and separates a constant wind from an
error of density; the law keeps the floor of altitude.
"""

from math import cos, degrees, exp, radians, sin

import numpy as np
import pytest
from pyquaternion import Quaternion
from test_fnpeg import as_believed, on_the_way

from edl6dof.fsw.guidance.entry.airframe import believed_aero
from edl6dof.fsw.guidance.entry.energy_plan import ENERGY_PLAN, fly_plan
from edl6dof.fsw.guidance.entry.laws.stochastic_pc import MEMBER, MEMORY, believe, keep_floor, learn
from edl6dof.fsw.navigation.derived import NAV, expected_wind, model_atmosphere

DT = 0.2
SOUTH = radians(180.0)


def attitude(velocity, slip):
    """Attitude with the body axis y level, turned by ``slip`` (rad) from the velocity in air (m/s, N)."""
    right = np.cross([0.0, 0.0, 1.0], velocity)
    right /= np.linalg.norm(right)
    ahead = velocity / np.linalg.norm(velocity)
    x, y = cos(slip) * ahead - sin(slip) * right, cos(slip) * right + sin(slip) * ahead
    return Quaternion(matrix=np.transpose([x, y, np.cross(x, y)])).elements


def descent(record, density, wind, slip=0.0):
    """States of a flight to the south that slows down from 4,500 to 700 m/s, in air of the believed density
    times a factor, with a wind (m/s, north and east) above the expected one; inertial axes are N.
    """
    for k in range(1000):
        t = DT * k
        speed, height, gamma = 700.0 + 3800.0 * exp(-t / 40.0), 14e3 + 26e3 * exp(-t / 35.0), radians(-7.0)
        nav = np.zeros(1, NAV)[0]
        nav["t"], nav["altitude"], nav["speed"], nav["azimuth"] = 100.0 + t, height, speed, SOUTH
        nav["v_N"] = nav["v_rel_I"] = -speed * cos(gamma), 0.0, -speed * sin(gamma)
        nav["north_I"], nav["east_I"], nav["up_I"] = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0)
        rho, sound, _ = model_atmosphere(record["atmosphere"], height)
        nav["mach"] = speed / sound
        north, east = expected_wind(record["atmosphere"], height)
        through = nav["v_N"] - [north + wind[0], east + wind[1], 0.0]
        area, _ = believed_aero(record["vehicle"], nav["mach"], speed)
        nav["drag"] = density * 0.5 * rho * (through @ through) * area / record["vehicle"]["entry_mass"]
        nav["q_I2B"] = attitude(through, slip)
        yield nav


def learned(record, navs):
    memory = np.zeros(1, MEMORY)[0]["air"]
    for nav in navs:
        learn(record["guidance"]["entry"]["stochastic_pc"], record, nav, memory)
    return memory


@pytest.mark.parametrize("wind", [(0.0, 0.0), (40.0, 0.0), (-40.0, 0.0), (0.0, 40.0), (20.0, -30.0)])
@pytest.mark.parametrize("density", [0.9, 1.1])
def test_filter_separates_a_constant_wind_from_an_error_of_density(onboard, density, wind):
    """In air without waves and gusts, and expecting none."""
    record = onboard[0]
    p, air = record["guidance"]["entry"]["stochastic_pc"], record["guidance"]["entry"]["air_data"]
    air["wave_sigma"], air["reading_error"], air["scale_height_error"] = 1e-4, 0.003, 1e-3
    p["wind_sigma"], p["wind_change"] = 60.0, 0.01
    memory = learned(record, descent(record, density, wind))
    level, _, north, east, _ = memory["state"]
    assert level == pytest.approx(density, abs=0.01)
    assert (north, east) == pytest.approx(wind, abs=4.0)


def test_filter_is_a_kalman_filter_with_matrices(onboard):
    """Prediction F P F' + Q and update of the two readings in turn, the drag linearised about the state."""
    record = onboard[0]
    p, air = record["guidance"]["entry"]["stochastic_pc"], record["guidance"]["entry"]["air_data"]
    navs = list(descent(record, 1.05, (20.0, 10.0), radians(0.3)))[:60]
    x = np.array([1.0, 0.0, 0.0, 0.0, 0.0])
    _, _, scale = model_atmosphere(record["atmosphere"], navs[0]["altitude"])
    air_errors = air["drag_error"], air["scale_height_error"] / scale
    P = np.diag([*air_errors, p["wind_sigma"], p["wind_sigma"], p["sideslip"]]) ** 2
    before = navs[0]
    for nav in navs:
        climb, dt = nav["altitude"] - before["altitude"], nav["t"] - before["t"]
        F = np.eye(5)
        F[0, 1] = climb
        waves = 2.0 * air["wave_sigma"] ** 2 / air["wave_length"] * abs(climb)
        walk = p["wind_change"] ** 2 * dt
        x = F @ x
        P = F @ P @ F.T + np.diag([waves, 0.0, walk, walk, p["sideslip_change"] ** 2 * dt])
        north, east = expected_wind(record["atmosphere"], nav["altitude"])
        expected = nav["v_N"] - [north, east, 0.0]
        through = expected - [x[2], x[3], 0.0]
        rho, _, _ = model_atmosphere(record["atmosphere"], nav["altitude"])
        area, _ = believed_aero(record["vehicle"], nav["mach"], nav["speed"])
        square = expected @ expected
        believed = 0.5 * rho * square * area / record["vehicle"]["entry_mass"]
        share = through @ through / square
        h = np.array([share, 0.0, *(-2.0 * x[0] * through[:2] / square), 0.0])
        readings = [(h, air["reading_error"] ** 2, nav["drag"] / believed - share * x[0])]
        if dt > 0.0:
            y = Quaternion(nav["q_I2B"]).rotation_matrix[:, 1]
            h = np.array([0.0, 0.0, y[0], y[1], nav["speed"]])
            readings.append((h, p["gust"] ** 2 * p["gust_time"] / dt, None))
        for h, noise, rest in readings:
            if rest is None:
                rest = y @ nav["v_N"] - y[:2] @ [north, east] - h @ x
            gain = P @ h / (h @ P @ h + noise)
            x, P = x + gain * rest, P - np.outer(gain, h @ P)
        before = nav
    memory = learned(record, navs)
    assert memory["state"] == pytest.approx(x, rel=1e-7, abs=1e-9)
    assert memory["covariance"] == pytest.approx(P, rel=1e-6, abs=1e-9)


def test_sigma_points_have_the_mean_and_the_covariance_with_the_wind_along_the_flight(onboard):
    record = onboard[0]
    memory, nav, out = learned(record, descent(record, 1.0, (0.0, 0.0))), on_the_way(), as_believed()
    nav["azimuth"] = radians(150.0)
    found = []
    for sigmas in (-1.0, 0.0, 1.0):
        believe(nav, memory, sigmas, out)
        found.append(np.array([out["drag_ratio"], out["drag_trend"], *out["wind_shift_N"]]))
    low, mean, high = found
    P, along = memory["covariance"][:4, :4], np.array([0.0, 0.0, cos(radians(150.0)), sin(radians(150.0))])
    assert mean == pytest.approx(memory["state"][:4])
    assert 0.5 * (low + high) == pytest.approx(mean)
    assert 0.5 * (high - low) == pytest.approx(P @ along / np.sqrt(along @ P @ along))


@pytest.mark.parametrize("floor", [-20e3, 60e3])
def test_last_bank_angle_is_lowered_below_the_floor_while_a_head_wind_leaves_range(onboard, floor):
    """Aim points in reach of any wind, and out of reach of a head wind."""
    record, nav, out = onboard[0], on_the_way(), as_believed()
    p = record["guidance"]["entry"]["stochastic_pc"]
    p["floor"] = floor
    for nearer, kept in ((2.0, floor > 0.0), (-4.0, False)):  # deg of latitude
        record["site"]["aim_latitude"] += radians(nearer)
        memory = np.zeros(1, MEMORY)[0]
        nav["azimuth"] = SOUTH
        learn(p, record, nav, memory["air"])
        memory["plan"]["side"], memory["plan"]["bank"] = 1.0, radians(50.0)
        for _ in range(40):
            keep_floor(p, record, nav, memory, out)
        lowest = max(degrees(p["last_bank"] - p["floor_bank"]), 0.0)
        assert degrees(memory["plan"]["lowered"]) == pytest.approx(lowest if kept else 0.0)
        record["site"]["aim_latitude"] -= radians(nearer)


def test_law_flies_the_plan_of_fnpeg_in_its_own_air(onboard):
    """Without a floor."""
    record, out, other = onboard[0], as_believed(), as_believed()
    p = record["guidance"]["entry"]["stochastic_pc"]
    memory, plan = np.zeros(1, MEMORY)[0], np.zeros(1, ENERGY_PLAN)[0]
    for k in range(4):
        nav = on_the_way()
        nav["t"], nav["drag"], nav["azimuth"] = DT * k, 0.6 + 0.1 * k, SOUTH
        nav["q_I2B"], nav["north_I"], nav["east_I"] = (1.0, 0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
        nav["v_rel_I"] = nav["v_N"]
        bank = MEMBER.kernels["guide"](p, record["plan"]["stochastic_pc"], record, nav, memory, out)
        x = memory["air"]["state"]
        other["drag_ratio"], other["drag_trend"], other["wind_shift_N"] = x[0], x[1], x[2:4]
        assert bank == pytest.approx(fly_plan(p, record, nav, plan, other), abs=1e-12)
    assert abs(x[0] - 1.0) > 1e-3 and plan["started"]
