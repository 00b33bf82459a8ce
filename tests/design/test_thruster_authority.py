"""Control authority of thrusters: by hand, by the vertices of the linear program, and about the vehicles that
ship.
"""

from __future__ import annotations

from itertools import combinations, product
from types import SimpleNamespace

import numpy as np
import pytest

import edl6dof
from edl6dof.design.thruster_authority import authority, configurations, effectiveness, groups_of
from edl6dof.fsw.allocation.effectiveness import effectiveness_matrix
from edl6dof.scenario.records import build_onboard

#: Four nozzles at the ends of the y axis that push along + and - z with 10 N.
FOUR = [
    SimpleNamespace(position_m=(0.0, y, 0.0), direction=(0.0, 0.0, z), thrust_n=10.0)
    for y in (1.0, -1.0)
    for z in (1.0, -1.0)
]
FLYING = ("tianwen1", "msl", "mars2020", "viking1", "phoenix", "insight", "schiaparelli", "pathfinder")


def symmetric(row: int, value: float) -> np.ndarray:
    found = np.zeros((6, 2))
    found[row] = -value, value
    return found


def test_four_thrusters_by_hand():
    """A couple gives 2 x 10 N x 1 m of roll, a pair 20 N along z without torque."""
    found = authority(effectiveness(FOUR, np.zeros(3)))
    hand = symmetric(2, 20.0) + symmetric(3, 20.0)
    np.testing.assert_allclose(found.pure, hand, atol=1e-9)
    np.testing.assert_allclose(found.total, hand, atol=1e-12)


def test_four_thrusters_about_a_centre_beside_them():
    """With the centre at y = 0.5 m the arms are 0.5 and 1.5 m: a couple still has 20 N m, but a force without
    torque takes the far nozzle at a third: 10 N + 10 N / 3.  The sum does not ask for that.
    """
    found = authority(effectiveness(FOUR, np.array([0.0, 0.5, 0.0])))
    np.testing.assert_allclose(found.pure, symmetric(2, 40.0 / 3.0) + symmetric(3, 20.0), atol=1e-6)
    np.testing.assert_allclose(found.total, symmetric(2, 20.0) + symmetric(3, 20.0), atol=1e-12)


def test_rounding_of_the_centre_is_no_unwanted_torque():
    """The row of the pitch torque would hold nothing but 1e-16 m of an arm, and forbid the pair."""
    found = authority(effectiveness(FOUR, np.array([1e-16, 0.0, 0.0])))
    np.testing.assert_allclose(found.pure, symmetric(2, 20.0) + symmetric(3, 20.0), atol=1e-9)


def test_group_without_means_against_its_unwanted_torque_has_none():
    """One nozzle beside the centre pushes and turns; it can do neither alone, nor two torques apart."""
    jet = SimpleNamespace(position_m=(1.0, 1.0, 0.0), direction=(0.0, 0.0, 1.0), thrust_n=10.0)
    found = authority(effectiveness([jet], np.zeros(3)))
    assert not found.pure.any()
    np.testing.assert_allclose(found.total[:, 0], [0, 0, 0, 0, -10, 0])
    np.testing.assert_allclose(found.total[:, 1], [0, 0, 10, 10, 0, 0])


def by_vertices(wanted: np.ndarray, unwanted: np.ndarray) -> float:
    """Return the largest value over the vertices of the polytope: all duties at a bound but for one of each
    equation, which follow from these.
    """
    rows, count = unwanted.shape
    best = 0.0
    for free in map(list, combinations(range(count), rows)):
        if abs(np.linalg.det(unwanted[:, free])) < 1e-9:
            continue
        held = [k for k in range(count) if k not in free]
        for bounds in product((0.0, 1.0), repeat=len(held)):
            duty = np.zeros(count)
            duty[held] = bounds
            duty[free] = np.linalg.solve(unwanted[:, free], -unwanted[:, held] @ duty[held])
            if np.all((duty > -1e-9) & (duty < 1.0 + 1e-9)):
                best = max(best, float(wanted @ duty))
    return best


@pytest.mark.parametrize("seed", [1, 8, 11])
def test_linear_programs_find_the_best_vertex(seed):
    """Ten thrusters at random, of those seeds with which they can push without torque at all."""
    random = np.random.default_rng(seed)
    matrix = random.normal(size=(10, 6)) * [10.0, 10.0, 10.0, 1.0, 1.0, 1.0]
    found = authority(matrix)
    for row, (side, sign) in product(range(6), enumerate((-1.0, 1.0))):
        unwanted = [k for k in (range(6) if row < 3 else range(3, 6)) if k != row]
        best = by_vertices(sign * matrix[:, row], matrix[:, unwanted].T)
        assert sign * found.pure[row, side] == pytest.approx(best, rel=1e-6, abs=1e-6)
    assert np.any(found.pure[:3]) and np.all(found.pure[3:])


def test_effectiveness_is_that_of_the_flight_software():
    scenario = edl6dof.load("tianwen1").scenario
    vehicle = build_onboard(scenario)[0]["vehicle"]
    jets, (entry, inside) = scenario.vehicle.rcs.thrusters, configurations(scenario.vehicle)
    own = np.zeros((len(jets), 6))
    for state, gone in ((entry, 0), (inside, 2 ** len(scenario.vehicle.parts) - 1)):
        centre = vehicle["configuration"][gone]["centre"]
        np.testing.assert_allclose(state.centre_m, centre, atol=1e-12)
        effectiveness_matrix(vehicle["thrusters"], len(jets), tuple(centre), own)
        np.testing.assert_allclose(effectiveness(jets, state.centre_m), own, atol=1e-9)


@pytest.mark.parametrize("name", FLYING)
def test_pure_authority_lies_within_the_sum_and_groups_within_all(name):
    vehicle = edl6dof.load(name).scenario.vehicle
    groups = groups_of(vehicle)
    for state in configurations(vehicle):
        assert list(state.groups) == list(groups)
        whole = state.groups.get("all")
        for found in state.groups.values():
            assert np.all(np.abs(found.pure) <= np.abs(found.total) + 1e-6)
            if whole is not None:
                assert np.all(np.abs(found.pure) <= np.abs(whole.pure) * (1.0 + 1e-6) + 1e-6)
    assert configurations(vehicle)[0].centre_m == pytest.approx(vehicle.mass.entry_centre_m, abs=1e-9)


def test_rover_hangs_below_the_descent_stage_without_its_aeroshell():
    """Mars 2020 lights its engines with the rover: what is left weighs what belongs to it."""
    vehicle = edl6dof.load("mars2020").scenario.vehicle
    rover = next(part for part in vehicle.parts if part.name == "rover")
    without = vehicle.model_copy(update={"parts": [part for part in vehicle.parts if part is not rover]})
    heights = [configurations(one)[1].centre_m[0] for one in (vehicle, without)]
    assert heights[0] == pytest.approx(
        heights[1], abs=1e-9
    )  # in the file without it, it is part of the lander
    assert configurations(vehicle)[0].centre_m[0] != pytest.approx(heights[0], abs=1e-3)
