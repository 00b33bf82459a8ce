"""Main engine against the exponential of a first-order lag, straight ramps, scipy rotations and the rocket
equation.
"""

from math import exp, log, radians

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from edl6dof.config.dtype import fill
from edl6dof.vehicle.engine import ENGINE, EngineParams, propellant_flow, thrust_rate, thrust_wrench

G0 = 9.80665
BAND = {"full_thrust_n": 7500.0, "throttle_min_n": 1500.0, "throttle_max_n": 5000.0}


def engine(**changes):
    record = np.zeros(1, ENGINE).view(np.recarray)[0]
    fill(record, EngineParams(**{"name": "main", **BAND, **changes}))
    return record


def response(record, start, command, times, starting=False):
    solution = solve_ivp(
        lambda t, y: [thrust_rate(record, y[0], command, starting)],
        (0.0, times[-1]),
        [start],
        t_eval=times,
        rtol=1e-9,
        max_step=0.01,
    )
    return solution.y[0]


@pytest.mark.parametrize("start, command", [(3000.0, 3150.0), (3150.0, 3000.0)])
def test_a_small_throttle_step_settles_as_an_exponential(start, command):
    times = np.linspace(0.0, 1.0, 21)
    got = response(engine(lag_s=0.15, rate_n_s=1500.0), start, command, times)
    assert got == pytest.approx([command + (start - command) * exp(-t / 0.15) for t in times], rel=1e-7)


@pytest.mark.parametrize("starting, limit", [(False, 1500.0), (True, 25000.0)])
def test_a_large_step_runs_at_the_rate_limit_until_the_lag_takes_over(starting, limit):
    """Ramp to where the lag asks for less than the limit, lag * limit short of the goal, then exponential."""
    goal, lag = 7500.0, 0.15
    ramp = (goal - lag * limit) / limit
    times = np.linspace(0.0, ramp + 0.6, 60)
    expected = [limit * t if t < ramp else goal - lag * limit * exp(-(t - ramp) / lag) for t in times]
    assert response(engine(), 0.0, goal, times, starting) == pytest.approx(expected, abs=0.05)


def test_cut_off_falls_as_fast_as_ignition_rises():
    record = engine()
    assert thrust_rate(record, 7500.0, 0.0, True) == -25000.0 == -thrust_rate(record, 0.0, 7500.0, True)
    assert thrust_rate(record, 2000.0, 2000.0, False) == 0.0


@pytest.mark.parametrize("ty, tz", [(0.0, 0.0), (1.0, 0.0), (0.0, -1.0), (2.5, -4.0)])
def test_thrust_is_minus_x_turned_about_y_and_then_about_z(ty, tz):
    nozzle = (-0.2, 0.03, -0.01)
    force, moment = thrust_wrench(
        engine(misalignment_y_deg=ty, misalignment_z_deg=tz, nozzle_m=nozzle, thrust_factor=0.97), 5000.0
    )
    # extrinsic: fixed axes of B
    expected = Rotation.from_euler("yz", (radians(ty), radians(tz))).apply((-0.97 * 5000.0, 0.0, 0.0))
    assert force == pytest.approx(expected, abs=1e-9)
    assert moment == pytest.approx(np.cross(nozzle, expected), abs=1e-9)


def test_an_aligned_engine_on_the_axis_makes_no_moment():
    force, moment = thrust_wrench(engine(nozzle_m=(-0.1, 0.0, 0.0)), 7500.0)
    assert force == pytest.approx((-7500.0, 0.0, 0.0)) and moment == pytest.approx((0.0, 0.0, 0.0))


def test_specific_impulse_runs_linearly_over_the_band_and_stays_level_outside():
    record = engine(full_specific_impulse_s=310.0, low_specific_impulse_s=280.0)
    thrusts = (700.0, 1500.0, 3000.0, 4500.0, 7500.0, 8000.0)
    got = [thrust / (propellant_flow(record, thrust) * G0) for thrust in thrusts]
    assert got == pytest.approx([280.0, 280.0, 287.5, 295.0, 310.0, 310.0])


@pytest.mark.parametrize("thrust", [0.0, -1.0])
def test_no_thrust_no_flow(thrust):
    assert propellant_flow(engine(), thrust) == 0.0


def test_an_engine_of_one_level_has_the_full_specific_impulse():
    record = engine(full_thrust_n=3000.0, throttle_min_n=3000.0, throttle_max_n=3000.0)
    assert 3000.0 / (propellant_flow(record, 3000.0) * G0) == pytest.approx(300.0)


def test_a_burn_in_free_space_obeys_the_rocket_equation():
    """Off-nominal thrust and specific impulse too: dv = 0.95 Isp g0 ln(m0/m1), whatever the thrust factor."""
    record = engine(thrust_factor=1.04, specific_impulse_factor=0.95)
    flow = propellant_flow(record, 7500.0)
    force = -thrust_wrench(record, 7500.0)[0][0]
    burn = solve_ivp(lambda t, y: [force / y[1], -flow], (0.0, 40.0), [0.0, 900.0], rtol=1e-11)
    speed, mass = burn.y[:, -1]
    assert speed == pytest.approx(0.95 * 300.0 * G0 * log(900.0 / mass), rel=1e-9)
