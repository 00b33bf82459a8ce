"""One base cycle of navigation: from the readings of the instruments to the estimated state."""

from __future__ import annotations

import numpy as np

from edl6dof.fsw.navigation.alignment import align
from edl6dof.fsw.navigation.beam_watch import BEAM_WATCH, watch_beams
from edl6dof.fsw.navigation.exclusions import EXCLUSIONS, note_changes
from edl6dof.fsw.navigation.filters.registry import (
    GIVEN,
    NAVIGATION_FILTERS,
    correct_solution,
    start_filter,
)
from edl6dof.fsw.navigation.guard import (
    GUARD,
    check_solution,
    guarded_height,
    height_and_climb,
    height_while_lost,
)
from edl6dof.fsw.navigation.hindsight import HINDSIGHT, look_back
from edl6dof.fsw.navigation.inertial import INERTIAL_MEMORY, read_motion, take_reading
from edl6dof.fsw.navigation.recovery import RECOVERY, recover
from edl6dof.fsw.navigation.solution import ESTIMATE, INSTRUMENT_HEALTH, MOTION, SOLUTION
from edl6dof.fsw.navigation.star_watch import STAR_WATCH, watch_stars
from edl6dof.fsw.navigation.strapdown import integrate
from edl6dof.fsw.navigation.tell import tell
from edl6dof.jit import kernel
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import add, cross, dot, norm, put3, sub, take3

#: Time between two readings (s) below which they are one.
LEAST_TIME = 1e-9

#: What navigation remembers.
NAVIGATION = np.dtype(
    [
        ("estimate", ESTIMATE),
        ("inertial", INERTIAL_MEMORY),
        ("motion", MOTION),
        ("solution", SOLUTION),
        ("hindsight", HINDSIGHT),
        ("recovery", RECOVERY),
        ("guard", GUARD),
        ("centre", "f8", (3,)),  # m, B: centre of mass that the solution is of
        ("health", INSTRUMENT_HEALTH),
        ("beam_watch", BEAM_WATCH),
        ("star_watch", STAR_WATCH),
        ("exclusions", EXCLUSIONS),
        ("filter", NAVIGATION_FILTERS.memory),
    ],
    align=True,
)


@kernel
def take_given(sensed, estimate):
    """Take the word of ideal instruments."""
    for i in range(4):
        estimate.q_I2B[i] = sensed.q_I2B[i]
    put3(estimate.r_I, 0, take3(sensed.r_I, 0))
    put3(estimate.v_I, 0, take3(sensed.v_I, 0))
    put3(estimate.w_B, 0, take3(sensed.w_B, 0))
    put3(estimate.specific_force_B, 0, take3(sensed.specific_force_B, 0))
    put3(estimate.imu_rate_B, 0, take3(sensed.imu_rate_B, 0))
    put3(estimate.imu_gain_B, 0, take3(sensed.imu_gain_B, 0))
    estimate.height_above_ground = sensed.height_above_ground


@kernel
def estimate_state(onboard, state, sensed, memory):
    """Bring ``memory.estimate`` up to the cycle of ``sensed``.

    Args:
        onboard: ``ONBOARD`` record.
        state: ``VEHICLE_STATE`` record: which parts are gone.
        sensed: ``SENSED`` record.
        memory: ``NAVIGATION`` record, updated.
    """
    estimate = memory.estimate
    estimate.t = sensed.t
    estimate.footpad_contact, estimate.wing_open = sensed.footpad_contact, sensed.wing_open
    if onboard.navigation.filter == GIVEN:
        take_given(sensed, estimate)
        return
    navigate(onboard, state, sensed, memory)
    if memory.solution.started != 0:
        tell(onboard.planet, memory.motion, memory.solution, estimate)
        guard(onboard, sensed, memory, estimate)


@kernel
def navigate(onboard, state, sensed, memory):
    """Bring ``memory.solution`` up to the reading of the inertial unit that arrives with ``sensed``."""
    params, motion, solution = onboard.navigation, memory.motion, memory.solution
    body = onboard.vehicle.configuration[state.configuration]
    centre = take3(body.centre, 0)
    dt = take_reading(onboard.instruments, sensed.t, sensed.inertial, memory.inertial)
    put3(motion.centre, 0, centre)
    if dt > LEAST_TIME:
        follow_centre(centre, motion, solution, memory.centre)
        read_motion(
            params, onboard.instruments, body, dt, sensed.inertial, solution=solution,
            health=memory.health, memory=memory.inertial, motion=motion,
        )  # fmt: skip
        put3(memory.estimate.imu_gain_B, 0, add(take3(memory.estimate.imu_gain_B, 0), take3(motion.gain, 0)))
    if solution.started == 0:
        if sensed.tracking.fresh != 0 and sensed.stars.valid != 0:
            align(onboard.planet, memory.inertial.t, sensed, motion, solution)
            put3(memory.centre, 0, centre)
            start_filter(params.filter, params, onboard, sensed, solution, memory=memory.filter)
    elif dt > LEAST_TIME:
        integrate(onboard.planet, motion, solution)
        lever = sub(take3(onboard.instruments.unit_position, 0), centre)
        look_back(body, lever, memory.inertial, motion, memory=memory.hindsight, solution=solution)
        recover(
            params.recovery, onboard, memory.health, sensed, motion, memory=memory.recovery, solution=solution
        )
        solution.looked = 0
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
        watch(onboard, state, sensed, memory)


@kernel
def watch(onboard, state, sensed, memory):
    """Exclude beams and star tracker where they have failed, and note what is out of use."""
    params, motion, solution = onboard.navigation, memory.motion, memory.solution
    health, instruments = memory.health, onboard.instruments
    watch_beams(params.beam_watch, instruments, sensed.radar, solution, health, memory=memory.beam_watch)
    watch_stars(
        params.star_watch,
        onboard.planet,
        instruments,
        state.requested,
        sensed.stars,
        motion=motion,
        solution=solution,
        health=health,
        memory=memory.star_watch,
    )
    note_changes(instruments, sensed.t, health, motion, memory.exclusions)


@kernel
def follow_centre(centre, motion, solution, before):
    """Let the solution be that of the new centre of mass (m, B) once a part has left; ``before``: the centre
    it is of, updated.
    """
    arm = sub(centre, take3(before, 0))
    if dot(arm, arm) == 0.0:
        return
    q = (solution.q_I2B[0], solution.q_I2B[1], solution.q_I2B[2], solution.q_I2B[3])
    put3(solution.r_I, 0, add(take3(solution.r_I, 0), from_frame(q, arm)))
    put3(solution.v_I, 0, add(take3(solution.v_I, 0), from_frame(q, cross(take3(motion.rate, 0), arm))))
    put3(before, 0, centre)


@kernel
def guard(onboard, sensed, memory, estimate):
    """Tell the height that the guards let pass, and have the vertical looked for where they find it wrong."""
    params, solution, instruments = onboard.navigation.guards, memory.solution, onboard.instruments
    r, v = take3(estimate.r_I, 0), take3(estimate.v_I, 0)
    height, climb, up = height_and_climb(onboard.planet, onboard.site, r, v, solution.terrain)
    height = guarded_height(
        params,
        height,
        climb,
        sigma=solution.sigma_height,
        contact=sensed.footpad_contact,
        dt=memory.motion.dt,
        memory=memory.guard,
    )
    spin = onboard.planet.rotation_rate
    speed = norm((v[0] + spin * r[1], v[1] - spin * r[0], v[2]))
    q = (estimate.q_I2B[0], estimate.q_I2B[1], estimate.q_I2B[2], estimate.q_I2B[3])
    check_solution(
        params, instruments, memory.health, sensed, speed, sigma=norm(take3(solution.sigma_v, 0)), q=q, up=up,
        memory=memory.guard, recovery=memory.recovery,
    )  # fmt: skip
    if memory.recovery.lost != 0:
        height = height_while_lost(instruments, memory.health, sensed.radar, memory.guard)
    estimate.height_above_ground = height
