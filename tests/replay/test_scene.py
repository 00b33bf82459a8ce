"""Ground, shapes and phase planes of the replay against the vehicle file, the true terrain and the control
laws.
"""

from __future__ import annotations

from math import radians
from types import SimpleNamespace

import numpy as np
import pytest

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.environment.areoid import areoid_height
from edl6dof.environment.terrain import TERRAIN, fill_terrain, ground_arrays, ground_inputs
from edl6dof.environment.terrain import ground as true_ground
from edl6dof.fsw.control import phase_plane as law
from edl6dof.fsw.control.phase_plane import switch_axis
from edl6dof.fsw.control.phase_plane_zones import ZoneParams, target_rate
from edl6dof.replay.charts import boundaries, squeeze
from edl6dof.replay.scene import craft_shapes
from edl6dof.replay.scene.craft_shapes import canopy
from edl6dof.replay.scene.landscape import RINGS, SHADE, SPOKES, Landscape, dither, grain, sky
from edl6dof.replay.scene.outline import outline
from edl6dof.replay.scene.poses import Site
from edl6dof.replay.scene.tracks import Globe, planet
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.terrain_preview import planned_ellipse


@pytest.fixture(scope="module")
def scenario():
    return load_scenario("tianwen1").scenario


@pytest.fixture(scope="module")
def site(scenario) -> Site:
    return Site(scenario)


def test_ground_is_that_of_the_simulation(scenario, site):
    terrain, grid = np.zeros(1, TERRAIN), ground_arrays(ground_inputs(scenario.terrain, scenario.planet))
    fill_terrain(terrain[0], scenario.terrain, grid, scenario.planet)
    for dlat, dlon in ((0.0, 0.0), (0.4, -0.7), (-3.0, 5.0)):
        lat, lon = (
            radians(scenario.terrain.site_latitude_deg + dlat),
            radians(scenario.terrain.site_longitude_deg + dlon),
        )
        elevated = true_ground(terrain[0], grid, lat, lon)[0]
        height = elevated + areoid_height(scenario.planet, lat, lon)
        e2 = site.flattening * (2.0 - site.flattening)
        prime = site.radius / np.sqrt(1.0 - e2 * np.sin(lat) ** 2)
        place = np.array(
            [(prime + height) * np.cos(lat) * np.cos(lon), (prime + height) * np.cos(lat) * np.sin(lon), 0.0]
        )
        place[2] = (prime * (1.0 - e2) + height) * np.sin(lat)
        east, north, up = site.axes @ (place - site.origin)
        elevation, drawn = site.ground(east, north)
        assert float(elevation) == pytest.approx(elevated, abs=5.0)
        assert float(drawn) == pytest.approx(up, abs=6.0)


def test_planned_ellipse_is_56_by_22_km_along_the_flight(scenario):
    site = scenario.terrain
    east, north = planned_ellipse(
        site.ellipse_length_m, site.ellipse_width_m, radians(site.ellipse_azimuth_deg)
    )
    far = np.hypot(east, north)
    assert (2.0 * far.max(), 2.0 * far.min()) == pytest.approx((56e3, 22e3))
    flight = np.radians(scenario.initial.azimuth_deg)
    assert abs(east[far.argmax()] * np.cos(flight) - north[far.argmax()] * np.sin(flight)) < 1e-3 * far.max()


def test_decoration_leaves_the_touchdown_alone_and_is_the_same_every_time(site):
    landscape, again = (Landscape(site, np.array([200.0, -50.0, 0.0])) for _ in range(2))
    mesh = landscape.mesh()
    assert np.array_equal(mesh.positions, again.mesh().positions)
    offset = np.hypot(mesh.positions[:, 0] - 200.0, mesh.positions[:, 1] + 50.0)
    near = mesh.positions[(offset < 5.9) & (mesh.positions[:, 2] > -1e3)]
    assert np.allclose(near[:, 2], site.ground(near[:, 0], near[:, 1])[1], atol=1e-6)
    far = mesh.positions[(offset > 200.0) & (offset < 2000.0)]
    relief = far[:, 2] - site.ground(far[:, 0], far[:, 1])[1]
    assert 0.2 < np.std(relief) < 20.0, "craters and ripples, not mountains"
    assert len(landscape.rocks().places) == 0, "the simulation knows no rock here, and no limit is checked"


@pytest.mark.parametrize("name", ["tianwen1", "msl_landing", "titan_probe"])
def test_decoration_puts_no_touchdown_into_a_pit(name):
    """Waves and craters wider than the calm ground around the vehicle were higher than it by up to 43 m."""
    site, turn = Site(load_scenario(name).scenario), np.linspace(0.0, 2.0 * np.pi, 90)
    landscape = Landscape(site, np.zeros(3))
    for radius in (40.0, 60.0, 100.0):
        east, north = radius * np.cos(turn), radius * np.sin(turn)
        assert abs(np.mean(landscape.height(east, north) - site.ground(east, north)[1])) < 4.0


def test_the_mesh_of_the_ground_is_as_fine_along_a_spoke_as_across(site):
    """Otherwise waves and craters would be smeared; and far waves, which are coarse, are faint."""
    landscape = Landscape(site, np.zeros(3))
    radius, spokes = landscape._radius, len(landscape._cos)
    assert np.all(np.abs(np.diff(radius) / radius[:-1] * spokes / (2.0 * np.pi) - 1.0) < 0.05)
    colours = landscape.mesh().colours[:-2].reshape(len(radius), spokes, -1)[..., 0].astype(float)
    spread = [colours[(radius > low) & (radius < 2.0 * low)].std() for low in (100.0, 2e4)]
    assert spread[1] < 0.5 * spread[0]


def test_the_grain_of_the_ground_grows_with_the_mesh_and_has_no_seam(site):
    mesh, noise = Landscape(site, np.zeros(3)).mesh(), grain()
    texture, places = noise["albedo_texture"].astype(float), noise["vertex_texcoords"]
    assert len(places) == len(mesh.positions)
    of_rings = places[:-2].reshape(RINGS, SPOKES, 2)
    steps = np.abs(np.diff(of_rings, axis=1, append=of_rings[:, :1]))[..., 0]
    assert np.allclose(steps, steps[0, 0]), "also from the last spoke to the first"
    assert np.allclose(np.diff(of_rings[..., 1], axis=0), steps[0, 0]), "square grain on a square mesh"
    assert abs(texture.mean() - SHADE) < 1.0 and 5.0 < texture.std() < 12.0


def test_the_sky_has_no_bands():
    """A texel of noise for each pixel (0.05 deg) that changes a colour by less than two of its 256 steps."""
    dome, noise = sky((150.0, 110.0, 80.0), (90.0, 60.0, 40.0)), dither()
    texture, places = noise["albedo_texture"], noise["vertex_texcoords"]
    assert len(places) == len(dome.positions)
    assert np.unique(texture).size > 2 and np.ptp(150.0 * texture / 255.0) < 2.0
    assert np.ptp(places[:, 1]) * texture.shape[0] * 0.05 == pytest.approx(180.0)


def test_shapes_have_the_dimensions_of_the_vehicle_file(scenario):
    vehicle = scenario.vehicle
    shape = outline(vehicle)
    shield, shell = craft_shapes.heat_shield(shape), craft_shapes.backshell(shape)
    radius = np.hypot(shield.positions[:, 1], shield.positions[:, 2])
    assert 2.0 * radius.max() == pytest.approx(vehicle.aero.capsule.diameter_m, rel=1e-9)
    assert shield.positions[:, 0].max() == pytest.approx(0.0, abs=1e-9), "the nose is the origin"
    flank = shield.positions[
        (radius > 0.55) & (radius < 1.5) & (np.linalg.norm(shield.normals, axis=1) > 0.5)
    ]
    outer = flank[flank[:, 0] > -0.5 * (np.hypot(flank[:, 1], flank[:, 2]))]
    slope = np.polyfit(np.hypot(outer[:, 1], outer[:, 2]), outer[:, 0], 1)[0]
    assert np.degrees(np.arctan2(1.0, -slope)) == pytest.approx(
        vehicle.aero.capsule.cone_half_angle_deg, abs=6.0
    )
    assert (
        np.hypot(shell.positions[:, 1], shell.positions[:, 2]).max() < 0.51 * vehicle.aero.capsule.diameter_m
    )
    bells = craft_shapes.nozzles(vehicle, shape).positions
    for jet in vehicle.rcs.thrusters:
        assert np.min(np.linalg.norm(bells - jet.position_m, axis=1)) < 0.12, jet.name
    feet = craft_shapes.legs(vehicle, shape, np.zeros(4)).positions
    for pad in vehicle.landing_gear.footpads_m:
        assert np.min(np.linalg.norm(feet - pad, axis=1)) < 0.01
    open_canopy, lines = canopy(vehicle, 0)
    assert np.hypot(open_canopy.positions[:, 1], open_canopy.positions[:, 2]).max() * 2.0 == pytest.approx(
        0.68 * vehicle.main_parachute.diameter_m, rel=0.01
    )
    assert lines[..., 0].max() >= vehicle.main_parachute.line_length_m


def test_zone_lines_are_those_that_the_control_law_steers_for():
    """The yellow line is the law's own target rate; near and far bounds stand where the parameters say."""
    params = ZoneParams(rate_deg_s=6.0, far_deg=25.0, near_deg=2.0, deceleration_deg_s2=3.0)
    record = np.zeros(1, dtype_of(ZoneParams))
    fill(record[0], params)
    lines = boundaries(dict.fromkeys(("roll", "pitch_yaw"), params.model_dump()), 1)
    curve = np.sinh(lines[1][0] * np.arcsinh(180.0)) * [1.0, -1.0]
    for error, rate in curve[1:-1:7]:
        assert np.degrees(target_rate(record[0], np.radians(error), 1.0)) == pytest.approx(rate, rel=1e-6)
    upright = sorted({round(float(line[0, 0]), 9) for line, _ in lines if line[0, 0] == line[1, 0]})
    assert upright == pytest.approx(sorted([squeeze(k) for k in (-25.0, -2.0, 2.0, 25.0)]))


def test_deadband_lines_are_where_the_switching_law_begins_to_fire():
    params = law.PhasePlaneParams(deadband_deg=2.0, rate_limit_deg_s=30.0)
    record = np.zeros(1, dtype_of(law.PhasePlaneParams))
    fill(record[0], params)
    right = np.sinh(boundaries(params.model_dump(), 0)[1][0] * np.arcsinh(180.0)) * [1.0, -1.0]
    for error, rate in right[(np.abs(right[:, 1]) < 8.0) & (np.abs(right[:, 1]) > 0.2)][::3]:
        inside, outside = (
            switch_axis(record[0], 0, np.radians(error + d), np.radians(rate)) for d in (-0.01, 0.01)
        )
        assert (inside, outside) == (0, 1), (error, rate)


def test_globe_shows_the_map():
    mesh = planet(
        3396.19,
        Site(load_scenario("tianwen1").scenario).relief.map,
        load_scenario("tianwen1").scenario.planet.appearance.relief,
    )
    assert np.allclose(np.linalg.norm(mesh.positions, axis=1), 3396.19, atol=1e-6)
    tone = mesh.colours.astype(int).sum(axis=1)
    olympus, hellas = (_nearest(mesh.positions, lat, lon) for lat, lon in ((18.65, -133.8), (-42.4, 70.5)))
    assert tone[olympus] > tone[hellas] + 150
    assert mesh.triangles.max() == len(mesh.positions) - 1


def test_the_globe_points_at_the_sun():
    """From the landing site, as high above its horizon as the calendar says."""
    site, told = Site(load_scenario("tianwen1").scenario), {}
    motion = SimpleNamespace(site=site)
    globe = SimpleNamespace(motion=motion, rr=pytest.importorskip("rerun"), static=told.__setitem__)
    globe.point = lambda *_: None
    Globe._sun(globe)
    arrow = told["globe/sun"].vectors.as_arrow_array().to_pylist()[0]
    up = site.origin / np.linalg.norm(site.origin)
    assert np.dot(arrow, up) / np.linalg.norm(arrow) == pytest.approx(site.sun[2], abs=5e-3)
    site.sun, told["globe/sun"] = None, None
    Globe._sun(globe)
    assert told["globe/sun"] is None


def _nearest(positions: np.ndarray, lat_deg: float, lon_deg: float) -> int:
    lat, lon = np.radians([lat_deg, lon_deg])
    way = np.array([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])
    return int(np.argmax(positions @ way))


def test_ground_and_globe_have_the_colours_of_the_planet():
    """Titan's pictures are not those of Mars: each tone lies between the planet's own darkest and lightest
    ground.
    """
    titan = Site(load_scenario("titan_probe").scenario)
    look = titan.appearance
    near = Landscape(titan, np.zeros(3)).mesh().colours[-2].astype(float)
    ratio = near / near[0]
    own = [np.array(tone) / tone[0] for tone in (look.ground_dark, look.ground_light)]
    assert np.all(ratio >= np.minimum(*own) - 0.05) and np.all(ratio <= np.maximum(*own) + 0.05)
    globe = planet(2574.7, titan.relief.map, look.relief).colours
    assert np.all(globe == globe[0]) and tuple(globe[0][:3]) == tuple(look.relief[0][1:])


@pytest.mark.parametrize("name", ["tianwen1", "titan_probe", "earth_drop", "nesc/case06"])
def test_ground_is_a_globe_of_the_planets_own_size(name):
    """Every vertex lies on the true ground or, for decoration, within a crater's depth of it."""
    scenario = load_scenario(name).scenario
    site = Site(scenario)
    mesh = Landscape(site, np.array([50.0, -20.0, 0.0])).mesh()
    place = mesh.positions[:-1] + site.axes @ site.origin
    squash = 1.0 / (1.0 - site.flattening)
    polar = place @ site.axes[:, 2]
    radius = np.sqrt((place**2).sum(axis=-1) + (squash**2 - 1.0) * polar**2)
    assert np.abs(radius / site.radius - 1.0).max() < 25e3 / site.radius
    assert mesh.positions[:, 2].min() < -1.99 * (1.0 - site.flattening) * site.radius, "its far side is there"
