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


def test_a_campaign_is_a_layer_with_its_outcomes_footprint_and_worst_cases(flight, tmp_path):
    from rerun.chunk import RrdReader

    from edl6dof.replay.scene.ensemble import OUTCOMES, WORST, Ensemble, Trajectory, Worst

    line = np.outer(np.arange(5.0), [100.0, 0.0, -50.0])
    landings = [line + shift for shift in ([1.0, 0.0, 0.0], [0.0, 50.0, 0.0], [90.0, 80.0, 0.0])]
    cases = [Trajectory(k, places, "", True) for k, places in enumerate(landings)]
    cases += [Trajectory(3, line, "crashed", False), Trajectory(7, np.full((3, 3), np.nan), "lost", False)]
    worst = [Worst(2, "distance from the landing site", "500 m", "400 m", 1.25)]
    ensemble = Ensemble(cases, worst, "case 3, the worst.")
    write_replay([history(flight)], tmp_path / "ensemble.rrd", ["case 3"], "Campaign", ensemble)
    wanted = ["/site/campaign/**", "/site/labels/worst/**", "/campaign", "/plots/velocity_m_s"]
    stored = {}
    for chunk in RrdReader(tmp_path / "ensemble.rrd").stream().filter(content=wanted).to_chunks():
        batch = chunk.to_record_batch()
        stored.setdefault(chunk.entity_path, {}).update(
            {name: batch.column(name).to_pylist()[0] for name in batch.schema.names if ":" in name}
        )

    def colour(entity, of="LineStrips3D"):
        number = stored[entity][f"{of}:colors"][0]
        return tuple((number >> shift) & 255 for shift in (24, 16, 8))

    paths, colours = "/site/campaign/paths", list(OUTCOMES.values())
    assert np.allclose(stored[f"{paths}/success"]["LineStrips3D:strips"], landings)
    assert stored[f"{paths}/success"]["LineStrips3D:labels"] == ["case 0", "case 1", "case 2"]
    assert [colour(f"{paths}/{name}") for name in ("success", "failure_1", "failure_2")] == colours[:3]
    assert stored[f"{paths}/failure_2"]["LineStrips3D:strips"] == [[]], (
        "a case that was never anywhere is counted, not drawn"
    )
    assert np.allclose(stored[f"{paths}/worst/case_2"]["LineStrips3D:strips"], [landings[2]])
    assert colour(f"{paths}/worst/case_2") == WORST
    assert stored["/site/labels/worst/case_2"]["Points3D:labels"] == ["case 2"]
    points = np.array(stored["/site/campaign/footprint/success"]["Points3D:positions"])
    assert np.allclose(points[:, :2], [places[-1, :2] for places in landings])
    assert stored["/site/campaign/footprint/failure_1"]["Points3D:positions"] == []
    curve = np.array(stored["/site/campaign/footprint/ellipse"]["LineStrips3D:strips"][0])[:, :2]
    covariance = np.cov(points[:, :2].T)
    off = curve - points[:, :2].mean(axis=0)
    inside = np.einsum("ni,ij,nj->n", off, np.linalg.inv(covariance), off)
    assert np.allclose(1.0 - np.exp(-0.5 * inside), 0.99, atol=1e-4)
    assert stored["/plots/velocity_m_s"]["SeriesLines:names"] == ["down", "north", "east"], (
        "as of a flight alone"
    )
    told = stored["/campaign"]["TextDocument:text"][0]
    assert "3 of 5 succeed" in told and "Followed, in white: case 3, the worst." in told
    assert "| 1 | vermilion | crashed |" in told
    assert "| 2 | 125% | 500 m | 400 m | distance from the landing site |" in told
