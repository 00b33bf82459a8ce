"""A fault changes what the actuators do, not what they are told, from its time on.

The oracle is the impulse of a rectangular pulse: thrust times open time, because valves rise and fall in the
same time.
"""

import numpy as np
import pytest
from broken_vehicle import CYCLE, D7, D8, IGNITION, MORTAR, PARACHUTE_PHASE, broken
from given_functions import actuate

import edl6dof
from edl6dof.interface.effectors import STUCK_ON
from edl6dof.vehicle.actuate import is_present
from edl6dof.vehicle.parachutes.parachute import INFLATING, RELEASED
from edl6dof.vehicle.plant import THRUST
from edl6dof.vehicle.propulsion.rcs import fire


def impulse(case, plant, command, cycles, pulse=None):
    """Momentum (N s, B) and propellant (kg) given in some cycles; ``pulse`` = (thruster, opens, closes)."""
    total, used = np.zeros(3), 0.0
    for k in range(cycles):
        plant["t"] = k * CYCLE
        if pulse is not None:
            command["valve_open_time"][pulse[0]], command["valve_close_time"][pulse[0]] = pulse[1:]
        actuate(case, command, plant)
        inputs, loads = plant["inputs"], case["feeds"]["thrusters"]
        inputs["filled"] = 1
        branch, counts = case["branches"]["of"], plant["branch_used"]
        fire(case["vehicle"]["rcs"], loads, branch, plant["valves"], plant["t"], CYCLE, inputs, counts)
        total += inputs["rcs_force"] * CYCLE
        used += inputs["rcs_flow"].sum() * CYCLE
    return total, used


def test_dead_thruster_gives_nothing_and_the_others_all(tables):
    case, plant, command = broken(tables, "{thruster: D7, kind: stuck_off, at: {time_s: 0}}")
    assert impulse(case, plant, command, 40, (D7, 0.1, 0.5))[0] == pytest.approx((0.0, 0.0, 0.0))
    assert impulse(case, plant, command, 40, (D8, 0.1, 0.5))[0] == pytest.approx((0.0, 0.0, -250.0 * 0.4))


def test_thruster_that_dies_within_a_pulse_has_given_the_part_before(tables):
    case, plant, command = broken(tables, "{thruster: D7, kind: stuck_off, at: {time_s: 0.3}}")
    assert impulse(case, plant, command, 40, (D7, 0.1, 0.5))[0][2] == pytest.approx(-250.0 * 0.2)


def test_stuck_thruster_burns_from_its_time_on_until_its_branch_is_shut(tables):
    case, plant, command = broken(tables, "{thruster: D7, kind: stuck_on, at: {time_s: 0.2}}")
    # 12 ms rise, no decay yet
    assert impulse(case, plant, command, 25)[0][2] == pytest.approx(-250.0 * (0.3 - 0.006))
    command["latch_closed"][case["branches"]["of"][D7]] = 1
    plant["valves"]["level"][:] = 0.0
    assert impulse(case, plant, command, 25)[0] == pytest.approx((0.0, 0.0, 0.0))


def test_weak_thruster_gives_its_share_of_impulse_and_uses_its_share_of_propellant(tables):
    case, plant, command = broken(
        tables, "{thruster: D7, kind: degraded, degraded: {thrust_factor: 0.3}, at: {time_s: 0}}"
    )
    push, used = impulse(case, plant, command, 40, (D7, 0.1, 0.5))
    assert push[2] == pytest.approx(-0.3 * 250.0 * 0.4)
    assert used == pytest.approx(0.3 * 250.0 * 0.4 / (270.0 * 9.80665))


def test_bad_catalyst_takes_thrust_and_leaves_the_flow(tables):
    degraded = "degraded: {thrust_factor: 0.3, flow_factor: 0.9}"
    case, plant, command = broken(tables, f"{{thruster: D7, kind: degraded, {degraded}, at: {{time_s: 0}}}}")
    push, used = impulse(case, plant, command, 40, (D7, 0.1, 0.5))
    assert push[2] == pytest.approx(-0.3 * 250.0 * 0.4)
    assert used == pytest.approx(0.9 * 250.0 * 0.4 / (270.0 * 9.80665))
    assert plant["branch_used"].sum() == pytest.approx(used, rel=1e-12)


@pytest.mark.parametrize("width", [0.06, 0.2, 0.7])
def test_slow_valve_gives_the_triangle_or_trapezium_of_its_rise_and_decay(tables, width):
    """Level after a pulse of width w: h = min(w / rise, 1); impulse F (h w - h2 rise / 2 + h2 decay / 2)."""
    rise, decay = 0.3, 0.4
    slow = f"slow: {{rise_s: {rise}, decay_s: {decay}}}"
    case, plant, command = broken(tables, f"{{thruster: D7, kind: slow, {slow}, at: {{time_s: 0}}}}")
    push, used = impulse(case, plant, command, 80, (D7, 0.1, 0.1 + width))
    h = min(width / rise, 1.0)
    assert -push[2] == pytest.approx(250.0 * (h * width + 0.5 * h * h * (decay - rise)), rel=1e-12)
    assert used == pytest.approx(-push[2] / (270.0 * 9.80665), rel=1e-12)


@pytest.mark.parametrize(("thrust", "flow"), [(0.2, 0.2), (1.0, 1.0), (0.0, 0.3), (0.1, 0.4)])
def test_leak_adds_to_what_the_valve_lets_through_until_the_latch_valve_shuts(tables, thrust, flow):
    """Of hot gas thrust and flow are the same share; what leaks without reacting gives less thrust."""
    leak = f"leaking: {{thrust_factor: {thrust}, flow_factor: {flow}}}"
    case, plant, command = broken(tables, f"{{thruster: D7, kind: leaking, {leak}, at: {{time_s: 0.2}}}}")
    push, used = impulse(case, plant, command, 50, (D7, 0.4, 0.6))
    assert push[2] == pytest.approx(-250.0 * (0.8 * thrust + 0.2 * (1.0 - thrust)))
    assert used == pytest.approx(250.0 / (270.0 * 9.80665) * (0.8 * flow + 0.2 * (1.0 - flow)))
    assert plant["branch_used"][case["branches"]["of"][D7]] == pytest.approx(used, rel=1e-12)
    command["latch_closed"][case["branches"]["of"][D7]] = 1
    command["valve_close_time"] = 0.0
    plant["valves"]["level"][:] = 0.0
    push, used = impulse(case, plant, command, 50)
    assert not push.any() and used == 0.0


def test_fault_ends_at_its_time_and_the_valve_obeys_again(tables):
    case, plant, command = broken(
        tables, "{thruster: D7, kind: stuck_off, duration_s: 0.2, at: {time_s: 0.2}}"
    )
    # shut from 0.2 to 0.4 s, where it begins to rise again
    assert impulse(case, plant, command, 40, (D7, 0.1, 0.5))[0][2] == pytest.approx(-250.0 * 0.2)
    case, plant, command = broken(
        tables, "{thruster: D7, kind: stuck_on, duration_s: 0.2, at: {time_s: 0.2}}"
    )
    assert impulse(case, plant, command, 40)[0][2] == pytest.approx(-250.0 * 0.2)
    assert plant["valves"]["fault"][D7] == 0


def presences(tables, presence, intervals, profile):
    """Intervals of 0.1 s in which the second of two intermittent faults of a flight is present, bool."""
    faults = [
        f"{{thruster: {name}, kind: stuck_off, presence: {p}, at: {{time_s: 0}}}}"
        for name, p in (("D1", 0.5), ("D7", presence))
    ]
    case, _, _ = broken(tables, *faults, others=[f"profile={profile}"])
    slot = case["faults"]["slots"][1]
    cycles = np.array([is_present(slot, k * CYCLE) for k in range(5 * intervals)]).reshape(intervals, 5)
    assert np.all(cycles == cycles[:, :1])
    return cycles[:, 0]


def test_intermittent_fault_is_present_in_its_share_of_intervals_independent_of_each_other(tables):
    """Binomial and runs, each within four standard deviations; the first interval always counts."""
    for presence in (0.1, 0.5, 0.9):
        found = presences(tables, presence, 2000, profile=0)
        assert found[0]
        spread = np.sqrt(presence * (1.0 - presence) / 2000)
        assert found[1:].mean() == pytest.approx(presence, abs=4.0 * spread)
        both = (found[1:-1] & found[2:]).mean()
        assert both == pytest.approx(presence**2, abs=4.0 * np.sqrt(presence**2 / 2000))
    assert presences(tables, 1.0, 50, profile=0).all()


def test_random_numbers_of_an_intermittent_fault_belong_to_its_flight(tables):
    first, again, other = (presences(tables, 0.5, 200, profile) for profile in (4, 4, 5))
    assert np.array_equal(first, again) and 60 < (first != other).sum() < 140


def test_intermittent_fault_acts_in_the_intervals_in_which_it_is_present(tables):
    fault = "{thruster: D7, kind: stuck_on, presence: 0.5, interval_s: 0.2, at: {time_s: 0}}"
    case, plant, command = broken(tables, fault)
    states = []
    for k in range(500):
        plant["t"] = k * CYCLE
        actuate(case, command, plant)
        states.append(int(plant["valves"]["fault"][D7]))
    slot = case["faults"]["slots"][0]
    assert states == [STUCK_ON * is_present(slot, k * CYCLE) for k in range(500)]
    assert 150 < states.count(STUCK_ON) < 350


@pytest.mark.parametrize("thruster", [D7, D8])
def test_weak_feed_takes_its_share_of_thrust_and_flow_from_all_and_adds_to_other_faults(tables, thruster):
    weak = "{kind: weak_thrusters, weak_thrusters: {thrust_factor: 0.7}, at: {time_s: 0}}"
    own = "{thruster: D7, kind: degraded, degraded: {thrust_factor: 0.5}, at: {time_s: 0}}"
    left = 0.7 * (0.5 if thruster == D7 else 1.0)
    for faults in ((weak, own), (own, weak)):
        case, plant, command = broken(tables, *faults)
        push, used = impulse(case, plant, command, 40, (thruster, 0.1, 0.5))
        assert push[2] == pytest.approx(-left * 250.0 * 0.4)
        assert used == pytest.approx(left * 250.0 * 0.4 / (270.0 * 9.80665))


def test_latch_valve_that_fails_shut_stops_its_branch_and_no_other(tables):
    names = edl6dof.load("tianwen1").scenario.thruster_names
    case, plant, command = broken(tables, "{kind: branch_dead, branch: D47, at: {time_s: 0.1}}")
    for name, pushed in (("D4", 0.0), ("D7", 0.0), ("D8", -250.0 * 0.4)):
        assert impulse(case, plant, command, 40, (names.index(name), 0.2, 0.6))[0][2] == pytest.approx(pushed)
        command["valve_close_time"] = 0.0
    assert [names[i] for i in np.flatnonzero(plant["valves"]["fault"])] == ["D4", "D7"]


def test_fault_of_a_phase_counts_from_the_cycle_in_which_that_phase_was_entered(tables):
    case, plant, command = broken(
        tables, "{thruster: D7, kind: stuck_off, at: {phase: parachute, plus_s: 0.1}}"
    )
    for k in range(20):
        plant["t"], command["phase"] = k * CYCLE, 1 if k < 7 else PARACHUTE_PHASE
        actuate(case, command, plant)
    assert plant["fault_since"][0] == pytest.approx(12 * CYCLE)


def test_phase_that_is_skipped_still_starts_its_fault(tables):
    case, plant, command = broken(tables, "{thruster: D7, kind: stuck_off, at: {phase: parachute}}")
    command["phase"] = 4
    actuate(case, command, plant)
    assert plant["fault_since"][0] == 0.0


def test_mortar_fires_late_by_the_delay_and_nothing_else_does(tables):
    case, plant, command = broken(
        tables, "{kind: parachute_delay, parachute_delay: {delay_s: 2.5}, at: {time_s: 0}}"
    )
    command["request"][[MORTAR, IGNITION]] = 1
    actuate(case, command, plant)
    assert plant["due"][MORTAR] == pytest.approx(0.015 + 2.5)
    assert plant["due"][IGNITION] == pytest.approx(0.15)


def test_stuck_throttle_holds_the_level_of_its_moment(tables):
    case, plant, command = broken(tables, "{kind: throttle_stuck, at: {time_s: 0.04}}")
    plant["running"][0], plant["y"][THRUST] = 1, 3210.0
    held = []
    for k in range(5):
        plant["t"], command["thrust"][0] = k * CYCLE, 2000.0 + k
        actuate(case, command, plant)
        held.append(float(plant["thrust_command"][0]))
        plant["y"][THRUST] += 100.0
    assert held == [2000.0, 2001.0, 3410.0, 3410.0, 3410.0]


def test_engine_lights_late_by_the_delay(tables):
    case, plant, command = broken(
        tables, "{kind: ignition_delay, ignition_delay: {delay_s: 1.5}, at: {time_s: 0}}"
    )
    command["request"][[MORTAR, IGNITION]] = 1
    actuate(case, command, plant)
    assert plant["due"][[MORTAR, IGNITION]] == pytest.approx([0.015, 0.15 + 1.5])


def test_dead_mortar_never_fires(tables):
    case, plant, command = broken(tables, "{kind: parachute_dead, at: {time_s: 0}}")
    command["request"][[MORTAR, IGNITION]] = 1
    actuate(case, command, plant)
    assert plant["due"][MORTAR] > 1e9 and plant["due"][IGNITION] == pytest.approx(0.15)


def test_torn_riser_lets_the_canopy_go_with_the_area_that_it_has(tables):
    torn = ["{kind: canopy_torn, canopy_torn: {area_factor: 0.6}, at: {time_s: 0}}"]
    found = []
    for faults in ([], torn):
        case, plant, command = broken(tables, *faults, "{kind: riser_torn, at: {time_s: 0}}")
        plant["canopy"] = INFLATING
        actuate(case, command, plant)
        assert plant["canopy"] == RELEASED
        found.append(float(plant["debris"]["drag_area"].max()))
    assert found[1] == pytest.approx(0.6 * found[0]) and found[0] > 100.0
