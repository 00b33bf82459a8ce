"""One base cycle of navigation: from the instrument readings to the estimated state."""

from __future__ import annotations

from edl6dof.fsw.navigation.exclusions import (
    BEAM_WATCH,
    EXCLUSIONS,
    note_changes,
    watch_beams,
)
from edl6dof.fsw.navigation.filters.registry import GIVEN, NAVIGATION_FILTERS
from edl6dof.fsw.navigation.gyro_gaps import GAP_SMOOTHING, smooth_gap
from edl6dof.fsw.navigation.inertial import INERTIAL_MEMORY, read_motion, take_reading
from edl6dof.fsw.navigation.integrity import INTEGRITY, check_integrity
from edl6dof.fsw.navigation.landmark_fix import LANDMARK_FIXES, note_exposure, read_landmarks
from edl6dof.fsw.navigation.recovery import RECOVERY, recover
from edl6dof.fsw.navigation.solution import ESTIMATE, INSTRUMENT_HEALTH, MOTION, SOLUTION
from edl6dof.fsw.navigation.star_fixes import STAR_WATCH, read_stars
from edl6dof.fsw.navigation.strapdown import align, attitude_at, gravity_I, integrate
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import add, cross, dot, put3, put4, scale, sub, take3, take4

#: Least time (s) between two different readings.
LEAST_TIME = 1e-9

#: Memory of navigation.
NAVIGATION = record(
    ("estimate", ESTIMATE),
    ("inertial", INERTIAL_MEMORY),
    ("motion", MOTION),
    ("solution", SOLUTION),
    ("gap_smoothing", GAP_SMOOTHING),
    ("recovery", RECOVERY),
    ("integrity", INTEGRITY),
    ("centre", "f8", (3,)),  # m, B: centre of mass that the solution refers to
    ("health", INSTRUMENT_HEALTH),
    ("beam_watch", BEAM_WATCH),
    ("star_watch", STAR_WATCH),
    ("exclusions", EXCLUSIONS),
    ("landmarks", LANDMARK_FIXES),
    ("filter", NAVIGATION_FILTERS.memory),
)


@kernel
def estimate_state(filters, onboard, state, sensed, memory):
    """Update ``memory.estimate`` to the cycle of ``sensed``.

    Args:
        filters: kernels of the chosen navigation filter: start and correct.
        onboard, state, sensed: ``ONBOARD``, ``VEHICLE_STATE`` (parts that are gone) and ``SENSED`` records.
        memory: ``NAVIGATION`` record, updated.
    """
    estimate = memory.estimate
    estimate.t = sensed.t
    estimate.footpad_contact, estimate.wing_open = sensed.footpad_contact, sensed.wing_open
    if onboard.navigation.filter == GIVEN:
        take_given(sensed, estimate)
        return
    navigate(filters, onboard, state, sensed, memory)
    if memory.solution.started != 0:
        extrapolate(onboard.planet, memory.motion, memory.solution, estimate)
        check_integrity(onboard, sensed, memory, estimate)


@kernel
def navigate(filters, onboard, state, sensed, memory):
    """Update ``memory.solution`` by the reading of the inertial unit that arrives with ``sensed``."""
    start_filter, correct_solution = filters
    params, motion, solution = onboard.navigation, memory.motion, memory.solution
    body = onboard.vehicle.configuration[state.configuration]
    centre = take3(body.centre, 0)
    before = take3(solution.r_I, 0)
    dt = take_reading(onboard.instruments, sensed.t, sensed.inertial, memory.inertial)
    put3(motion.centre, 0, centre)
    if dt > LEAST_TIME:
        follow_centre(centre, motion, solution, memory.centre)
        read_motion(
            params, onboard.instruments, body, dt, sensed.inertial, solution=solution,
            health=memory.health, memory=memory.inertial, motion=motion,
        )  # fmt: skip
        put3(memory.estimate.imu_gain_B, 0, add(take3(memory.estimate.imu_gain_B, 0), take3(motion.gain, 0)))
    read_stars(
        onboard, state.requested, sensed, solution, memory.health, memory=memory.star_watch, motion=motion
    )
    if solution.started == 0:
        if sensed.tracking.fresh != 0 and motion.fixes > 0:
            align(onboard.planet, memory.inertial.t, sensed, motion, solution)
            put3(memory.centre, 0, centre)
            start_filter(params.filter, params, onboard, sensed, solution, memory=memory.filter)
    elif dt > LEAST_TIME:
        integrate(onboard.planet, motion, solution)
        lever = sub(take3(onboard.instruments.unit_position, 0), centre)
        smooth_gap(body, lever, memory.inertial, motion, memory=memory.gap_smoothing, solution=solution)
        recover(
            params.recovery, onboard, memory.health, sensed, motion, memory=memory.recovery, solution=solution
        )
        solution.looked = 0
        way = add(take3(memory.landmarks.way, 0), sub(take3(solution.r_I, 0), before))
        put3(memory.landmarks.way, 0, way)
        read_landmarks(onboard, sensed, solution, memory.landmarks, motion.position_fix)
        correct_solution(
            params.filter,
            params,
            onboard,
            memory.health,
            sensed,
            motion=motion,
            solution=solution,
            memory=memory.filter,
        )
        note_exposure(onboard, sensed, motion, solution, memory.landmarks)
        watch(onboard, sensed, memory)


@kernel
def watch(onboard, sensed, memory):
    """Exclude beams that have failed, and log all exclusions."""
    params, motion, solution = onboard.navigation, memory.motion, memory.solution
    health, instruments = memory.health, onboard.instruments
    watch_beams(
        params.beam_watch,
        onboard.planet,
        instruments,
        sensed.radar,
        solution,
        health=health,
        memory=memory.beam_watch,
    )
    note_changes(instruments, sensed.t, health, motion, memory.exclusions)


@kernel
def follow_centre(centre, motion, solution, before):
    """Refer the solution to the new ``centre`` of mass (m, B) when parts have left; ``before``: last centre,
    updated.
    """
    arm = sub(centre, take3(before, 0))
    if dot(arm, arm) == 0.0:
        return
    q = take4(solution.q_I2B)
    put3(solution.r_I, 0, add(take3(solution.r_I, 0), from_frame(q, arm)))
    put3(solution.v_I, 0, add(take3(solution.v_I, 0), from_frame(q, cross(take3(motion.rate, 0), arm))))
    put3(before, 0, centre)


@kernel
def extrapolate(planet, motion, solution, estimate):
    """Extrapolate ``solution`` from the last reading to the cycle of ``estimate``, except its height."""
    age = estimate.t - solution.t
    q = take4(solution.q_I2B)
    r, v = take3(solution.r_I, 0), take3(solution.v_I, 0)
    rate = take3(motion.rate, 0)
    force = scale(1.0 / motion.dt if motion.dt > 0.0 else 0.0, take3(motion.gain, 0))
    gained = scale(age, add(from_frame(q, force), gravity_I(planet, r)))
    r = add(r, scale(age, add(v, scale(0.5, gained))))
    put3(estimate.r_I, 0, r)
    put3(estimate.v_I, 0, add(v, gained))
    put4(estimate.q_I2B, attitude_at(solution, motion, estimate.t))
    put3(estimate.w_B, 0, rate)
    put3(estimate.specific_force_B, 0, force)
    put3(estimate.imu_rate_B, 0, rate)


@kernel
def take_given(sensed, estimate):
    """Copy the readings of ideal instruments."""
    put4(estimate.q_I2B, sensed.q_I2B)
    put3(estimate.r_I, 0, take3(sensed.r_I, 0))
    put3(estimate.v_I, 0, take3(sensed.v_I, 0))
    put3(estimate.w_B, 0, take3(sensed.w_B, 0))
    put3(estimate.specific_force_B, 0, take3(sensed.specific_force_B, 0))
    put3(estimate.imu_rate_B, 0, take3(sensed.imu_rate_B, 0))
    put3(estimate.imu_gain_B, 0, take3(sensed.imu_gain_B, 0))
    estimate.height_above_ground = sensed.height_above_ground
