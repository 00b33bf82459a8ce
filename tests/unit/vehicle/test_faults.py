"""A fault changes what the actuators do, not what they are told, from its time on.

The oracle is the impulse of a rectangular pulse: thrust times open time, because valves rise and fall in the
same time.
"""

import json

import numpy as np
import pytest

import edl6dof
from edl6dof.config.errors import ConfigError
from edl6dof.interface.command import COMMAND
from edl6dof.interface.events import DEPLOY
from edl6dof.scenario.records import build_case, build_tables, initial_plant
from edl6dof.vehicle.actuate import actuate
from edl6dof.vehicle.faults.registry import FAULT_KINDS, components_of
from edl6dof.vehicle.parachutes.parachute import INFLATING, RELEASED
from edl6dof.vehicle.plant import THRUST
from edl6dof.vehicle.propulsion.rcs import fire

CYCLE = 0.02
D7, D8 = 6, 7
PARACHUTE_PHASE = edl6dof.load("tianwen1").scenario.phase_names.index("parachute")

#: Numbers of two events of the mission.
MORTAR, IGNITION = (
    list(edl6dof.load("tianwen1").scenario.mission.events).index(name) for name in ("mortar", "ignition")
)


@pytest.fixture(scope="module")
def tables():
    return build_tables(edl6dof.load("tianwen1").scenario)


def broken(tables, *faults, others=()):
    """Case, plant and an idle command of a vehicle with these faults."""
    scenario = edl6dof.load("tianwen1", [*others, f"faults=[{', '.join(faults)}]"]).scenario
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
    command["shut"][case["branches"]["of"][D7]] = 1
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
        command["closes"] = 0.0
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


# ---- one of several ----------------------------------------------------------------------------


def doubled(items, *names):
    """Override: the only one of a list of the vehicle as often as there are names."""
    one = getattr(edl6dof.load("tianwen1").scenario.vehicle, items)[0].model_dump(mode="json")
    return f"vehicle.{items}={json.dumps([{**one, 'name': name} for name in names])}"


def mission(change):
    """Override: the events of the phases with ``change(event)``, one or several, in the place of each."""
    phases = edl6dof.load("tianwen1").scenario.mission.phases
    table = [phase.model_dump(mode="json", exclude_none=True) for phase in phases]
    for phase in table:
        phase["events"] = [new for event in phase.get("events", []) for new in change(event)]
    return f"mission.phases={json.dumps(table)}"


def of_first_engine(event):
    return [{**event, "thing": "left"} if event["action"] in ("ignite", "cut_off") else event]


TWO_ENGINES = (doubled("engines", "left", "right"), mission(of_first_engine))


def test_only_the_engine_that_is_named_loses_thrust(tables):
    fault = "{kind: engine_shortfall, engine: right, engine_shortfall: {thrust_factor: 0.7}, at: {time_s: 0}}"
    case, plant, command = broken(tables, fault, others=TWO_ENGINES)
    actuate(case, command, plant)
    assert plant["thrust_lost"] == pytest.approx([0.0, 0.3, 0.0, 0.0])


def test_only_the_throttle_that_is_named_is_stuck(tables):
    fault = "{kind: throttle_stuck, engine: right, at: {time_s: 0}}"
    case, plant, command = broken(tables, fault, others=TWO_ENGINES)
    plant["running"][:2], plant["y"][THRUST : THRUST + 2] = 1, (3000.0, 3300.0)
    command["thrust"][:2] = 2000.0
    actuate(case, command, plant)
    assert plant["thrust_command"] == pytest.approx([2000.0, 3300.0, 0.0, 0.0])


@pytest.mark.parametrize("kind", ["wing_lost", "wing_stuck"])
def test_only_the_surface_that_is_named_fails(tables, kind):
    two = doubled("surfaces", "trim_wing", "other")
    case, plant, command = broken(
        tables, f"{{kind: {kind}, surface: other, at: {{time_s: 0}}}}", others=[two]
    )
    actuate(case, command, plant)
    assert list(plant["wing_lost"][:2]) == [0.0, 1.0]


def test_only_the_parachute_that_is_named_is_late(tables):
    def two_mortars(event):
        first = {**event, "name": "first", "thing": "drogue"}
        return [first, event] if event["action"] == "deploy" else [event]

    others = [doubled("parachutes", "drogue", "main"), mission(two_mortars)]
    fault = "{kind: parachute_delay, parachute: main, parachute_delay: {delay_s: 2.5}, at: {time_s: 0}}"
    case, plant, command = broken(tables, fault, others=others)
    command["request"][[0, 1, 2]] = 1
    actuate(case, command, plant)
    deployed = case["events"]["events"]["action"][:3] == DEPLOY
    assert plant["due"][:3][deployed] == pytest.approx([0.015, 0.015 + 2.5])


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ("kind: engine_shortfall", "faults.0: engine_shortfall must name its engine; names: left, right"),
        ("kind: throttle_stuck, engine: main", "faults.0.engine: no engine named 'main'; names: left, right"),
    ],
)
def test_one_of_several_must_be_named(fault, words):
    with pytest.raises(ConfigError) as refusal:
        edl6dof.load("tianwen1", [*TWO_ENGINES, f"faults=[{{{fault}, at: {{time_s: 1}}}}]"])
    assert words in str(refusal.value)


def test_a_surface_must_be_there_to_fail():
    with pytest.raises(ConfigError) as refusal:
        edl6dof.load(
            "tianwen1",
            ["vehicle.surfaces=[]", mission(without_wing), "faults=[{kind: wing_lost, at: {time_s: 1}}]"],
        )
    assert "faults.0: wing_lost must name its surface; names: none" in str(refusal.value)


def without_wing(event):
    return [] if event["thing"] == "trim_wing" else [event]


# ---- all kinds ---------------------------------------------------------------------------------


INSTRUMENTS = (
    "sensors.carried=[perfect, imu, inertial_unit, star_tracker, ground_tracking, radar, flow_meters, "
    "landing_camera, lidar, stereo]"
)
NAMED = {
    "landing_camera": "stereo: stereo, ",
    "thruster": "thruster: D7, ",
    "branch": "branch: D47, ",
    "gyro": "gyro: g2, ",
    "beam": "beam: b3, ",
}


def of_kind(tables, kind, time_s):
    """A vehicle with a fault of this kind, and a sound one."""
    name = NAMED.get(components_of(kind)[0], "")
    fault = f"{{{name}kind: {kind}, at: {{time_s: {time_s}}}}}"
    return broken(tables, fault, others=[INSTRUMENTS]), broken(tables)


def put_to_use(command, *plants):
    """Mortar, parachute, engine, wing and thrusters, so that each kind finds something to break."""
    command["closes"][:22], command["thrust"], command["request"][[MORTAR, IGNITION]] = 0.7, 3000.0, 1
    for plant in plants:
        plant["canopy"] = INFLATING


@pytest.mark.parametrize("kind", FAULT_KINDS.names)
def test_no_kind_does_anything_before_its_time(tables, kind):
    (case, plant, command), (sound_case, sound, _) = of_kind(tables, kind, 1.0)
    put_to_use(command, plant, sound)
    for k in range(40):
        plant["t"] = sound["t"] = k * CYCLE
        actuate(case, command, plant)
        actuate(sound_case, command, sound)
    sound["phase_seen"] = plant["phase_seen"]
    assert plant.tobytes() == sound.tobytes()


@pytest.mark.parametrize("kind", FAULT_KINDS.names)
def test_every_kind_breaks_the_vehicle_and_changes_no_command(tables, kind):
    (case, plant, command), (sound_case, sound, _) = of_kind(tables, kind, 0.1)
    put_to_use(command, plant, sound)
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
        ("{kind: hardover, at: {time_s: 1}}", "faults.0: hardover must name one gyro or accelerometer"),
        (
            "{beam: b1, kind: hardover, at: {time_s: 1}}",
            "faults.0: hardover is about one gyro or accelerometer and nothing else (got beam 'b1')",
        ),
        (
            "{gyro: g1, accelerometer: a1, kind: hardover, at: {time_s: 1}}",
            "and nothing else (got gyro 'g1', accelerometer 'a1')",
        ),
        (
            "{kind: false_lock, at: {time_s: 1}}",
            "faults.0: false_lock must name its beam; names: b1, b2, b3, b4",
        ),
        (
            "{thruster: D7, kind: wing_lost, at: {time_s: 1}}",
            "faults.0: wing_lost is about one surface and nothing else (got thruster 'D7')",
        ),
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
