"""The thrusters of Tianwen-1: the torque they can give in any direction, also with one failed, against linear
programming, and what is published of their layout.
"""

from itertools import combinations, product

import numpy as np
import pytest
from scipy.optimize import linprog
from thruster_wrenches import ENTRY, LANDER, UNDER_CHUTE, wrenches

from edl6dof.interface.effectors import THRUSTER_GROUPS

CENTRES = {"entry": ENTRY, "under_chute": UNDER_CHUTE, "lander": LANDER}


def torques(onboard, configuration, failed=None, groups=THRUSTER_GROUPS):
    vehicle = onboard[0]["vehicle"]
    count = vehicle["n_thrusters"]
    columns = wrenches(vehicle["thrusters"], count, vehicle["configuration"][configuration]["centre"])[3:]
    chosen = [THRUSTER_GROUPS[g] in groups for g in vehicle["thrusters"]["group"][:count]]
    return columns[:, [i for i in range(count) if chosen[i] and i != failed]]


def authority_along(columns, direction):
    """Largest s with T u = s d, 0 <= u <= 1, by linear programming; zero when the direction cannot be
    produced.
    """
    count = columns.shape[1]
    answer = linprog(
        [*np.zeros(count), -1.0],
        A_eq=np.column_stack([columns, -np.asarray(direction)]),
        b_eq=np.zeros(3),
        bounds=[(0.0, 1.0)] * count + [(0.0, None)],
        method="highs",
    )
    assert answer.status == 0
    return -answer.fun


def inscribed_radius(columns):
    """Radius of the largest ball about zero inside {T u, 0 <= u <= 1}: least support over the facet normals
    of the zonotope.

    The facets of a zonotope are spanned by pairs of its generators, so this is exact over all directions.
    """
    i, j = zip(*combinations(range(columns.shape[1]), 2), strict=True)
    normals = np.cross(columns[:, i].T, columns[:, j].T)
    length = np.linalg.norm(normals, axis=1)
    normals = normals[length > 1e-6] / length[length > 1e-6, None]
    if len(normals) == 0:
        return 0.0
    both = np.vstack([normals, -normals])
    return float(np.min(np.sum(np.maximum(both @ columns, 0.0), axis=1)))


def directions():
    d = np.array([v for v in product((-1, 0, 1), repeat=3) if any(v)], float)
    return d / np.linalg.norm(d, axis=1, keepdims=True)


def test_zonotope_radius_and_linear_programme_agree(shared_onboard):
    """The two proofs of controllability are independent of each other; on random directions radius <=
    authority.
    """
    columns = torques(shared_onboard, LANDER)
    rng = np.random.default_rng(7)
    d = rng.normal(size=(300, 3))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    radius = inscribed_radius(columns)
    along = np.array([authority_along(columns, v) for v in d[:60]])
    assert np.all(along >= radius * (1 - 1e-9))
    assert np.min(np.sum(np.maximum(d @ columns, 0.0), axis=1)) >= radius * (1 - 1e-9)
    # horizontal thrusters alone do not give every direction with any size of pitch
    only_roll = columns[:, :8]
    assert inscribed_radius(only_roll) < radius
    assert inscribed_radius(np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0]]).T) == 0.0


@pytest.mark.parametrize(
    "name", ["lander", *(pytest.param(name, marks=pytest.mark.long) for name in ("entry", "under_chute"))]
)
def test_torque_in_every_direction_with_any_single_thruster_of_22_failed(shared_onboard, name):
    assert shared_onboard[0]["vehicle"]["n_thrusters"] == 22
    for failed in range(22):
        columns = torques(shared_onboard, CENTRES[name], failed)
        assert inscribed_radius(columns) > 50.0, failed
    for failed in range(0, 22, 4):
        columns = torques(shared_onboard, CENTRES[name], failed)
        for d in directions()[::2]:
            assert authority_along(columns, d) > 50.0, (failed, d)


def test_each_phase_keeps_three_axis_torque_with_its_own_thruster_groups_after_one_failure(
    shared_onboard, scenario
):
    """S1 section 6.3: a fault in any single RCS does not influence the success of landing."""
    lost = []
    for phase in scenario.mission.phases:
        if not phase.thrusters:
            continue
        index = (
            ENTRY
            if phase.name in ("trim_aoa", "lift")
            else UNDER_CHUTE
            if phase.name == "parachute"
            else LANDER
        )
        for failed in range(22):
            if inscribed_radius(torques(shared_onboard, index, failed, phase.thrusters)) < 5.0:
                lost.append((phase.name, scenario.vehicle.rcs.thrusters[failed].name))
    assert lost == []


def test_horizontal_thrusters_have_a_roll_arm_above_1_m_and_one_failure_leaves_more_than_250_newton_metres(
    shared_onboard,
):
    """S1 section 6.3: two act together in one direction; one failed gives more than 250 N m in the roll
    channel.
    """
    vehicle = shared_onboard[0]["vehicle"]
    centre = vehicle["configuration"][LANDER]["centre"]
    horizontal = vehicle["thrusters"][:22][vehicle["thrusters"]["group"][:22] == 0]
    assert len(horizontal) == 8
    for jet in horizontal:
        roll = np.cross(jet["position"] - centre, jet["thrust"] * jet["direction"])[0]
        assert jet["direction"][0] == 0.0
        assert abs(roll) > 250.0
        assert abs(roll) / jet["thrust"] > 1.0
    about_axis = np.cross(horizontal["position"], horizontal["thrust"][:, None] * horizontal["direction"])[
        :, 0
    ]
    for direction in ((0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)):
        pair = np.all(horizontal["direction"] == direction, axis=1)
        assert np.sum(pair) == 2
        assert np.sum(about_axis[pair]) == pytest.approx(0.0, abs=1e-9)  # the pair pushes without rolling


def test_four_axial_thrusters_push_along_the_engine_axis_and_balance_about_it(shared_onboard):
    vehicle = shared_onboard[0]["vehicle"]
    axial = vehicle["thrusters"][:22][vehicle["thrusters"]["group"][:22] == 1]
    assert len(axial) == 4
    assert np.all(axial["direction"] == (-1.0, 0.0, 0.0))  # engine thrust is along -x of B
    assert np.sum(axial["thrust"]) == 1000.0
    assert np.allclose(
        np.sum(np.cross(axial["position"], axial["thrust"][:, None] * axial["direction"]), axis=0), 0.0
    )


def test_sixteen_of_250_newton_and_six_of_25_newton(shared_onboard):
    thrust = shared_onboard[0]["vehicle"]["thrusters"]["thrust"][:22]
    assert np.sum(thrust == 250.0) == 16
    assert np.sum(thrust == 25.0) == 6
    minimum = shared_onboard[0]["vehicle"]["thrusters"]["minimum_pulse"][:22]
    assert np.all(minimum[thrust == 250.0] == 0.040)
    assert np.all(minimum[thrust == 25.0] == 0.128)
