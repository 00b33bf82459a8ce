"""A fault changes what the actuators do, not what they are told, from its time on.

The oracle is the impulse of a rectangular pulse: thrust times open time, because valves rise and fall in the
same time.
"""

import numpy as np
import pytest

import edl6dof
from edl6dof.config.errors import ConfigError
from edl6dof.interface.command import COMMAND
from edl6dof.scenario.records import build_case, build_tables, initial_plant
from edl6dof.vehicle.actuate import actuate
from edl6dof.vehicle.faults import FAULT_KINDS, THRUSTER_KINDS
from edl6dof.vehicle.plant import THRUST
from edl6dof.vehicle.rcs import fire

CYCLE = 0.02
D7, D8 = 6, 7

#: Numbers of two events of the mission.
MORTAR, IGNITION = (
    list(edl6dof.load("tianwen1").scenario.mission.events).index(name) for name in ("mortar", "ignition")
)


@pytest.fixture(scope="module")
def tables():
    return build_tables(edl6dof.load("tianwen1").scenario)


def broken(tables, *faults):
    """Case, plant and an idle command of a vehicle with these faults."""
    scenario = edl6dof.load("tianwen1", [f"faults=[{', '.join(faults)}]"]).scenario
    case = build_case(scenario, tables)
    return case[0], initial_plant(scenario, case)[0], np.zeros(1, COMMAND)[0]


def impulse(case, plant, command, cycles, pulse=None):
    """Momentum (N s, B) and propellant (kg) given in some cycles; ``pulse`` = (thruster, opens, closes)."""
    total, used = np.zeros(3), 0.0
    for k in range(cycles):
        plant["t"] = k * CYCLE
        if pulse is not None:
            command["opens"][pulse[0]], command["closes"][pulse[0]] = pulse[1:]
        actuate(case, command, plant)
        inputs, loads = plant["inputs"], case["feeds"]["thrusters"]
        inputs["filled"] = 1
        fire(case["vehicle"]["rcs"], loads, plant["valves"], plant["t"], CYCLE, 0.0, inputs)
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


def test_stuck_thruster_burns_from_its_time_on_until_it_is_isolated(tables):
    case, plant, command = broken(tables, "{thruster: D7, kind: stuck_on, at: {time_s: 0.2}}")
    # 12 ms rise, no decay yet
    assert impulse(case, plant, command, 25)[0][2] == pytest.approx(-250.0 * (0.3 - 0.006))
    command["isolate"][D7] = 1
    plant["valves"]["level"][:] = 0.0
    assert impulse(case, plant, command, 25)[0] == pytest.approx((0.0, 0.0, 0.0))


def test_weak_thruster_gives_its_share_of_impulse_and_uses_its_share_of_propellant(tables):
    case, plant, command = broken(
        tables, "{thruster: D7, kind: degraded, degraded: {thrust_factor: 0.3}, at: {time_s: 0}}"
    )
    push, used = impulse(case, plant, command, 40, (D7, 0.1, 0.5))
    assert push[2] == pytest.approx(-0.3 * 250.0 * 0.4)
    assert used == pytest.approx(0.3 * 250.0 * 0.4 / (270.0 * 9.80665))


def test_fault_of_a_phase_counts_from_the_cycle_in_which_that_phase_was_entered(tables):
    case, plant, command = broken(
        tables, "{thruster: D7, kind: stuck_off, at: {phase: parachute, plus_s: 0.1}}"
    )
    for k in range(20):
        plant["t"], command["phase"] = k * CYCLE, 1 if k < 7 else 2
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


@pytest.mark.parametrize("kind", FAULT_KINDS.names)
def test_no_kind_does_anything_before_its_time(tables, kind):
    thruster = "thruster: D7, " if kind in THRUSTER_KINDS else ""
    case, plant, command = broken(tables, f"{{{thruster}kind: {kind}, at: {{time_s: 1}}}}")
    sound_case, sound, _ = broken(tables)
    command["closes"][:22], command["thrust"], command["request"][MORTAR] = 0.7, 3000.0, 1
    for k in range(40):
        plant["t"] = sound["t"] = k * CYCLE
        actuate(case, command, plant)
        actuate(sound_case, command, sound)
    sound["phase_seen"] = plant["phase_seen"]
    assert plant.tobytes() == sound.tobytes()


@pytest.mark.parametrize("kind", FAULT_KINDS.names)
def test_every_kind_breaks_the_vehicle_and_changes_no_command(tables, kind):
    """Mortar, engine, wing and thrusters are in use, so that each kind finds something to break."""
    thruster = "thruster: D7, " if kind in THRUSTER_KINDS else ""
    case, plant, command = broken(tables, f"{{{thruster}kind: {kind}, at: {{time_s: 0.1}}}}")
    sound_case, sound, _ = broken(tables)
    command["closes"][:22], command["thrust"], command["request"][MORTAR] = 0.7, 3000.0, 1
    before = command.tobytes()
    for k in range(40):
        plant["t"] = sound["t"] = k * CYCLE
        actuate(case, command, plant)
        actuate(sound_case, command, sound)
    assert plant["fault_since"][0] == pytest.approx(0.1)
    sound["phase_seen"], sound["fault_since"] = plant["phase_seen"], plant["fault_since"]
    assert plant.tobytes() != sound.tobytes()
    assert command.tobytes() == before


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        (
            "{thruster: D9, kind: stuck_off, at: {time_s: 1}}",
            "faults.0.thruster: no thruster named 'D9'; names: D1, D2",
        ),
        (
            "{thruster: D7, kind: stuck_off, at: {phase: hazard}}",
            "faults.0.at.phase: no phase named 'hazard'; names: trim_aoa",
        ),
        ("{thruster: D7, kind: stuck, at: {time_s: 1}}", "faults.0.kind: unknown name"),
        ("{kind: stuck_off, at: {time_s: 1}}", "faults.0: stuck_off must name its thruster"),
        ("{thruster: D7, kind: wing_lost, at: {time_s: 1}}", "faults.0: wing_lost is not about a thruster"),
        (
            "{thruster: D7, kind: stuck_off, at: {time_s: 1, phase: lift}}",
            "faults.0.at: must name either a phase",
        ),
        ("{thruster: D7, kind: stuck_off}", "faults.0.at: "),
    ],
)
def test_fault_that_cannot_be_is_refused_at_its_key(fault, words):
    with pytest.raises(ConfigError) as refusal:
        edl6dof.load("tianwen1", [f"faults=[{fault}]"])
    assert words in str(refusal.value)
