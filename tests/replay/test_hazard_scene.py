"""What the replay shows of the ground: the landing area as it is, and what the lander saw and chose on it."""

from __future__ import annotations

import numpy as np
import pytest
from made_up import read

import edl6dof
from edl6dof.replay.scene.landscape import NEAR, Landscape
from edl6dof.replay.scene.poses import Site
from edl6dof.replay.scene.sensing import PAINT
from edl6dof.report.catalogue import CELLS

pytest.importorskip("rerun")


@pytest.fixture(scope="module")
def flight():
    return edl6dof.fly("tianwen1_hazards", ["terrain.landing_area.rock_abundance=0.1"])


def test_drawn_ground_is_that_of_the_simulation_and_its_rocks_lie_on_it(flight):
    site = Site(flight.scenario)
    touchdown = np.array([flight.figures["landing_east_m"], flight.figures["landing_north_m"], 0.0])
    landscape = Landscape(site, touchdown)
    near = landscape.near()
    assert np.abs(near.positions[:, :2] - touchdown[:2]).max() == pytest.approx(NEAR)
    some = near.positions[::997]
    assert np.allclose(site.ground(some[:, 0], some[:, 1])[1], some[:, 2], atol=1e-9)
    rocks = landscape.rocks()
    # half as high as wide, and nothing else but the ground below: off their middles it falls by that much
    east, north, diameter = site.rocks(*touchdown[:2], 4.0 * NEAR, 0.4).T
    assert len(rocks.places) == len(diameter) > 100
    top = site.ground(east, north)[1]
    beside = np.array(
        [
            site.ground(east + 0.6 * diameter * np.cos(a), north + 0.6 * diameter * np.sin(a))[1]
            for a in range(6)
        ]
    )
    assert np.median(top - np.median(beside, axis=0) - 0.5 * diameter) == pytest.approx(0.0, abs=0.05)


def test_ground_without_relief_keeps_its_decoration():
    site = Site(edl6dof.load("tianwen1").scenario)
    assert Landscape(site, np.zeros(3)).near() is None


def test_rocks_of_the_landing_area_are_in_the_recording(replay):
    from rerun.chunk import RrdReader

    drawn = [
        chunk.to_record_batch()
        for chunk in RrdReader(replay).stream().filter(content=["/site/ground/rocks/**"]).to_chunks()
    ]
    names = "InstancePoses3D:translations"
    assert sum(len(batch.column(names).to_pylist()[0]) for batch in drawn) > 100


def test_map_is_painted_where_it_was_seen_from_the_choice_on(flight, replay):
    found = flight.landing_map
    when = {event["key"]: event["t_s"] for event in flight.events}
    times, columns = read(replay, "/site/hazards/map")
    assert times == pytest.approx([when["spot"]], abs=1e-3)
    places = np.array(columns["Mesh3D:vertex_positions"][0])
    error = np.array(
        [
            np.interp(when["scan"], flight.telemetry["t_s"], flight.telemetry[f"nav.error_{way}_m"])
            for way in ("east", "north")
        ]
    )  # fmt: skip
    corner = found.corner_m - error
    side = float(found.cell_m) * len(found.cell_class)
    assert np.allclose(places[:, :2].min(axis=0), corner, atol=0.3)
    assert np.allclose(places[:, :2].max(axis=0), corner + side, atol=0.5)
    assert len(places) == (len(found.cell_class) // 2) ** 2


def test_legend_beside_the_map_names_each_colour_in_it(flight, replay):
    _, columns = read(replay, "/site/hazards/map")
    corners = np.array(columns["Mesh3D:vertex_positions"][0])
    _, columns = read(replay, "/site/hazards/legend")
    places = np.array(columns["Points3D:positions"][0])
    colours = [(one >> 24, one >> 16 & 255, one >> 8 & 255) for one in columns["Points3D:colors"][0]]
    assert colours[: len(PAINT)] == list(PAINT.values())
    _, columns = read(replay, "/site/hazards/legend/words")
    words = columns["Points3D:labels"][0]
    assert words[: len(CELLS)] == [name for name, _ in CELLS.values()]
    assert ("passed over" in words) == (len(flight.landing_map.rejected_m) > 0)
    assert np.all(places[:, 0] < corners[:, 0].min()), "it covers nothing of the map"
    assert np.diff(places[:, 1]) == pytest.approx(-0.15 * np.ptp(corners[:, 1]), rel=0.02)
    _, columns = read(replay, "/site/hazards/spot")
    assert columns["Points3D:labels"] == [["chosen spot"]]


def test_footprint_lies_around_the_spot_and_the_lander_stands_in_it(flight, replay):
    _, columns = read(replay, "/site/hazards/chosen")
    ring = np.array(columns["LineStrips3D:strips"][0][0])[:, :2]
    radius = flight.scenario.flight_software.hazard.footprint_radius_m
    middle = ring[:-1].mean(axis=0)
    assert np.allclose(np.linalg.norm(ring - middle, axis=1), radius, atol=1e-2)
    stands = np.array([flight.figures["landing_east_m"], flight.figures["landing_north_m"]])
    assert np.linalg.norm(stands - middle) == pytest.approx(flight.figures["spot_miss_m"], abs=0.2)


def test_rays_end_on_the_ground_and_with_the_scan(flight, replay):
    when = {event["key"]: event["t_s"] for event in flight.events}
    times, columns = read(replay, "/site/hazards/rays")
    drawn = [
        (t, np.array(strips))
        for t, strips in zip(times, columns["LineStrips3D:strips"], strict=True)
        if strips
    ]
    assert when["scan"] - 1e-6 <= drawn[0][0] and drawn[-1][0] <= when["spot"] + 1e-6  # whole nanoseconds
    site = Site(flight.scenario)
    for _, strips in drawn:
        ends = strips[:, 1]
        assert np.abs(ends[:, 2] - site.ground(ends[:, 0], ends[:, 1])[1]).max() < 0.5
