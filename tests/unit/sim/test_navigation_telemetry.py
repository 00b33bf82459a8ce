"""Telemetry of navigation against errors that are put in along north, east and down."""

from math import cos, radians, sin

import numpy as np
import pytest
from pyquaternion import Quaternion

import edl6dof
from edl6dof.fsw.navigation.update import NAVIGATION
from edl6dof.interface.sensed import SENSED
from edl6dof.metrics.evaluation import formed
from edl6dof.metrics.figures import Flown
from edl6dof.scenario.records import build_records, initial_plant
from edl6dof.telemetry.channels import TICK
from edl6dof.telemetry.columns import Telemetry, describe
from edl6dof.telemetry.sample import (
    farthest,
    mask,
    record_claims,
    record_errors,
    record_readings,
)
from edl6dof.vehicle.plant import OUTPUTS

SPIN = 7.08821807e-05


def place(t):
    """A plant at t (s), what follows of its place, and the axes north, east, down in I as columns."""
    loaded = edl6dof.load("tianwen1")
    plant, outputs = initial_plant(loaded.truth, build_records(loaded).case)[0], np.zeros(1, OUTPUTS)[0]
    lat, lon = radians(31.0), radians(-77.0)
    for name, value in zip(
        ("sin_lat", "cos_lat", "sin_lon", "cos_lon"), (sin(lat), cos(lat), sin(lon), cos(lon)), strict=True
    ):
        outputs[name] = value
    outputs["height"] = 812.0
    up = np.array([cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)])
    east = np.array([-sin(lon), cos(lon), 0.0])
    fixed = np.column_stack([np.cross(up, east), east, -up])
    return plant, outputs, Quaternion(axis=(0, 0, 1), radians=SPIN * t).rotation_matrix @ fixed


@pytest.mark.parametrize("t", [0.0, 440.0])
@pytest.mark.parametrize("seed", [1, 2])
def test_errors_that_are_put_in_are_told_along_the_axes_of_the_place(t, seed):
    plant, outputs, ned = place(t)
    rng = np.random.default_rng(seed)
    position, velocity, turn = rng.normal(size=3) * 1e3, rng.normal(size=3), rng.normal(size=3) * 1e-3
    estimate, row = np.zeros(1, NAVIGATION["estimate"])[0], np.zeros(1, TICK["nav"])[0]
    true = Quaternion(plant["y"][6:10])
    angle = np.linalg.norm(turn)
    estimate["r_I"] = plant["y"][:3] + ned @ position
    carried = np.cross((0.0, 0.0, SPIN), ned @ position)  # what the planet does where the estimate is
    estimate["v_I"] = plant["y"][3:6] + ned @ velocity + carried
    estimate["q_I2B"] = (Quaternion(axis=ned @ turn / angle, radians=angle) * true).elements
    estimate["height_above_ground"] = 815.5
    record_errors(plant, outputs, estimate, SPIN, cos(SPIN * t), sin(SPIN * t), row)
    axes = ("north", "east", "down")
    assert [row[f"error_{axis}"] for axis in axes] == pytest.approx(position, abs=1e-8)
    assert [row[f"error_v_{axis}"] for axis in axes] == pytest.approx(velocity, abs=1e-11)
    assert [row[f"error_attitude_{axis}"] for axis in axes] == pytest.approx(turn, abs=1e-12)
    assert row["error_height"] == pytest.approx(3.5)


def test_claims_and_masks_are_those_of_navigation():
    navigation, row = np.zeros(1, NAVIGATION)[0], np.zeros(1, TICK["nav"])[0]
    solution = navigation["solution"]
    solution["sigma_r"], solution["sigma_v"], solution["sigma_attitude"] = (1, 2, 3), (4, 5, 6), (7, 8, 9)
    solution["sigma_height"], solution["beams_used"] = 0.5, 5
    solution["range_innovation"][:4] = (0.1, -2.5, 1.0, 0.0)
    navigation["health"]["gyro"][:6] = (1, 1, 0, 1, 1, 1)
    record_claims(navigation, row)
    assert [row[f"sigma_{axis}"] for axis in ("north", "east", "down")] == [1, 2, 3]
    assert [row[f"sigma_v_{axis}"] for axis in ("north", "east", "down")] == [4, 5, 6]
    assert [row[f"sigma_attitude_{axis}"] for axis in ("north", "east", "down")] == [7, 8, 9]
    assert (row["sigma_height"], row["beams_used"], row["range_innovation"]) == (0.5, 5, 2.5)
    assert row["gyros_in_use"] == 0b111011 == mask(navigation["health"]["gyro"])
    assert farthest(np.array([0.0, -3.0, 2.0])) == 3.0


def test_readings_name_what_is_saturated_and_the_range_of_beams_with_an_echo():
    sensed, log = np.zeros(1, SENSED)[0], np.zeros(1, TICK)
    sensed["inertial"]["gyro_saturated"][[0, 2]] = 1
    sensed["inertial"]["accelerometer_saturated"][1] = 1
    sensed["radar"]["range"][:3], sensed["radar"]["locked"][:3] = (900.0, 800.0, 700.0), (1, 0, 1)
    sensed["branch_used"][:3] = (0.25, 0.5, 9.0)
    record_readings(sensed, 2, log[0])
    telemetry = Telemetry(log, ["D1"], ["left", "mid", "right"], ["a", "b"])
    assert [telemetry[f"metered.{branch}_kg"][0] for branch in "ab"] == [0.25, 0.5]
    assert log["metered"][0, 2] == 0.0
    assert (telemetry["sensed.gyros_saturated"], telemetry["sensed.accelerometers_saturated"]) == (5, 2)
    assert [telemetry[f"range.{beam}_m"][0] for beam in ("left", "mid", "right")] == [900.0, 0.0, 700.0]
    assert list(telemetry.rows(0, 1)) == list(telemetry) and len(telemetry) == len(list(telemetry))
    assert describe("range.left_m")[0] == "m" and "beam left" in describe("range.left_m")[1]


def test_figures_are_lengths_of_the_errors_at_the_moments_that_count():
    log = np.zeros(11, TICK)
    log["t"] = np.arange(11.0)
    log["nav"]["error_north"], log["nav"]["error_east"], log["nav"]["error_down"] = 2.0, 3.0, 6.0
    log["nav"]["error_v_down"] = 0.1 * np.arange(11.0)
    log["nav"]["error_height"] = -np.arange(11.0)
    log["nav"]["error_attitude_north"], log["nav"]["error_attitude_east"] = radians(0.3), radians(0.4)
    log["nav"]["error_attitude_down"] = radians(50.0)
    telemetry = Telemetry(log, [])
    found = formed(Flown(telemetry, {"mortar": 2.0, "ignition": 4.5, "touchdown": 9.0}, []), "navigation")
    assert found == pytest.approx(
        {
            "parachute_nav_position_m": 7.0,
            "ignition_nav_height_m": -4.5,
            "ignition_nav_velocity_m_s": 0.45,
            "touchdown_nav_height_m": -8.0,
            "touchdown_nav_velocity_m_s": 0.8,
            "touchdown_nav_vertical_deg": 0.5,
        }
    )
    assert formed(Flown(telemetry, {"mortar": 2.0}, []), "navigation") == pytest.approx(
        {"parachute_nav_position_m": 7.0}
    )
