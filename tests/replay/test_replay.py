"""The replay read back: what it holds, against the telemetry it was written from."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from pyquaternion import Quaternion

from edl6dof.post.history import spans, thin
from edl6dof.post.motion import Motion, Site
from edl6dof.post.replay import history, write_replay
from edl6dof.sim.channels import CHANNELS
from edl6dof.sim.scenario import load_scenario
from edl6dof.spatial.frames import fixed_to_enu, from_geodetic

pytest.importorskip("rerun")

MORTAR, SHIELD, SHELL, END = 6.0, 10.0, 14.0, 20.0
RELEASES = {"canopy": (MORTAR, SHELL), "heat_shield": (SHIELD, END), "backshell": (SHELL, END)}


def synthetic_flight() -> SimpleNamespace:
    """20 s of made-up telemetry over the Tianwen-1 site, with every separation in it."""
    scenario = load_scenario("tianwen1").scenario
    t = np.arange(0.0, END + 0.01, 0.02)
    rng = np.random.default_rng(3)
    tm = {"t_s": t}
    for k, channel in enumerate(CHANNELS):
        tm[channel.name] = np.sin(0.1 * (k + 1) * t) + 0.01 * k
    tm["truth.height_m"] = np.maximum(900.0 - 45.0 * t, 0.7)
    tm["truth.altitude_m"] = tm["truth.height_m"] - 4099.4
    tm["truth.site_east_m"], tm["truth.site_north_m"], tm["truth.site_up_m"] = 3.0 * t, 200.0 - 10.0 * t, tm["truth.height_m"]
    q = rng.normal(size=4) + 0.1 * np.outer(np.sin(t), rng.normal(size=4))
    for axis, column in zip("wxyz", (q / np.linalg.norm(q, axis=1, keepdims=True)).T, strict=True):
        tm[f"truth.q_I2B_{axis}"] = column
    for name, (start, stop) in RELEASES.items():
        on = (t >= start) & ((t < stop) | (stop == END))
        for axis, offset in zip(("east", "north", "up"), (5.0, 5.0, 30.0), strict=True):
            tm[f"truth.{name}_{axis}_m"] = np.where(on, tm[f"truth.site_{axis}_m"] + offset, np.nan)
    names = [phase.name for phase in scenario.mission.phases]
    tm["guide.phase"] = np.floor(t / END * (len(names) - 0.01))
    tm["truth.engine_thrust_n"] = np.where(t > SHELL, 3000.0, 0.0)
    tm["truth.footpads"] = np.where(t > 19.5, 4.0, 0.0)
    for k, jet in enumerate(scenario.vehicle.rcs.thrusters):
        tm[f"rcs.{jet.name}"] = np.clip(np.sin(t + k), 0.0, 1.0)
    keys = {"mortar": MORTAR, "heat_shield": SHIELD, "landing_legs": 12.0, "backshell": SHELL, "trim_wing": 4.0, "end": END}
    order = sorted(keys.items(), key=lambda item: item[1])
    events = [{"t_s": when, "key": key, "name": key, "detail": "detail"} for key, when in order]
    return SimpleNamespace(
        telemetry=tm, events=events, phase_names=names, scenario=scenario, outcome="landed within limits", name="synthetic"
    )


@pytest.fixture(scope="module")
def flight() -> SimpleNamespace:
    return synthetic_flight()


@pytest.fixture(scope="module")
def replay(flight, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("replay") / "replay.rrd"
    write_replay(history(flight), path)
    return path


def read(path: Path, entity: str) -> tuple[np.ndarray, dict[str, list]]:
    """Times (s) and component values of all rows of an entity that are not static."""
    from rerun.chunk import RrdReader

    rows: list[tuple[float, dict]] = []
    for chunk in RrdReader(path).stream().filter(content=[entity], is_static=False).to_chunks():
        batch = chunk.to_record_batch()
        times = batch.column("sim_time").to_numpy(zero_copy_only=False).astype("timedelta64[ns]").astype(np.int64) / 1e9
        columns = {n: batch.column(n).to_pylist() for n in batch.schema.names if ":" in n}
        rows += [(t, {n: values[i] for n, values in columns.items()}) for i, t in enumerate(times)]
    rows.sort(key=lambda row: row[0])
    names = sorted({n for _, row in rows for n in row})
    return np.array([t for t, _ in rows]), {n: [row.get(n) for _, row in rows] for n in names}


def test_file_is_sound_and_small(replay):
    command = [sys.executable, "-m", "rerun", "rrd", "verify", str(replay)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert replay.stat().st_size < 4e6


def test_entities_and_components(replay):
    from rerun.chunk import RrdReader

    held = {(c.entity_path, c.component) for c in RrdReader(replay).stream().collect().schema().component_columns()}
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
        "/states/phase": "StateChange:state",
        "/events": "TextLog:text",
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
    assert {"Chase", "Descent", "Whole flight", "Landing", "Readout", "Phases", "Events", "Mach number (1)"} <= names


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
        assert np.allclose(np.diff(times), 0.08, atol=1e-6)
        rows = np.searchsorted(tm["t_s"], times - 1e-6)
        wanted = factor * np.stack([tm[name][rows] for name in names], axis=-1)
        assert np.array_equal(np.array(columns["Scalars:scalars"]), wanted)


def test_duty_is_the_mean_between_rows(flight, replay):
    times, columns = read(replay, "/plots/thruster_duty/axial")
    jets = [jet.name for jet in flight.scenario.vehicle.rcs.thrusters if jet.group == "axial"]
    values = np.array(columns["Scalars:scalars"])
    for k, name in enumerate(jets):
        assert values[7, k] == pytest.approx(flight.telemetry[f"rcs.{name}"][28:32].mean(), abs=1e-7)
    assert len(values) == len(times) == 251


def test_silent_thrusters_show_no_flame(replay):
    times, columns = read(replay, "/site/vehicle/engine_plume/core")
    scales = [np.array(cell) for cell in columns["InstancePoses3D:scales"]]
    assert times[0] == 0.0
    assert np.all(scales[0] < 1e-3)
    assert all(len(scale) == 1 for scale in scales)
    assert times[1] > SHELL - 0.05
    assert np.all(scales[1] > 0.3)


def test_phases_events_and_units(flight, replay):
    times, columns = read(replay, "/states/phase")
    assert [cell[0] for cell in columns["StateChange:state"]] == flight.phase_names
    assert times[0] == 0.0
    assert np.all(np.diff(times) > 0.0)
    times, columns = read(replay, "/events")
    assert np.allclose(times, [event["t_s"] for event in flight.events])
    assert columns["TextLog:text"][0][0] == "trim_wing: detail"


def test_parts_leave_the_vehicle_when_the_telemetry_says_so(replay):
    for part, when in (("heat_shield", SHIELD), ("backshell", SHELL)):
        times, _ = read(replay, f"/site/{part}")
        assert times[0] == pytest.approx(when, abs=0.041)
        times, columns = read(replay, f"/site/vehicle/{part}")
        cleared = [t for t, cell in zip(times, columns["Clear:is_recursive"], strict=True) if cell]
        assert cleared == [pytest.approx(when, abs=0.041)]


def test_site_frame_agrees_with_the_kernels(flight):
    site, terrain = Site(flight.scenario), flight.scenario.terrain
    lat, lon = np.radians(terrain.site_latitude_deg), np.radians(terrain.site_longitude_deg)
    origin = from_geodetic(site.radius, site.flattening, lat, lon, terrain.site_elevation_m)
    assert np.allclose(site.origin, origin, atol=1e-6)
    far = from_geodetic(site.radius, site.flattening, lat + 0.05, lon - 0.03, 1500.0)
    east, north, up = fixed_to_enu(origin, np.sin(lat), np.cos(lat), np.sin(lon), np.cos(lon), far)
    assert np.allclose(site.axes @ (np.array(far) - site.origin), [east, north, up], atol=1e-6)
    assert site.surface(np.array(east), np.array(north), 1500.0) == pytest.approx(up, abs=0.5)


def test_ground_passes_under_the_vehicle(flight):
    motion = Motion(history(flight))
    ground = motion.ground_up(motion.centre[:, 0], motion.centre[:, 1])
    assert np.allclose(motion.centre[:, 2] - ground, motion.height, atol=0.5)


def test_a_flight_that_ends_early_can_be_shown(flight, tmp_path):
    short = SimpleNamespace(**vars(flight))
    short.telemetry = {name: values[:3].copy() for name, values in flight.telemetry.items()}
    short.telemetry["truth.site_east_m"][2] = np.nan
    short.events, short.phase_names, short.outcome = [], [], "not finite"
    write_replay(history(short), tmp_path / "short.rrd")
    times, _ = read(tmp_path / "short.rrd", "/site/vehicle")
    assert len(times) == 2
    short.telemetry["truth.site_east_m"][:] = np.nan
    write_replay(history(short), tmp_path / "nothing.rrd")
    assert (tmp_path / "nothing.rrd").stat().st_size > 0


def test_thinning_keeps_both_ends():
    rows = thin(np.arange(0.0, 10.01, 0.02), 25.0)
    assert rows[0] == 0
    assert rows[-1] == 500
    assert np.all(np.diff(rows) == 2)
    assert thin(np.array([1.0]), 10.0).tolist() == [0]
    assert spans(np.array([False, True, True, False, True])) == [(1, 3), (4, 5)]
