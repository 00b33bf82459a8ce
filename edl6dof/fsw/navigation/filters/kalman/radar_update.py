"""Radar update of the filter: the speed and the range of each beam, one scalar after the other.

The speeds come first: no terrain explains a wrong speed, so the range of a beam with a wrong speed is not
used. A speed is that of the antenna along the beam, u . (v_rel + w x l). A range is measured along the beam
to a plane, whose height is the elevation of the site plus the terrain state, and whose slope is the slope
state. Excluded readings are still compared with their expected values, so that they can be used again.

``memory.rows``, ``innovation`` and ``noise`` (variance) are the sensitivity of each reading, its difference
from the expected value, and its noise; ``present`` has a bit for each beam with a reading.

Sources: Farrell, Aided Navigation (2008), chapter 12; Busnardo, Aitken, Tolson, Pierrottet and Amzajerdian,
"LIDAR-aided inertial navigation with extended Kalman filtering for pinpoint landing", AIAA 2011-6428.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.fsw.navigation.filters.kalman.covariance import reopen_slope
from edl6dof.fsw.navigation.filters.kalman.measurement_update import (
    NONE,
    clear_row,
    find_outlier,
    reconsider,
    refused_again,
    update_by_reading,
)
from edl6dof.fsw.navigation.filters.kalman.states import (
    ATTITUDE_ERROR,
    POSITION,
    RANGE_BIAS,
    RANGE_SCALE,
    SLOPE,
    SPEED_SCALE,
    TERRAIN,
    VELOCITY,
)
from edl6dof.fsw.navigation.radar_beams import (
    STEEPEST,
    expected_range,
    ground_normal,
    horizontal,
    locked_beams,
    place_antenna,
)
from edl6dof.kernels import kernel
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import add, cross, dot, put3, scale, sub, take3


@kernel
def update_by_beams(params, n_beams, present, healthy, up, memory, deviations):
    """Update with the readings that are trusted (``healthy``: flags) and agree; writes the normalised
    innovation of each trusted one into ``deviations``.

    Returns:
        bits of the beams used; bits of the beams known as wrong: the identified one of the trusted readings,
        unless most are refused, and the refused ones of the others; number of trusted readings; number of
        trusted readings refused, and their least squared innovation.
    """
    left_out = find_outlier(
        params.gate, params.doubt, VELOCITY, n_beams, present, healthy=healthy, memory=memory
    )
    used, wrong, tried, against, least = 0, 0, 0, 0, 0.0
    for beam in range(n_beams):
        deviations[beam] = 0.0
        if present >> beam & 1 == 0:
            continue
        trusted, innovation, row = healthy[beam] != 0, memory.innovation[beam], memory.rows[beam]
        believed = trusted and beam != left_out
        deviation, agrees = update_by_reading(
            params, memory.noise[beam], innovation, up, believed, row=row, memory=memory
        )
        agrees = agrees and beam != left_out
        if not trusted:
            wrong |= 0 if agrees else 1 << beam
        else:
            deviations[beam] = deviation
            tried += 1
            if agrees:
                used |= 1 << beam
            else:
                against += 1
                least = innovation**2 if against == 1 else min(least, innovation**2)
    if left_out != NONE and 2 * against <= tried:
        wrong |= 1 << left_out
    return used, wrong, tried, against, least


@kernel
def speed_row(u, spin, velocity, speed, beam, row):
    """Write the sensitivity ``row`` of the ``speed`` (m/s) of a ``beam`` along ``u`` (I); ``velocity``:
    planet-relative, m/s, I.
    """
    clear_row(row)
    put3(row, POSITION, (-spin * u[1], spin * u[0], 0.0))
    put3(row, VELOCITY, u)
    put3(row, ATTITUDE_ERROR, cross(u, velocity))
    row[SPEED_SCALE + beam] = speed


@kernel
def expect_speeds(onboard, radar, antenna, memory):
    """Fill ``rows``, ``innovation`` and ``noise`` (variance) of ``memory`` for every beam with an echo."""
    instruments, spin = onboard.instruments, onboard.planet.rotation_rate
    q, _, velocity, swing, _, _ = antenna
    for beam in range(instruments.n_beams):
        if radar.locked[beam] != 0:
            u = from_frame(q, take3(instruments.beam_axis[beam], 0))
            speed = dot(u, add(velocity, swing))
            memory.innovation[beam] = radar.speed[beam] - speed
            own = instruments.speed_sigma + instruments.speed_sigma_relative * abs(speed)
            memory.noise[beam] = own**2
            speed_row(u, spin, velocity, speed, beam, row=memory.rows[beam])


@kernel
def update_by_speeds(params, onboard, health, radar, antenna, solution, memory):
    """Update with the speeds along the beams; returns bits of the beams used, and of those known as wrong."""
    n_beams = onboard.instruments.n_beams
    expect_speeds(onboard, radar, antenna, memory)
    locked, up, deviations = locked_beams(radar, n_beams), antenna[4], solution.speed_innovation
    used, wrong, tried, against, least = update_by_beams(
        params, n_beams, locked, health.beam_speed, up, memory=memory, deviations=deviations
    )
    if memory.doubted > 1.0:
        # the solution follows the mean of the beams instead of the motion since an earlier one
        for i in range(VELOCITY, VELOCITY + 3):
            memory.covariance[i, i] += FOLLOWED * memory.doubted * onboard.instruments.speed_sigma**2
    if tried > 1:  # a single beam may be wrong itself
        memory.speeds_refused = refused_again(memory.speeds_refused, against, tried)
    if memory.speeds_refused >= params.patience:
        for i in range(VELOCITY, VELOCITY + 3):
            memory.covariance[i, i] += least
        memory.speeds_refused = 0
    return used, wrong


#: Variance of the velocity that is added in each look with doubted speeds, over the variance of a speed.
FOLLOWED = 0.003
#: Number of ranges that a plane always fits, as it has a height and two slopes.
PLANE = 3
#: Horizontal distance (m) from which on relief is the same: wider relief is the slope of the plane.
WIDEST = 400.0


@kernel
def range_row(u, up, normal, lever, steepness, reach, radius, beam, row):
    """Write the sensitivity ``row`` of the range of a ``beam`` along ``u`` (I) to the errors; ``reach``:
    expected range, m.
    """
    clear_row(row)
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
def consider_relief(params, instruments, steepness, off, at, memory):
    """Set the variance (m2) of the considered error ``at`` of a range: bias of the beam, and relief over the
    horizontal distance ``off`` (m) to the spot, with a Hurst exponent of 3/4.

    Looks from almost the same place meet the same relief, which no mean over looks reduces. It changes as the
    vehicle descends and the spot moves inwards: the error is a share of the one before, and new relief.
    """
    way = min(off, WIDEST) / 1000.0
    variance = instruments.range_bias**2 + params.relief**2 * way * sqrt(way) / steepness**2
    share = min(variance / max(memory.considered[at], 1e-12), 1.0)
    reconsider(at, variance, share * sqrt(share), memory)


@kernel
def expect_ranges(params, onboard, radar, antenna, normal, memory):
    """Fill ``rows``, ``innovation`` and ``noise`` (variance) of ``memory``. Returns bits of the beams with an
    echo that are steep enough, and of those whose spot is farther off the plane than relief explains.
    """
    q, lever, _, _, up, height = antenna
    height -= dot(lever, sub(up, normal))
    instruments, radius, present, off_ground = onboard.instruments, onboard.planet.equatorial_radius, 0, 0
    for beam in range(instruments.n_beams):
        u = from_frame(q, take3(instruments.beam_axis[beam], 0))
        if radar.locked[beam] != 0 and -dot(u, normal) > STEEPEST:
            reach, steepness, off = expected_range(u, up, normal, height, radius)
            memory.innovation[beam] = radar.range[beam] - reach
            memory.noise[beam] = (instruments.range_sigma + instruments.range_sigma_relative * reach) ** 2
            consider_relief(params, instruments, steepness, off, RANGE_BIAS + beam, memory=memory)
            range_row(
                u, up, normal, lever, steepness, reach=reach, radius=radius, beam=beam, row=memory.rows[beam]
            )
            present |= 1 << beam
            if abs(memory.innovation[beam]) * steepness > params.unevenness * sqrt(off / 1000.0):
                off_ground |= 1 << beam
    return present, off_ground


@kernel
def update_by_ranges(params, onboard, health, radar, speeds, antenna, solution, memory):
    """Update with the ranges of the beams whose speed was used (bits ``speeds``). Returns bits of the beams
    used, and of the beams with ranges that no terrain explains.

    Several refused ranges at once do not count as wrong, nor does one of three, since a plane fits any three
    ranges: if this persists, the variance of the slope is raised; that of the height too, unless three ranges
    have agreed before and most agree now.
    """
    n_beams, up, deviations = onboard.instruments.n_beams, antenna[4], solution.range_innovation
    normal = ground_normal(up, solution.slope)
    present, off_ground = expect_ranges(params, onboard, radar, antenna, normal, memory=memory)
    used, wrong, tried, against, least = update_by_beams(
        params, n_beams, present & speeds, health.beam_range, up, memory=memory, deviations=deviations
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
    return used, 0 if other_ground else wrong & off_ground


@kernel
def update_by_radar(params, onboard, health, sensed, motion, solution, memory):
    """Update covariance and correction with a new radar measurement."""
    antenna = place_antenna(onboard, motion, solution, sensed.t)
    speeds, off_speeds = update_by_speeds(
        params, onboard, health, sensed.radar, antenna, solution=solution, memory=memory
    )
    ranges, off_ranges = update_by_ranges(
        params, onboard, health, sensed.radar, speeds, antenna=antenna, solution=solution, memory=memory
    )
    solution.beams_used, solution.looked = ranges | speeds, 1
    solution.ranges_refused, solution.speeds_refused = off_ranges, off_speeds
    memory.radar_t = sensed.t
