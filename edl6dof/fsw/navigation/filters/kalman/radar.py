"""A look at the radar: range and speed of each beam, one scalar after the other.

Range: along the beam to ground at the elevation of the site plus the terrain state.  Speed: of the antenna
along the beam, u . (v_rel + w x l).

Source: Farrell, Aided Navigation (2008), chapter 12; Busnardo, Aitken, Tolson, Pierrottet and Amzajerdian,
"LIDAR-aided inertial navigation with extended Kalman filtering for pinpoint landing", AIAA 2011-6428.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.fsw.navigation.filters.kalman.antenna import STEEPEST, expected_range, place_antenna
from edl6dof.fsw.navigation.filters.kalman.gate import median, refused_again, weighted_noise
from edl6dof.fsw.navigation.filters.kalman.scalar_update import (
    expected_by,
    fold_in,
    predicted_variance,
    weigh,
)
from edl6dof.fsw.navigation.filters.kalman.states import (
    ATTITUDE_ERROR,
    POSITION,
    RANGE_BIAS,
    RANGE_SCALE,
    SPEED_SCALE,
    TERRAIN,
    VELOCITY,
    WIDTH,
)
from edl6dof.jit import kernel
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import add, cross, dot, put3, scale, take3


@kernel
def usable(health, radar, beam):
    """Whether a beam has an echo and is trusted."""
    return health.beam[beam] != 0 and radar.locked[beam] != 0


@kernel
def count_usable(health, radar, n_beams):
    """How many beams there are to look at."""
    count = 0
    for beam in range(n_beams):
        count += usable(health, radar, beam)
    return count


@kernel
def clear(row):
    """A row of nothing."""
    for j in range(WIDTH):
        row[j] = 0.0


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
def speed_row(u, spin, velocity, speed, beam, row):
    """Write what the speed of a ``beam`` along ``u`` sees of the errors; ``velocity`` is that of the
    centre of mass relative to a planet that turns at ``spin``.
    """
    clear(row)
    put3(row, POSITION, (-spin * u[1], spin * u[0], 0.0))
    put3(row, VELOCITY, u)
    put3(row, ATTITUDE_ERROR, cross(u, velocity))
    row[SPEED_SCALE + beam] = speed


@kernel
def range_noise(params, instruments, reach, slope, off):
    """Noise variance of a range: of the instrument, and of ground that is not as high below the vehicle as
    where the beam meets it.
    """
    own = instruments.range_sigma + instruments.range_sigma_relative * reach
    return own**2 + params.terrain_change**2 * off / (1000.0 * slope * slope)


@kernel
def keep_place(up, gain):
    """Let a reading move the position along ``up`` alone.

    Radar and stars see where over the planet the vehicle is through the direction of the vertical, a few
    micrometres per second squared for a hundred metres: less than beams out of place, slopes and the gravity
    of mountains feign.  So the place is considered, with what it means for the other states, and not
    estimated.
    """
    put3(gain, POSITION, scale(dot(up, take3(gain, POSITION)), up))


@kernel
def take_in(params, noise, innovation, up, memory):
    """Take a reading that sees ``memory.row`` into the covariance and the correction, if the gate lets it.

    Returns its innovation over its standard deviation, and whether it was taken.
    """
    own = predicted_variance(memory.covariance, memory.considered, memory.row, memory.product)
    rest = innovation - expected_by(memory.row, memory.correction)
    variance = own + noise
    weighted = weighted_noise(rest, variance, noise, params.gate, params.huber)
    if weighted >= 0.0:
        weigh(memory.product, own + weighted, memory.gain)
        keep_place(up, memory.gain)
        fold_in(
            *(memory.covariance, memory.product, memory.gain, memory.correction),
            *(own + weighted, rest),
        )
    return rest / sqrt(variance), weighted >= 0.0


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
def stands_apart(params, instruments, error, common, slope, off, reach, noise, memory):
    """Whether the height of a beam differs from the median of all by more than noise, bias and attitude
    explain; then the beam is wrong, however unsure the solution is.
    """
    covariance = memory.covariance
    level = covariance[ATTITUDE_ERROR, ATTITUDE_ERROR]
    level += (
        covariance[ATTITUDE_ERROR + 1, ATTITUDE_ERROR + 1]
        + covariance[ATTITUDE_ERROR + 2, ATTITUDE_ERROR + 2]
    )
    lasting = instruments.range_bias**2 + (instruments.range_scale * reach) ** 2
    spread = 2.0 * slope * slope * (noise + lasting) + 2.0 * off * off * level
    return (error - common) ** 2 > params.gate**2 * spread


@kernel
def look_at_ranges(params, onboard, health, radar, q, lever, up, height, solution, memory):
    """Take in the ranges; a bit for each beam that was used."""
    instruments, radius = onboard.instruments, onboard.planet.equatorial_radius
    told, common = common_height_error(onboard, health, radar, q, up, height, memory)
    used, tried, refused, least = 0, 0, 0, 0.0
    for beam in range(instruments.n_beams):
        solution.range_innovation[beam] = 0.0
        u = from_frame(q, take3(instruments.beam_axis[beam], 0))
        if usable(health, radar, beam) and -dot(u, up) > STEEPEST:
            reach, slope, off = expected_range(u, up, height, radius)
            innovation = radar.range[beam] - reach
            noise = range_noise(params, instruments, reach, slope, off)
            if told > 2 and stands_apart(
                params, instruments, innovation * slope, common, slope, off, reach, noise, memory
            ):
                continue
            range_row(u, up, lever, slope, reach, radius, beam, memory.row)
            deviation, taken = take_in(params, noise, innovation, up, memory)
            solution.range_innovation[beam] = deviation
            tried += 1
            if taken:
                used |= 1 << beam
            else:
                refused += 1
                square = (innovation * slope) ** 2
                least = square if refused == 1 else min(least, square)
    memory.ranges_refused = refused_again(memory.ranges_refused, refused, tried)
    if memory.ranges_refused >= params.patience:
        memory.covariance[TERRAIN, TERRAIN] += least
        memory.ranges_refused = 0
    return used


@kernel
def look_at_speeds(params, onboard, health, radar, q, up, velocity, swing, solution, memory):
    """Take in the speeds along the beams; a bit for each beam that was used."""
    instruments, spin = onboard.instruments, onboard.planet.rotation_rate
    used, tried, refused, least = 0, 0, 0, 0.0
    for beam in range(instruments.n_beams):
        solution.speed_innovation[beam] = 0.0
        if usable(health, radar, beam):
            u = from_frame(q, take3(instruments.beam_axis[beam], 0))
            speed = dot(u, add(velocity, swing))
            own = instruments.speed_sigma + instruments.speed_sigma_relative * abs(speed)
            speed_row(u, spin, velocity, speed, beam, memory.row)
            innovation = radar.speed[beam] - speed
            deviation, taken = take_in(params, own**2, innovation, up, memory)
            solution.speed_innovation[beam] = deviation
            tried += 1
            if taken:
                used |= 1 << beam
            else:
                refused += 1
                square = innovation**2
                least = square if refused == 1 else min(least, square)
    memory.speeds_refused = refused_again(memory.speeds_refused, refused, tried)
    if memory.speeds_refused >= params.patience:
        for i in range(VELOCITY, VELOCITY + 3):
            memory.covariance[i, i] += least
        memory.speeds_refused = 0
    return used


@kernel
def look_at_radar(params, onboard, health, sensed, motion, solution, memory):
    """Take in a fresh look at the radar, into covariance and correction."""
    q, lever, velocity, swing, up, height = place_antenna(onboard, motion, solution, sensed.t)
    radar = sensed.radar
    ranges = look_at_ranges(params, onboard, health, radar, q, lever, up, height, solution, memory)
    speeds = look_at_speeds(params, onboard, health, radar, q, up, velocity, swing, solution, memory)
    solution.beams_used = ranges | speeds
    memory.radar_t = sensed.t
