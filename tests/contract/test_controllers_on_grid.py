"""One contract for what every attitude controller does on a grid of states: finite, bounded, repeatable."""

from itertools import product
from math import pi, radians

import numpy as np
import pytest
from onboard_states import ENTRY, LANDER, X, Y, Z, guided, nav_state
from pyquaternion import Quaternion

from edl6dof.fsw.allocation.registry import DEMAND, compose_demand
from edl6dof.fsw.control.registry import CONTROL_INPUTS, CONTROLLERS, attitude_control
from edl6dof.fsw.vehicle_state import VEHICLE_STATE


def demand_of(index, onboard, nav, goal, configuration, cycles=3):
    """Torque and attitude error of a controller, and the force that guidance demands with it."""
    inputs, memory = np.zeros(1, CONTROL_INPUTS)[0], np.zeros(1, CONTROLLERS.memory)[0]
    inputs["inertia"] = onboard[0]["vehicle"]["configuration"][configuration]["inertia"]
    inputs["phase_time"], inputs["bandwidth"], inputs["disturbance_pole"] = 100.0, 1.0, 8.0
    for _ in range(cycles):
        torque, error = attitude_control(index, onboard[0]["control"], nav, goal, inputs, 0.04, memory)
    phase, demand = onboard[0]["mission"]["phases"][0], np.zeros(1, DEMAND)[0]
    compose_demand(
        phase,
        onboard[0]["vehicle"],
        np.zeros((32, 6)),
        np.zeros(1, VEHICLE_STATE)[0],
        np.ones(32, "i8"),
        nav,
        goal,
        torque,
        error,
        demand,
    )
    return np.array(demand["wrench"]), np.array(error)


@pytest.mark.parametrize("index", range(len(CONTROLLERS.members)), ids=CONTROLLERS.names)
def test_controller_demands_are_finite_bounded_and_repeatable_on_the_whole_grid(shared_onboard, grid, index):
    """Bound: 20 rad/s2 on the believed inertia, far above what any thruster set can do, far below nonsense.

    Below 50 m/s a large force turns the path itself at tens of rad/s, and the laws that follow the path ask
    for five times that.
    """
    for nav, configuration in product(grid, (ENTRY, LANDER)):
        for guide in (guided(), guided(-2.5, (0.3, -0.2, -0.93), 1)):
            demand, error = demand_of(index, shared_onboard, nav, guide, configuration)
            inertia = shared_onboard[0]["vehicle"]["configuration"][configuration]["inertia"]
            assert np.all(np.isfinite(demand)) and np.all(np.isfinite(error))
            assert np.all(np.abs(demand[3:]) < (20.0 if nav["speed"] > 50.0 else 100.0) * inertia)
            assert np.all(np.abs(demand[:3]) <= 500.0)
            assert np.all(np.abs(error) <= pi + radians(10.0) + 1e-9)  # the error of alpha is not wrapped
            again, _ = demand_of(index, shared_onboard, nav, guide, configuration)
            assert np.array_equal(demand, again)


@pytest.mark.parametrize("index", range(len(CONTROLLERS.members)), ids=CONTROLLERS.names)
def test_controller_on_its_goal_and_at_rest_demands_next_to_nothing(shared_onboard, index):
    """Entry members at the commanded attitude turning with the path; lander members upright with y south."""
    site = shared_onboard[0]["site"]
    guide = guided(bank=0.6)
    path = (
        Quaternion(axis=Z, radians=3.0) * Quaternion(axis=Y, radians=-0.2) * Quaternion(axis=X, radians=0.6)
    )
    velocity = 3000.0 * (Quaternion(axis=Z, radians=3.0) * Quaternion(axis=Y, radians=-0.2)).rotate(X)
    body = path * Quaternion(axis=Y, radians=radians(-10.0))
    name = CONTROLLERS.names[index]
    if name in ("phase_plane", "bank_to_steer", "off"):
        nav = nav_state(shared_onboard, site["latitude"], site["longitude"], 40e3, velocity, body)
        # free fall: the path turns by gravity alone
        down = body.inverse.rotate(Z) * nav["gravity"]
        v = body.inverse.rotate(velocity)
        nav["w_B"] = np.cross(v, down) / (v @ v)
        demand, error = demand_of(index, shared_onboard, nav, guide, ENTRY)
    else:
        upright = Quaternion(matrix=np.column_stack([Z, -X, np.cross(Z, -X)]))
        nav = nav_state(
            shared_onboard, site["latitude"], site["longitude"], -4000.0, (0.0, 0.0, 1.0), upright
        )
        demand, error = demand_of(index, shared_onboard, nav, guide, LANDER)
    assert np.abs(demand) == pytest.approx(np.zeros(6), abs=0.5)
    assert np.abs(error) == pytest.approx(np.zeros(3), abs=1e-6)


@pytest.mark.parametrize("name", ["phase_plane", "thrust_vector"])
def test_controller_pushes_towards_its_goal_on_each_axis(shared_onboard, name):
    """A rotation away from the goal about one body axis is answered by a torque against it."""
    site = shared_onboard[0]["site"]
    index = CONTROLLERS.names.index(name)
    for axis, sign in product(range(3), (1.0, -1.0)):
        off = Quaternion(axis=np.eye(3)[axis], degrees=sign * 8.0)
        if name == "phase_plane":
            velocity = 4000.0 * Quaternion(axis=Y, radians=-0.2).rotate(X)
            goal = (
                Quaternion(axis=Y, radians=-0.2)
                * Quaternion(axis=X, radians=0.6)
                * Quaternion(axis=Y, radians=radians(-10.0))
            )
            nav = nav_state(shared_onboard, site["latitude"], site["longitude"], 110e3, velocity, goal * off)
            demand, error = demand_of(index, shared_onboard, nav, guided(0.6), ENTRY, 1)
        else:
            goal = Quaternion(matrix=np.column_stack([Z, -X, np.cross(Z, -X)]))
            nav = nav_state(
                shared_onboard, site["latitude"], site["longitude"], -3000.0, (0.0, 0.0, 20.0), goal * off
            )
            demand, error = demand_of(index, shared_onboard, nav, guided(), LANDER, 1)
        assert sign * demand[3 + axis] < -10.0
        assert error[axis] == pytest.approx(-sign * radians(8.0), abs=1e-3)
        others = [i for i in range(3) if i != axis]
        assert np.all(np.abs(demand[3:][others]) < 0.3 * abs(demand[3 + axis]))


@pytest.mark.parametrize("index", range(len(CONTROLLERS.names)), ids=CONTROLLERS.names)
def test_controller_of_a_vehicle_exactly_at_rest_is_finite(shared_onboard, whole_grid, index):
    resting = [nav for nav in whole_grid if nav["speed"] == 0.0]
    assert resting
    for nav in resting:
        demand, error = demand_of(index, shared_onboard, nav, guided(), LANDER)
        assert np.all(np.isfinite(demand)) and np.all(np.isfinite(error))
