"""Each kind of instrument fault as it shows in the reading: from its time on, in that reading alone."""

import json

import numpy as np
import pytest
from given_functions import inflict
from instrument_bench import Bench
from scipy.spatial.transform import Rotation
from test_flow_meters import meters
from test_inertial_unit import unit
from test_radar import UP, radar
from test_star_tracker import TRUE, tracker

import edl6dof
from edl6dof.interface.command import COMMAND
from edl6dof.scenario.records import build_records

H = 0.02
DEG = np.pi / 180.0
CARRIED = ["sensors.carried=[perfect, imu, inertial_unit, star_tracker, ground_tracking, radar, flow_meters]"]
#: Names of the axes of the bench's unit and of the radar's beams, as the scenario has them.
NAMES = [
    *(f"sensors.inertial_unit.{kind}.axes=[{{name: x, axis: [1, 0, 0]}}, {{name: y, axis: [0, 1, 0]}}]"
      for kind in ("gyros", "accelerometers")),
]  # fmt: skip


def faulty(bench, fault, cycles=100, sets=(), **motion):
    """Readings over two seconds, with a fault that begins after one."""
    loaded = edl6dof.load("tianwen1", [*CARRIED, *NAMES, *sets, f"faults=[{{{fault}, at: {{time_s: 1}}}}]"])
    case, command = build_records(loaded).case[0], np.zeros(1, COMMAND)[0]
    rows = []
    for k in range(cycles):
        bench.put(t=k * H)
        bench.plant["velocity_gain"] = np.array(motion.get("force", (0.0, 0.0, 0.0))) * k * H
        bench.plant["branch_used"] = motion.get("flow", 0.0) * k * H
        rows.append(bench.measure(w=motion.get("rate", (0.0, 0.0, 0.0))).copy())
        inflict(case, command, bench.plant)
    return np.array(rows, dtype=rows[0].dtype)


def steps(rows, kind, axis):
    """What was counted from one cycle to the next, over the cycle: mean rate or specific force."""
    return np.diff(rows["inertial"][kind][:, axis]) / H


@pytest.mark.parametrize("name, kind, unit_", [("gyro", "angle", DEG), ("accelerometer", "gain", 1.0)])
@pytest.mark.parametrize(
    "fault, first, last",
    [
        ("reading_bias, reading_bias: {rate_deg_s: 0.5, acceleration_m_s2: 0.5}", 0.5, 0.5),
        ("reading_drift, reading_drift: {rate_deg_s2: 0.1, acceleration_m_s3: 0.1}", 0.0, 0.1 * 0.96),
        (
            "reading_bias, reading_bias: {rate_deg_s: 0.5, acceleration_m_s2: 0.5}, duration_s: 0.5",
            0.5,
            0.0,
        ),
    ],
)
def test_bias_and_drift_are_counted_from_their_time_on(name, kind, unit_, fault, first, last):
    rows = faulty(unit(), f"{name}: y, kind: {fault}")
    found = steps(rows, kind, 1) / unit_
    assert np.all(found[:50] == 0.0)
    assert found[50] == pytest.approx(first, abs=1e-9) and found[-1] == pytest.approx(last, abs=1e-9)
    assert not rows["inertial"][kind][:, [0, 2]].any()


def test_noise_has_its_standard_deviation():
    fault = "gyro: x, kind: reading_noise, reading_noise: {rate_deg_s: 2.0}"
    found = steps(faulty(unit(), fault, cycles=650), "angle", 0) / DEG
    assert np.all(found[:50] == 0.0)
    assert found[50:].std() == pytest.approx(2.0, rel=5.0 / np.sqrt(1200.0))


def test_stuck_goes_on_as_before_and_an_outage_counts_nothing():
    """The force changes sign with the fault's time: only what is stuck does not notice."""
    for kind, after in (("reading_stuck", 3.0), ("reading_outage", 0.0)):
        bench = unit()
        loaded = edl6dof.load(
            "tianwen1", [*CARRIED, *NAMES, f"faults=[{{accelerometer: x, kind: {kind}, at: {{time_s: 1}}}}]"]
        )
        case, command = build_records(loaded).case[0], np.zeros(1, COMMAND)[0]
        gain, rows = 0.0, []
        for k in range(100):
            gain += (3.0 if k <= 50 else -3.0) * H
            bench.plant["velocity_gain"] = (gain, gain, 0.0)
            rows.append(bench.measure(t=k * H)["inertial"]["gain"][:2].copy())
            inflict(case, command, bench.plant)
        found = np.diff(rows, axis=0) / H
        np.testing.assert_allclose(found[:50], 3.0)
        np.testing.assert_allclose(found[50:, 0], after, atol=1e-9)
        np.testing.assert_allclose(found[50:, 1], -3.0)


def test_hardover_is_the_end_of_the_range_without_a_flag_and_saturation_with_one():
    for kind, flag, sign in (("hardover", 0, 1.0), ("saturation", 1, -1.0)):
        bench = unit(accelerometers={"range_g0": 2.0})
        rows = faulty(bench, f"accelerometer: x, kind: {kind}", force=(-1.0, 0.0, 0.0))
        found = steps(rows, "gain", 0)
        np.testing.assert_allclose(found[:50], -1.0)
        np.testing.assert_allclose(found[50:], sign * 2.0 * 9.80665)
        flags = rows["inertial"]["accelerometer_saturated"]
        assert not flags[:51].any() and np.all(flags[51:, 0] == flag) and not flags[:, 1:].any()


def test_all_gyros_saturate_for_a_second():
    rows = faulty(unit({"persistence_s": 0.1}), "kind: gyros_saturated", cycles=150)
    flags = rows["inertial"]["gyro_saturated"][:, :3]
    assert not flags[:51].any() and flags[51:101].all() and flags[101:105].all() and not flags[107:].any()
    assert np.abs(rows["inertial"]["rate"][60, :3]) == pytest.approx(330.0 * DEG)


def test_star_tracker_loses_the_stars_for_a_while():
    outage = "star_tracker: s1, kind: reading_outage, duration_s: 0.4"
    valid = faulty(tracker(), outage)["stars"]["valid"]
    assert valid[:51].all() and not valid[51:71, 0].any() and valid[51:71, 1].all() and valid[71:].all()


@pytest.mark.parametrize(
    "fault, first, last",
    [
        ("reading_bias, reading_bias: {attitude_deg: 0.3}", 0.3, 0.3),
        ("reading_drift, reading_drift: {attitude_deg_s: 0.1}", 0.0, 0.096),
    ],
)
def test_star_tracker_is_turned_about_the_diagonal_by_its_fault(fault, first, last):
    ideal = dict(noise_arcsec=0.0, boresight_noise_arcsec=0.0, misalignment_arcsec=0.0)
    rows = faulty(tracker(**ideal), f"star_tracker: s2, kind: {fault}")["stars"]["q_I2B"]
    read = Rotation.from_quat(rows.reshape(-1, 4), scalar_first=True)
    off = np.degrees((TRUE.inv() * read).as_rotvec()).reshape(-1, 2, 3)
    diagonal = np.full(3, np.sqrt(1.0 / 3.0))
    np.testing.assert_allclose(off[:, 0], 0.0, atol=1e-9)
    np.testing.assert_allclose(off[[50, 51, -1], 1], np.outer([0.0, first, last], diagonal), atol=1e-6)


def test_star_tracker_sticks_and_scatters():
    held = faulty(tracker(), "star_tracker: s1, kind: reading_stuck")["stars"]
    assert held["valid"].all() and np.ptp(held["q_I2B"][50:, 0], axis=0).max() == 0.0
    assert np.ptp(held["q_I2B"][:51, 0], axis=0).max() > 0.0 < np.ptp(held["q_I2B"][50:, 1], axis=0).max()
    ideal = dict(noise_arcsec=0.0, boresight_noise_arcsec=0.0, misalignment_arcsec=0.0)
    noise = "star_tracker: s1, kind: reading_noise, reading_noise: {attitude_deg: 0.2}"
    rows = faulty(tracker(**ideal), noise, cycles=650)["stars"]["q_I2B"][51:, 0]
    read = Rotation.from_quat(rows, scalar_first=True)
    size = np.degrees((TRUE.inv() * read).as_rotvec()) @ np.full(3, np.sqrt(1.0 / 3.0))
    assert size.std() == pytest.approx(0.2, rel=5.0 / np.sqrt(1200.0))


@pytest.mark.parametrize(
    "fault, distance, speed, locked",
    [
        ("reading_bias, reading_bias: {range_m: 30.0, speed_m_s: -4.0}", 30.0, -4.0, 1),
        ("reading_drift, reading_drift: {range_m_s: 10.0, speed_m_s2: 1.0}", 9.6, 0.96, 1),
        ("reading_outage", None, None, 0),
    ],
)
def test_beam_is_off_by_its_fault(fault, distance, speed, locked):
    rows = faulty(radar(1000.0, v=-50.0 * UP), f"beam: b2, kind: {fault}")["radar"]
    assert rows["locked"][:51, :4].all() and rows["locked"][-1, 1] == locked
    if locked:
        assert rows["range"][-1, 1] - rows["range"][0, 1] == pytest.approx(distance, abs=0.1)
        assert rows["speed"][-1, 1] - rows["speed"][0, 1] == pytest.approx(speed, abs=0.01)
    assert np.ptp(rows["range"][:, [0, 2, 3]], axis=0).max() < 1e-6  # the planet turns


def test_a_dead_radar_has_no_echo_on_any_of_its_beams_and_the_other_radar_has():
    beams = [
        {"name": name, "axis": (0.8, 0.6 * y, 0.6 * z), "radar": number}
        for name, y, z, number in (("a", 1, 0, 1), ("b", 0, 1, 2), ("c", -1, 0, 2), ("d", 0, -1, 1))
    ]
    fault = "radar: r2, kind: reading_outage, duration_s: 0.4"
    sets = [f"sensors.radar.beams={json.dumps(beams)}"]
    locked = faulty(radar(1000.0, beams=beams), fault, sets=sets)["radar"]["locked"]
    assert locked[:51, :4].all() and locked[51:71, [0, 3]].all() and locked[71:, :4].all()
    assert not locked[51:71, [1, 2]].any()


def test_beam_sticks_scatters_and_locks_on_nothing_real():
    bench = radar(1000.0, range_noise_m=1.0)
    held = faulty(bench, "beam: b1, kind: reading_stuck")["radar"]["range"]
    assert np.ptp(held[:51, 0]) > 0.0 and np.ptp(held[50:, 0]) == 0.0 and np.ptp(held[51:, 1]) > 0.0
    noisy = faulty(radar(1000.0), "beam: b1, kind: reading_noise, reading_noise: {range_m: 9.0}", cycles=450)
    assert noisy["radar"]["range"][51:, 0].std() == pytest.approx(9.0, rel=5.0 / np.sqrt(800.0))
    false = "beam: b1, kind: false_lock, false_lock: {range_m: 77.0, speed_m_s: 3.0}"
    locked = faulty(radar(9000.0), false)["radar"]
    assert not locked["locked"][:51].any() and not locked["locked"][:, 1:].any()
    assert np.all(locked["range"][51:, 0] == 77.0) and np.all(locked["speed"][51:, 0] == 3.0)
    assert locked["locked"][51:, 0].all()


@pytest.mark.parametrize(
    "fault, first, last",
    [
        ("reading_bias, reading_bias: {flow_kg_s: 0.03}", 0.13, 0.13),
        ("reading_drift, reading_drift: {flow_kg_s2: 0.01}, duration_s: 0.9", 0.1, 0.1),
        pytest.param("reading_drift, reading_drift: {flow_kg_s2: 0.01}", 0.1, 0.1096, marks=pytest.mark.long),
        pytest.param("reading_outage", 0.0, 0.0, marks=pytest.mark.long),
        ("reading_outage, duration_s: 0.5", 0.0, 0.1),
    ],
)
def test_flow_meter_is_off_by_its_fault(fault, first, last):
    counts = faulty(meters(), f"flow_meter: A13, kind: {fault}", flow=0.1)["branch_used"][:, :11]
    flow = np.diff(counts, axis=0) / H
    np.testing.assert_allclose(flow[:50], 0.1)
    assert flow[[50, -1], 4] == pytest.approx([first, last], abs=1e-9)
    np.testing.assert_allclose(np.delete(flow, 4, axis=1), 0.1)


def test_flow_meter_sticks_and_scatters():
    noise = "flow_meter: D16, kind: reading_noise, reading_noise: {flow_kg_s: 0.02}"
    flow = np.diff(faulty(meters(), noise, cycles=650, flow=0.1)["branch_used"][:, :2], axis=0) / H
    assert flow[50:, 0].std() == pytest.approx(0.02, rel=5.0 / np.sqrt(1200.0))
    assert flow[50:, 0].mean() == pytest.approx(0.1, abs=5.0 * 0.02 / np.sqrt(600.0))
    np.testing.assert_allclose(flow[:, 1], 0.1)
    stuck = "flow_meter: D16, kind: reading_stuck"
    held = np.diff(faulty(meters(noise_pct=1.0), stuck, flow=0.1)["branch_used"][:, :2], axis=0) / H
    np.testing.assert_allclose(held[50:, 0], held[49, 0])
    assert held[:50, 0].std() > 0.0 and held[50:, 1].std() > 0.0


def test_sound_instruments_on_the_same_bench_say_nothing():
    assert not faulty(unit(), "star_tracker: s1, kind: reading_outage")["inertial"]["angle"].any()
    assert Bench("inertial_unit").plant["instruments"].tobytes() == bytes(
        Bench("inertial_unit").plant["instruments"].nbytes
    )
