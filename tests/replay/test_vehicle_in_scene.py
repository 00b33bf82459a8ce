"""The vehicle in the replay, read back: where it is and what leaves it, burns, fails and pushes, against the
telemetry it was written from.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from made_up import DIAGNOSIS, FAILURE, SHELL, SHIELD, entities, read
from pyquaternion import Quaternion

from edl6dof.replay.recording import history, write_replay
from edl6dof.replay.scene.poses import Motion, Site
from edl6dof.spatial.frames import fixed_to_enu, from_geodetic

pytest.importorskip("rerun")


def test_pose_is_that_of_the_telemetry(flight, replay):
    tm, planet = flight.telemetry, flight.scenario.planet
    times, columns = read(replay, "/site/vehicle")
    assert np.allclose(np.diff(times), 0.04, atol=1e-6)
    site = Site(flight.scenario)
    for k in (0, 137, len(times) - 1):
        i = int(np.argmin(np.abs(tm["t_s"] - times[k])))
        q = Quaternion([tm[f"truth.q_I2B_{axis}"][i] for axis in "wxyz"])
        spin = Quaternion(axis=[0.0, 0.0, 1.0], radians=-planet.rotation_rate_rad_s * times[k])
        x, y, z, w = columns["Transform3D:quaternion"][k][0]
        for axis in np.eye(3):
            in_L = site.axes @ spin.rotate(q.rotate(axis))
            assert np.allclose(Quaternion(w, x, y, z).rotate(axis), in_L, atol=1e-6)
        centre = Quaternion(w, x, y, z).rotate(np.array([tm[f"truth.centre_{axis}_m"][i] for axis in "xyz"]))
        place = [tm[f"truth.site_{axis}_m"][i] for axis in ("east", "north", "up")]
        assert np.allclose(columns["Transform3D:translation"][k][0] + centre, place, atol=1e-3)


def test_site_frame_agrees_with_the_kernels(flight):
    site, terrain = Site(flight.scenario), flight.scenario.terrain
    lat, lon = np.radians(terrain.site_latitude_deg), np.radians(terrain.site_longitude_deg)
    origin = from_geodetic(
        site.radius, site.flattening, lat, lon, terrain.site_elevation_m + flight.scenario.site_areoid_m
    )
    assert np.allclose(site.origin, origin, atol=1e-6)
    far = from_geodetic(site.radius, site.flattening, lat + 0.05, lon - 0.03, 1500.0)
    east, north, up = fixed_to_enu(origin, (np.sin(lat), np.cos(lat), np.sin(lon), np.cos(lon)), far)
    assert np.allclose(site.axes @ (np.array(far) - site.origin), [east, north, up], atol=1e-6)
    assert site.surface(np.array(east), np.array(north), 1500.0) == pytest.approx(up, abs=0.5)


def test_ground_passes_under_the_vehicle(flight):
    motion = Motion(history(flight))
    ground = motion.site.ground(motion.centre[:, 0], motion.centre[:, 1])[1]
    assert np.allclose(motion.centre[:, 2] - ground, motion.height, atol=1.5)  # the made-up ground is level


def test_parts_leave_the_vehicle_when_the_telemetry_says_so(replay):
    for part, when in (("heat_shield", SHIELD), ("backshell", SHELL)):
        times, _ = read(replay, f"/site/{part}")
        assert times[0] == pytest.approx(when, abs=0.041)
        times, columns = read(replay, f"/site/vehicle/{part}")
        cleared = [t for t, cell in zip(times, columns["Clear:is_recursive"], strict=True) if cell]
        assert cleared == [pytest.approx(when, abs=0.041)]


def test_trim_wing_swings_out_to_the_vehicle_files_place_and_square_to_the_axis(flight, replay):
    times, columns = read(replay, "/site/vehicle/trim_wing")
    wing, rows = (
        flight.scenario.vehicle.surfaces[0],
        [i for i, q in enumerate(columns["Transform3D:quaternion"]) if q],
    )
    poses = [Quaternion(*np.roll(columns["Transform3D:quaternion"][i][0], 1)) for i in rows]
    hinge = np.array(columns["Transform3D:translation"][rows[0]][0])
    angles = [np.degrees((pose.inverse * poses[-1]).angle) for pose in poses]
    assert angles[0] == pytest.approx(
        90.0 + flight.scenario.vehicle.aero.capsule.backshell_cone_angle_deg, abs=0.01
    )
    assert np.all(np.diff(angles) < 0.0)
    assert times[rows[1]] > 4.0 and times[rows[-1]] == pytest.approx(4.7, abs=0.05)
    assert np.allclose(poses[-1].rotate([0.0, 0.0, 1.0]), [1.0, 0.0, 0.0], atol=1e-6), (
        "the open plate faces the flow"
    )
    span = abs(wing.position_z_m) - abs(hinge[2])
    assert np.allclose(
        hinge + poses[-1].rotate([span, 0.0, 0.0]), [wing.position_x_m, 0.0, wing.position_z_m], atol=1e-6
    )


def test_no_flame_before_ignition_and_none_of_an_engine_that_never_burns(flight, replay, tmp_path):
    times, columns = read(replay, "/site/vehicle/engine_plume/core")
    shapes = [t for t, cell in zip(times, columns["Mesh3D:vertex_positions"], strict=True) if cell]
    assert shapes == [times[0]] and times[0] > SHELL - 0.05
    scales = [np.array(cell) for cell in columns["InstancePoses3D:scales"] if cell]
    assert np.all(scales[0] > 0.3) and all(len(scale) == 1 for scale in scales)
    silent = SimpleNamespace(**vars(flight))
    fired = ("truth.engine_thrust_n", *(f"rcs.{jet}" for jet in flight.scenario.thruster_names))
    silent.telemetry = {
        **flight.telemetry,
        **{name: np.zeros(len(flight.telemetry["t_s"])) for name in fired},
    }
    write_replay([history(silent)], tmp_path / "silent.rrd")
    assert not [path for path in entities(tmp_path / "silent.rrd") if "plume" in path or "spark" in path]


def test_sparks_are_at_the_nozzles_that_fire(flight, replay):
    times, columns = read(replay, "/site/vehicle/thruster_sparks")
    duty = history(flight).duty
    jets = np.array([jet.position_m for jet in flight.scenario.vehicle.rcs.thrusters])
    for k in (0, 40, len(times) - 1):
        row = int(round(times[k] * 25.0))
        assert np.allclose(columns["Points3D:positions"][k], jets[duty[row] > 0.02], atol=1e-6)


def test_failed_thruster_is_red_from_the_failure_on_and_named_when_diagnosed(replay):
    times, columns = read(replay, "/site/vehicle/failed/D7")
    assert times[0] == pytest.approx(FAILURE, abs=0.041)
    colours = np.array(columns["Mesh3D:vertex_colors"][0], np.uint32)
    red, green, blue = (colours >> 24) & 255, (colours >> 16) & 255, (colours >> 8) & 255
    assert np.all((red > 200) & (green < 80) & (blue < 80))
    times, columns = read(replay, "/site/vehicle/failed/D7/mark")
    assert times.tolist() == [pytest.approx(FAILURE, abs=0.041), DIAGNOSIS]
    assert columns["Points3D:labels"] == [["failed"], ["D7 stuck off"]]
    times, columns = read(replay, "/Thruster-D7")
    failed = [t for t, cell in zip(times, columns["StateChange:state"], strict=True) if cell == ["failed"]]
    assert failed == [pytest.approx(FAILURE, abs=0.041)]
    assert len(read(replay, "/Thruster-D8")[0]) > 1
    assert len(read(replay, "/site/vehicle/failed/D8")[0]) == 0


def test_arrows_end_when_their_force_does(flight, replay):
    times, columns = read(replay, "/site/near/arrows/thrust")
    shown = np.array([len(cell or []) for cell in columns["Arrows3D:vectors"]])
    assert times[0] > SHELL - 0.1 and np.all(shown == 1)
    times, columns = read(replay, "/site/near/arrows/lift")
    lengths = [len(cell or []) for cell in columns["Arrows3D:vectors"]]
    assert lengths[-1] == 0 and times[-1] == pytest.approx(6.0, abs=0.2), "none under the parachute"
    force = np.stack([flight.telemetry[f"truth.aero_force_{axis}_n"] for axis in "xyz"], axis=-1)
    assert np.linalg.norm(force[0]) > 0.0
