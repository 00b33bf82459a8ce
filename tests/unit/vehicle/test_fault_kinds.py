"""What holds of faults of every kind: nothing before their time, something from then on, no command changed;
and which cannot be.
"""

import pytest
from broken_vehicle import CYCLE, IGNITION, MORTAR, broken
from given_functions import actuate

import edl6dof
from edl6dof.config.errors import ConfigError
from edl6dof.interface.effectors import THRUSTER_FAILURES
from edl6dof.vehicle.faults.fault import FAULT_KINDS, about
from edl6dof.vehicle.parachutes.parachute import INFLATING

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


BEGINS = 20 * CYCLE


@pytest.fixture(scope="module")
def sound_vehicle(tables):
    return broken(tables)


@pytest.fixture
def of_kind(tables, sound_vehicle):
    """Makes a vehicle with a fault of a kind, and a healthy one."""

    def make(kind):
        name = NAMED.get(about(kind).components[0], "")
        fault = f"{{{name}kind: {kind}, at: {{time_s: {BEGINS}}}}}"
        sound, plant, command = sound_vehicle
        return broken(tables, fault, others=[INSTRUMENTS]), (sound, plant.copy(), command.copy())

    return make


def put_to_use(command, *plants):
    """Mortar, parachute, engine, wing and thrusters, so that each kind finds something to break."""
    command["valve_close_time"][:22], command["thrust"], command["request"][[MORTAR, IGNITION]] = (
        0.7,
        3000.0,
        1,
    )
    for plant in plants:
        plant["canopy"] = INFLATING


@pytest.mark.parametrize("kind", FAULT_KINDS.names)
def test_a_kind_that_is_about_thrusters_says_how_they_fail(kind):
    about_thrusters = set(about(kind).components) <= {"thruster", "branch", "rcs"}
    assert (about(kind).failure in THRUSTER_FAILURES) == about_thrusters


@pytest.mark.parametrize("kind", FAULT_KINDS.names)
def test_every_kind_breaks_the_vehicle_not_before_its_time_and_changes_no_command(of_kind, kind):
    (case, plant, command), (sound_case, sound, _) = of_kind(kind)
    put_to_use(command, plant, sound)
    before = command.tobytes()
    for k in range(60):
        plant["t"] = sound["t"] = k * CYCLE
        actuate(case, command, plant)
        actuate(sound_case, command, sound)
        if k == 19:
            sound["phase_seen"] = plant["phase_seen"]
            assert plant.tobytes() == sound.tobytes()
    assert plant["fault_since"][0] == pytest.approx(BEGINS)
    sound["phase_seen"], sound["fault_since"] = plant["phase_seen"], plant["fault_since"]
    assert plant.tobytes() != sound.tobytes()
    assert command.tobytes() == before


@pytest.mark.parametrize("kind", [kind for kind in FAULT_KINDS.names if about(kind).ends])
def test_a_fault_that_has_ended_leaves_the_vehicle_as_sound_as_before(tables, sound_vehicle, kind):
    """Effects end; what was done meanwhile, such as an event that was delayed, is not undone."""
    name = NAMED.get(about(kind).components[0], "")
    fault = f"{{{name}kind: {kind}, duration_s: 0.4, at: {{time_s: {BEGINS}}}}}"
    case, plant, command = broken(tables, fault, others=[INSTRUMENTS])
    sound = sound_vehicle[1].copy()
    put_to_use(command, plant, sound)
    for k in range(60):
        plant["t"] = sound["t"] = k * CYCLE
        actuate(case, command, plant)
        actuate(sound_vehicle[0], command, sound)
    assert plant["fault_since"][0] == pytest.approx(BEGINS)
    for done in ("phase_seen", "fault_since", "due", "thrust_held"):
        sound[done] = plant[done]
    assert plant.tobytes() == sound.tobytes()


@pytest.mark.parametrize("kind", ["wing_lost", "riser_torn", "canopy_torn"])
def test_a_lost_part_does_not_come_back(kind):
    with pytest.raises(ConfigError, match=rf"faults.0: {kind} cannot end: leave out duration_s and presence"):
        edl6dof.load("tianwen1", [f"faults=[{{kind: {kind}, duration_s: 2, at: {{time_s: 1}}}}]"])


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
