"""Instruments on a real flight: what they read agrees with the truth, and goes on from a saved state."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import edl6dof
from edl6dof.scenario import records
from edl6dof.sim import loop
from edl6dof.sim.flight import fly
from edl6dof.sim.functions import functions_of
from edl6dof.telemetry.channels import BRIEF, TICK
from edl6dof.vehicle.plant import OUTPUTS, WORKSPACE

CARRIED = (
    "sensors.carried=[perfect, imu, inertial_unit, star_tracker, ground_tracking, switches, radar]",
    "flight_software.navigation.filter=given",
)
IDEAL = [
    *(f"sensors.inertial_unit.gyros.{name}=0" for name in
      ("bias_deg_h", "bias_walk_deg_h_sqrt_h", "noise_deg_sqrt_h", "scale_ppm", "misalignment_arcsec",
       "quantum_arcsec", "bandwidth_hz")),
    *(f"sensors.inertial_unit.accelerometers.{name}=0" for name in
      ("bias_ug", "bias_walk_ug_sqrt_h", "noise_ug_sqrt_hz", "scale_ppm", "misalignment_arcsec",
       "quantum_m_s")),
    "sensors.inertial_unit.delay_cycles=0",
    "sensors.inertial_unit.vibration={rate_deg_s: 0, acceleration_m_s2: 0}",
]  # fmt: skip


@pytest.fixture(scope="module")
def carried():
    """A flight with all instruments beside the ideal ones, and a state of it under the parachute."""
    loaded = edl6dof.load("tianwen1", [*CARRIED])
    return loaded, fly(loaded, save_at_s=276.0)


def cycles(loaded, state, count):
    """Plant and centre of mass at the start of each cycle from a saved state on, and what is sensed in it."""
    case, tables, onboard = records.build_records(loaded)
    plant, peaks, sensors, fsw = (one.copy() for one in (state.plant, state.peaks, state.sensors, state.fsw))
    outputs, work = np.zeros(1, OUTPUTS), np.zeros(1, WORKSPACE)
    log, brief = np.zeros(0, TICK), np.zeros(4, BRIEF)
    steps = loaded.scenario.steps_per_cycle
    loop.take_up(case, plant, fsw)
    sensors["inertial_unit"] = 0
    flown = (functions_of(case, onboard[0]), case, onboard, tables, plant, outputs, peaks, work, sensors, fsw)
    for k in range(state.cycle, state.cycle + count):
        before, centre = plant[0].copy(), outputs[0]["centre"].copy()
        loop.fly(*flown, k, k + 1, 0, steps, log, brief, 0)
        if k > state.cycle:
            yield before, centre, sensors[0]["sensed"]["inertial"]


def test_flight_with_instruments_goes_on_from_a_saved_state_bit_for_bit(carried):
    loaded, whole = carried
    late = fly(loaded, save_at_s=500.0)
    rest = fly(loaded, start=whole.saved, save_at_s=500.0)
    assert rest.plant.tobytes() == whole.plant.tobytes()
    assert rest.saved.sensors.tobytes() == late.saved.sensors.tobytes()
    assert late.saved.sensors["sensed"]["radar"]["locked"].any()


def test_another_seed_has_other_errors_and_the_same_flight_the_same(carried):
    loaded, whole = carried
    again = fly(loaded, save_at_s=276.0)
    assert again.saved.sensors.tobytes() == whole.saved.sensors.tobytes()
    other = records.build_records(edl6dof.load("tianwen1", [*CARRIED, "seed=2"])).case["sensors"]["unit"]
    same = records.build_records(loaded).case["sensors"]["unit"]
    for name in ("inertial_unit", "star_tracker", "ground_tracking", "radar"):
        assert other[name].tobytes() != same[name].tobytes()


def test_counts_of_an_ideal_unit_carry_the_state_over_mortar_and_heat_shield(carried):
    """From 276 s to 320 s by midpoint integration written out here, with the true gravity: the recoil of
    separations, the snatch of the lines and the swinging lever arm are all in the counts.
    """
    _, whole = carried
    loaded = edl6dof.load("tianwen1", [*CARRIED, *IDEAL])
    axes = np.array([one.axis for one in loaded.scenario.sensors.inertial_unit.gyros.axes])
    solve = np.linalg.pinv(axes)
    place = np.array(loaded.scenario.sensors.inertial_unit.position_m)
    state, h, last = whole.saved, 0.02, None
    for before, centre, read in cycles(loaded, state, 2200):
        angle, gain = solve @ read["angle"][:6], solve @ read["gain"][:6]
        y, g = before["y"], gravity(before, loaded)
        swing = rotated(y, np.cross(y[10:13], place - centre))  # of the unit about the centre of mass
        if last is None:
            q, v = Rotation.from_quat(y[6:10], scalar_first=True), y[3:6] + swing
        else:
            turn, felt = angle - last[0], gain - last[1]
            half = q * Rotation.from_rotvec(0.5 * turn)
            v = v + half.apply(felt) + 0.5 * h * (g + last[2])
            q = q * Rotation.from_rotvec(turn)
        last = (angle, gain, g)
    true = Rotation.from_quat(y[6:10], scalar_first=True)
    assert state.plant["attached"].sum() - before["attached"].sum() == 2
    assert np.degrees((q.inv() * true).magnitude()) < 0.005
    assert np.abs(v - (y[3:6] + swing)).max() < 0.02


def rotated(y, vector):
    return Rotation.from_quat(y[6:10], scalar_first=True).apply(vector)


def gravity(plant, loaded):
    """Gravitation at the vehicle: the central term here, the rest as the plant holds it."""
    r = plant["y"][:3]
    mu = loaded.scenario.planet.gravity.mu_m3_s2
    return -mu * r / np.linalg.norm(r) ** 3 + plant["inputs"]["noncentral_I"]


def test_fault_of_an_instrument_is_an_event_and_breaks_no_more_than_its_reading(carried):
    """With ideal instruments beside it, whose word is taken, the flight stays what it was."""
    _, whole = carried
    fault = "faults=[{gyro: g3, kind: hardover, at: {phase: parachute, plus_s: 5}}]"
    broken = fly(edl6dof.load("tianwen1", [*CARRIED, fault]), save_at_s=400.0)
    said = [event["name"] for event in broken.events if event["key"] == "fault"]
    assert said == ["fault: g3 hardover"]
    assert broken.plant["y"].tobytes() == whole.plant["y"].tobytes()
    reading = broken.saved.sensors["sensed"]["inertial"]["rate"][0]
    limit = np.radians(330.0)
    assert reading[2] == pytest.approx(limit) and np.abs(np.delete(reading, 2)).max() < 0.1 * limit


def test_stars_are_seen_until_the_event_that_is_named_and_not_missed_after_it(nominal):
    """All the way down to the trim wing: the attitude is known better until then, and drifts after."""
    stars = "sensors.star_tracker={until: trim_wing, lowest_m: -1.0e+4, rate_deg_s: 10}"
    flight = edl6dof.fly("tianwen1", [stars])
    wing = flight.figures["trim_wing_s"]
    before, at, after, usual = (
        one.telemetry.at(t, "nav.sigma_attitude_down_deg")[0]
        for one, t in ((flight, wing - 20.0), (flight, wing), (flight, wing + 60.0), (nominal, wing))
    )
    assert max(before, at) < 0.7 * usual
    assert before == pytest.approx(at, rel=0.05)
    assert after > 1.1 * at
    assert flight.exclusions == [] and flight.landed
