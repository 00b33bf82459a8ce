"""The ranges of a look at the radar: along each beam to ground at the elevation of the site plus the terrain
state.

Source: Farrell, Aided Navigation (2008), chapter 12; Busnardo, Aitken, Tolson, Pierrottet and Amzajerdian,
"LIDAR-aided inertial navigation with extended Kalman filtering for pinpoint landing", AIAA 2011-6428.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.fsw.navigation.filters.kalman.antenna import STEEPEST, expected_range
from edl6dof.fsw.navigation.filters.kalman.beams import usable
from edl6dof.fsw.navigation.filters.kalman.gate import median, refused_again
from edl6dof.fsw.navigation.filters.kalman.reading import clear, take_in
from edl6dof.fsw.navigation.filters.kalman.states import (
    ATTITUDE_ERROR,
    POSITION,
    RANGE_BIAS,
    RANGE_SCALE,
    TERRAIN,
)
from edl6dof.jit import kernel
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import add, cross, dot, put3, scale, take3

#: Gates beyond which no slope of the ground explains a range.
FAR_OFF = 3.0


@kernel
def range_row(u, up, lever, slope, reach, radius, beam, row):
    """Write what the range of a ``beam`` along ``u`` sees of the errors; ``reach`` is the range expected.

    A place to the side has another vertical, too.
    """
    clear(row)
    level = scale(reach / (slope * radius), add(u, scale(slope, up)))
    put3(row, POSITION, add(scale(1.0 / slope, up), level))
    put3(row, ATTITUDE_ERROR, scale(1.0 / slope, add(cross(lever, up), scale(reach, cross(u, up)))))
    row[TERRAIN] = -1.0 / slope
    row[RANGE_SCALE + beam] = reach
    row[RANGE_BIAS + beam] = 1.0


@kernel
def range_noise(params, instruments, reach, slope, off):
    """Noise variance of a range: of the instrument, and of ground that is not as high below the vehicle as
    where the beam meets it.
    """
    own = instruments.range_sigma + instruments.range_sigma_relative * reach
    return own**2 + params.terrain_change**2 * off / (1000.0 * slope * slope)


@kernel
def common_height_error(onboard, health, radar, q, up, height, memory):
    """Fill ``memory.height_error`` with how much higher each beam says the vehicle is; how many tell, and
    the median.
    """
    instruments, count = onboard.instruments, 0
    for beam in range(instruments.n_beams):
        if usable(health, radar, beam):
            u = from_frame(q, take3(instruments.beam_axis[beam], 0))
            if -dot(u, up) > STEEPEST:
                reach, slope, _ = expected_range(u, up, height, onboard.planet.equatorial_radius)
                memory.height_error[count] = (radar.range[beam] - reach) * slope
                count += 1
    if count == 0:
        return 0, 0.0
    return count, median(memory.height_error, count, memory.sorted)


@kernel
def apart(instruments, error, common, slope, off, reach, noise, memory):
    """How far the height of a beam differs from the median of all, over what noise, bias and attitude
    explain; beyond the gate the beam is wrong, however unsure the solution is.
    """
    covariance = memory.covariance
    level = covariance[ATTITUDE_ERROR, ATTITUDE_ERROR]
    level += (
        covariance[ATTITUDE_ERROR + 1, ATTITUDE_ERROR + 1]
        + covariance[ATTITUDE_ERROR + 2, ATTITUDE_ERROR + 2]
    )
    lasting = instruments.range_bias**2 + (instruments.range_scale * reach) ** 2
    spread = 2.0 * slope * slope * (noise + lasting) + 2.0 * off * off * level
    return abs(error - common) / sqrt(spread)


@kernel
def look_at_ranges(params, onboard, health, radar, q, lever, up, height, solution, memory):
    """Take in the ranges; bits of the beams that were used, and of those that are far off.

    Ground that slopes puts a sound beam beyond the gate, too, for as long as it does: only what is several
    gates off counts against the beam.
    """
    instruments, radius = onboard.instruments, onboard.planet.equatorial_radius
    told, common = common_height_error(onboard, health, radar, q, up, height, memory)
    used, refused, tried, against, least = 0, 0, 0, 0, 0.0
    for beam in range(instruments.n_beams):
        solution.range_innovation[beam] = 0.0
        u, trusted = from_frame(q, take3(instruments.beam_axis[beam], 0)), health.beam[beam] != 0
        if radar.locked[beam] == 0 or -dot(u, up) <= STEEPEST:
            continue
        reach, slope, off = expected_range(u, up, height, radius)
        innovation = radar.range[beam] - reach
        noise = range_noise(params, instruments, reach, slope, off)
        alone = 0.0
        if told > 2:
            alone = apart(instruments, innovation * slope, common, slope, off, reach, noise, memory)
        if alone > FAR_OFF * params.gate:
            refused |= 1 << beam
        if alone > params.gate:
            continue
        range_row(u, up, lever, slope, reach, radius, beam, memory.row)
        deviation, agrees = take_in(params, noise, innovation, up, trusted, memory.row, memory)
        if abs(deviation) > FAR_OFF * params.gate:
            refused |= 1 << beam
        if trusted:
            solution.range_innovation[beam] = deviation
            tried += 1
            if agrees:
                used |= 1 << beam
            else:
                against += 1
                square = (innovation * slope) ** 2
                least = square if against == 1 else min(least, square)
    if tried > 1:  # a beam alone may be wrong itself
        memory.ranges_refused = refused_again(memory.ranges_refused, against, tried)
    if memory.ranges_refused >= params.patience:
        memory.covariance[TERRAIN, TERRAIN] += least
        memory.ranges_refused = 0
    return used, refused
