"""Opposed test pulses: they cancel, they leave working valves alone, they reach every thruster in each phase,
and a suspect goes first.
"""

import numpy as np
import pytest
from thruster_bench import (
    close_for_test,
    modulate,
    open_for_test,
    opposite,
    pair_to_test,
    thruster_to_close,
)

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.allocation.effectiveness import EFFECTIVENESS, update_effectiveness
from edl6dof.fsw.diagnosis.exercise import ExerciseParams
from edl6dof.fsw.diagnosis.flow_evidence import NONE
from edl6dof.fsw.modulation import ModulationParams
from edl6dof.fsw.onboard import FSW
from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.interface.effectors import STUCK_OFF

#: Parts of Tianwen-1 that are gone, a bit for each: heat shield, backshell, parachute pack.
LANDER = 0b111

DT = 0.04


@pytest.fixture(scope="module")
def vehicle(shared_onboard):
    return shared_onboard[0]["vehicle"]


@pytest.fixture(scope="module")
def effectiveness(vehicle):
    record = np.zeros(1, EFFECTIVENESS)
    update_effectiveness(vehicle, LANDER, np.zeros(MAX_THRUSTERS), record[0])
    return record["matrix"][0]


class Bench:
    """The exercise and the modulator in a loop over control cycles of a phase that began at t = 0."""

    def __init__(self, vehicle, effectiveness, sideways=True, **settings):
        self.vehicle, self.fsw = vehicle, np.zeros(1, FSW)
        self.params, self.diagnosis = np.zeros(1, dtype_of(ExerciseParams)), self.fsw["diagnosis"]
        fill(self.params[0], ExerciseParams(**settings))
        self.modulation = np.zeros(1, dtype_of(ModulationParams))
        fill(self.modulation[0], ModulationParams())
        self.memory, self.healthy = self.diagnosis["exercise"], self.fsw["health"]["thruster"][0]
        self.healthy[:], self.fsw["effectiveness"]["matrix"] = 1, effectiveness
        self.t, self.sideways, self.axial = 100.0, sideways, 1e4
        self.open_time, self.close_time = (
            self.fsw["modulation"][name][0] for name in ("open_time", "close_time")
        )
        self.memory["used"] = self.memory["tested"] = 99.0
        self.on_time, self.last = np.zeros(32), (NONE, NONE)

    def cycle(self, firing=()):
        """One control cycle with ``firing`` commanded; returns the thrusters that are tested from now on."""
        duty = self.fsw["allocation"]["duty"][0]
        duty[:] = 0.0
        duty[list(firing)] = 1.0
        modulate(self.modulation, self.vehicle, self.t, DT, self.fsw)
        pair = pair_to_test(self.params, self.vehicle, self.sideways, self.axial, 0.0, self.t, DT, self.fsw)
        tested = {i for i in pair if i != NONE}
        for i in tested:
            open_for_test(i, self.vehicle, self.t, DT, self.fsw)
        self.t += DT
        self.on_time += self.close_time - self.open_time
        return tested


def test_opposite_has_the_opposite_torque_and_lateral_force(vehicle, effectiveness):
    """For the axial thrusters the forces along the axis add up, which turns nothing."""
    count, fsw = int(vehicle["n_thrusters"]), np.zeros(1, FSW)
    fsw["effectiveness"]["matrix"] = effectiveness
    for i in range(count):
        j = opposite(count, i, fsw)
        turns = effectiveness[:count, 1:]
        left = np.linalg.norm(turns + turns[i], axis=1) / np.linalg.norm(turns[i])
        assert left[j] < 0.1 and np.sum(left < 0.1) == 1
    assert [opposite(count, i, fsw) for i in range(8)] == [5, 4, 7, 6, 1, 0, 3, 2]


def test_every_test_cancels_and_all_eight_are_reached_within_four_tenths_of_a_second(vehicle, effectiveness):
    bench, reached, worst = Bench(vehicle, effectiveness), set(), 0.0
    for _ in range(10):
        tested = bench.cycle()
        reached |= tested
        worst = max(worst, np.abs(effectiveness[sorted(tested)].sum(axis=0)[1:]).max() if tested else 0.0)
    assert reached == set(range(8)) and worst < 1.0


def test_in_any_phase_every_thruster_gives_its_shortest_pulse_once_a_minute(vehicle, effectiveness):
    bench, count = Bench(vehicle, effectiveness, sideways=False, every_s=20.0), int(vehicle["n_thrusters"])
    for _ in range(round(19.0 / DT)):
        bench.cycle()
    bench.memory["used"] = bench.t - 1e3
    bench.on_time[:] = 0.0
    for _ in range(round(19.0 / DT)):
        bench.cycle()
    shortest = vehicle["thrusters"]["minimum_pulse"][:count]
    assert bench.on_time[:count] == pytest.approx(np.maximum(shortest, DT), abs=1e-9)


def test_a_firing_thruster_is_not_touched_nor_one_that_was_used_lately(vehicle, effectiveness):
    bench = Bench(vehicle, effectiveness)
    for _ in range(40):
        assert not bench.cycle(firing=(0, 3)) & {0, 3}


def test_isolated_thruster_and_its_opposite_are_not_tested(vehicle, effectiveness):
    bench = Bench(vehicle, effectiveness)
    bench.healthy[2] = 0
    assert not any(bench.cycle() & {2, 7} for _ in range(40))


def test_suspect_of_force_and_torque_fires_a_train_of_pulses(vehicle, effectiveness):
    """From the next cycle on, each pulse when the last one has been measured."""
    bench = Bench(vehicle, effectiveness)
    for _ in range(10):
        bench.cycle()
    best = bench.diagnosis["hypotheses"]
    best["thruster"], best["kind"], best["evidence"] = 6, STUCK_OFF, 8.0
    assert [bench.cycle() for _ in range(9)] == [{3, 6}, *([set()] * 3 + [{3, 6}]) * 2]


def test_suspect_that_fires_steadily_is_closed_for_a_cycle(vehicle, effectiveness):
    """Not while it pulses, nor within its shortest pulse, nor without suspicion or once it is out of use."""
    bench = Bench(vehicle, effectiveness)
    best, share = bench.diagnosis["hypotheses"], bench.diagnosis["residual"]["share"][0]

    def closed():
        return thruster_to_close(bench.params, vehicle, bench.t, DT, bench.fsw)

    for _ in range(10):
        bench.cycle(firing=[3])
    share[:, 3] = 1.0
    assert closed() == NONE
    best["thruster"], best["kind"], best["evidence"] = 3, STUCK_OFF, 8.0
    assert closed() == 3
    close_for_test(3, bench.fsw)
    assert bench.close_time[3] == bench.open_time[3]
    bench.fsw["modulation"]["busy_until"][0, 3] = bench.t + 0.01
    assert closed() == NONE
    bench.fsw["modulation"]["busy_until"][0, 3], share[2, 3] = 0.0, 0.6
    assert closed() == NONE
    share[2, 3], bench.healthy[3] = 1.0, 0
    assert closed() == NONE
    bench.healthy[3], best["evidence"] = 1, 3.0
    assert closed() == NONE
    bench.cycle(firing=[3])
    assert bench.close_time[3] - bench.open_time[3] == pytest.approx(DT)


def test_two_of_which_one_let_nothing_through_are_each_tried_alone(vehicle, effectiveness):
    bench = Bench(vehicle, effectiveness, sideways=False)
    bench.diagnosis["flow"]["doubtful"][0, [3, 6]] = 1
    tried = [bench.cycle() for _ in range(9)]
    assert tried == [{3}, set(), set(), set(), {6}, set(), set(), set(), {3}]  # in turn, each measured first
    bench.diagnosis["flow"]["doubtful"][0, 3] = 0
    assert [bench.cycle() for _ in range(4)] == [set(), set(), set(), {6}]


def test_where_a_loss_may_be_the_propellants_others_are_tested_at_once(vehicle, effectiveness):
    bench = Bench(vehicle, effectiveness, sideways=False)
    assert bench.cycle() == set()
    bench.diagnosis["flow"]["suspecting"] = 1
    assert len(bench.cycle()) == 2
    bench.diagnosis["flow"]["seen"] = 3
    assert bench.cycle() == set()


def test_what_would_pass_for_drag_is_not_tested(vehicle, effectiveness):
    """Two axial thrusters push with 500 N."""
    bench, axial = Bench(vehicle, effectiveness, sideways=False, every_s=20.0), {8, 9, 10, 11}
    bench.memory["used"], bench.axial = bench.t - 1e3, 2499.0
    tested = set().union(*(bench.cycle() for _ in range(round(19.0 / DT))))
    assert tested == set(range(int(vehicle["n_thrusters"]))) - axial
    bench.axial = 2501.0
    assert axial <= set().union(*(bench.cycle() for _ in range(round(5.0 / DT))))


def test_switched_off_it_tests_nothing(vehicle, effectiveness):
    bench = Bench(vehicle, effectiveness, enabled=False)
    assert not any(bench.cycle() for _ in range(40))
