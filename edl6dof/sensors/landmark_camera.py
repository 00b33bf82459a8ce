"""Landmark camera: an image of the ground matched on board with a map, for terrain-relative navigation.

The map contains landmarks on lattices around the site, each at a random place in its cell. The lattice of an
image is as fine as its height requires, so that all images contain about the same number of landmarks. A
match consists of the pixel at which a landmark was found and its place on the map. The pixel has noise; a
wrong match has a pixel anywhere in the image. The map is displaced as a whole, by a constant drawn for each
case, and each landmark by an error of its own. The matches of an image arrive after the time that it takes to
find them.

Parts that have left the vehicle hide landmarks. The camera sees nothing through the heat shield.

Source: Johnson et al., The Lander Vision System for Mars 2020 entry descent and landing, AAS GNC (2017), for
the camera and the range of heights; Johnson et al., Mars 2020 Lander Vision System flight performance, AIAA
SciTech (2022), for the sequence. Left out: blur, shadow, a map that shows the ground at another time of day,
and matches that are wrong in the same way.
"""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import Vec3, param
from edl6dof.config.dtype import in_si
from edl6dof.environment.terrain import geodetic_of, ground
from edl6dof.interface.capacities import LANDMARK_ROWS, MAX_LANDMARKS
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, FLAG, record, whole
from edl6dof.registry import Member
from edl6dof.sensors.imager import (
    DISCS,
    ImagerParams,
    draw_imager,
    find_discs,
    imager_attitude,
    imager_pose,
    is_hidden,
    view_range,
)
from edl6dof.sensors.ray_ground import point_motion
from edl6dof.spatial.elementary import sincos, tan
from edl6dof.spatial.frames import from_geodetic, ned_to_fixed, rotate_z
from edl6dof.spatial.quaternion import to_frame
from edl6dof.spatial.random_numbers import Stream, normal_pair, random_bits, random_bits_at, uniform
from edl6dof.spatial.table_index import endless_cell
from edl6dof.spatial.vector import add, dot, norm, put3, scale, sub, take3
from edl6dof.vehicle.surroundings import planet_rotation


class LandmarkCameraParams(ImagerParams):
    """Landmark camera and its map; errors as standard deviations."""

    largest = {"m": 1e5}

    field_of_view_deg: float = param(
        90.0,
        "field of view along rows and along columns",
        status="recalled",
        source="Johnson et al. 2017",
        gt=0.0,
        le=120.0,
    )
    pixels: int = param(
        1024,
        "pixels along each side of the image",
        status="recalled",
        source="Johnson et al. 2017",
        ge=64,
        le=16384,
    )
    position_m: Vec3 = param((-0.5, 0.6, 0.0), "position of the camera in B", status="estimate")
    interval_s: float = param(1.0, "time between two images", status="estimate", gt=0.0, le=100.0)
    delay_s: float = param(
        0.5,
        "time from the exposure until the matches arrive, at most that between two images",
        status="estimate",
        ge=0.0,
        le=100.0,
    )
    highest_m: float = param(
        4200.0,
        "height above the ground below which images are taken",
        status="recalled",
        source="Mars 2020",
        gt=0.0,
    )
    lowest_m: float = param(
        400.0,
        "height above the ground down to which images are taken; lower down the map is too coarse",
        status="estimate",
        ge=0.0,
    )
    longest_m: float = param(10000.0, "distance up to which landmarks are found", status="estimate", gt=0.0)
    noise_px: float = param(
        0.5, "noise of a pixel, along rows and columns", status="estimate", gt=0.0, le=50.0
    )
    wrong_share: float = param(0.2, "share of wrong matches", status="estimate", ge=0.0, lt=1.0)
    map_offset_m: Vec3 = param(
        (3.0, 3.0, 3.0), "displacement of the map north, east and down", status="estimate"
    )
    map_noise_m: float = param(
        3.0, "error of a landmark's place on the map along each axis", status="estimate", ge=0.0, le=1000.0
    )


#: Errors of the camera in this case: misalignment, a small rotation in B (rad); displacement of the map (m,
#: N); key of the noise.
UNIT = record(("turn", "f8", (3,)), ("offset", "f8", (3,)), ("key", "i8"))

MEMORY = record(
    ("discs", DISCS),
    ("images", COUNT),
    ("next_t", "f8"),  # s, flight time: the next image at the earliest
    ("due_t", "f8"),  # s, flight time: the matches of the last image arrive
    ("under_way", FLAG),  # they have not arrived
    ("count", whole(0, MAX_LANDMARKS)),
    ("pixel", "f8", (MAX_LANDMARKS, 2)),  # row and column, from the middle of the image
    ("map_F", "f8", (MAX_LANDMARKS, 3)),  # m, F
)

#: Times count as reached this much (s) early.
_EARLY = 1e-6
#: Largest sine of the dip of a line of sight along which the camera does not look at the ground.
_SHALLOW = 0.3
#: Key of the random places of landmarks on the map.
_MAP_KEY = 20210218
#: Random numbers of a match: pixel noise, wrong or not, place of a wrong one.
_NUMBERS = 4


@kernel
def measure(params, unit, case, tables, plant, outputs, memory, sensed):
    """Deliver the matches of the last image when they are due, and take the next image."""
    landmarks = sensed.landmarks
    landmarks.shutter = landmarks.fresh = 0
    if plant.instruments.landmarks_lost != 0:
        memory.under_way = 0
        return
    if memory.under_way != 0:
        if plant.t < memory.due_t - _EARLY:
            return
        memory.under_way, landmarks.fresh, landmarks.count = 0, 1, memory.count
        for k in range(memory.count):
            landmarks.pixel[k, 0], landmarks.pixel[k, 1] = memory.pixel[k, 0], memory.pixel[k, 1]
            put3(landmarks.map_F[k], 0, take3(memory.map_F[k], 0))
    reach = view_range(params, plant)
    seen = params.lowest <= outputs.height <= params.highest and reach > 0.0
    if seen and plant.t >= memory.next_t - _EARLY:
        memory.next_t = plant.t + params.interval
        memory.due_t = plant.t + min(params.delay, params.interval)
        landmarks.shutter = memory.under_way = 1
        find_landmarks(params, unit, case, tables, plant, outputs=outputs, memory=memory)
        memory.images += 1


@kernel
def find_landmarks(params, unit, case, tables, plant, outputs, memory):
    """Write the matches of an image taken now into ``memory``."""
    position, turn = take3(params.position, 0), take3(unit.turn, 0)
    origin, axes, height = imager_pose(case, tables, plant, outputs, position, turn=turn)
    memory.count = 0
    if -axes[0][2] < _SHALLOW or height <= 0.0:
        return
    c, s = planet_rotation(case.planet, plant.t)
    eye_F, _ = point_motion(case, plant, outputs, position, (c, s))
    attitude = imager_attitude(plant, turn)
    find_discs(case, plant, outputs, position, turn, discs=memory.discs)
    tangent = tan(0.5 * params.field_of_view)
    focal = 0.5 * params.pixels / tangent
    level, cell = lattice(2.0 * tangent * height)
    way = height / -axes[0][2]
    first = endless_cell((origin[0] + way * axes[0][0]) / cell) - LANDMARK_ROWS // 2
    left = endless_cell((origin[1] + way * axes[0][1]) / cell) - LANDMARK_ROWS // 2
    for a in range(MAX_LANDMARKS):
        i, j = first + a // LANDMARK_ROWS, left + a % LANDMARK_ROWS
        mark = random_bits_at(_MAP_KEY + level, i, j)
        north, east = (i + uniform(mark, 0)) * cell, (j + uniform(mark, 1)) * cell
        place_F, error_F = landmark(
            params, unit, case, tables, plant.inputs.areoid, place=(north, east), mark=mark
        )
        look = to_frame(attitude, rotate_z(c, -s, sub(place_F, eye_F)))
        distance = norm(look)
        inside = look[0] > 0.0 and max(abs(look[1]), abs(look[2])) <= tangent * look[0]
        if inside and distance <= params.longest and not is_hidden(memory.discs, scale(1.0 / distance, look)):
            number = _NUMBERS * (memory.images * MAX_LANDMARKS + a)
            row, column = focal * look[2] / look[0], focal * look[1] / look[0]
            if uniform(unit.key, number + 1) < params.wrong_share:
                row = params.pixels * (uniform(unit.key, number + 2) - 0.5)
                column = params.pixels * (uniform(unit.key, number + 3) - 0.5)
            noise = normal_pair(unit.key, number)
            memory.pixel[memory.count, 0] = row + params.noise_px * noise[0]
            memory.pixel[memory.count, 1] = column + params.noise_px * noise[1]
            put3(memory.map_F[memory.count], 0, add(place_F, error_F))
            memory.count += 1


@kernel
def lattice(width):
    """Number and side of the cells (m, a power of two) of the lattice for an image ``width`` m wide."""
    level, cell = 0, 1.0
    while 2.0 * cell * LANDMARK_ROWS <= width:
        level, cell = level + 1, 2.0 * cell
    return level, cell


@kernel
def landmark(params, unit, case, tables, areoid, place, mark):
    """True position (m, F) of the landmark ``mark`` at a ``place`` (m north and east of the site), and the
    error of its position on the map (m, F).
    """
    planet = case.planet
    lat, lon = geodetic_of(case.terrain, place[0], place[1])
    elevation = ground(case.terrain, tables.terrain, lat, lon)[0]
    r_F = from_geodetic(planet.equatorial_radius, planet.flattening, lat, lon, elevation)
    altitude = elevation + dot(take3(areoid, 0), r_F) + areoid[3]
    r_F = from_geodetic(planet.equatorial_radius, planet.flattening, lat, lon, altitude)
    own = random_bits(unit.key, mark)
    north, east = normal_pair(own, 0)
    down, _ = normal_pair(own, 1)
    error = add(take3(unit.offset, 0), scale(params.map_noise, (north, east, down)))
    (sin_lat, cos_lat), (sin_lon, cos_lon) = sincos(lat), sincos(lon)
    return r_F, ned_to_fixed(sin_lat, cos_lat, sin_lon, cos_lon, error)


def plan(params: LandmarkCameraParams, rng: Stream, unit: np.void) -> None:
    """Draw the errors of camera and map in this case."""
    draw_imager(params, rng, unit)
    unit["offset"] = in_si(params)["map_offset"] * rng.standard_normal(3)


MEMBER = Member(
    "landmark_camera",
    LandmarkCameraParams,
    {"measure": measure},
    "Johnson et al., The Lander Vision System for Mars 2020, AAS GNC (2017)",
    memory=MEMORY,
    tables=UNIT,
    plan=plan,
    writes=("landmarks",),
)
