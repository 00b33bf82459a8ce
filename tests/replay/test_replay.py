"""The replay read back: what it holds, and its plots, phases and events against the telemetry."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from made_up import NOT_ENTERED, read, synthetic_flight

from edl6dof.replay.history import MANY, poses, thin
from edl6dof.replay.recording import history, write_replay
from edl6dof.telemetry.thinning import spans

pytest.importorskip("rerun")


def test_file_is_sound_and_small(replay):
    command = [sys.executable, "-m", "rerun", "rrd", "verify", str(replay)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert replay.stat().st_size < 5e6


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs Linux's full device")
def test_a_full_disk_is_named(made_up_flight):
    with pytest.raises(OSError, match="No space left"):
        write_replay([history(made_up_flight)], Path("/dev/full"))


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
        "/plots/altitude": "Scalars:scalars",
        "/Phase": "StateChange:state",
        "/Vehicle": "StateChange:state",
        "/Thruster-D7": "StateChange:state",
        "/site/ground_track": "LineStrips3D:strips",
        "/site/sky": "Transform3D:scale",
        "/site/markers/target": "LineStrips3D:strips",
        "/site/markers/ellipse": "LineStrips3D:strips",
        "/site/vehicle/trim_wing": "Transform3D:quaternion",
        "/site/vehicle/failed/D7": "Mesh3D:vertex_positions",
        "/site/vehicle/failed/D7/mark": "Points3D:labels",
        "/site/vehicle/attitude_frame": "TransformAxes3D:axis_length",
        "/site/near/velocity_frame": "TransformAxes3D:axis_length",
        "/site/near/arrows/velocity": "Arrows3D:vectors",
        "/site/near/arrows/lift": "Arrows3D:vectors",
        "/site/near/arrows/thrust": "Arrows3D:vectors",
        "/site/near/arrows/disturbance": "Arrows3D:vectors",
        "/site/near/arrows/names": "Points3D:labels",
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
    assert not [entity for entity, _ in held if entity.startswith("/site/ground/rocks")], "the site has none"


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
            "Disturbance torque, roll (N m)",
            "Thrusters A1 to D7",
        ),
    } <= names


def test_plots_hold_the_telemetry(flight, replay):
    tm = flight.telemetry
    for entity, names, factor in (
        ("/plots/altitude", ["truth.altitude_m", "truth.height_above_areoid_m", "truth.height_m"], 1.0),
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
        "/plots/riser_tension": ("max_riser_tension_n", 1.0),
        "/plots/load_g0": ("max_load_parachute_g0", 1.0),
        "/plots/dynamic_pressure": ("peak_dynamic_pressure_pa", 1.0),
        "/plots/heat_flux_w_cm2": ("peak_heat_flux_w_cm2", 1.0),
    }
    for entity, (figure, factor) in peaks.items():
        _, columns = read(tmp_path / "replay.rrd", entity)
        assert np.max(columns["Scalars:scalars"]) == pytest.approx(nominal.figures[figure] * factor, rel=2e-7)


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


def test_every_pulse_of_a_thruster_is_in_its_lane(made_up_flight, tmp_path):
    flight = SimpleNamespace(**vars(made_up_flight))
    t = flight.telemetry["t_s"]
    pulsing = np.where(np.arange(len(t)) % 4 == 1, 0.6, 0.0)  # 20 ms in every 80 ms
    flight.telemetry = {**flight.telemetry, "rcs.A2": pulsing}
    write_replay([history(flight)], tmp_path / "pulses.rrd")
    times, columns = read(tmp_path / "pulses.rrd", "/Thruster-A2")
    states = [cell[0] for cell in columns["StateChange:state"]]
    begun = times[np.array(states) == "firing"]
    assert begun == pytest.approx(t[pulsing > 0.0], abs=1e-6) and len(begun) > 200


def test_phases_events_and_units(flight, replay):
    times, columns = read(replay, "/Phase")
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


def test_the_first_isolation_of_a_thruster_is_shown():
    flight = synthetic_flight()
    (first,) = (event for event in flight.events if event["key"] == "diagnosis")
    flight.events.append({**first, "t_s": first["t_s"] + 5.0, "isolated": "D7 stuck on"})
    assert history(flight).diagnosed == {"D7": (first["t_s"], "D7 stuck off")}


def test_a_flight_of_hours_is_thinned_away_from_its_events_only():
    t, events = np.arange(0.0, 9470.0, 0.1), [0.0, 300.0, 5000.0]
    times = t[poses(t, events)]
    assert len(times) < 1.1 * MANY < len(t)
    assert (times[0], times[-1]) == (t[0], t[-1])
    for event in events:
        assert np.diff(times[np.abs(times - event) < 59.0]).max() < 0.11
    assert np.diff(times).max() < 0.6
    assert len(poses(t[:20_000], events)) == 20_000
