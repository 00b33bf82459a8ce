"""The replay read back: what it holds, against the telemetry it was written from."""

from __future__ import annotations

import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from made_up import DIAGNOSIS, FAILURE, NOT_ENTERED, SHELL, SHIELD, entities, read, synthetic_flight
from pyquaternion import Quaternion

from edl6dof.replay.history import thin
from edl6dof.replay.recording import history, write_replay
from edl6dof.replay.scene.motion import Motion
from edl6dof.replay.scene.site import Site
from edl6dof.spatial.frames import fixed_to_enu, from_geodetic
from edl6dof.telemetry.spans import spans

pytest.importorskip("rerun")


def test_file_is_sound_and_small(replay):
    command = [sys.executable, "-m", "rerun", "rrd", "verify", str(replay)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert replay.stat().st_size < 5e6


def test_entities_and_components(replay):
    from rerun.chunk import RrdReader

    held = {
        (c.entity_path, c.component)
        for c in RrdReader(replay).stream().collect().schema().component_columns()
    }
    expected = {
        "/site/ground": "Mesh3D:vertex_positions",
        "/site/path": "LineStrips3D:strips",
        "/site/trail": "LineStrips3D:strips",
        "/site/vehicle": "Transform3D:quaternion",
        "/site/vehicle/lander": "Mesh3D:vertex_positions",
        "/site/vehicle/legs": "Mesh3D:vertex_positions",
        "/site/vehicle/heat_shield": "Mesh3D:albedo_factor",
        "/site/vehicle/thruster_plumes/core": "InstancePoses3D:scales",
        "/site/vehicle/engine_plume/mantle": "InstancePoses3D:scales",
        "/site/camera": "Transform3D:scale",
        "/site/parachute": "Transform3D:translation",
        "/site/parachute/canopy": "Mesh3D:vertex_positions",
        "/site/heat_shield": "Transform3D:translation",
        "/site/backshell/shape": "Mesh3D:vertex_positions",
        "/site/labels/target": "Points3D:positions",
        "/site/labels/touchdown": "Points3D:positions",
        "/plots/altitude_km": "Scalars:scalars",
        "/plots/thruster_duty/fine": "Scalars:scalars",
        "/Flight/Phase": "StateChange:state",
        "/Powered-descent/Vehicle": "StateChange:state",
        "/rcs/D7": "StateChange:state",
        "/site/ground/rocks/0": "InstancePoses3D:scales",
        "/site/ground_track": "LineStrips3D:strips",
        "/site/sky": "Transform3D:scale",
        "/site/markers/target": "LineStrips3D:strips",
        "/site/markers/ellipse": "LineStrips3D:strips",
        "/site/vehicle/trim_wing": "Transform3D:quaternion",
        "/site/vehicle/failed/D7": "Mesh3D:vertex_positions",
        "/site/vehicle/failed/D7/mark": "Points3D:labels",
        "/site/vehicle/attitude_frame": "TransformAxes3D:axis_length",
        "/site/velocity_frame": "TransformAxes3D:axis_length",
        "/site/arrows/velocity": "Arrows3D:vectors",
        "/site/arrows/lift": "Arrows3D:vectors",
        "/site/arrows/thrust": "Arrows3D:vectors",
        "/site/arrows/disturbance": "Arrows3D:vectors",
        "/site/arrows/names": "Points3D:labels",
        "/site/camera_away": "Transform3D:scale",
        "/globe/planet": "Mesh3D:vertex_positions",
        "/globe/track": "LineStrips3D:strips",
        "/phase_plane/roll/zones": "LineStrips2D:strips",
        "/phase_plane/yaw/way": "LineStrips2D:strips",
        "/plots/disturbance_torque_x_nm": "Scalars:scalars",
        "/events": "TextDocument:text",
        "/readout": "TextDocument:text",
    }
    assert set(expected.items()) <= held


def test_blueprint_travels_with_the_file(replay):
    from rerun.chunk import RrdReader

    reader = RrdReader(replay)
    assert reader.recordings()[0].application_id == "edl6dof"
    (store,) = reader.blueprints()
    names = {
        name
        for chunk in reader.stream(store=store).to_chunks()
        for column in [chunk.to_record_batch()]
        if "ViewBlueprint:display_name" in column.schema.names
        for cell in column.column("ViewBlueprint:display_name").to_pylist()
        for name in cell or []
    }
    assert {
        *(
            "Chase",
            "Descent",
            "Whole flight",
            "Landing",
            "Site",
            "Globe",
            "What falls away",
            "Readout",
            "Phases",
            "Events",
        ),
        *(
            "Mach number (1)",
            "Roll: error (deg), rate (deg/s)",
            "Disturbance torque x (N m)",
            "Thrusters A1 to D7",
        ),
    } <= names


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


def test_plots_hold_the_telemetry(flight, replay):
    tm = flight.telemetry
    for entity, names, factor in (
        ("/plots/altitude_km", ["truth.altitude_m", "truth.height_m"], 1e-3),
        ("/plots/body_rate_deg_s", [f"truth.rate_{axis}_deg_s" for axis in "pqr"], 1.0),
    ):
        times, columns = read(replay, entity)
        shown, whole = np.array(columns["Scalars:scalars"]), factor * np.stack([tm[n] for n in names], -1)
        rows = np.searchsorted(tm["t_s"], times - 1e-6)
        assert np.allclose(shown, whole[rows], rtol=2e-7, atol=0.0)  # single precision
        for k in range(len(names)):
            between = np.interp(tm["t_s"], times, shown[:, k])
            assert np.abs(between - whole[:, k]).max() <= np.ptp(whole[:, k]) / 4000


def test_the_largest_value_of_a_plot_is_the_peak_of_the_flight(nominal, tmp_path):
    write_replay([history(nominal)], tmp_path / "replay.rrd")
    peaks = {
        "/plots/riser_tension_kn": ("max_riser_tension_n", 1e-3),
        "/plots/load_g0": ("max_load_parachute_g0", 1.0),
        "/plots/dynamic_pressure_kpa": ("peak_dynamic_pressure_pa", 1e-3),
        "/plots/heat_flux_w_cm2": ("peak_heat_flux_w_cm2", 1.0),
    }
    for entity, (figure, factor) in peaks.items():
        _, columns = read(tmp_path / "replay.rrd", entity)
        assert np.max(columns["Scalars:scalars"]) == pytest.approx(nominal.metrics[figure] * factor, rel=2e-7)


def test_the_viewer_draws_extremes_where_it_has_no_room_for_every_value(replay):
    from rerun.chunk import RrdReader

    policies = [
        batch.column(name).to_pylist()
        for chunk in RrdReader(replay).stream().filter(content=["/plots/**"], is_static=True).to_chunks()
        for batch in [chunk.to_record_batch()]
        for name in batch.schema.names
        if name == "SeriesLines:aggregation_policy"
    ]
    assert len(policies) > 20 and all(policy == [[5]] for policy in policies), "5 is MinMax"


def test_duty_is_the_mean_between_rows(flight, replay):
    times, columns = read(replay, "/plots/thruster_duty/axial")
    jets = [jet.name for jet in flight.scenario.vehicle.rcs.thrusters if jet.group == "axial"]
    values = np.array(columns["Scalars:scalars"])
    for k, name in enumerate(jets):
        assert values[7, k] == pytest.approx(flight.telemetry[f"rcs.{name}"][56:64].mean(), abs=1e-7)
    assert len(values) == len(times) == 126


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


def test_phases_events_and_units(flight, replay):
    times, columns = read(replay, "/Flight/Phase")
    flown = [name for name in flight.phase_names if name not in NOT_ENTERED]
    assert [cell[0] for cell in columns["StateChange:state"]] == flown
    assert times[0] == 0.0
    assert np.all(np.diff(times) > 0.0)
    times, columns = read(replay, "/events")
    assert np.allclose(times, [0.0, *(event["t_s"] for event in flight.events)])
    tables = [cell[0].splitlines() for cell in columns["TextDocument:text"]]
    assert tables[0][2] == "| T+4.00 s | trim wing | detail |", "nothing has happened yet"
    assert tables[1][2] == "| **T+4.00 s** | **trim wing** | **detail** |"
    assert [len(table) for table in tables[1:]] == [9, 9, 8, 7, 6, 5, 4], "the last but one and what comes"


def test_parts_leave_the_vehicle_when_the_telemetry_says_so(replay):
    for part, when in (("heat_shield", SHIELD), ("backshell", SHELL)):
        times, _ = read(replay, f"/site/{part}")
        assert times[0] == pytest.approx(when, abs=0.041)
        times, columns = read(replay, f"/site/vehicle/{part}")
        cleared = [t for t, cell in zip(times, columns["Clear:is_recursive"], strict=True) if cell]
        assert cleared == [pytest.approx(when, abs=0.041)]


def test_failed_thruster_is_red_from_the_failure_on_and_named_when_diagnosed(replay):
    times, columns = read(replay, "/site/vehicle/failed/D7")
    assert times[0] == pytest.approx(FAILURE, abs=0.041)
    colours = np.array(columns["Mesh3D:vertex_colors"][0], np.uint32)
    red, green, blue = (colours >> 24) & 255, (colours >> 16) & 255, (colours >> 8) & 255
    assert np.all((red > 200) & (green < 80) & (blue < 80))
    times, columns = read(replay, "/site/vehicle/failed/D7/mark")
    assert times.tolist() == [pytest.approx(FAILURE, abs=0.041), DIAGNOSIS]
    assert columns["Points3D:labels"] == [["failed"], ["D7 stuck off"]]
    times, columns = read(replay, "/rcs/D7")
    failed = [t for t, cell in zip(times, columns["StateChange:state"], strict=True) if cell == ["failed"]]
    assert failed == [pytest.approx(FAILURE, abs=0.041)]
    assert len(read(replay, "/rcs/D8")[0]) > 1
    assert len(read(replay, "/site/vehicle/failed/D8")[0]) == 0


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


def test_arrows_end_when_their_force_does(flight, replay):
    times, columns = read(replay, "/site/arrows/thrust")
    shown = np.array([len(cell or []) for cell in columns["Arrows3D:vectors"]])
    assert times[0] > SHELL - 0.1 and np.all(shown == 1)
    times, columns = read(replay, "/site/arrows/lift")
    lengths = [len(cell or []) for cell in columns["Arrows3D:vectors"]]
    assert lengths[-1] == 0 and times[-1] == pytest.approx(6.0, abs=0.2), "none under the parachute"
    force = np.stack([flight.telemetry[f"truth.aero_force_{axis}_n"] for axis in "xyz"], axis=-1)
    assert np.linalg.norm(force[0]) > 0.0


def test_several_flights_share_one_scene(flight, tmp_path):
    from rerun.chunk import RrdReader

    write_replay([history(flight), history(flight)], tmp_path / "two.rrd", ["one", "two"])
    held = {
        c.entity_path for c in RrdReader(tmp_path / "two.rrd").stream().collect().schema().component_columns()
    }
    own = {"vehicle", "path", "trail", "parachute", "markers/vehicle", "vehicle/lander", "vehicle/failed/D7"}
    assert {f"/site/flight_1/{name}" for name in own} <= held
    assert {"/site/ground", "/plots/mach/flight_1", "/globe/flight_1/track"} <= held
    assert {"/site/flight_1/camera", "/site/flight_1/camera/name", "/site/camera/name"} <= held
    assert "/site/flight_1/ground" not in held
    one, two = (
        read(tmp_path / "two.rrd", entity)[1]["Transform3D:translation"]
        for entity in ("/site/vehicle", "/site/flight_1/vehicle")
    )
    assert one == two


def test_site_frame_agrees_with_the_kernels(flight):
    site, terrain = Site(flight.scenario), flight.scenario.terrain
    lat, lon = np.radians(terrain.site_latitude_deg), np.radians(terrain.site_longitude_deg)
    origin = from_geodetic(
        site.radius, site.flattening, lat, lon, terrain.site_elevation_m + flight.scenario.site_areoid_m
    )
    assert np.allclose(site.origin, origin, atol=1e-6)
    far = from_geodetic(site.radius, site.flattening, lat + 0.05, lon - 0.03, 1500.0)
    east, north, up = fixed_to_enu(origin, np.sin(lat), np.cos(lat), np.sin(lon), np.cos(lon), far)
    assert np.allclose(site.axes @ (np.array(far) - site.origin), [east, north, up], atol=1e-6)
    assert site.surface(np.array(east), np.array(north), 1500.0) == pytest.approx(up, abs=0.5)


def test_ground_passes_under_the_vehicle(flight):
    motion = Motion(history(flight))
    ground = motion.site.ground(motion.centre[:, 0], motion.centre[:, 1])[1]
    assert np.allclose(motion.centre[:, 2] - ground, motion.height, atol=1.5)  # the made-up ground is level


def test_a_flight_that_ends_early_can_be_shown(flight, tmp_path):
    short = SimpleNamespace(**vars(flight))
    short.telemetry = {name: values[:3].copy() for name, values in flight.telemetry.items()}
    short.telemetry["truth.site_east_m"][2] = np.nan
    short.events, short.phase_names, short.outcome = [], [], "not finite"
    write_replay([history(short)], tmp_path / "short.rrd")
    times, _ = read(tmp_path / "short.rrd", "/site/vehicle")
    assert len(times) == 2
    short.telemetry["truth.site_east_m"][:] = np.nan
    write_replay([history(short)], tmp_path / "nothing.rrd")
    assert (tmp_path / "nothing.rrd").stat().st_size > 0


def test_thinning_keeps_both_ends():
    rows = thin(np.arange(0.0, 10.01, 0.02), 25.0)
    assert rows[0] == 0
    assert rows[-1] == 500
    assert np.all(np.diff(rows) == 2)
    assert thin(np.array([1.0]), 10.0).tolist() == [0]
    assert spans(np.array([False, True, True, False, True])) == [(1, 3), (4, 5)]


def test_a_campaign_is_a_layer_coloured_by_how_its_cases_ended(flight, tmp_path):
    from rerun.chunk import RrdReader

    from edl6dof.replay.scene.ensemble import CAUSES, SUCCESS, Ensemble, Trajectory

    line = np.outer(np.arange(5.0), [100.0, 0.0, -50.0])
    cases = [
        Trajectory(line, ""),
        Trajectory(line + 1.0, ""),
        Trajectory(line, "crashed"),
        Trajectory(np.full((3, 3), np.nan), "lost"),
    ]
    ensemble = Ensemble(cases, "case 3, the worst.")
    write_replay([history(flight)], tmp_path / "ensemble.rrd", ["case 3"], ensemble=ensemble)
    stored = {}
    for chunk in (
        RrdReader(tmp_path / "ensemble.rrd")
        .stream()
        .filter(content=["/site/campaign/**", "/campaign"])
        .to_chunks()
    ):
        batch = chunk.to_record_batch()
        stored[chunk.entity_path] = {
            name: batch.column(name).to_pylist()[0] for name in batch.schema.names if ":" in name
        }
    good, worse = stored["/site/campaign/success"], stored["/site/campaign/failure_1"]
    assert np.allclose(good["LineStrips3D:strips"], [line, line + 1.0])
    rgb = [
        [(colour >> shift) & 255 for shift in (24, 16, 8)]
        for colour in (good["LineStrips3D:colors"][0], worse["LineStrips3D:colors"][0])
    ]
    assert rgb == [list(SUCCESS), list(CAUSES[0])]
    assert stored["/site/campaign/failure_2"]["LineStrips3D:strips"] == [[]], (
        "a case that was never anywhere is counted, not drawn"
    )
    told = stored["/campaign"]["TextDocument:text"][0]
    assert "2 of 4 succeed" in told and "Followed here, in white: case 3, the worst." in told


def test_events_of_a_run_that_told_no_thruster_or_isolation_can_be_replayed():
    flight = synthetic_flight()
    diagnosis = next(event for event in flight.events if event["key"] == "diagnosis")
    assert history(flight).diagnosed["D7"].text == "D7 stuck off"
    del diagnosis["isolated"]
    assert history(flight).diagnosed["D7"].text == diagnosis["name"]
    del diagnosis["thruster"]
    assert history(flight).diagnosed == {}
