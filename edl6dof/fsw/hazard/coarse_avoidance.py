"""Coarse avoidance: the part of an image with the fewest obstacles, and a target in it that keeps clear of
backshell and canopy.

Rule of Tianwen-1, claim 1 of Chinese patent CN108594802B: where the angle of the velocity to the vertical
lies within a preset range, the image is halved along the velocity, else quartered about its centre; the part
with the fewest obstacles is taken, and the thrust turned to its side.  Cells that show no ground count as
obstacles.  The distance of the target and the choice by the drift of backshell and canopy are estimates.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.config.base import Params, param
from edl6dof.fsw.hazard.backshell_drift import DRIFT, LASTING, distance_from_drifts
from edl6dof.interface.capacities import CAMERA_CELLS
from edl6dof.kernels import kernel
from edl6dof.records import record, whole
from edl6dof.spatial.elementary import atan2
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import dot, take3

#: Most parts of an image.
MAX_PARTS_OF_IMAGE = 4


class CoarseParams(Params):
    """Coarse avoidance at the start of powered descent."""

    halved_from_deg: float = param(
        3.0, "angle of velocity to the vertical from which the image is halved", status="estimate",
        ge=0.0, le=90.0,
    )  # fmt: skip
    halved_to_deg: float = param(
        60.0, "angle of velocity to the vertical up to which it is", status="estimate", ge=0.0, le=90.0
    )
    divert_m: float = param(
        170.0, "distance of the target into the part that is chosen", status="estimate", ge=0.0
    )
    lead_s: float = param(
        12.0, "time for which the target runs ahead with the drift", status="estimate", ge=0.0, le=60.0
    )
    keep_clear_m: float = param(
        150.0, "least distance of the target from the predicted drift of backshell and canopy",
        status="estimate", ge=0.0,
    )  # fmt: skip
    wind_time_s: float = param(
        10.0, "time over which the velocity under the parachute is taken for the wind", status="estimate",
        gt=0.1, le=100.0,
    )  # fmt: skip


COARSE = record(
    ("parts", whole(0, MAX_PARTS_OF_IMAGE)),  # that the image was cut into
    ("part", whole(0, MAX_PARTS_OF_IMAGE - 1)),  # that was taken
    ("obstacles", "f8", (MAX_PARTS_OF_IMAGE,)),  # share of each part that is obstacle or not seen
    ("target_L", "f8", (MAX_PARTS_OF_IMAGE, 2)),  # m: east, north of the landing site, of each part
    ("clear", "f8", (MAX_PARTS_OF_IMAGE,)),  # m: of each target from the drift
    ("drift", DRIFT, (len(LASTING),)),
)


@kernel
def part_of(parts, along, across, y, z):
    """Part of the image in which a cell at (``y``, ``z``) of B lies: of two, that on one side (1) or the
    other (0) of the velocity (``along``, ``across`` in y and z); of four, by the signs.
    """
    if parts == 2:
        return 1 if along * z - across * y > 0.0 else 0
    return (1 if y > 0.0 else 0) + (2 if z > 0.0 else 0)


@kernel
def direction_of(parts, part, along, across):
    """Unit direction in y and z of B from the centre of the image into a part."""
    side = 1.0 if part % 2 == 1 else -1.0
    if parts == 2:
        size = sqrt(along * along + across * across)
        return -side * across / size, side * along / size
    other = 1.0 if part >= 2 else -1.0
    return side * sqrt(0.5), other * sqrt(0.5)


@kernel
def count_obstacles(camera, parts, along, across, out):
    """Share of each part of the image that is obstacle or not seen."""
    cells = (0.0, 0.0, 0.0, 0.0)
    for part in range(MAX_PARTS_OF_IMAGE):
        out.obstacles[part] = 0.0
    for i in range(CAMERA_CELLS):
        z = (2.0 * i + 1.0) / CAMERA_CELLS - 1.0
        for j in range(CAMERA_CELLS):
            y = (2.0 * j + 1.0) / CAMERA_CELLS - 1.0
            part = part_of(parts, along, across, y, z)
            share = camera.density[i, j] if camera.seen[i, j] != 0 else 1.0
            out.obstacles[part] += share
            cells = (
                cells[0] + (1.0 if part == 0 else 0.0),
                cells[1] + (1.0 if part == 1 else 0.0),
                cells[2] + (1.0 if part == 2 else 0.0),
                cells[3] + (1.0 if part == 3 else 0.0),
            )
    for part in range(parts):
        out.obstacles[part] /= max(cells[part], 1.0)


@kernel
def lay_targets(p, nav, along, across, out):
    """Target of each part: ahead with the drift, and off into the part."""
    q = (nav.q_I2B[0], nav.q_I2B[1], nav.q_I2B[2], nav.q_I2B[3])
    for part in range(out.parts):
        y, z = direction_of(out.parts, part, along, across)
        into = from_frame(q, (0.0, y, z))
        east, north = dot(into, take3(nav.east_I, 0)), dot(into, take3(nav.north_I, 0))
        size = max(sqrt(east * east + north * north), 1e-9)
        out.target_L[part, 0] = nav.site_L[0] + p.lead * nav.v_N[1] + p.divert * east / size
        out.target_L[part, 1] = nav.site_L[1] + p.lead * nav.v_N[0] + p.divert * north / size


@kernel
def choose_part(p, camera, nav, out):
    """Take the part of fewest obstacles whose target keeps clear of the drift; where none does, the one that
    keeps clearest.

    Args:
        p: coarse parameters.
        camera: ``CAMERA`` record: the image.
        nav: ``NAV`` record when it was taken.
        out: ``COARSE`` record with the drift predicted, written.

    Returns:
        Its target, east and north of the landing site (m).
    """
    q = (nav.q_I2B[0], nav.q_I2B[1], nav.q_I2B[2], nav.q_I2B[3])
    side = sqrt(nav.v_N[0] * nav.v_N[0] + nav.v_N[1] * nav.v_N[1])
    slant = atan2(side, nav.v_N[2])
    north, east = take3(nav.north_I, 0), take3(nav.east_I, 0)
    along = nav.v_N[0] * dot(from_frame(q, (0.0, 1.0, 0.0)), north) + nav.v_N[1] * dot(
        from_frame(q, (0.0, 1.0, 0.0)), east
    )
    across = nav.v_N[0] * dot(from_frame(q, (0.0, 0.0, 1.0)), north) + nav.v_N[1] * dot(
        from_frame(q, (0.0, 0.0, 1.0)), east
    )
    out.parts = 2 if p.halved_from <= slant <= p.halved_to and along * along + across * across > 0.0 else 4
    count_obstacles(camera, out.parts, along, across, out)
    lay_targets(p, nav, along, across, out)
    out.part, best = 0, (2, 0.0)
    for part in range(out.parts):
        target = out.target_L[part]
        out.clear[part] = distance_from_drifts(out.drift, target[0], target[1])
        keeps = out.clear[part] >= p.keep_clear
        mark = (0, out.obstacles[part]) if keeps else (1, -out.clear[part])
        if mark[0] < best[0] or (mark[0] == best[0] and mark[1] < best[1]):
            out.part, best = part, mark
    return out.target_L[out.part, 0], out.target_L[out.part, 1]
