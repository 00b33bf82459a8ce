"""Shadow, dust and legs near the ground, and the sun over it: against ground, telemetry and sky."""

from __future__ import annotations

from math import degrees, pi, radians
from types import SimpleNamespace

import numpy as np
import pytest
from made_up import SHELL, read, synthetic_flight

from edl6dof.environment.climate import days_since_j2000, local_true_solar_time, solar_longitude, utc
from edl6dof.replay.recording import history, write_replay
from edl6dof.replay.scene.poses import ANYWHERE, Motion, Site, light, towards_sun
from edl6dof.scenario.loading import load_scenario

pytest.importorskip("rerun")


def test_shadow_lies_on_the_ground_where_the_light_throws_it(flight, replay):
    times, columns = read(replay, "/site/near_ground/shadow")
    place = np.array([cell[0] for cell in columns["Transform3D:translation"]])
    motion = Motion(history(flight))
    assert np.allclose(place[:, 2], motion.site.ground(place[:, 0], place[:, 1])[1], atol=1e-3)
    rows = np.searchsorted(motion.t, times - 1e-6)
    assert motion.height[rows].max() < 300.0 < motion.height.max()
    ray = motion.centre[rows] - place
    ray /= np.linalg.norm(ray, axis=-1, keepdims=True)
    assert np.all(ray @ motion.site.light > 0.999)
    width = np.array([cell[0] for cell in columns["Transform3D:scale"]])[:, 0]
    assert np.all(np.diff(width) <= 1e-6), "narrower as it comes down"


def test_dust_is_raised_by_thrust_near_the_ground_alone(flight, replay, tmp_path):
    times, columns = read(replay, "/site/near_ground/dust/0/puffs")
    opaque = np.array([cell[0] & 255 for cell in columns["Mesh3D:albedo_factor"] if cell])
    motion = Motion(history(flight))
    low = motion.t[np.argmax(motion.height < 80.0)]
    assert SHELL < low <= times[0] + 1.0 and opaque.max() > 5
    still = SimpleNamespace(**vars(flight))
    still.telemetry = {**flight.telemetry, "truth.engine_thrust_n": np.zeros(len(flight.telemetry["t_s"]))}
    write_replay([history(still)], tmp_path / "still.rrd")
    assert len(read(tmp_path / "still.rrd", "/site/near_ground/dust/0")[0]) == 0


def test_legs_are_pressed_to_the_ground_under_each_pad():
    motion = Motion(history(synthetic_flight()))
    pads = np.array(motion.vehicle.landing_gear.footpads_m)
    # nose down: x of B is down
    motion.rotation[-1] = np.array([np.cos(pi / 4.0), 0.0, np.sin(pi / 4.0), 0.0])
    level = motion.site.ground(np.array(0.0), np.array(0.0))[1]
    motion.nose[-1] = [0.0, 0.0, float(level) + pads[0, 0] - 0.03]
    assert motion.strokes(pads) == pytest.approx(0.03, abs=5e-3)
    motion.nose[-1, 2] += 1.0
    assert np.all(motion.strokes(pads) == 0.0), "legs are never pulled out"


def test_sun_stands_where_season_and_hour_say():
    calendar = load_scenario("tianwen1").scenario.planet.climate.calendar
    days = days_since_j2000(utc("2021-05-14T23:18:00"))
    tilt = radians(25.19)  # Allison and McEwen 2000
    declination = np.arcsin(np.sin(tilt) * np.sin(solar_longitude(calendar, days)))
    longitude = radians((12.0 - local_true_solar_time(calendar, days, 0.0)) * 15.0)
    noon = towards_sun(calendar, days, declination, longitude)
    assert degrees(np.arccos(noon[2])) < 0.1, "overhead at noon where the latitude is the declination"
    morning = towards_sun(calendar, days, 0.0, longitude - 0.5 * pi)
    assert morning[0] > 0.85 and abs(morning[2]) < 0.01, "in the east on the equator at six"
    north = towards_sun(calendar, days, 0.5 * pi, 1.0)
    assert north[2] == pytest.approx(np.sin(declination), abs=1e-3), "at the pole as high as the declination"


def test_light_comes_from_the_sun_where_it_is_known_and_up():
    afternoon = Site(load_scenario("tianwen1").scenario)
    assert afternoon.sun is not None and np.array_equal(afternoon.light, afternoon.sun)
    assert afternoon.sun[0] < 0.0, "the landing of 14 May 2021 was in the afternoon"
    assert Site(load_scenario("titan_probe").scenario).sun is None
    assert np.array_equal(light(None), ANYWHERE)
    assert np.array_equal(light(np.array([0.0, -1.0, 0.0])), ANYWHERE)
