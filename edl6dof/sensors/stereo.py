"""Stereo cameras: a map of ranges from one pair of images, independent of the lidar.

Range follows from disparity, whose error is the same all over the image: so the error of the range grows with
the square of the distance, over base line and focal length.  Where the ground has no texture, which is so for
blocks of cells at a time, no disparity is found.

Source: Matthies, Maimone, Johnson et al., Computer vision on Mars, Int. J. Computer Vision 75(1), 2007.
Left out: motion while the images are exposed, and ground that only one of the cameras sees.
"""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import Vec3, param
from edl6dof.interface.capacities import STEREO_CELLS
from edl6dof.interface.sensed import cell_direction
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, record
from edl6dof.registry import Member
from edl6dof.sensors.imager import (
    IMAGER_UNIT,
    ImagerParams,
    draw_imager,
    ground_direction,
    imager_pose,
    lay_tile_in_view,
    view_range,
)
from edl6dof.sensors.ray_ground import GROUND_TILE, trace_ray
from edl6dof.spatial.elementary import cos, tan
from edl6dof.spatial.random_numbers import Stream, normal_pair, uniform
from edl6dof.spatial.vector import take3

#: Cells along each side of a block that has texture or has none.
_BLOCK = 4


class StereoParams(ImagerParams):
    """Stereo cameras; errors as standard deviations."""

    largest = {"m": 1e4}

    field_of_view_deg: float = param(
        28.0, "field of view of the map along rows and along columns", status="estimate", gt=0.0, le=90.0
    )
    position_m: Vec3 = param(
        (-0.5, 0.0, -0.6),
        "position in B of the camera that the map belongs to",
        status="estimate",
    )
    baseline_m: float = param(1.5, "distance of the cameras", status="estimate", gt=0.0, le=10.0)
    pixels: int = param(
        2048, "pixels along each side of an image", status="estimate", ge=STEREO_CELLS, le=16384
    )
    disparity_noise_px: float = param(
        0.1, "noise of the disparity of a cell, in pixels", status="estimate", ge=0.0, le=10.0
    )
    disparity_bias_px: float = param(
        0.05, "constant error of the disparity, drawn for each case", status="estimate", ge=0.0, le=10.0
    )
    textureless: float = param(0.03, "share of the ground without texture", status="estimate", ge=0.0, le=1.0)
    longest_m: float = param(200.0, "range beyond which nothing is found", status="estimate", gt=0.0)
    incidence_deg: float = param(
        70.0,
        "largest angle between a line of sight and the normal of the ground",
        status="estimate",
        gt=0.0,
        lt=90.0,
    )


MEMORY = record(("tile", GROUND_TILE), ("pairs", COUNT))


@kernel
def measure(params, unit, case, tables, plant, outputs, memory, sensed):
    """Take a pair of images when a scan is commanded."""
    stereo = sensed.stereo
    stereo.fresh = 0 if plant.instruments.stereo_lost != 0 else plant.imagers.scan
    if stereo.fresh == 0:
        return
    turn = take3(unit.turn, 0)
    origin, axes, height = imager_pose(
        case, tables, plant, outputs, position=take3(params.position, 0), turn=turn
    )
    reach = view_range(params, plant)
    lay_tile_in_view(case, tables, origin, axes, height, reach=reach, tile=memory.tile)
    tangent, flattest = tan(0.5 * params.field_of_view), cos(params.incidence)
    per_pixel = 2.0 * tangent / (params.pixels * params.baseline)
    pair = memory.pairs
    memory.pairs += 1
    for i in range(STEREO_CELLS):
        for j in range(STEREO_CELLS):
            direction = cell_direction(tangent, STEREO_CELLS, i, j)
            way, incidence = trace_ray(memory.tile, origin, ground_direction(axes, direction), reach)
            block = (pair * STEREO_CELLS + i // _BLOCK) * STEREO_CELLS + j // _BLOCK
            found = way > 0.0 and incidence >= flattest
            if found and uniform(unit.key, 2 * block) >= params.textureless:
                cell = (pair * STEREO_CELLS + i) * STEREO_CELLS + j
                noise, _ = normal_pair(unit.key, 2 * cell + 1)
                disparity = unit.bias + params.disparity_noise_px * noise
                stereo.range[i, j] = max(way * (1.0 + way * direction[0] * per_pixel * disparity), 0.0)
            else:
                stereo.range[i, j] = 0.0


def plan(params: StereoParams, rng: Stream, unit: np.void) -> None:
    """Draw the errors of the instrument in this case."""
    draw_imager(params, rng, unit)
    unit["bias"] = params.disparity_bias_px * rng.standard_normal()


MEMBER = Member(
    "stereo",
    StereoParams,
    {"measure": measure},
    "Matthies, Maimone, Johnson et al., Int. J. Computer Vision 75(1), 2007",
    memory=MEMORY,
    tables=IMAGER_UNIT,
    plan=plan,
    writes=("stereo",),
)
