"""Replays of several flights: side by side in one scene, and a campaign as a layer below one of them."""

from __future__ import annotations

import numpy as np
import pytest
from made_up import read

from edl6dof.replay.recording import history, write_replay

pytest.importorskip("rerun")


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


def test_a_campaign_is_a_layer_coloured_by_how_its_cases_ended(flight, tmp_path):
    from rerun.chunk import RrdReader

    from edl6dof.replay.scene.tracks import CAUSES, SUCCESS, Ensemble, Trajectory

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
