"""The ranges of a look at the radar: along each beam to a plane, as high below the vehicle as the elevation
of the site and the terrain state say, that slopes as the state of the slope says.

Source: Farrell, Aided Navigation (2008), chapter 12; Busnardo, Aitken, Tolson, Pierrottet and Amzajerdian,
"LIDAR-aided inertial navigation with extended Kalman filtering for pinpoint landing", AIAA 2011-6428.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.fsw.navigation.filters.kalman.antenna import (
    STEEPEST,
    expected_range,
    ground_normal,
    horizontal,
)
from edl6dof.fsw.navigation.filters.kalman.look import take_in_look
from edl6dof.fsw.navigation.filters.kalman.reading import clear
from edl6dof.fsw.navigation.filters.kalman.start import reopen_slope
from edl6dof.fsw.navigation.filters.kalman.states import (
    ATTITUDE_ERROR,
    POSITION,
    RANGE_BIAS,
    RANGE_SCALE,
    SLOPE,
    TERRAIN,
)
from edl6dof.jit import kernel
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import add, cross, dot, put3, scale, sub, take3

#: Ranges that some plane always fits: its height and two slopes.
PLANE = 3


@kernel
def range_row(u, up, normal, lever, steepness, reach, radius, beam, row):
    """Write what the range of a ``beam`` along ``u`` sees of the errors; ``reach`` is the range expected.

    A place to the side has another vertical, too.
    """
    clear(row)
    spot = add(lever, scale(reach, u))
    level = scale(reach / (steepness * radius), sub(u, scale(dot(u, up), up)))
    put3(row, POSITION, add(scale(1.0 / steepness, up), level))
    put3(row, ATTITUDE_ERROR, scale(1.0 / steepness, cross(spot, normal)))
    row[TERRAIN] = -1.0 / steepness
    for i, axis in enumerate(horizontal(up)):
        row[SLOPE + i] = -dot(spot, axis) / steepness
    row[RANGE_SCALE + beam] = reach
    row[RANGE_BIAS + beam] = 1.0


@kernel
def range_noise(params, instruments, reach, steepness, off):
    """Noise variance of a range: of the instrument, and of ground that is uneven between the vehicle and
    where the beam meets it.
    """
    own = instruments.range_sigma + instruments.range_sigma_relative * reach
    return own**2 + params.terrain_change**2 * off / (1000.0 * steepness * steepness)


@kernel
def expect_ranges(params, onboard, radar, q, lever, up, normal, height, memory):
    """Fill ``rows``, ``innovation`` and ``noise`` (variance) of ``memory``; bits of the beams with an echo
    that are not too flat, and of those whose spot lies farther off the plane than uneven ground does.
    ``height``: of the antenna, m.
    """
    instruments, radius, present, off_ground = onboard.instruments, onboard.planet.equatorial_radius, 0, 0
    for beam in range(instruments.n_beams):
        u = from_frame(q, take3(instruments.beam_axis[beam], 0))
        if radar.locked[beam] != 0 and -dot(u, normal) > STEEPEST:
            reach, steepness, off = expected_range(u, up, normal, height, radius)
            memory.innovation[beam] = radar.range[beam] - reach
            memory.noise[beam] = range_noise(params, instruments, reach, steepness, off)
            range_row(
                u, up, normal, lever, steepness, reach=reach, radius=radius, beam=beam, row=memory.rows[beam]
            )
            present |= 1 << beam
            if abs(memory.innovation[beam]) * steepness > params.unevenness * sqrt(off / 1000.0):
                off_ground |= 1 << beam
    return present, off_ground


@kernel
def look_at_ranges(params, onboard, health, radar, speeds, q, lever, up, height, solution, memory):
    """Take in the ranges of the beams whose speed was used (bits ``speeds``); bits of the beams that were
    used, and of the one whose range no ground explains.

    Of several that are refused none is wrong, nor is one of three, since a plane fits any three ranges: the
    slope is opened again, and the height, too, unless three have agreed before and most do now.
    """
    normal = ground_normal(up, solution.slope)
    above = height - dot(lever, sub(up, normal))
    present, off_ground = expect_ranges(
        params, onboard, radar, q, lever, up=up, normal=normal, height=above, memory=memory
    )
    used, refused, tried, against, least = take_in_look(
        params,
        onboard.instruments.n_beams,
        present=present & speeds,
        healthy=health.beam_range,
        up=up,
        memory=memory,
        deviations=solution.range_innovation,
    )
    if tried >= PLANE and against == 0:
        memory.plane_seen = 1
    other_ground = against > 1 or against == 1 and tried <= PLANE
    memory.ranges_refused = memory.ranges_refused + 1 if other_ground else 0
    if memory.ranges_refused >= params.patience:
        reopen_slope(params, memory.covariance)
        if 2 * against > tried or memory.plane_seen == 0:
            memory.covariance[TERRAIN, TERRAIN] += least
        memory.ranges_refused = 0
    return used, 0 if other_ground else refused & off_ground
