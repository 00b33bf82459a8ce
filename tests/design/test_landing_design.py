"""Verifies: the conic landing on the classic Mars case (Acikmese & Ploen 2007), by its figures, by flying it
in the true equations of motion, and by what optimal control says of it.

gravity 3.7114 m/s2 | 1905 kg | Isp 225 s | 6 x 3.1 kN, canted by 27 deg, 30 to 80 % | source [M]: 399.6 kg at
78 s with a glide slope of 4 deg, 391.7 kg at 75 s that only keeps above the ground
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from edl6dof.design.landing.problem import classic_mars, held_controls, interpolated_controls

pytest.importorskip("clarabel")
from edl6dof.design.landing.conic import best_time, solve


@pytest.mark.parametrize(("slope_deg", "fuel", "time"), [(4.0, 399.6, 78.0), (0.0, 391.7, 75.0)])
def test_classic_case_takes_the_fuel_and_the_time_that_others_find(slope_deg, fuel, time):
    found = best_time(classic_mars(slope_deg), lambda t: interpolated_controls(t, 50), 70.0, 85.0)
    assert found.fuel == pytest.approx(fuel, rel=4e-3)
    assert found.time == pytest.approx(time, abs=0.8)


@pytest.mark.parametrize("slope_deg", [None, 4.0])
def test_relaxation_loses_nothing_and_thrust_switches_twice(slope_deg):
    landing = classic_mars(slope_deg)
    found = solve(landing, interpolated_controls(78.0, 50))
    size = np.linalg.norm(found.acceleration, axis=1)
    assert size == pytest.approx(found.bound, rel=1e-5)
    thrust, (low, high) = size * found.mass, landing.thrust
    assert np.all((thrust > 0.999 * low) & (thrust < 1.001 * high))
    level = [1 if t > 0.99 * high else -1 if t < 1.01 * low else 0 for t in thrust]
    assert level.count(0) <= 3
    assert [a for a, b in zip(level, [0, *level], strict=False) if a not in (b, 0)] == [1, -1, 1]


def test_it_lands_when_its_thrust_is_flown_in_the_true_equations():
    landing, count, time = classic_mars(4.0), 30, 78.0
    found = solve(landing, held_controls(time, count))
    step = time / count

    def motion(t, y):
        u = found.acceleration[min(int(t / step), count - 1)]
        down = np.array([0.0, 0.0, -landing.gravity])
        return [*y[3:6], *(u + down), -y[6] * np.linalg.norm(u) / landing.exhaust_speed]

    state = np.array([*landing.position, *landing.velocity, landing.mass])
    for k in range(count):
        state = solve_ivp(motion, (k * step + 1e-9, (k + 1) * step - 1e-9), state, rtol=1e-10).y[:, -1]
    assert state[:3] == pytest.approx(np.zeros(3), abs=1e-3)
    assert state[3:6] == pytest.approx(np.zeros(3), abs=1e-4)
    assert landing.mass - state[6] == pytest.approx(found.fuel, rel=1e-6)


def test_no_landing_is_found_where_there_is_none():
    assert solve(classic_mars(4.0), held_controls(50.0, 30)) is None
    short = solve(classic_mars(4.0), held_controls(62.0, 30), miss_weight=1.0)
    assert short is None or short.miss > 1.0
