"""Scanning lidar: ranges along a fan of rays, a few rows of it in each base cycle.

A scan begins when it is commanded, and takes as many cycles as it has blocks of rows; each block is shot from
where the vehicle is then, so that its motion bends the scan.  A ray meets the true ground (rocks included)
within the tile of ground that lies in view when the scan begins; nothing comes back from beyond it, from too
far away, from ground met at too flat an angle, and at random times.

Source: Johnson, Keim and Ivanov, Analysis of flash lidar field test data for safe lunar landing, IEEE
Aerospace Conference (2010).
Left out: the width of a ray, and parts of the vehicle that fly below it.
"""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import Vec3, param
from edl6dof.config.dtype import in_si
from edl6dof.interface.capacities import SCAN_BLOCK, SCAN_COLUMNS, SCAN_ROWS
from edl6dof.interface.sensed import cell_direction
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, record, whole
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


class LidarParams(ImagerParams):
    """Scanning lidar; errors as standard deviations."""

    largest = {"m": 1e4}

    field_of_view_deg: float = param(
        28.0, "field of view along rows and columns: 50 m of ground from 100 m", status="derived",
        source="patch of Chang'e-3, hover of Tianwen-1", gt=0.0, le=90.0,
    )  # fmt: skip
    position_m: Vec3 = param((-0.5, 0.6, 0.0), "position of the lidar in B", status="estimate")
    longest_m: float = param(300.0, "range beyond which nothing comes back", status="estimate", gt=0.0)
    incidence_deg: float = param(
        75.0, "largest angle between a ray and the normal of the ground", status="estimate", gt=0.0, lt=90.0
    )
    dropout: float = param(0.01, "probability that nothing comes back", status="estimate", ge=0.0, le=1.0)
    range_noise_m: float = param(0.03, "noise of a range", status="estimate", ge=0.0)
    range_bias_m: float = param(
        0.02, "constant error of all ranges, drawn for each case", status="estimate", ge=0.0
    )
    quantum_m: float = param(0.01, "step of the ranges", status="estimate", gt=0.0)


MEMORY = record(
    ("tile", GROUND_TILE),  # the ground in view when the scan began
    ("left", whole(0, SCAN_ROWS)),  # rows that are still to be shot
    ("scans", COUNT),  # number of scans begun
    ("mirror", whole(0, SCAN_ROWS - SCAN_BLOCK)),  # first row that the mirror turns the rays to
)


@kernel
def measure(params, unit, case, tables, plant, outputs, memory, sensed):
    """Begin a scan when commanded, and measure the next block of rows of the scan in progress."""
    lidar, faults = sensed.lidar, plant.instruments
    lidar.fresh = 0
    if faults.lidar_lost != 0:
        memory.left = 0
        return
    if plant.imagers.scan == 0 and memory.left == 0:
        return
    turn = take3(unit.turn, 0)
    origin, axes, height = imager_pose(
        case, tables, plant, outputs, position=take3(params.position, 0), turn=turn
    )
    reach = view_range(params, plant)
    if plant.imagers.scan != 0:
        lay_tile_in_view(case, tables, origin, axes, height, reach=reach, tile=memory.tile)
        memory.left = SCAN_ROWS
        memory.scans += 1
    lidar.row, lidar.fresh = SCAN_ROWS - memory.left, 1
    memory.left -= SCAN_BLOCK
    if faults.mirror_stuck == 0:
        memory.mirror = lidar.row
    tangent, flattest = tan(0.5 * params.field_of_view), cos(params.incidence)
    first = (memory.scans * SCAN_ROWS + lidar.row) * SCAN_COLUMNS
    for i in range(SCAN_BLOCK):
        for j in range(SCAN_COLUMNS):
            ray = ground_direction(axes, cell_direction(tangent, SCAN_COLUMNS, memory.mirror + i, j))
            way, incidence = trace_ray(memory.tile, origin, ray, reach)
            seen = way > 0.0 and incidence >= flattest
            lidar.range[i, j] = read(params, unit, way, first + i * SCAN_COLUMNS + j) if seen else 0.0


@kernel
def read(params, unit, way, number):
    """Reading of ray ``number`` for a true range (m); 0 where nothing comes back."""
    if uniform(unit.key, 2 * number) < params.dropout:
        return 0.0
    noise, _ = normal_pair(unit.key, 2 * number + 1)
    noisy = way + unit.bias + params.range_noise * noise + 0.5 * params.quantum
    return max(noisy - noisy % params.quantum, 0.0)


def plan(params: LidarParams, rng: Stream, unit: np.void) -> None:
    """Draw the errors of the instrument in this case."""
    draw_imager(params, rng, unit)
    unit["bias"] = in_si(params)["range_bias"] * rng.standard_normal()


MEMBER = Member(
    "lidar",
    LidarParams,
    {"measure": measure},
    "Johnson, Keim and Ivanov, IEEE Aerospace Conference (2010)",
    memory=MEMORY,
    tables=IMAGER_UNIT,
    plan=plan,
    writes=("lidar",),
)
