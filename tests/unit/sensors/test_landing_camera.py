"""Landing camera: obstacles against a count of them, their law, blur by motion, parts in view, slopes."""

import numpy as np
import pytest
from hovering import Hovering, area, bare

from edl6dof.environment.landing_area.population import list_within
from edl6dof.environment.terrain import geodetic_of
from edl6dof.interface.capacities import CAMERA_CELLS
from edl6dof.interface.sensed import cell_direction
from edl6dof.sensors.landing_camera import smear_of_motion, smeared
from edl6dof.spatial.frames import from_geodetic
from edl6dof.spatial.quaternion import from_frame
from edl6dof.vehicle.parachutes.parachute import RELEASED
from edl6dof.vehicle.plant import ATTITUDE, FALLING, LOOSE

STILL = {"misalignment_deg": 0.0, "exposure_s": 0.0}
#: Rocks and nothing else.
ROCKS = area("plane", rms_slope_deg=0.0, crater_density_per_km2=0.0)
CRATERS = area("plane", rms_slope_deg=0.0, rock_abundance=0.0, crater_density_per_km2=200.0)
FLAT = area("plane", rms_slope_deg=0.0, crater_density_per_km2=0.0, rock_abundance=0.0)
TANGENT = np.tan(np.radians(30.0))
SHELL = [part.name for part in FLAT.scenario.vehicle.parts].index("backshell")


def image(bench):
    told = bench.measure()["camera"]
    assert told["fresh"] == 1
    return told["density"].astype(float), told["seen"] == 1


def counted(bench, population, height, smallest, half):
    """Obstacles in view of a camera that looks straight down with z to the south: their diameters, and the
    places where they lie, in cells to the south and to the east of the first corner.
    """
    place = bench.params["position"]
    south, west = float(-place[2]) - half, float(place[1]) - half
    found = np.zeros((400_000, 4))
    number = list_within(bench.case["terrain"]["landing_area"][population], south, west, 2.0 * half, found)
    assert number < len(found)
    north, east, diameter = found[:number, :3].T
    to_east, to_south = east - float(place[1]), -north - float(place[2])
    rows, columns = ((v / (TANGENT * height) + 1.0) * CAMERA_CELLS / 2 for v in (to_south, to_east))
    shown = (diameter >= smallest) & (rows >= 0) & (rows < CAMERA_CELLS)
    shown &= (columns >= 0) & (columns < CAMERA_CELLS)
    return diameter[shown], rows[shown], columns[shown]


def covered(diameter, rows, columns, cell):
    """Share of each cell (width ``cell``, m) that obstacles cover."""
    share = np.zeros((CAMERA_CELLS, CAMERA_CELLS))
    np.add.at(share, (rows.astype(int), columns.astype(int)), 0.25 * np.pi * diameter**2 / cell**2)
    return share


def beside_a_border(rows, columns, tolerance):
    """Cells on both sides of a border that an obstacle lies on, to a tolerance in cells."""
    touched = np.zeros((CAMERA_CELLS, CAMERA_CELLS), dtype=bool)
    for i in (-tolerance, 0.0, tolerance):
        for j in (-tolerance, 0.0, tolerance):
            near = np.clip(np.array([rows + i, columns + j]).astype(int), 0, CAMERA_CELLS - 1)
            on_border = (near[0] != rows.astype(int)) | (near[1] != columns.astype(int))
            touched[near[0][on_border], near[1][on_border]] = True
            touched[rows.astype(int)[on_border], columns.astype(int)[on_border]] = True
    return touched


def test_image_of_rocks_is_a_count_of_them():
    bench = Hovering("landing_camera", ROCKS, STILL | {"steepest_deg": 45.0}, height=200.0)
    density, seen = image(bench)
    depth = bench.clearance(bench.eye())
    pixel = 2.0 * TANGENT * depth / 1024
    diameter, rows, columns = counted(bench, "rocks", depth, 2.0 * pixel, 1.2 * TANGENT * depth)
    cell = 2.0 * TANGENT * depth / CAMERA_CELLS
    expected = covered(diameter, rows, columns, cell)
    assert np.all(seen) and len(diameter) > 500
    # the map of places is straight to 3e-4 of the distance: an obstacle near a border may change cells
    certain = ~beside_a_border(rows, columns, 3e-4 * depth / cell)
    assert certain.mean() > 0.8
    assert np.isclose(density, expected, rtol=2e-3, atol=1e-7)[certain].mean() > 0.995
    assert density.sum() == pytest.approx(expected.sum(), rel=1e-3)


def test_mean_of_many_images_follows_the_law_of_rocks():
    """Golombek: rocks from D1 to D2 cover k (exp(-q D1) - exp(-q D2))."""
    densities = []
    for k in range(12):
        bench = Hovering(
            "landing_camera", ROCKS, STILL | {"steepest_deg": 45.0}, height=150.0, place=(400.0 * k, 0.0)
        )
        densities.append(image(bench)[0].mean())
    smallest = 2.0 * 2.0 * TANGENT * 150.5 / 1024
    q = 1.79 + 0.152 / 0.1
    share = 0.1 * (np.exp(-q * smallest) - np.exp(-q * 5.0))
    assert np.mean(densities) == pytest.approx(share, abs=5.0 * np.std(densities) / np.sqrt(12))
    assert np.std(densities) / np.sqrt(12) < 0.03 * share


def test_steep_craters_count_and_worn_ones_do_not():
    bench = Hovering("landing_camera", CRATERS, STILL, height=700.0)
    density, _ = image(bench)
    depth = bench.clearance(bench.eye())
    cell = 2.0 * TANGENT * depth / CAMERA_CELLS
    diameter, rows, columns = counted(
        bench, "craters", depth, 4.0 * TANGENT * depth / 1024, 1.2 * TANGENT * depth
    )
    small = diameter < 0.5 * cell
    every, some = covered(diameter[small], rows[small], columns[small], cell), density > 0.0
    assert some.sum() > 100
    assert density.sum() > 0.5 * every.sum()
    steeper = Hovering("landing_camera", CRATERS, STILL | {"steepest_deg": 25.0}, height=700.0)
    assert 0.0 < image(steeper)[0].sum() < 0.7 * density.sum()


@pytest.mark.parametrize("slope", [0.0, 12.0])
def test_corners_of_the_cells_lie_on_the_ground_where_they_look(slope):
    bench = Hovering("landing_camera", bare(slope), STILL, height=800.0, turns=(30.0, 12.0, -8.0))
    image(bench)
    planet, terrain, eye = bench.case["planet"], bench.case["terrain"], bench.eye()
    areoid, q = bench.plant["inputs"]["areoid"], tuple(bench.plant["y"][ATTITUDE : ATTITUDE + 4])
    shape = float(planet["equatorial_radius"]), float(planet["flattening"])
    for i in range(0, CAMERA_CELLS + 1, 8):
        for j in range(0, CAMERA_CELLS + 1, 8):
            north, east, level = map(float, bench.memory["cells"]["place"][i, j])
            lat, lon = geodetic_of(terrain, north, east)
            at_areoid = areoid[:3] @ from_geodetic(*shape, lat, lon, 0.0) + areoid[3]
            altitude = float(at_areoid + terrain["site_elevation"] + level)
            point = np.array(from_geodetic(*shape, lat, lon, altitude))
            assert abs(bench.clearance(point)) < 1e-2
            way = point - eye
            direction = from_frame(q, cell_direction(TANGENT, CAMERA_CELLS, i - 0.5, j - 0.5))
            assert np.linalg.norm(np.cross(way / np.linalg.norm(way), direction)) < 1e-3


@pytest.mark.parametrize("slope, expected", [(7.5, 0.0), (8.5, 1.0)])
def test_ground_too_steep_is_an_obstacle(slope, expected):
    density, seen = image(Hovering("landing_camera", bare(slope), STILL, height=300.0))
    assert np.all(seen) and np.allclose(density, expected)


def test_small_obstacles_are_lost_with_height_and_with_motion():
    def total(height, **given):
        settings = STILL | {"steepest_deg": 45.0} | given.pop("params", {})
        return image(Hovering("landing_camera", ROCKS, settings, height=height, **given))[0].mean()

    assert total(150.0) > 2.0 * total(600.0) > 0.0
    still = total(150.0)
    for motion in ({"v_ned": (60.0, 0.0, 0.0)}, {"w": (0.0, 0.4, 0.0)}):
        exposed = {"params": {"exposure_s": 0.01}, **motion}
        assert total(150.0, **exposed) < 0.8 * still
    # the same motion over no time
    assert total(150.0, v_ned=(60.0, 0.0, 0.0)) == still
    # as many pixels as the image moves: 60 m/s for 0.01 s are 3.5 pixels of 0.17 m
    blurred = total(150.0, v_ned=(60.0, 0.0, 0.0), params={"exposure_s": 0.01})
    coarser = total(150.0, params={"smallest_px": 2.0 + 0.6 / (2.0 * TANGENT * 150.5 / 1024)})
    assert blurred == pytest.approx(coarser, rel=0.01)


@pytest.mark.parametrize("seed", range(5))
def test_smear_is_how_far_a_point_moves_in_the_picture(seed):
    """By the pinhole projection of the point before and after the exposure, half of it each way."""
    rng = np.random.default_rng(seed)
    velocity, rate = rng.normal(0.0, 5.0, 3), rng.normal(0.0, 0.1, 3)
    look, depth, tangent, exposure = np.array([1.0, 0.3, -0.4]), 80.0, 0.4, 0.01
    point = depth * look

    def picture(t):
        """Row and column: z and y of the point over its depth, seen from the moving, turning camera."""
        seen = point - t * (velocity + np.cross(rate, point))
        return 0.5 * CAMERA_CELLS / tangent * seen[[2, 1]] / seen[0]

    half = 0.5e-3 * exposure
    moved = (picture(half) - picture(-half)) * 1e3
    motion = tuple(velocity), tuple(rate)
    found = smear_of_motion(motion, tuple(look), depth, tangent, exposure)
    assert found == pytest.approx(moved, rel=1e-6)


def test_smear_runs_along_the_motion_and_keeps_the_sum():
    sharp = np.zeros((CAMERA_CELLS, CAMERA_CELLS), "f4")
    sharp[30, 30] = 1.0

    def out(smear):
        return np.array([[smeared(sharp, i, j, smear) for j in range(64)] for i in range(64)])

    assert np.array_equal(out((0.0, 0.0)), sharp)
    for smear in ((6.0, 0.0), (0.0, -6.0), (4.0, 4.0), (0.3, 0.1)):
        blurred = out(smear)
        rows, columns = np.nonzero(blurred > 1e-9)
        assert blurred.sum() == pytest.approx(1.0, abs=1e-6)
        for cells, length in ((rows, smear[0]), (columns, smear[1])):
            assert np.max(np.abs(cells - 30)) <= np.ceil(abs(length) / 2.0)
        offsets = np.array(np.nonzero(blurred)) - 30
        spread = np.average(offsets**2, axis=1, weights=blurred[blurred > 0.0])
        if max(map(abs, smear)) > 1.0:
            assert spread[0] >= spread[1] if abs(smear[0]) > abs(smear[1]) else True
            assert np.sum(spread) == pytest.approx(np.dot(smear, smear) / 12.0, rel=0.35)


def disc(offset_east, offset_south, depth, radius):
    """Cells whose middles a sphere hides."""
    steps = (2.0 * np.arange(CAMERA_CELLS) + 1.0) / CAMERA_CELLS - 1.0
    z, y = np.meshgrid(TANGENT * steps, TANGENT * steps, indexing="ij")
    to = np.array([depth, offset_east, offset_south])
    along = (to[0] + y * to[1] + z * to[2]) / np.sqrt(1.0 + y * y + z * z)
    return (along > 0.0) & (to @ to - along**2 <= radius**2)


def plant_part(bench, part, to_eye, active=FALLING):
    """Put a part ``to_eye`` (m: down, east, south) from the eye, at rest over the ground."""
    q = bench.plant["y"][ATTITUDE : ATTITUDE + 4]
    r = bench.eye() + np.array(from_frame(tuple(q), to_eye))
    debris = bench.plant["debris"][part]
    spin = float(bench.case["planet"]["rotation_rate"])
    debris["active"], debris["r_I"], debris["mass"] = active, r, 130.0
    debris["v_I"] = (-spin * r[1], spin * r[0], 0.0)
    debris["drag_area"] = bench.case["vehicle"]["parts"][part]["drag_area"]
    return debris


def test_a_part_below_hides_what_lies_behind_it():
    bench = Hovering("landing_camera", FLAT, STILL, height=300.0)
    plant_part(bench, SHELL, (25.0, 4.0, -6.0))
    _, seen = image(bench)
    hidden = disc(4.0, -6.0, 25.0, np.sqrt(9.0 / np.pi))
    assert 10 < hidden.sum() < 60
    assert np.array_equal(~seen, hidden)
    plant_part(bench, SHELL, (-25.0, 4.0, -6.0))  # above
    assert np.all(image(bench)[1])


def test_a_canopy_hides_more_above_the_part_that_carries_it():
    bench = Hovering("landing_camera", FLAT, STILL, height=900.0)
    lines = float(bench.case["vehicle"]["parachutes"][0]["line_length"])
    debris = plant_part(bench, SHELL, (120.0, 40.0, 0.0), LOOSE)
    debris["drag_area"] += 100.0
    bench.plant["canopy"], bench.plant["parachute"] = RELEASED, 0
    down = bench.looks(2).mean(axis=(0, 1))
    debris["v_I"] += 30.0 * down / np.linalg.norm(down)
    _, seen = image(bench)
    shell_disc = disc(40.0, 0.0, 120.0, np.sqrt(9.0 / np.pi))
    both = shell_disc | disc(40.0, 0.0, 120.0 - lines, np.sqrt(100.0 / np.pi))
    assert both.sum() > shell_disc.sum() + 20
    assert np.array_equal(~seen, both)


def test_past_the_horizon_and_beyond_its_range_it_sees_no_ground():
    bench = Hovering("landing_camera", FLAT, STILL, height=300.0, turns=(0.0, 70.0, 0.0))
    _, seen = image(bench)
    assert 0.2 < seen.mean() < 0.8
    rows = seen.mean(axis=1)
    assert {0.0, 1.0} <= set(rows[[0, -1]])
    near = Hovering("landing_camera", FLAT, STILL | {"longest_m": 340.0}, height=300.0)
    _, seen = image(near)
    ranges = 300.5 * np.sqrt(1.0 + (TANGENT * ((2.0 * np.arange(64) + 1.0) / 64 - 1.0)) ** 2)
    assert np.all(seen[32, ranges < 335.0]) and not np.any(seen[0])


def test_takes_an_image_when_told_alone_and_the_same_one_again():
    bench = Hovering("landing_camera", ROCKS, {})
    first = image(bench)[0]
    bench.plant["imagers"]["camera_trigger"] = 0
    assert bench.measure()["camera"]["fresh"] == 0
    assert np.array_equal(first, image(Hovering("landing_camera", ROCKS, {}))[0])
