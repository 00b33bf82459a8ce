"""Two independent filters, as on the Mars Science Laboratory: velocity by least squares over the beams, with
data editing, and height as the mean of buffered beam heights; each corrects the solution once it has
converged.

The velocity filter fits errors of velocity and acceleration (6 states) to the speeds along the beams, with
fading weights. Position fixes from landmarks correct the horizontal position; without them it remains that of
the inertial unit, as the attitude does.

Source: C. W. Chen and B. D. Pollard, "Radar terminal descent sensor performance during Mars Science
Laboratory landing", Journal of Spacecraft and Rockets 51 (2014); the fit: Bierman, Factorization Methods for
Discrete Sequential Estimation (1977), chapter II.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.config.base import Params, param
from edl6dof.fsw.navigation.filters.kalman.covariance import deviation
from edl6dof.fsw.navigation.filters.kalman.measurement_update import (
    apply_gain,
    explained_by,
    find_outlier,
    median,
    optimal_gain,
    predicted_variance,
)
from edl6dof.fsw.navigation.landmark_fix import deviation_along
from edl6dof.fsw.navigation.radar_beams import (
    STEEPEST,
    beam_usable,
    count_usable_beams,
    expected_range,
    locked_beams,
    place_antenna,
)
from edl6dof.fsw.navigation.strapdown import level_axes
from edl6dof.interface.capacities import MAX_BEAMS
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, FLAG, record
from edl6dof.registry import Member
from edl6dof.spatial.elementary import exp
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import add, dot, put3, scale, take3

#: Beam heights that the buffer can hold.
HEIGHTS = 128

TWO_FILTER = record(
    # errors of velocity (m/s, I) and acceleration (m/s2, I)
    ("covariance", "f8", (6, 6)),
    ("correction", "f8", (6,)),
    ("converged", FLAG),  # the fitted velocity corrects the solution
    ("age", "f8"),  # s: since the last use of the radar
    ("height_error", "f8", (HEIGHTS,)),  # m: by how much the believed height is too large, beam by beam
    ("heights", COUNT),  # beam heights so far
    ("started_t", "f8"),  # s, flight time
    ("placed_t", "f8"),  # s, flight time: last position fix; 0: none
    ("place_variance", "f8", (2,)),  # m2: of the position on the map north and east, after that fix
    # workspace
    ("considered", "f8", (6,)),
    ("product", "f8", (6,)),
    ("gain", "f8", (6,)),
    ("rows", "f8", (MAX_BEAMS, 6)),
    ("innovation", "f8", (MAX_BEAMS,)),
    ("noise", "f8", (MAX_BEAMS,)),
    ("rest", "f8", (MAX_BEAMS,)),
    ("spread", "f8", (MAX_BEAMS, MAX_BEAMS)),
    ("doubted", "f8"),  # factor on the noise of the last look, as a speed is wrong but not identified
    ("beam_errors", "f8", (MAX_BEAMS,)),
    ("ordered", "f8", (MAX_BEAMS,)),
)


class TwoFilterParams(Params):
    """Velocity and height filters."""

    radar_interval_s: float = param(0.1, "time between two looks at the radar that are used", ge=0.0, le=10.0)
    window_s: float = param(3.0, "time over which the speeds are fitted", gt=0.0, le=100.0)
    edit: float = param(
        3.0, "standard deviations of a residual beyond which a reading is left out", ge=1.0, le=20.0
    )
    velocity_sigma_m_s: float = param(
        5.0, "standard deviation of the velocity when the radar first locks", status="estimate", gt=0.0
    )
    acceleration_sigma_m_s2: float = param(
        0.05, "standard deviation of the acceleration when the radar first locks", status="estimate", gt=0.0
    )
    converged_m_s: float = param(0.15, "standard deviation below which the fitted velocity is used", gt=0.0)
    heights: int = param(40, "beam heights that are averaged", ge=1, le=HEIGHTS)


@kernel
def start(params, onboard, sensed, solution, memory):
    """Initialise both filters."""
    for i in range(6):
        memory.correction[i] = 0.0
        for j in range(6):
            memory.covariance[i, j] = 0.0
    for i in range(3):
        memory.covariance[i, i] = params.velocity_sigma**2
        memory.covariance[3 + i, 3 + i] = params.acceleration_sigma**2
    memory.converged, memory.heights, memory.age = 0, 0, 0.0
    memory.started_t, memory.placed_t = solution.t, 0.0
    _report_covariance(params, onboard, solution, memory)


@kernel
def correct(params, onboard, health, sensed, motion, solution, memory):
    """Process a radar measurement when due, and correct the quantities whose filter has converged."""
    memory.age += motion.dt
    if motion.position_fix.matches > 0:
        _correct_position(onboard, motion.position_fix, solution, memory)
    due = sensed.radar.fresh != 0 and memory.age > params.radar_interval - 0.5 * motion.dt
    n_beams = onboard.instruments.n_beams
    echoes = count_usable_beams(health, sensed.radar, n_beams)
    if due and echoes > 0:
        _carry_forward(params, echoes > 1, memory)
        antenna = place_antenna(onboard, motion, solution, sensed.t)
        speeds, wrong = _fit_speeds(
            params, onboard, health, sensed.radar, antenna, solution=solution, memory=memory
        )
        ranges = _buffer_heights(
            params, onboard, health, sensed.radar, speeds, antenna=antenna, solution=solution, memory=memory
        )
        solution.beams_used, solution.speeds_refused, solution.looked = speeds | ranges, wrong, 1
        _correct_velocity(params, solution, memory)
        _correct_height(params, solution, memory)
        _report_covariance(params, onboard, solution, memory)


@kernel
def _carry_forward(params, ground_seen, memory):
    """Propagate the fit: the velocity error grows by the acceleration error, and old information fades, but
    not for one echo alone (``ground_seen`` false), which may not be from the ground.
    """
    P, T = memory.covariance, memory.age
    fade = exp(min(T / params.window, 2.0)) if ground_seen else 1.0
    for i in range(3):
        memory.correction[i] += T * memory.correction[3 + i]
        for j in range(3):
            P[i, j] += T * (P[3 + i, j] + P[i, 3 + j]) + T * T * P[3 + i, 3 + j]
    for i in range(3):
        for j in range(3):
            P[i, 3 + j] += T * P[3 + i, 3 + j]
            P[3 + j, i] = P[i, 3 + j]
    for i in range(6):
        for j in range(6):
            P[i, j] *= fade
    memory.age = 0.0


@kernel
def _expect_speeds(onboard, radar, antenna, memory):
    """Fill ``rows``, ``innovation`` and ``noise`` (variance) of ``memory`` for every beam with an echo."""
    instruments, q, velocity = onboard.instruments, antenna[0], add(antenna[2], antenna[3])
    for beam in range(instruments.n_beams):
        if radar.locked[beam] != 0:
            u = from_frame(q, take3(instruments.beam_axis[beam], 0))
            speed = dot(u, velocity)
            put3(memory.rows[beam], 0, u)
            memory.innovation[beam] = radar.speed[beam] - speed
            own = instruments.speed_sigma + instruments.speed_sigma_relative * abs(speed)
            memory.noise[beam] = own**2


@kernel
def _fit_speeds(params, onboard, health, radar, antenna, solution, memory):
    """Update with the trusted speeds that agree; returns bits of these beams, and of those known as wrong:
    the identified one of the trusted speeds, and the others that disagree. A wrong speed that was used before
    it was identified may have changed the velocity by as much as this was unknown at first.
    """
    n_beams, used, wrong = onboard.instruments.n_beams, 0, 0
    _expect_speeds(onboard, radar, antenna, memory)
    locked = locked_beams(radar, n_beams)
    left_out = find_outlier(
        params.edit, params.velocity_sigma, 0, n_beams, locked, healthy=health.beam_speed, memory=memory
    )
    for beam in range(n_beams):
        solution.speed_innovation[beam] = 0.0
        if locked >> beam & 1:
            row, trusted = memory.rows[beam], health.beam_speed[beam] != 0
            variance = predicted_variance(memory.covariance, memory.considered, row, memory.product)
            variance += memory.noise[beam]
            residual = memory.innovation[beam] - explained_by(row, memory.correction)
            agrees = residual**2 <= params.edit**2 * variance
            if trusted:
                solution.speed_innovation[beam] = residual / sqrt(variance)
            if beam == left_out or not (trusted or agrees):
                wrong |= 1 << beam
            elif trusted and agrees:
                optimal_gain(memory, variance)
                apply_gain(memory, variance, residual)
                used |= 1 << beam
    return used, wrong


@kernel
def _buffer_heights(params, onboard, health, radar, speeds, antenna, solution, memory):
    """Store the height errors of beams with a used speed (bits ``speeds``) that agree with their median;
    returns bits of these beams.
    """
    instruments, radius = onboard.instruments, onboard.planet.equatorial_radius
    q, _, _, _, up, height = antenna
    used, count = 0, 0
    for step in range(2):  # the median first
        common = median(memory.beam_errors, count, memory.ordered) if count > 0 else 0.0
        for beam in range(instruments.n_beams):
            u = from_frame(q, take3(instruments.beam_axis[beam], 0))
            sound = speeds >> beam & 1 and beam_usable(health.beam_range, radar, beam)
            if sound and -dot(u, up) > STEEPEST:
                reach, slope, _ = expected_range(u, up, up, height, radius)
                error = (reach - radar.range[beam]) * slope
                sigma = slope * (instruments.range_sigma + instruments.range_sigma_relative * abs(reach))
                if step == 0:
                    memory.beam_errors[count] = error
                    count += 1
                elif abs(error - common) <= params.edit * 1.5 * sigma:
                    memory.height_error[memory.heights % params.heights] = error
                    memory.heights += 1
                    solution.range_innovation[beam] = -error / sigma
                    used |= 1 << beam
    return used


@kernel
def _correct_velocity(params, solution, memory):
    """Correct the velocity once its error is known well enough; the acceleration error remains in the fit."""
    worst = max(memory.covariance[0, 0], memory.covariance[1, 1], memory.covariance[2, 2])
    if worst < params.converged**2:
        memory.converged = 1
    if memory.converged != 0:
        for i in range(3):
            solution.v_I[i] += memory.correction[i]
            memory.correction[i] = 0.0


@kernel
def _correct_height(params, solution, memory):
    """Subtract the mean of the buffer from the believed height once the buffer is full."""
    if memory.heights >= params.heights:
        mean = 0.0
        for k in range(params.heights):
            mean += memory.height_error[k] / params.heights
        solution.terrain += mean
        for k in range(params.heights):
            memory.height_error[k] -= mean


@kernel
def _correct_position(onboard, fix, solution, memory):
    """Correct the horizontal position by a position fix (``POSITION_FIX``): a scalar filter along north and
    east, whose variance does not fall below that by the attitude error, which all fixes share.
    """
    r_I, error = take3(solution.r_I, 0), take3(fix.error, 0)
    north, east, _, _ = level_axes(onboard.planet, r_I, solution.t)
    for i, axis in enumerate((north, east)):
        own, turned = deviation_along(fix, axis)
        lasting = (turned * solution.sigma_attitude[i]) ** 2
        variance = solution.sigma_r[i] ** 2
        if memory.placed_t > 0.0:
            variance = memory.place_variance[i]
            variance += (solution.sigma_v[i] * (solution.t - memory.placed_t)) ** 2
        share = variance / (variance + own**2 + lasting)
        r_I = add(r_I, scale(share * dot(error, axis), axis))
        memory.place_variance[i] = max((1.0 - share) * variance, lasting)
    put3(solution.r_I, 0, r_I)
    memory.placed_t = solution.t


@kernel
def _report_covariance(params, onboard, solution, memory):
    """Write the standard deviations: of fit and mean, otherwise of dead reckoning from the start."""
    instruments, t = onboard.instruments, solution.t - memory.started_t
    r_I = take3(solution.r_I, 0)
    north, east, up, altitude = level_axes(onboard.planet, r_I, solution.t)
    attitude = instruments.star_sigma**2 + instruments.star_bias**2
    attitude += instruments.gyro_noise**2 * t + (instruments.gyro_bias * t) ** 2
    for i, axis in enumerate((north, east, up)):
        tracked = deviation(instruments.tracking_position, 0, axis)
        tracked_v = deviation(instruments.tracking_velocity, 0, axis)
        solution.sigma_r[i] = sqrt(tracked**2 + (tracked_v * t) ** 2)
        if memory.placed_t > 0.0 and i < 2:
            displaced = onboard.instruments.landmarks.map_offset
            grown = solution.sigma_v[i] * (solution.t - memory.placed_t)
            solution.sigma_r[i] = sqrt(memory.place_variance[i] + grown**2 + displaced**2)
        fitted = deviation(memory.covariance, 0, axis)
        solution.sigma_v[i] = fitted if memory.converged != 0 else tracked_v
        solution.sigma_attitude[i] = sqrt(attitude)
    height = abs(altitude - onboard.site.altitude - solution.terrain)
    own = instruments.range_sigma + instruments.range_sigma_relative * height
    lasting = (instruments.range_scale * height) ** 2 + instruments.range_bias**2
    averaged = sqrt(own**2 / params.heights + lasting / max(instruments.n_beams, 1))
    solution.sigma_height = averaged if memory.heights >= params.heights else solution.sigma_r[2]


MEMBER = Member(
    "two_filter",
    TwoFilterParams,
    {"start": start, "correct": correct},
    "Chen and Pollard, Journal of Spacecraft and Rockets 51 (2014)",
    memory=TWO_FILTER,
    reads=("inertial", "stars", "radar", "tracking"),
)
