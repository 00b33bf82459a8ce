"""Terrain-relative navigation: the position of the vehicle from landmarks of a map found in an image.

Each match gives a line of sight to a known place, and the attitude is that of the solution, so two matches
determine the position. Random sample consensus draws pairs of matches, a fixed number of times, and keeps the
position with which most matches agree; all s = 2 matches of a pair are right with the probability (1 - eps)^s
for a share eps of wrong matches, so k draws fail with the probability (1 - (1 - eps)^s)^k. Weighted least
squares over the matches that agree then give the position and its covariance, with pixel noise and the errors
of single landmarks on the map. The displacement of the map and the attitude error are left to the filter. The
misalignment of the camera counts as noise of each fix, although it is the same in all of them.

The matches arrive after the exposure. Attitude and centre of mass are stored when the shutter opens; the way
from then on, the sum of the increments of the strapdown integration, carries the fix to the present.

Sources: Fischler and Bolles, Random sample consensus, Communications of the ACM 24(6), 1981; Mourikis et al.,
Vision-aided inertial navigation for spacecraft entry, descent, and landing, IEEE Transactions on Robotics
25(2), 2009; delay: Larsen et al., Incorporation of time delayed measurements in a discrete-time Kalman
filter, IEEE CDC (1998).
"""

from __future__ import annotations

from math import sqrt

from edl6dof.config.base import Params, param
from edl6dof.fsw.navigation.strapdown import attitude_at
from edl6dof.interface.capacities import MAX_LANDMARKS
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, record
from edl6dof.spatial.elementary import sincos
from edl6dof.spatial.frames import rotate_z
from edl6dof.spatial.quaternion import axes, from_frame
from edl6dof.spatial.random_numbers import uniform
from edl6dof.spatial.table_index import endless_cell
from edl6dof.spatial.vector import add, cross, dot, inertia_solve, put3, put4, scale, sub, take3, take4, unit


class LandmarkFixParams(Params):
    """Position fixes from landmarks of a map."""

    draws: int = param(40, "pairs of matches that are drawn from each image", ge=1, le=1000)
    gate: float = param(
        3.5,
        "standard deviations of pixel and map within which a match agrees, along rows and columns",
        ge=1.0,
        le=20.0,
    )
    least_matches: int = param(6, "matches that agree without which there is no fix", ge=3, le=MAX_LANDMARKS)
    attitude_deg: float = param(
        0.1,
        "standard deviation of an attitude error, for which the agreement of matches allows",
        status="estimate",
        ge=0.0,
        le=10.0,
    )


#: The flight computer's model of the landmark camera and its map.
LANDMARK_CAMERA = record(
    ("place", "f8", (3,)),  # m, B
    ("focal", "f8"),  # focal length in pixels
    ("noise", "f8"),  # standard deviation of a pixel
    ("misalignment", "f8"),  # rad: standard deviation of its direction
    ("map_noise", "f8"),  # m: standard deviation of a landmark on the map
    ("map_offset", "f8"),  # m: standard deviation of the displacement of the map along each axis
)

LANDMARK_FIXES = record(
    ("t", "f8"),  # s, flight time: last exposure
    ("q_I2B", "f8", (4,)),  # attitude then
    ("r_I", "f8", (3,)),  # m, I: position of the centre of mass then, as navigated
    ("arm", "f8", (3,)),  # m, B: from the centre of mass to the camera then
    ("way", "f8", (3,)),  # m, I: way of the centre of mass since then
    ("images", COUNT),
    # workspace
    ("seen", "f8", (MAX_LANDMARKS, 2)),  # tangents of the line of sight towards y and z of B
    ("place", "f8", (MAX_LANDMARKS, 3)),  # m, I: on the map, from the expected position of the camera
)


#: Key of the draws of pairs, and counters kept for each image.
_KEY, _PAIRS = 1981, 1 << 16


@kernel
def read_landmarks(onboard, sensed, solution, memory, fix):
    """Store the state at an exposure, and write the ``fix`` (``POSITION_FIX``) when matches arrive."""
    fix.matches = 0
    landmarks = sensed.landmarks
    if landmarks.fresh != 0:
        known, params = onboard.instruments.landmarks, onboard.navigation.landmarks
        gather(onboard.planet.rotation_rate, known, landmarks, memory)
        frame = axes(take4(memory.q_I2B))
        draw = memory.images * _PAIRS
        found, agreed = consensus(params, known, frame, landmarks.count, draw, memory=memory)
        memory.images += 1
        if agreed >= params.least_matches:
            locate(params, known, frame, landmarks.count, found, memory=memory, fix=fix)
            here = add(add(take3(memory.r_I, 0), take3(fix.error, 0)), take3(memory.way, 0))
            put3(fix.error, 0, sub(here, take3(solution.r_I, 0)))
            fix.age = solution.t - memory.t


@kernel
def note_exposure(onboard, sensed, motion, solution, memory):
    """Store attitude and position at an exposure in this cycle."""
    if sensed.landmarks.shutter == 0:
        return
    ahead = sensed.t - solution.t
    way = scale(ahead, take3(solution.v_I, 0))
    memory.t = sensed.t
    put4(memory.q_I2B, attitude_at(solution, motion, sensed.t))
    put3(memory.r_I, 0, add(take3(solution.r_I, 0), way))
    put3(memory.way, 0, scale(-1.0, way))
    put3(memory.arm, 0, sub(take3(onboard.instruments.landmarks.place, 0), take3(motion.centre, 0)))


@kernel
def gather(spin, known, landmarks, memory):
    """Write lines of sight and places of the matches for the state at the exposure."""
    s, c = sincos(spin * memory.t)
    eye = add(take3(memory.r_I, 0), from_frame(take4(memory.q_I2B), take3(memory.arm, 0)))
    for k in range(landmarks.count):
        memory.seen[k, 0] = landmarks.pixel[k, 1] / known.focal
        memory.seen[k, 1] = landmarks.pixel[k, 0] / known.focal
        put3(memory.place[k], 0, sub(rotate_z(c, -s, take3(landmarks.map_F[k], 0)), eye))


@kernel
def between_lines(frame, memory, i, j):
    """Position (m) nearest to the lines of sight through the matches ``i`` and ``j``, and the square of the
    sine of the angle between them; ``frame``: axes of B (I).
    """
    x, y, z = frame
    a = unit(add(x, add(scale(memory.seen[i, 0], y), scale(memory.seen[i, 1], z))))
    b = unit(add(x, add(scale(memory.seen[j, 0], y), scale(memory.seen[j, 1], z))))
    p, q = take3(memory.place[i], 0), take3(memory.place[j], 0)
    turn = cross(a, b)
    square = dot(turn, turn)
    if square <= LEAST_ANGLE:
        return p, 0.0
    tensor = (
        2.0 - a[0] * a[0] - b[0] * b[0],
        2.0 - a[1] * a[1] - b[1] * b[1],
        2.0 - a[2] * a[2] - b[2] * b[2],
        -a[0] * a[1] - b[0] * b[1],
        -a[0] * a[2] - b[0] * b[2],
        -a[1] * a[2] - b[1] * b[2],
    )
    across = add(sub(p, scale(dot(a, p), a)), sub(q, scale(dot(b, q), b)))
    return inertia_solve(tensor, across), square


#: Square of the sine of the least angle between two lines of sight that determine a position.
LEAST_ANGLE = 1e-4


@kernel
def residual(params, known, frame, position, k, memory):
    """Errors of the tangents of match ``k`` seen from a ``position`` (m), the depth of its place (m, not
    positive behind the camera), and whether it agrees.
    """
    x, y, z = frame
    to_place = sub(take3(memory.place[k], 0), position)
    depth = dot(x, to_place)
    if depth <= 0.0:
        return 0.0, 0.0, depth, False
    off_y = memory.seen[k, 0] - dot(y, to_place) / depth
    off_z = memory.seen[k, 1] - dot(z, to_place) / depth
    # what a rotation leaves after the best displacement grows with the square of the tangent
    square = memory.seen[k, 0] ** 2 + memory.seen[k, 1] ** 2
    variance = (known.noise / known.focal) ** 2 + (known.map_noise / depth) ** 2 * (1.0 + square)
    variance += (params.attitude * square) ** 2
    agrees = off_y * off_y + off_z * off_z <= 2.0 * params.gate * params.gate * variance
    return off_y, off_z, depth, agrees


@kernel
def consensus(params, known, frame, count, draw, memory):
    """Position (m, I, from the expected one of the camera) of the drawn pair with which most of the ``count``
    matches agree, and their number; ``draw``: counter of the first pair.
    """
    best, most = (0.0, 0.0, 0.0), 0
    if count < 2:
        return best, most
    for n in range(params.draws):
        i, j = draw_pair(draw + n, count)
        position, spread = between_lines(frame, memory, i, j)
        if spread > 0.0:
            agreed = 0
            for k in range(count):
                agreed += residual(params, known, frame, position, k, memory=memory)[3]
            if agreed > most:
                best, most = position, agreed
    return best, most


@kernel
def draw_pair(counter, count):
    """Two different numbers from 0 on, below ``count`` (2 or more)."""
    i = endless_cell(uniform(_KEY, 2 * counter) * count)
    j = endless_cell(uniform(_KEY, 2 * counter + 1) * (count - 1))
    return i, j + 1 if j >= i else j


#: Steps of Gauss and Newton from the position of a pair.
_STEPS = 4


@kernel
def locate(params, known, frame, count, start, memory, fix):
    """Write the position of least squares over the matches that agree with it, as the error of the expected
    one, its covariance, and its sensitivity to the attitude; ``start``: position of a pair.
    """
    x, y, z = frame
    position = start
    for _ in range(_STEPS):
        information, right = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        fix.matches = 0
        clear(fix.turn)
        for k in range(count):
            off_y, off_z, depth, agrees = residual(params, known, frame, position, k, memory=memory)
            if agrees:
                fix.matches += 1
                to_place = sub(take3(memory.place[k], 0), position)
                tan_y, tan_z = dot(y, to_place) / depth, dot(z, to_place) / depth
                pixel, place = (known.noise / known.focal) ** 2, (known.map_noise / depth) ** 2
                # an error of the place is isotropic: its part along the line of sight correlates the tangents
                variance_y, variance_z = pixel + place * (1.0 + tan_y**2), pixel + place * (1.0 + tan_z**2)
                share = place * tan_y * tan_z / variance_y
                h_y = scale(-1.0 / depth, sub(y, scale(tan_y, x)))
                h_z = sub(scale(-1.0 / depth, sub(z, scale(tan_z, x))), scale(share, h_y))
                for h, off, weight in (
                    (h_y, off_y, 1.0 / variance_y),
                    (h_z, off_z - share * off_y, 1.0 / (variance_z - share * share * variance_y)),
                ):
                    information = add_square(information, weight, h)
                    right = add(right, scale(weight * off, h))
                    # an attitude error psi changes the tangent by (to_place x h) . psi
                    g = cross(to_place, h)
                    for i in range(3):
                        for j in range(3):
                            fix.turn[i, j] += weight * h[i] * g[j]
        if fix.matches < params.least_matches:
            fix.matches = 0
            return
        position = add(position, inertia_solve(information, right))
    put3(fix.error, 0, position)
    for j in range(3):
        column = inertia_solve(information, (fix.turn[0, j], fix.turn[1, j], fix.turn[2, j]))
        fix.turn[0, j], fix.turn[1, j], fix.turn[2, j] = column
        axis = (1.0 if j == 0 else 0.0, 1.0 if j == 1 else 0.0, 1.0 if j == 2 else 0.0)
        fix.covariance[0, j], fix.covariance[1, j], fix.covariance[2, j] = inertia_solve(information, axis)
    for i in range(3):
        for j in range(3):
            turned = dot(take3(fix.turn[i], 0), take3(fix.turn[j], 0))
            fix.covariance[i, j] += known.misalignment**2 * turned


@kernel
def add_square(tensor, weight, h):
    """Return a symmetric 3x3 ``tensor`` (xx, yy, zz, xy, xz, yz) plus ``weight`` times h h'."""
    xx, yy, zz, xy, xz, yz = tensor
    return (
        xx + weight * h[0] * h[0],
        yy + weight * h[1] * h[1],
        zz + weight * h[2] * h[2],
        xy + weight * h[0] * h[1],
        xz + weight * h[0] * h[2],
        yz + weight * h[1] * h[2],
    )


@kernel
def clear(a):
    """Set a 3 x 3 matrix to zero."""
    for i in range(3):
        put3(a[i], 0, (0.0, 0.0, 0.0))


@kernel
def deviation_along(fix, axis):
    """Standard deviation (m) of a fix along a unit vector (I) without attitude error, and that for an
    attitude error of one radian about each axis (m).
    """
    own, turned = 0.0, (0.0, 0.0, 0.0)
    for i in range(3):
        turned = add(turned, scale(axis[i], take3(fix.turn[i], 0)))
        own += axis[i] * dot(axis, take3(fix.covariance[i], 0))
    return sqrt(own), sqrt(dot(turned, turned))
