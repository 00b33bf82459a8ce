"""Landing camera: an image of the share of the ground that obstacles take, as far as the camera resolves
them.

The camera resolves obstacles of at least some pixels.  Motion of the image during the exposure, by speed and
by rotation, raises this limit and smears the image along the motion. Cells that look past the ground, farther
than the camera sees, or at the backshell, the canopy or another part, show no ground; nor does a cell that
moves across the whole image.

Lines of sight along the corners of a cell are intersected with the ground without generated rocks and
craters, which are low at the heights that images are taken from; the generated surface then gives the heights
of the corners.  Rocks, craters with steep walls, and steep ground are obstacles.  Obstacles smaller than the
camera can resolve do not count, nor does a crater wider than the cell: its walls show in the slope of the
cells that lie on them.

Source: Trawny et al., Flight testing of terrain-relative navigation and large-divert guidance on a VTVL
rocket, AIAA SPACE (2015), for image motion; obstacles of a landing image: Chinese patent CN108594802B. Left
out: shadow and texture.
"""

from __future__ import annotations

from math import pi, sqrt

from edl6dof.config.base import Vec3, param
from edl6dof.environment.landing_area.population import (
    cell_bits,
    crater_height,
    drawn_in,
    first_cell,
    last_cell,
    member,
)
from edl6dof.environment.landing_area.relief import GENERATED
from edl6dof.environment.terrain import geodetic_of, ground, regional
from edl6dof.interface.capacities import CAMERA_CELLS
from edl6dof.interface.sensed import cell_direction
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.registry import Member
from edl6dof.sensors.imager import (
    DISCS,
    IMAGER_UNIT,
    ImagerParams,
    draw_imager,
    find_discs,
    ground_direction,
    imager_pose,
    is_hidden,
    reciprocal_axes,
    view_range,
)
from edl6dof.sensors.ray_ground import LEVEL, point_motion
from edl6dof.spatial.elementary import tan
from edl6dof.spatial.frames import rotate_z
from edl6dof.spatial.quaternion import to_frame
from edl6dof.spatial.table_index import held_cell
from edl6dof.spatial.vector import add, cross, dot, norm, put3, scale, sub, take3
from edl6dof.vehicle.plant import RATE, take_attitude
from edl6dof.vehicle.surroundings import planet_rotation

CORNERS = CAMERA_CELLS + 1
#: Iterations of the intersection of a corner with the ground, at most: each leaves an error smaller than the
#: one before by the slope of the ground times the tangent of the ray's angle to the vertical.
_ITERATIONS = 5
#: Change of the distance (m) at which the iteration ends.
_CLOSE = 1e-6

GROUND_CELLS = record(
    ("place", "f8", (CORNERS, CORNERS, 3)),  # m north, east and above the site, of each corner
    ("met", FLAG, (CORNERS, CORNERS)),  # it shows ground
)


@kernel
def lay_cells(case, tables, pose, tangent, reach, cells):
    """Find the ground seen along the corners of the cells, up to ``reach`` (m); ``pose``: of
    :func:`imager_pose`.
    """
    origin, axes, height = pose
    terrain = case.terrain
    for i in range(CORNERS):
        for j in range(CORNERS):
            ray = ground_direction(axes, cell_direction(tangent, CAMERA_CELLS, i - 0.5, j - 0.5))
            cells.met[i, j] = 0
            if not (height > 0.0 and ray[2] < -LEVEL):
                continue
            way = -height / ray[2]
            for _ in range(_ITERATIONS):
                lat, lon = geodetic_of(terrain, origin[0] + way * ray[0], origin[1] + way * ray[1])
                level = regional(terrain, tables.terrain, lat, lon)[0] - terrain.site_elevation
                before, way = way, (level - origin[2]) / ray[2]
                if abs(way - before) < _CLOSE:
                    break
            if 0.0 < way <= reach:
                y, x = origin[0] + way * ray[0], origin[1] + way * ray[1]
                lat, lon = geodetic_of(terrain, y, x)
                level = ground(terrain, tables.terrain, lat, lon)[0] - terrain.site_elevation
                put3(cells.place[i, j], 0, (y, x, level))
                cells.met[i, j] = 1


@kernel
def shows_ground(cells, i, j):
    """Test whether all of the cell (``i``, ``j``) shows ground."""
    return cells.met[i, j] + cells.met[i, j + 1] + cells.met[i + 1, j] + cells.met[i + 1, j + 1] == 4


@kernel
def extent(cells, i, j):
    """Area (m2, seen from above) of a cell on the ground, and the tangent of its slope."""
    normal = cross(
        sub(take3(cells.place[i + 1, j + 1], 0), take3(cells.place[i, j], 0)),
        sub(take3(cells.place[i + 1, j], 0), take3(cells.place[i, j + 1], 0)),
    )
    return 0.5 * abs(normal[2]), sqrt(normal[0] * normal[0] + normal[1] * normal[1]) / abs(normal[2])


@kernel
def middle(cells, i, j):
    """Middle of a cell on the ground: m north, east and above the site."""
    place = cells.place
    return (
        0.25 * (place[i, j, 0] + place[i, j + 1, 0] + place[i + 1, j, 0] + place[i + 1, j + 1, 0]),
        0.25 * (place[i, j, 1] + place[i, j + 1, 1] + place[i + 1, j, 1] + place[i + 1, j + 1, 1]),
        0.25 * (place[i, j, 2] + place[i, j + 1, 2] + place[i + 1, j, 2] + place[i + 1, j + 1, 2]),
    )


@kernel
def span(cells, i, j, k):
    """Least and most of coordinate ``k`` among the corners of a cell."""
    a, b = cells.place[i, j, k], cells.place[i, j + 1, k]
    c, d = cells.place[i + 1, j, k], cells.place[i + 1, j + 1, k]
    return min(min(a, b), min(c, d)), max(max(a, b), max(c, d))


#: Part of its radius, inwards from the rim, over which the wall of a crater is taken.
_WALL = 0.1


@kernel
def share_of_obstacles(area, view, cells, i, j, smallest, steepest):
    """Share of the ground of the cell (``i``, ``j``) that obstacles take.

    Args:
        area: ``LANDING_AREA`` record.
        view: origin of the imager, :func:`reciprocal_axes`, tangent of half the field of view.
        cells: ``GROUND_CELLS`` record.
        smallest: diameter (m) of the smallest obstacle that can be made out.
        steepest: tangent of the slope from which on ground is an obstacle.
    """
    size, slope = extent(cells, i, j)
    if slope >= steepest:
        return 1.0
    if area.model != GENERATED:
        return 0.0
    rocks = covered(
        area.rocks, view, cells, i, j, smallest=smallest, largest=area.largest_rock, steepest=-1.0
    )
    craters = covered(
        area.craters, view, cells, i, j, smallest=smallest, largest=sqrt(size), steepest=steepest
    )
    return min((rocks + craters) / size, 1.0)


@kernel
def covered(population, view, cells, i, j, smallest, largest, steepest):
    """Area (m2) covered by the members of a population whose middle lies in the cell (``i``, ``j``), with
    diameters from ``smallest`` to ``largest`` (m) and walls at least as steep as ``steepest`` (below 0: any).
    """
    south, north = span(cells, i, j, 0)
    west, east = span(cells, i, j, 1)
    height, taken = middle(cells, i, j)[2], 0.0
    for k in range(population.n):
        if population.largest[k] < smallest or population.smallest[k] > largest:
            continue
        for a in range(first_cell(population, k, south), last_cell(population, k, north) + 1):
            for b in range(first_cell(population, k, west), last_cell(population, k, east) + 1):
                bits = cell_bits(population, k, a, b)
                for n in range(drawn_in(population, k, bits)):
                    y, x, diameter, character = member(population, k, bits, i=a, j=b, n=n)
                    if (
                        max(smallest, 1e-3) <= diameter <= largest
                        and wall(diameter, character) >= steepest
                        and shows_at(view, (y, x, height), i, j)
                    ):
                        taken += 0.25 * pi * diameter * diameter
    return taken


@kernel
def wall(diameter, freshness):
    """Tangent of the slope of a crater's wall below its rim."""
    rim = 0.25 * diameter * diameter
    inner = (1.0 - _WALL) ** 2 * rim
    rise = crater_height(diameter, freshness, rim) - crater_height(diameter, freshness, inner)
    return rise / (0.5 * _WALL * diameter)


@kernel
def shows_at(view, place, i, j):
    """Test whether a place on the ground is seen in the cell (``i``, ``j``)."""
    origin, parts, tangent = view
    to_place = sub(place, origin)
    depth = dot(to_place, parts[0])
    if depth <= 0.0:
        return False
    half = 0.5 * CAMERA_CELLS / (tangent * depth)
    column = half * dot(to_place, parts[1]) + 0.5 * CAMERA_CELLS
    row = half * dot(to_place, parts[2]) + 0.5 * CAMERA_CELLS
    return i <= row < i + 1 and j <= column < j + 1


#: Samples of an image on each half of a smear: two for each cell of one that is 16 cells long.
_SAMPLES = 16


class LandingCameraParams(ImagerParams):
    """Landing camera."""

    largest = {"m": 1e5}

    field_of_view_deg: float = param(
        60.0, "field of view along rows and along columns", status="estimate", gt=0.0, le=120.0
    )
    position_m: Vec3 = param((-0.5, -0.6, 0.0), "position of the camera in B", status="estimate")
    pixels: int = param(
        1024, "pixels along each side of the image", status="estimate", ge=CAMERA_CELLS, le=16384
    )
    smallest_px: float = param(
        2.0,
        "diameter of the smallest obstacle that it detects, in pixels",
        status="estimate",
        gt=0.0,
        le=100.0,
    )
    exposure_s: float = param(0.002, "time for which an image is exposed", status="estimate", ge=0.0, le=1.0)
    steepest_deg: float = param(
        8.0,
        "slope from which the ground counts as an obstacle",
        status="recalled",
        source="Chang'e-3",
        gt=0.0,
        le=45.0,
    )
    longest_m: float = param(5000.0, "distance up to which it sees ground", status="estimate", gt=0.0)


MEMORY = record(
    ("cells", GROUND_CELLS),
    ("discs", DISCS),
    ("sharp", "f4", (CAMERA_CELLS, CAMERA_CELLS)),  # the image without motion
    ("smear", "f8", (CAMERA_CELLS, CAMERA_CELLS, 2)),  # rows and columns that each cell moves by
)


@kernel
def measure(params, unit, case, tables, plant, outputs, memory, sensed):
    """Take an image when the camera is triggered."""
    camera = sensed.camera
    camera.fresh = 0 if plant.instruments.camera_lost != 0 else plant.imagers.camera_trigger
    if camera.fresh == 0:
        return
    position, turn, tangent = take3(params.position, 0), take3(unit.turn, 0), tan(0.5 * params.field_of_view)
    origin, axes, height = imager_pose(case, tables, plant, outputs, position, turn=turn)
    view = (origin, reciprocal_axes(axes), tangent)
    reach = view_range(params, plant)
    lay_cells(case, tables, (origin, axes, height), tangent, reach, cells=memory.cells)
    find_discs(case, plant, outputs, position, turn, discs=memory.discs)
    motion = _motion(case, plant, outputs, position)
    pixel, steepest = 2.0 * tangent / params.pixels, tan(params.steepest)
    for i in range(CAMERA_CELLS):
        for j in range(CAMERA_CELLS):
            direction = cell_direction(tangent, CAMERA_CELLS, i, j)
            depth = dot(sub(middle(memory.cells, i, j), origin), view[1][0])
            row, column = smear_of_motion(motion, direction, depth, tangent, params.exposure)
            blur = norm((row, column, 0.0)) * params.pixels / CAMERA_CELLS
            shows = shows_ground(memory.cells, i, j) and not is_hidden(memory.discs, direction)
            seen = shows and blur < params.pixels
            camera.seen[i, j] = 1 if seen else 0
            memory.sharp[i, j] = memory.smear[i, j, 0] = memory.smear[i, j, 1] = 0.0
            if seen:
                memory.smear[i, j, 0], memory.smear[i, j, 1] = row, column
                smallest = (params.smallest_px + blur) * pixel * depth
                memory.sharp[i, j] = share_of_obstacles(
                    case.terrain.landing_area, view, memory.cells, i, j, smallest=smallest, steepest=steepest
                )
    for i in range(CAMERA_CELLS):
        for j in range(CAMERA_CELLS):
            seen = camera.seen[i, j] != 0
            smear = (memory.smear[i, j, 0], memory.smear[i, j, 1])
            camera.density[i, j] = smeared(memory.sharp, i, j, smear) if seen else 0.0


@kernel
def _motion(case, plant, outputs, position):
    """Velocity over the ground (m/s, B) and rate (rad/s, B) of the camera."""
    y = plant.y
    c, s = planet_rotation(case.planet, plant.t)
    _, v = point_motion(case, plant, outputs, position, (c, s))
    q = take_attitude(y)
    return to_frame(q, rotate_z(c, -s, v)), take3(y, RATE)


@kernel
def smear_of_motion(motion, look_B, depth, tangent, exposure):
    """Rows and columns that a point of the ground moves by during the exposure, at a depth (m)."""
    velocity, rate = motion
    to_ground = scale(depth / look_B[0], look_B)
    moving = scale(-1.0, add(velocity, cross(rate, to_ground)))
    per_cell = 0.5 * CAMERA_CELLS * exposure / (tangent * depth)
    row = moving[2] - moving[0] * to_ground[2] / depth
    column = moving[1] - moving[0] * to_ground[1] / depth
    return per_cell * row, per_cell * column


@kernel
def smeared(sharp, i, j, smear):
    """Mean of an image along a smear (rows, columns) about the cell (``i``, ``j``)."""
    cells, total = sharp.shape[0] - 1, 0.0
    for k in range(-_SAMPLES, _SAMPLES + 1):
        share = 0.5 * k / _SAMPLES
        a, u = held_cell(i + share * smear[0], cells)
        b, t = held_cell(j + share * smear[1], cells)
        before = (1.0 - t) * sharp[a, b] + t * sharp[a, b + 1]
        after = (1.0 - t) * sharp[a + 1, b] + t * sharp[a + 1, b + 1]
        total += (1.0 - u) * before + u * after
    return total / (2 * _SAMPLES + 1)


MEMBER = Member(
    "landing_camera",
    LandingCameraParams,
    {"measure": measure},
    "Chinese patent CN108594802B",
    memory=MEMORY,
    tables=IMAGER_UNIT,
    plan=draw_imager,
    writes=("camera",),
)
