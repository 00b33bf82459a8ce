"""Landing camera: an image of the share of the ground that obstacles take, as far as the camera resolves
them.

An obstacle is resolved from some pixels on; the motion of the image during the exposure, by speed and by
rotation, blurs that, and smears the image along itself. Cells that look past the ground, farther than the
camera sees, or at the backshell, the canopy or another part, show no ground; nor does a cell that moves
across the whole image.

Source: Trawny et al., Flight testing of terrain-relative navigation and large-divert guidance on a VTVL
rocket, AIAA SPACE (2015), for image motion; obstacles of a landing image: Chinese patent CN108594802B. Left
out: shadow and texture.
"""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import Vec3, param
from edl6dof.interface.capacities import CAMERA_CELLS
from edl6dof.interface.sensed import cell_direction
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.sensors.imager import (
    IMAGER_UNIT,
    ImagerParams,
    draw_imager,
    imager_pose,
    reciprocal_axes,
    view_range,
)
from edl6dof.sensors.obstacle_density import GROUND_CELLS, lay_cells, middle, share_of_obstacles, shows_ground
from edl6dof.sensors.occlusion import DISCS, find_discs, is_hidden
from edl6dof.sensors.ray_ground import point_motion
from edl6dof.spatial.elementary import tan
from edl6dof.spatial.frames import rotate_z
from edl6dof.spatial.quaternion import to_frame
from edl6dof.spatial.table_index import held_cell
from edl6dof.spatial.vector import add, cross, dot, norm, scale, sub, take3
from edl6dof.vehicle.plant import ATTITUDE, RATE
from edl6dof.vehicle.surroundings import planet_rotation

#: Samples of an image on each half of a smear: two for each cell of one that is 16 cells long.
_SAMPLES = 16


class LandingCameraParams(ImagerParams):
    """Landing camera."""

    largest = {"m": 1e5}

    field_of_view_deg: float = param(
        60.0, "of the image, rows and columns", status="estimate", gt=0.0, le=120.0
    )
    position_m: Vec3 = param((-0.5, -0.6, 0.0), "where it sits, B", status="estimate", min_length=3)
    pixels: int = param(1024, "along each side of the image", status="estimate", ge=CAMERA_CELLS, le=16384)
    smallest_px: float = param(
        2.0,
        "diameter of the smallest obstacle that it makes out, in pixels",
        status="estimate",
        gt=0.0,
        le=100.0,
    )
    exposure_s: float = param(0.002, "time for which an image is exposed", status="estimate", ge=0.0, le=1.0)
    steepest_deg: float = param(
        8.0,
        "slope from which on ground is an obstacle",
        status="recalled",
        source="Chang'e-3",
        gt=0.0,
        le=45.0,
    )
    longest_m: float = param(5000.0, "distance up to which it sees ground", status="estimate", gt=0.0)


MEMORY = np.dtype(
    [
        ("cells", GROUND_CELLS),
        ("discs", DISCS),
        ("sharp", "f4", (CAMERA_CELLS, CAMERA_CELLS)),  # the image as without motion
        ("smear", "f8", (CAMERA_CELLS, CAMERA_CELLS, 2)),  # rows and columns that each cell moves by
    ],
    align=True,
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
    lay_cells(
        case,
        tables,
        origin,
        axes,
        height,
        tangent=tangent,
        reach=view_range(params, plant),
        cells=memory.cells,
    )
    find_discs(case, plant, outputs, position, turn, discs=memory.discs)
    motion = _motion(case, plant, outputs, position)
    pixel, steepest = 2.0 * tangent / params.pixels, tan(params.steepest)
    for i in range(CAMERA_CELLS):
        for j in range(CAMERA_CELLS):
            direction = cell_direction(tangent, CAMERA_CELLS, i, j)
            depth = dot(sub(middle(memory.cells, i, j), origin), view[1][0])
            row, column = _smear(motion, direction, depth, tangent, params.exposure)
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
    q = (y[ATTITUDE], y[ATTITUDE + 1], y[ATTITUDE + 2], y[ATTITUDE + 3])
    return to_frame(q, rotate_z(c, -s, v)), take3(y, RATE)


@kernel
def _smear(motion, look_B, depth, tangent, exposure):
    """By how many rows and columns a point of the ground moves in the image while it is exposed, at a depth
    (m) along the line of sight.
    """
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
