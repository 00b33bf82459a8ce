"""What landing camera, lidar and stereo cameras have in common."""

from itertools import product

import numpy as np
import pytest
from given_functions import actuate, inflict
from hovering import Hovering, area

import edl6dof
from edl6dof.interface.command import COMMAND
from edl6dof.interface.sensed import cell_direction
from edl6dof.records import first_not_finite
from edl6dof.scenario.records import build_records, initial_plant
from edl6dof.vehicle.mass import CONFIG_BACKSHELL, CONFIG_CAPSULE

IMAGERS = ("landing_camera", "lidar", "stereo")
GROUND = area()
#: What the flight computer of Tianwen-1 needs, and the imagers.
READINGS = "inertial_unit, star_tracker, ground_tracking, radar, switches"
CARRIED = f"sensors.carried=[{READINGS}, landing_camera, lidar, stereo]"


@pytest.mark.parametrize("cells", [64, 128, 256])
def test_cells_divide_the_plane_across_the_line_of_sight(cells):
    tangent = np.tan(np.radians(20.0))
    looks = np.array([[cell_direction(tangent, cells, i, j) for j in range(cells)] for i in range(cells)])
    assert np.allclose(np.linalg.norm(looks, axis=2), 1.0, atol=1e-14)
    y, z = looks[..., 1] / looks[..., 0], looks[..., 2] / looks[..., 0]
    middles = tangent * (np.arange(cells) - 0.5 * (cells - 1)) / (0.5 * cells)
    assert np.allclose(y, middles[None, :], atol=1e-14) and np.allclose(z, middles[:, None], atol=1e-14)
    corner = cell_direction(tangent, cells, -0.5, cells - 0.5)
    assert (corner[1] / corner[0], corner[2] / corner[0]) == pytest.approx((tangent, -tangent))


def test_flight_computer_believes_the_imagers_that_are_carried():
    carried = [CARRIED, "sensors.lidar.range_noise_m=0.05", "sensors.lidar.quantum_m=0.12"]
    imagers = build_records(edl6dof.load("tianwen1", carried)).onboard[0]["instruments"]["imagers"]
    assert tuple(imagers["lidar"]["place"]) == (-0.5, 0.6, 0.0)
    assert imagers["lidar"]["tangent"] == pytest.approx(np.tan(np.radians(14.0)))
    assert imagers["camera"]["tangent"] == pytest.approx(np.tan(np.radians(30.0)))
    assert imagers["lidar"]["sigma"] == pytest.approx(np.sqrt(0.05**2 + 0.12**2 / 12.0))
    # 0.1 px over 1.5 m and a focal length of 1024 px / tan(14 deg)
    assert imagers["stereo"]["sigma_square"] == pytest.approx(0.1 / (1024.0 / np.tan(np.radians(14.0)) * 1.5))
    none = build_records(edl6dof.load("tianwen1")).onboard[0]["instruments"]["imagers"]
    assert [none[name]["tangent"] for name in ("camera", "lidar", "stereo")] == [0.0, 0.0, 0.0]


def test_imagers_stay_where_ideal_sensors_fly():
    loaded = edl6dof.load(
        "tianwen1", [CARRIED.replace("perfect, imu", "perfect, radar, imu"), "sensors.set=perfect"]
    )
    assert loaded.scenario.sensors.flown == ["perfect", "imu", "landing_camera", "lidar", "stereo"]


def test_commands_reach_the_imagers_for_a_cycle():
    loaded = edl6dof.load("tianwen1")
    case = build_records(loaded).case
    plant, command = initial_plant(loaded.truth, case)[0], np.zeros(1, COMMAND)[0]
    for expose, scan in ((1, 0), (0, 1), (0, 0)):
        command["camera_trigger"], command["scan"] = expose, scan
        actuate(case[0], command, plant)
        assert (plant["imagers"]["camera_trigger"], plant["imagers"]["scan"]) == (expose, scan)


@pytest.mark.parametrize("name", IMAGERS)
@pytest.mark.parametrize(
    "value",
    [np.nan, pytest.param(np.inf, marks=pytest.mark.long), pytest.param(-1e300, marks=pytest.mark.long)],
)
def test_images_are_finite_whatever_the_vehicle_does(name, value):
    for place, turns in product(range(13), ((0.0, 0.0, 0.0), (0.0, 80.0, 0.0))):
        bench = Hovering(name, GROUND, turns=turns)
        bench.plant["y"][place] = value
        for record in (bench.measure(), bench.memory):
            assert first_not_finite(np.array([record], record.dtype)) is None


@pytest.mark.parametrize("name, record, image", [
    ("landing_camera", "camera", "seen"), ("lidar", "lidar", "range"), ("stereo", "stereo", "range"),
])  # fmt: skip
def test_imagers_see_nothing_through_the_heat_shield(name, record, image):
    for shape, sees in ((CONFIG_CAPSULE, False), (CONFIG_BACKSHELL, True)):
        bench = Hovering(name, GROUND)
        bench.plant["shape"] = shape
        assert np.any(bench.measure()[record][image]) == sees
        assert bench.sensed[record]["fresh"] == 1


def with_fault(bench, fault):
    """Inflict a fault that has begun on the plant of a bench."""
    loaded = edl6dof.load("tianwen1", [CARRIED, f"faults=[{{{fault}, at: {{time_s: 0}}}}]"])
    inflict(build_records(loaded).case[0], np.zeros(1, COMMAND)[0], bench.plant)
    return bench


@pytest.mark.parametrize("name, record", [*zip(IMAGERS, ("camera", "lidar", "stereo"), strict=True)])
def test_an_eye_that_is_lost_makes_no_images_and_the_others_do(name, record):
    for lost in IMAGERS:
        bench = with_fault(Hovering(name, GROUND), f"{lost}: {lost}, kind: images_lost")
        assert bench.measure()[record]["fresh"] == (lost != name)


def test_a_scan_under_way_ends_when_the_lidar_is_lost():
    bench = Hovering("lidar", GROUND)
    assert bench.measure()["lidar"]["fresh"] == 1
    bench.plant["imagers"]["scan"], bench.plant["instruments"]["lidar_lost"] = 0, 1
    assert bench.measure()["lidar"]["fresh"] == 0
    bench.plant["instruments"]["lidar_lost"] = 0
    assert bench.measure()["lidar"]["fresh"] == 0


def test_a_mirror_that_is_stuck_shows_one_block_of_rows_all_over():
    exact = {"dropout": 0.0, "range_noise_m": 0.0}
    sound = Hovering("lidar", GROUND, exact).scan()
    bench, rows = Hovering("lidar", GROUND, exact), []
    for k in range(64):
        bench.plant["imagers"]["scan"] = 1 if k == 0 else 0
        if k == 20:
            with_fault(bench, "kind: mirror_stuck")
        told = bench.measure()["lidar"]
        assert told["row"] == 4 * k
        rows.append(told["range"].copy())
    assert np.array_equal(np.vstack(rows[:20]), sound[:80])
    assert all(np.array_equal(block, sound[76:80]) for block in rows[20:])
