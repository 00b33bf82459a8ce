"""What vehicles look like: as their files say, and where those are silent, as their physics does."""

from __future__ import annotations

import json
import struct

import numpy as np
import pytest
from made_up import entities, synthetic_flight
from scipy.spatial import Delaunay

from edl6dof.replay.recording import history, write_replay
from edl6dof.replay.scene import craft_shapes
from edl6dof.replay.scene.craft_shapes import canopy
from edl6dof.replay.scene.outline import outline
from edl6dof.replay.scene.poses import Motion
from edl6dof.scenario.loading import load_scenario
from edl6dof.vehicle.propulsion.rcs import RcsParams

pytest.importorskip("rerun")


def vehicle(scenario: str = "tianwen1", *overrides: str):
    """The vehicle of a shipped scenario."""
    return load_scenario(scenario, overrides).scenario.vehicle


def extent(mesh) -> np.ndarray:
    """Sides of the box that just holds a mesh."""
    return np.ptp(mesh.positions, axis=0)


@pytest.mark.parametrize("case", ["case01", "case06"])
def test_the_cannonball_is_a_sphere_of_six_inches(case):
    shape = outline(vehicle(f"nesc/{case}"))
    assert shape.body == "sphere" and shape.lander == "none"
    assert extent(craft_shapes.body(shape)) == pytest.approx(0.1524, rel=1e-3)


def test_the_brick_has_the_sides_that_its_inertia_and_mass_give():
    """8 by 4 by 2.25 inches, NASA/TM-2015-218675: nothing but mass and inertia is in the file."""
    shape = outline(vehicle("nesc/case02"))
    assert shape.body == "box"
    assert shape.sides == pytest.approx(0.0254 * np.array([8.0, 4.0, 2.25]), rel=2e-3)


@pytest.mark.parametrize("name", ["titan_probe", "earth_drop", "wu2013", "yan2016", "zheng2015", "msl"])
def test_capsules_are_as_wide_as_their_reference_area(name):
    own = vehicle(name)
    area = {"capsule": lambda a: np.pi / 4.0 * a.capsule.diameter_m**2}.get(
        own.aero.model, lambda a: getattr(a, a.model).reference_area_m2
    )(own.aero)
    mesh = craft_shapes.heat_shield(outline(own))
    assert np.pi / 4.0 * extent(mesh)[1:] ** 2 == pytest.approx(area, rel=2e-3)


@pytest.mark.parametrize("diameter", [1.2, 2.4, 3.4, 4.5])
@pytest.mark.parametrize("kind", ["legs", "platform", "rover"])
def test_the_lander_lies_inside_its_aeroshell_whatever_its_size(kind, diameter):
    share = diameter / 3.4
    own = vehicle(
        "tianwen1",
        f"vehicle.aero.capsule.diameter_m={diameter}",
        f"vehicle.aero.capsule.nose_radius_m={0.85 * share}",
        f"vehicle.aero.capsule.shoulder_radius_m={0.085 * share}",
        f"vehicle.aero.capsule.backshell_break_radius_m={1.0 * share}",
        f"vehicle.aero.capsule.backshell_base_radius_m={0.45 * share}",
        f"vehicle.engines.main.nozzle_m=[{-0.3 * share}, 0, 0]",
        f"vehicle.appearance.lander={kind}",
    ).model_copy(update={"rcs": RcsParams()})  # whose struts go wherever the thrusters are
    shape = outline(own)
    place = craft_shapes.lander(own, shape).positions
    shell = np.array(sorted([*shape.forebody, *shape.afterbody]))
    assert np.all(np.hypot(place[:, 1], place[:, 2]) < np.interp(place[:, 0], *shell.T, left=0.0, right=0.0))
    assert np.hypot(place[:, 1], place[:, 2]).max() > 0.35 * 0.5 * diameter, "and not a toy"


@pytest.mark.parametrize("name", ["tianwen1", "msl_landing", "mars2020", "schiaparelli", "phoenix"])
def test_nozzles_beside_the_body_are_carried_by_struts_that_begin_inside_it(name):
    own = vehicle(name)
    shape = outline(own)
    bare = own.model_copy(update={"rcs": RcsParams()})
    carried = craft_shapes.struts(own, shape)
    inside = Delaunay(craft_shapes.lander(bare.model_copy(update={"engines": own.engines}), shape).positions)
    nozzles = craft_shapes.nozzles(own, shape).positions
    assert len(carried) >= 8
    for mount, throat in carried:
        assert inside.find_simplex(mount) >= 0, "not in the air"
        assert np.linalg.norm(nozzles - throat, axis=-1).min() < 0.2
    held = np.array([throat for _, throat in carried])
    for jet in own.rcs.thrusters:
        near = np.linalg.norm(held - np.add(jet.position_m, 0.1 * np.array(jet.direction)), axis=-1).min()
        assert near < 0.01 or inside.find_simplex(jet.position_m) >= 0, jet.name


@pytest.mark.parametrize("name", ["msl_landing", "mars2020"])
def test_a_sky_crane_carries_its_rover_on_bridles_below_it(name):
    own = vehicle(name)
    shape = outline(own)
    assert shape.lander == "crane"
    colours = {tuple(one) for one in craft_shapes.lander(own, shape).colours}
    assert craft_shapes.WHITE in colours and craft_shapes.PANEL not in colours
    x, *across = craft_shapes.lander(own.model_copy(update={"rcs": RcsParams()}), shape).positions.T
    assert x.max() > min(engine.nozzle_m[0] for engine in own.engines), "the rover, below the nozzles"
    assert np.all(np.hypot(*across) < shape.radius_at(x)), "all inside the aeroshell"


def test_legs_are_drawn_where_there_are_footpads_and_a_platform_has_none():
    assert outline(vehicle("tianwen1", "vehicle.appearance={}")).lander == "legs"
    flat = vehicle("tianwen1", "vehicle.appearance.lander=platform")
    assert craft_shapes.legs(flat, outline(flat), np.zeros(4)) is None
    none = vehicle("tianwen1", "vehicle.appearance.lander=none")
    assert craft_shapes.lander(none, outline(none)) is None


def test_own_meshes_take_the_place_of_parts_and_lander(tmp_path):
    from rerun.chunk import RrdReader

    corners = struct.pack("<12f", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0)
    (tmp_path / "x.stl").write_bytes(b"\0" * 80 + struct.pack("<I", 1) + corners + b"\0\0")
    file = tmp_path / "x.stl"
    meshes = f"[{{file: {file}, part: heat_shield, scale: 2.0}}, {{file: {file}, origin_m: [-1, 0, 0]}}]"
    flight = synthetic_flight(("sensors.set=perfect", f"vehicle.appearance.meshes={meshes}"))
    write_replay([history(flight)], tmp_path / "own.rrd")
    held = {
        (str(c.entity_path), c.component)
        for c in RrdReader(tmp_path / "own.rrd").stream().collect().schema().component_columns()
    }
    for entity in ("/site/vehicle/heat_shield", "/site/heat_shield/shape", "/site/vehicle/lander"):
        assert (entity, "Asset3D:blob") in held and (entity, "Mesh3D:vertex_positions") not in held
        assert (entity, "Transform3D:scale") in held
    assert ("/site/vehicle/backshell", "Mesh3D:vertex_positions") in held
    assert "/site/vehicle/legs" not in entities(tmp_path / "own.rrd")


def test_each_parachute_has_its_own_size_while_it_flies():
    """A drogue of 5 m up to the deployment of the main parachute, which the made-up flight calls mortar."""
    own = vehicle().parachutes[0].model_dump(mode="json")
    drogue = {**own, "name": "drogue", "pack": None, "diameter_m": 5.0, "line_length_m": 12.0}
    flight = synthetic_flight(("sensors.set=perfect", f"vehicle.parachutes={json.dumps([drogue, own])}"))
    main = next(event for event in flight.events if event["key"] == "mortar")
    motion = Motion(history(flight))
    (alone,) = motion.parachutes()
    assert (alone.number, motion.t[alone.first]) == (1, pytest.approx(main["t_s"], abs=0.05))
    phase = next(one for one in flight.scenario.mission.phases if one.events and one.role == "parachute")
    mortar = next(one for one in phase.events if one.name == "mortar")
    phase.events.append(mortar.model_copy(update={"name": "drogue", "component": "drogue"}))
    flight.events.append({**main, "key": "drogue"})
    main["t_s"] += 3.0
    pair = Motion(history(flight)).parachutes()
    assert [one.number for one in pair] == [0, 1] and pair[0].end == pair[1].first
    widths = [extent(canopy(flight.scenario.vehicle, one.number)[0])[1:] for one in pair]
    assert widths[1] / widths[0] == pytest.approx(own["diameter_m"] / 5.0, rel=1e-6)


def test_a_biconic_forebody_has_its_break():
    capsule = "vehicle.aero.capsule"
    second = (f"{capsule}.forebody_break_radius_m=1.2", f"{capsule}.forebody_second_cone_angle_deg=50")
    biconic = vehicle("tianwen1", f"{capsule}.cone_half_angle_deg=65", *second)
    forebody = outline(biconic).forebody
    at = next(k for k, (_, r) in enumerate(forebody) if abs(r - 1.2) < 1e-12)
    for k, half_angle in ((at - 1, 65.0), (at, 50.0)):
        (x0, r0), (x1, r1) = forebody[k], forebody[k + 1]
        assert np.degrees(np.arctan2(r1 - r0, x0 - x1)) == pytest.approx(half_angle)
