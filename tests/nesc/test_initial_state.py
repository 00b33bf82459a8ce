"""The two ways of giving velocity and attitude at t = 0 agree, and contradictions are refused at their
keys.
"""

import numpy as np
import pytest
from pyquaternion import Quaternion

import edl6dof
from edl6dof.config.errors import ConfigError
from edl6dof.scenario.records import build_case, build_tables, initial_plant


def start(*overrides):
    scenario = edl6dof.load(
        "nesc/case06", ["initial={altitude_m: 1000, latitude_deg: 35, longitude_deg: 20}", *overrides]
    ).scenario
    return initial_plant(scenario, build_case(scenario, build_tables(scenario)))["y"][0]


PATH = ("initial.speed_m_s=100", "initial.flight_path_angle_deg=-30", "initial.azimuth_deg=120")
NED = "initial.velocity_ned_m_s=[-43.30127018922193, 75.0, 50.0]"


@pytest.mark.parametrize("vertical", ["geodetic", "geocentric"])
def test_components_and_angles_give_the_same_velocity(vertical):
    both = [start(*words, f"initial.vertical={vertical}")[:6] for words in (PATH, (NED,))]
    assert np.allclose(*both, rtol=0.0, atol=1e-9)


def test_euler_angles_are_from_geodetic_north_east_down():
    q = Quaternion(start(NED, "initial.yaw_pitch_roll_deg=[30, -20, 10]")[6:10])
    lat, lon = np.radians([35.0, 20.0])
    north = np.array([-np.sin(lat) * np.cos(lon), -np.sin(lat) * np.sin(lon), np.cos(lat)])
    east = np.array([-np.sin(lon), np.cos(lon), 0.0])
    down = np.cross(north, east)
    yaw, pitch, roll = np.radians([30.0, -20.0, 10.0])
    turned = (
        Quaternion(axis=[0, 0, 1], angle=yaw)
        * Quaternion(axis=[0, 1, 0], angle=pitch)
        * Quaternion(axis=[1, 0, 0], angle=roll)
    )
    for axis in np.eye(3):
        expected = np.array([north, east, down]).T @ turned.rotate(axis)
        assert np.allclose(q.rotate(axis), expected, atol=1e-12)


def test_wind_angles_of_zero_equal_euler_angles_along_the_path():
    first, second = (
        start(*words)[6:10] for words in (PATH, (NED, "initial.yaw_pitch_roll_deg=[120, -30, 0]"))
    )
    assert abs(first @ second) == pytest.approx(1.0, abs=1e-14)


def test_at_rest():
    y = start("initial.velocity_ned_m_s=[0, 0, 0]", "initial.yaw_pitch_roll_deg=[0, 0, 0]")
    spin = 7.292115e-5
    assert np.allclose(y[3:6], [-spin * y[1], spin * y[0], 0.0], atol=1e-12)
    assert np.isfinite(start("initial.velocity_ned_m_s=[0, 0, 0]")).all()


@pytest.mark.parametrize(
    "overrides, key, words",
    [
        (
            (),
            "initial.speed_m_s",
            "required key is missing: speed relative to the rotating planet, in m/s (or give",
        ),
        (PATH[:2], "initial.azimuth_deg", "required key is missing"),
        ((NED, PATH[0]), "initial.speed_m_s", "must not stand beside velocity_ned_m_s"),
        ((NED, PATH[2]), "initial.azimuth_deg", "must not stand beside velocity_ned_m_s"),
        (
            ("initial.velocity_ned_m_s=[20000, 20000, 0]",),
            "initial.velocity_ned_m_s",
            "must have a length of at most 20000",
        ),
        (
            (NED, "initial.yaw_pitch_roll_deg=[0, 0, 0]", "initial.alpha_deg=0"),
            "initial.alpha_deg",
            "must not stand beside yaw_pitch_roll",
        ),
        (
            (NED, "initial.yaw_pitch_roll_deg=[0, 91, 0]"),
            "initial.yaw_pitch_roll_deg",
            "pitch within -90 and 90",
        ),
        ((NED, "initial.yaw_pitch_roll_deg=[0, 0]"), "initial.yaw_pitch_roll_deg", "must be"),
    ],
)
def test_contradictions_are_refused_at_their_keys(overrides, key, words):
    with pytest.raises(ConfigError) as error:
        start(*overrides)
    messages = {problem.path: problem.message for problem in error.value.problems}
    assert words in messages[key]
