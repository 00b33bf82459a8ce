"""Error-state Kalman filter: position, velocity, attitude, biases of gyros and accelerometers, height and
slope of the ground, corrected by star fixes, by range and speed of each radar beam, and by position fixes
from landmarks.

The covariance is propagated at a low rate, and whenever a reading is used; errors that the readings share
(scale factors and misalignments, bias of a beam's range, of the star tracker) are considered, not estimated.

Source: Farrell, Aided Navigation (2008), chapters 5 and 11; considered errors: Schmidt, Advances in Control
Systems 3 (1966); weights: Karlgaard and Schaub, JGCD 30 (2007).
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.fsw.navigation.filters.kalman.covariance import (
    add_process_noise,
    follow_exclusions,
    report_covariance,
    start_covariance,
)
from edl6dof.fsw.navigation.filters.kalman.landmark_update import update_by_landmarks
from edl6dof.fsw.navigation.filters.kalman.measurement_update import apply_correction, update_by_stars
from edl6dof.fsw.navigation.filters.kalman.radar_update import update_by_radar
from edl6dof.fsw.navigation.filters.kalman.states import (
    ERROR_STATE,
    accumulate,
    begin_interval,
    fill_transition,
    follow_slope,
    move_covariance,
)
from edl6dof.fsw.navigation.radar_beams import count_usable_beams
from edl6dof.fsw.navigation.strapdown import level_axes
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.vector import dot, scale, take3, take4


class ErrorStateParams(Params):
    """Error-state Kalman filter."""

    covariance_interval_s: float = param(
        1.0, "longest time between two steps of the covariance", gt=0.0, le=10.0
    )
    radar_interval_s: float = param(0.1, "time between two looks at the radar that are used", ge=0.0, le=10.0)
    star_interval_s: float = param(1.0, "time between two star fixes that are used", ge=0.0, le=100.0)
    gate: float = param(
        4.0, "standard deviations of an innovation beyond which a reading is rejected", ge=2.0, le=20.0
    )
    huber: float = param(
        2.5,
        "standard deviations of an innovation beyond which the weight of a reading is reduced",
        ge=1.0,
        le=20.0,
    )
    doubt_m_s: float = param(
        0.25,
        "standard deviation of an error of the velocity that a beam with a bias may have caused before it "
        "was detected; the identification of the wrong beam allows for it",
        status="estimate",
        ge=0.0,
        le=100.0,
    )
    patience: int = param(
        10,
        "consecutive looks in which most beams are rejected after which the solution counts as wrong",
        ge=1,
        le=1000,
    )
    terrain_sigma_m: float = param(
        150.0,
        "initial standard deviation of the height of the ground above the site",
        status="estimate",
        gt=0.0,
        le=10e3,
    )
    terrain_change_m: float = param(
        5.0,
        "standard deviation of the change of the height of the ground over 1 km",
        status="estimate",
        gt=0.0,
        le=1000.0,
    )
    relief_m: float = param(
        14.5,
        "standard deviation of the difference of height between two places 1 km apart, off the plane",
        status="estimate",
        gt=0.0,
        le=1000.0,
    )
    slope_sigma_deg: float = param(
        12.0, "standard deviation of the slope before the radar sees it", status="estimate", gt=0.0, le=45.0
    )
    slope_change_deg: float = param(
        2.0,
        "standard deviation of the change of the slope over a flown distance equal to the height",
        status="estimate",
        gt=0.0,
        le=45.0,
    )
    unevenness_m: float = param(
        120.0,
        "largest deviation of the ground from its plane at a distance of 1 km, proportional "
        "to the square root of the distance; a range with a larger deviation counts as wrong",
        status="estimate",
        gt=0.0,
        le=1000.0,
    )
    gravity_m_s2: float = param(
        1e-3,
        "standard deviation of the error of the gravity model, which counts as accelerometer bias",
        status="estimate",
        ge=0.0,
        le=1.0,
    )
    unknown_rate_deg_s: float = param(
        2.0, "standard deviation of the rate during a gap of the gyros", status="estimate", ge=0.0, le=1000.0
    )
    unknown_force_m_s2: float = param(
        50.0, "standard deviation of the force beyond the range of the accelerometers", ge=0.0, le=1000.0
    )


@kernel
def start(params, onboard, sensed, solution, memory):
    """Initialise the filter with the errors of ground tracking, star tracker and the data sheets of the
    instruments.
    """
    start_covariance(params, onboard.instruments, solution, memory)
    report_covariance(onboard.planet, memory.covariance, solution)


@kernel
def correct(params, onboard, health, sensed, motion, solution, memory):
    """Accumulate the motion; when due, propagate the covariance and update it with star tracker and radar."""
    accumulate(params, motion, solution, memory)
    early = 0.5 * motion.dt
    stars = motion.fixes > 0 and sensed.t - memory.stars_t > params.star_interval - early
    radar = sensed.radar.fresh != 0 and sensed.t - memory.radar_t > params.radar_interval - early
    echoes = count_usable_beams(health, sensed.radar, onboard.instruments.n_beams)
    radar = radar and echoes > 0
    landmarks = motion.position_fix.matches > 0
    if stars or radar or landmarks or memory.interval.dt > params.covariance_interval - early:
        # a single echo may not be from the ground
        _carry_forward(params, onboard, health, radar and echoes > 1, solution, memory=memory)
        if stars:
            update_by_stars(params, onboard, sensed, motion, solution, memory=memory)
        if radar:
            update_by_radar(params, onboard, health, sensed, motion, solution=solution, memory=memory)
        if landmarks:
            update_by_landmarks(params, motion.position_fix, memory)
        apply_correction(memory, solution)
        report_covariance(onboard.planet, memory.covariance, solution)


@kernel
def _carry_forward(params, onboard, health, ground_seen, solution, memory):
    """Propagate the covariance to the time of the solution; while the radar sees the ground
    (``ground_seen``), also the height of the ground, as the slope is only known for ground between the beams.
    """
    planet, instruments, r_I = onboard.planet, onboard.instruments, take3(solution.r_I, 0)
    follow_exclusions(instruments, health, memory)
    fill_transition(planet.mu, r_I, memory.interval, memory.transition)
    move_covariance(memory.transition, memory.considered, memory.moved, memory.covariance)
    north, east, up, altitude = level_axes(planet, r_I, solution.t)
    spin, v_I = planet.rotation_rate, take3(solution.v_I, 0)
    v_rel_I = (v_I[0] + spin * r_I[1], v_I[1] - spin * r_I[0], v_I[2])
    q = take4(solution.q_I2B)
    if ground_seen:
        way = scale(memory.interval.dt, v_rel_I)
        follow_slope(dot(north, way), dot(east, way), solution, memory.covariance)
    height = altitude - onboard.site.altitude - solution.terrain
    add_process_noise(params, instruments, v_rel_I, up, height, q=q, memory=memory)
    begin_interval(memory.interval)


MEMBER = Member(
    "error_state",
    ErrorStateParams,
    {"start": start, "correct": correct},
    "Farrell, Aided Navigation (2008), chapters 5 and 11",
    memory=ERROR_STATE,
    reads=("inertial", "stars", "radar", "tracking"),
)
