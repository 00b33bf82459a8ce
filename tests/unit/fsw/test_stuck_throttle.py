"""A throttle that stands: when it is believed, and where its thrust stops a lander, against scipy."""

from math import hypot

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.estimation.engine_thrust import STUCK_THROTTLE, StuckThrottleParams, stuck_throttle
from edl6dof.fsw.guidance.powered.stopping import (
    LEAST_DESCENT,
    StuckThrottleDescentParams,
    expect_stop,
    stop_height,
)
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.fsw.vehicle_state import VEHICLE_STATE

DT, FULL, WEIGHT = 0.04, 7500.0, 4500.0


def believed(commanded, measured, noise=0.0, seed=1):
    """Thrust believed to be held after each control cycle, N."""
    params, memory = np.zeros(1, dtype_of(StuckThrottleParams))[0], np.zeros(1, STUCK_THROTTLE)[0]
    fill(params, StuckThrottleParams())
    rng = np.random.default_rng(seed)
    return np.array(
        [
            stuck_throttle(params, c, m + noise * rng.standard_normal(), FULL, WEIGHT, DT, memory)
            for c, m in zip(commanded, measured, strict=True)
        ]
    )


def followed(commanded, share=1.0, more=0.0, rate=1500.0):
    """Thrust of an engine that follows its command with a limited rate (N/s), and what shows beside it."""
    thrust = [share * commanded[0]]
    for c in commanded:
        thrust.append(thrust[-1] + np.clip(share * c - thrust[-1], -rate * DT, rate * DT))
    return np.array(thrust[1:]) + more


#: Full level for 3 s, into the band at once, down slowly, up again, and to and fro.
MOVING = np.concatenate(
    [np.full(75, 7500.0), np.linspace(4800.0, 3400.0, 300), np.full(50, 5000.0), np.full(50, 3000.0)]
)


@pytest.mark.parametrize(
    ("share", "more"), [(1.0, 0.0), (0.97, 400.0), (0.7, 0.0), (1.0, 500.0), (1.03, -200.0)]
)
def test_engine_that_follows_is_never_believed_to_stand(share, more):
    """Also a weak one, in drag, or beside a thruster that is stuck on."""
    assert not believed(MOVING, followed(MOVING, share, more), noise=60.0).any()


def test_throttle_that_stands_is_believed_once_its_command_has_fallen():
    commanded = np.concatenate([np.full(50, 4500.0), np.linspace(4500.0, 3000.0, 500)])
    found = believed(commanded, np.full(550, 4500.0), noise=60.0)
    assert found[-1] == pytest.approx(4500.0, rel=0.02)
    assert 0.15 < 1.0 - commanded[np.argmax(found > 0.0)] / 4500.0 < 0.3


def test_thrust_that_is_lost_and_made_up_for_by_the_command_does_not_stand():
    commanded = np.concatenate([np.full(100, 3350.0), np.linspace(3350.0, 4190.0, 50), np.full(100, 4190.0)])
    measured = np.concatenate([np.full(100, 3350.0), 0.8 * commanded[100:]])
    assert not believed(commanded, measured, noise=60.0).any()


def test_jolt_while_the_throttle_stands_does_not_hide_it():
    commanded = np.concatenate([np.full(100, 4300.0), np.full(100, 3400.0)])
    measured = np.full(200, 4300.0)
    measured[105:112] += 1500.0
    assert believed(commanded, measured, noise=60.0)[-1] == pytest.approx(4300.0, rel=0.02)


@pytest.mark.parametrize("falls_s", [3.0, 0.5])
@pytest.mark.parametrize("stands", [7000.0, 5190.0, 4000.0])
def test_throttle_that_stops_on_its_way_down_is_believed_to_stand(stands, falls_s):
    """It has followed more of the whole fall than a weak engine has to; of the rest it follows nothing, also
    where nothing is left because the command was down before it stopped.
    """
    full, falls = np.full(75, 7500.0), np.linspace(5000.0, 1500.0, int(falls_s / DT))
    commanded = np.concatenate([full, falls, np.full(150, 1500.0)])
    found = believed(commanded, np.maximum(followed(commanded), stands), noise=60.0)
    assert found[-1] == pytest.approx(stands, rel=0.02)


def test_drag_and_all_axial_thrusters_beside_the_lowest_thrust_are_no_throttle_that_stands():
    commanded = np.concatenate([np.full(75, 7500.0), np.full(200, 1500.0)])
    assert not believed(commanded, followed(commanded, more=1500.0), noise=60.0).any()


def test_canopy_that_brakes_beside_the_full_level_is_no_throttle_that_stands():
    """Rockets that cannot be throttled burn below their parachute."""
    assert not believed(np.full(200, FULL), np.full(200, FULL + WEIGHT), noise=60.0).any()


def test_weak_engine_whose_command_rises_once_it_rests_and_falls_again_does_not_stand():
    """Its thrust is noted with the command at which it came to rest, not with the one that rose since."""
    full, low, falls = np.full(75, 9100.0), np.full(100, 5100.0), np.linspace(6300.0, 5200.0, 60)
    for cycles in range(35, 65, 2):
        rests, rises = np.full(cycles, 6300.0), np.full(40, 9100.0)
        commanded = np.concatenate([full, rests, rises, falls, low])
        assert not believed(commanded, followed(commanded, 0.66), noise=60.0).any()


def test_full_level_that_stays_is_believed_within_two_seconds_and_kept_while_the_engine_is_off():
    commanded = np.concatenate([np.full(75, 7500.0), np.full(50, 5000.0), np.zeros(100)])
    found = believed(commanded, np.where(commanded > 0.0, 7500.0, 0.0), noise=100.0)
    assert not found[:75].any() and found[124] == pytest.approx(7500.0, rel=0.02)
    assert (found[125:] == found[124]).all()


@pytest.mark.parametrize(
    ("thrust", "height", "sideways", "descent"),
    [(4500.0, 300.0, 8.0, 25.0), (7500.0, 900.0, 15.0, 75.0), (3600.0, 40.0, 1.0, 3.0)],
)
def test_stop_of_a_gravity_turn_is_that_of_scipy(thrust, height, sideways, descent):
    gravity, mass, flow, stop, tilt = 3.72, 900.0, thrust / 2942.0, 1.0, 0.5

    def rates(t, y):
        upward = max(y[2], LEAST_DESCENT)
        lean = min(y[1], np.tan(tilt) * upward)
        a = thrust / (mass - flow * t) / hypot(lean, upward)
        return [-y[2], -a * lean, gravity - a * upward]

    def stopped(t, y):
        return y[2] - stop

    stopped.terminal = True
    flown = solve_ivp(rates, (0.0, 200.0), [height, sideways, descent], events=stopped, rtol=1e-9, atol=1e-9)
    found = stop_height(tilt, stop, thrust, flow, mass, gravity, height, sideways, descent)
    assert found == pytest.approx(flown.y[0, -1], abs=0.01 * (height - flown.y[0, -1]))


def test_the_stop_depends_on_the_horizontal_speed_and_not_on_its_direction(shared_onboard):
    params, state = np.zeros(1, dtype_of(StuckThrottleDescentParams))[0], np.zeros(1, VEHICLE_STATE)[0]
    fill(params, StuckThrottleDescentParams())
    state["ignited"], state["mass"], state["held_thrust"] = 1, 900.0, 5000.0

    def stop(north, east):
        nav = np.zeros(1, NAV)[0]
        nav["t"], nav["gravity"], nav["height"], nav["v_N"] = 100.0, 3.71, 500.0, (north, east, 30.0)
        return expect_stop(params, shared_onboard[0]["vehicle"], state, nav)

    assert stop(12.0, 0.0) == pytest.approx(stop(0.0, 12.0), abs=1e-9)
    assert stop(12.0, 0.0) == pytest.approx(stop(7.2, -9.6), abs=1e-9)
    assert abs(stop(12.0, 0.0) - stop(0.0, 0.0)) > 1.0


def test_thrust_below_the_weight_stops_nothing():
    assert stop_height(0.5, 1.0, 3000.0, 1.0, 900.0, 3.72, 100.0, 0.0, 5.0) < -900.0
