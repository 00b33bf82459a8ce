"""What every method of allocation must do, and what the table does by the book (Hu et al. 2022, section
4.3).
"""

import numpy as np
import pytest
from given_functions import allocate

from edl6dof.fsw.allocation.effectiveness import EFFECTIVENESS, update_effectiveness
from edl6dof.fsw.allocation.registry import ALLOCATION, ALLOCATORS, DEMAND
from edl6dof.fsw.onboard import FSW
from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.interface.effectors import ATTITUDE, AXIAL, FINE, HORIZONTAL
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.records import build_onboard

#: Parts of Tianwen-1 that are gone, a bit for each: heat shield, backshell, parachute pack.
LANDER = 0b111

ALL, USUAL = 0b1111, 0b1101
TABLE = ALLOCATORS.names.index("table")


@pytest.fixture(scope="module")
def solve():
    """Of a mission without entry: there is nothing to plan, nor to compile for it with the bounds check."""
    onboard = build_onboard(load_scenario("tianwen1", ["mission.phases=[{name: descent}]"]).scenario)
    vehicle, params = onboard[0]["vehicle"], onboard[0]["allocation"]
    count, effectiveness = int(vehicle["n_thrusters"]), np.zeros(1, EFFECTIVENESS)[0]
    update_effectiveness(vehicle, LANDER, np.zeros(MAX_THRUSTERS), effectiveness)

    def run(method, wrench, allowed=USUAL, translating=False, boosting=False, dead=()):
        found, demand, health = (np.zeros(1, kind)[0] for kind in (ALLOCATION, DEMAND, FSW["health"]))
        health["thruster"] = 1
        health["thruster"][list(dead)] = 0
        demand["wrench"], demand["groups"] = wrench, allowed
        demand["translating"], demand["boosting"] = translating, boosting
        params["method"] = method
        allocate(params, vehicle, health, effectiveness, demand, found)
        return found, vehicle["thrusters"]["group"][:count], count, effectiveness["matrix"][:count]

    return run


@pytest.mark.parametrize("method", range(len(ALLOCATORS.members)), ids=ALLOCATORS.names)
def test_duties_are_bounded_groups_are_kept_and_what_is_missing_is_reported(solve, method):
    rng = np.random.default_rng(1)
    for k in range(200):
        demand = rng.normal(size=6) * 10.0 ** rng.uniform(0.0, 3.3)
        demand[0], allowed, dead = 0.0, [ALL, USUAL, 1 << FINE][k % 3], [int(rng.integers(22))]
        memory, group, count, matrix = solve(method, demand, allowed, translating=k % 2 == 0, dead=dead)
        duty = memory["duty"][:count]
        assert np.all((duty >= 0.0) & (duty <= 1.0)) and duty[dead[0]] == 0.0
        assert np.all(duty[[(allowed >> g) & 1 == 0 for g in group]] == 0.0)
        assert memory["unallocated"] == pytest.approx(demand - duty @ matrix, abs=1e-8)


@pytest.mark.parametrize("method", range(len(ALLOCATORS.members)), ids=ALLOCATORS.names)
@pytest.mark.parametrize("axis", [3, 4, 5])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_torque_of_100_n_m_is_delivered_also_with_any_one_thruster_dead(solve, method, axis, sign):
    """Axial thrusters step in where an attitude thruster is gone."""
    for dead in range(22):
        demand = np.zeros(6)
        demand[axis] = 100.0 * sign
        memory, *_ = solve(method, demand, ALL, dead=[dead])
        assert abs(memory["unallocated"][axis]) < 5.0


def test_table_gives_small_demands_to_the_fine_thrusters_and_large_ones_to_the_others(solve):
    for size, expected in ((10.0, {FINE}), (150.0, {ATTITUDE}), (320.0, {ATTITUDE, FINE})):
        memory, group, count, matrix = solve(TABLE, [0, 0, 0, 0, size, 0])
        pitching = matrix[:, 4] > 20.0
        working = {
            int(g)
            for g, duty in zip(group[pitching], memory["duty"][:count][pitching], strict=True)
            if duty > 0.1
        }
        assert working - {HORIZONTAL} == expected


def test_table_flies_sideways_with_two_thrusters_to_a_direction(solve):
    memory, group, count, matrix = solve(TABLE, [0, 400.0, 0, 0, 0, 0], translating=True)
    assert memory["duty"][:2] == pytest.approx([0.8, 0.8], abs=0.02)
    assert memory["unallocated"][1] == pytest.approx(0.0, abs=60.0)


def test_table_keeps_the_axial_thrusters_on_under_full_thrust(solve):
    memory, group, count, matrix = solve(TABLE, [0, 0, 0, 0, 0, 0], ALL, boosting=True)
    assert np.all(memory["duty"][:count][group == AXIAL] == 1.0)
