"""Opposed test pulses: they cancel, they leave working valves alone, they reach every horizontal thruster,
and a suspect goes first.
"""

import numpy as np
import pytest

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.allocation.effectiveness import effectiveness_matrix
from edl6dof.fsw.diagnosis.exercise import EXERCISE, NONE, ExerciseParams, opposite, pair_to_test
from edl6dof.fsw.diagnosis.hypotheses import HYPOTHESES, STUCK_OFF
from edl6dof.fsw.modulation import MODULATION, open_pair

#: Parts of Tianwen-1 that are gone, a bit for each: heat shield, backshell, parachute pack.
LANDER = 0b111

DT = 0.04


@pytest.fixture(scope="module")
def vehicle(shared_onboard):
    return shared_onboard[0]["vehicle"]


@pytest.fixture(scope="module")
def effectiveness(vehicle):
    table = np.zeros((32, 6))
    effectiveness_matrix(
        vehicle["thrusters"],
        int(vehicle["n_thrusters"]),
        tuple(vehicle["configuration"][LANDER]["centre"]),
        table,
    )
    return table


class Bench:
    """The exercise in a loop over control cycles; ``firing`` valves are open already."""

    def __init__(self, vehicle, effectiveness, **settings):
        self.vehicle, self.effectiveness, self.count = vehicle, effectiveness, int(vehicle["n_thrusters"])
        self.params, self.memory = np.zeros(1, dtype_of(ExerciseParams)), np.zeros(1, EXERCISE)
        fill(self.params[0], ExerciseParams(**settings))
        self.hypotheses, self.modulator, self.healthy = (
            np.zeros(1, HYPOTHESES),
            np.zeros(1, MODULATION),
            np.ones(32, "i8"),
        )
        self.t = 100.0

    def cycle(self, firing=()):
        opens, closes = np.full(32, self.t), np.full(32, self.t)
        closes[list(firing)] += 0.7 * DT
        i, j = pair_to_test(
            self.params[0],
            self.vehicle,
            self.effectiveness,
            self.healthy,
            self.hypotheses[0],
            self.modulator[0]["busy_until"],
            opens,
            closes,
            self.t,
            DT,
            self.memory[0],
        )
        if i != NONE:
            open_pair(i, j, self.t, DT, opens, closes)
        self.t += DT
        tested = closes - opens > 0.99 * DT
        return {int(i) for i in np.flatnonzero(tested)}


def test_opposite_is_the_thruster_on_the_same_line_of_action(vehicle, effectiveness):
    count = int(vehicle["n_thrusters"])
    for i in range(count):
        j = opposite(effectiveness, count, i)
        matches = [k for k in range(count) if np.allclose(effectiveness[k], -effectiveness[i], atol=1.0)]
        assert j == (matches[0] if matches else NONE)
    assert [opposite(effectiveness, count, i) for i in range(8)] == [5, 4, 7, 6, 1, 0, 3, 2]


def test_every_test_cancels_and_all_eight_are_reached_within_four_tenths_of_a_second(vehicle, effectiveness):
    bench, reached, worst = Bench(vehicle, effectiveness), set(), 0.0
    for _ in range(10):
        tested = bench.cycle()
        reached |= tested
        worst = max(worst, np.abs(effectiveness[sorted(tested)].sum(axis=0)).max() if tested else 0.0)
    assert reached == set(range(8)) and worst < 1.0


def test_a_firing_thruster_is_not_touched_nor_one_that_was_used_lately(vehicle, effectiveness):
    bench = Bench(vehicle, effectiveness)
    for _ in range(40):
        tested = bench.cycle(firing=(0, 3))
        assert not tested & {0, 3, 5, 6}


def test_isolated_thruster_and_its_opposite_are_not_tested(vehicle, effectiveness):
    bench = Bench(vehicle, effectiveness)
    bench.healthy[2] = 0
    assert not any(bench.cycle() & {2, 7} for _ in range(40))


def test_suspect_is_tested_in_the_next_cycle(vehicle, effectiveness):
    bench = Bench(vehicle, effectiveness)
    for _ in range(10):
        bench.cycle()
    bench.hypotheses["thruster"], bench.hypotheses["kind"], bench.hypotheses["evidence"] = 6, STUCK_OFF, 8.0
    assert [bench.cycle() for _ in range(3)] == [{3, 6}] * 3


def test_switched_off_it_tests_nothing(vehicle, effectiveness):
    bench = Bench(vehicle, effectiveness, enabled=False)
    assert not any(bench.cycle() for _ in range(40))
