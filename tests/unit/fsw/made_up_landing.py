"""A made-up Mars landing for navigation filters: the true course of ``made_up_course``, with instruments that
err as the flight computer believes.

The solution is integrated by the rule by which the truth was made, so that instruments alone make errors.
"""

from math import sqrt

import numpy as np
from made_up_course import DT, SITE, half_turned, pull_of
from made_up_instruments import (
    CENTRE,
    draw_unit,
    drawn_before,
    lay_ground,
    normal,
    read_radar,
    spoilt,
    star_fix,
    walk,
)

from edl6dof.fsw.navigation.filters import error_state
from edl6dof.fsw.navigation.filters.kalman.states import ERROR_STATE, STATES
from edl6dof.fsw.navigation.solution import INSTRUMENT_HEALTH, MOTION, SOLUTION
from edl6dof.fsw.navigation.strapdown import level_axes
from edl6dof.interface.sensed import SENSED
from edl6dof.kernels import kernel
from edl6dof.spatial.quaternion import (
    about_axis,
    conjugate,
    from_frame,
    multiply,
    normalise,
    rotation_vector,
)
from edl6dof.spatial.vector import add, dot, norm, put3, put4, scale, sub, take3

#: The filter as flights call it: what is compiled for them is not compiled again with what flies it here.
start, correct = error_state.start, error_state.correct


@kernel
def strapdown(onboard, motion, solution):
    """One cycle of the solution, by the rule by which the truth was made."""
    r, v, q, a = take3(solution.r_I, 0), take3(solution.v_I, 0), attitude(solution), take3(motion.angle, 0)
    gained = from_frame(half_turned(q, a), take3(motion.gain, 0))
    size = norm(a)
    if size > 0.0:
        q = multiply(q, about_axis(scale(1.0 / size, a), size))
    later = add(v, add(scale(DT, pull_of(r)), gained))
    put3(solution.r_I, 0, add(r, scale(0.5 * DT, add(v, later))))
    put3(solution.v_I, 0, later)
    put4(solution.q_I2B, normalise(q))
    solution.t += DT


@kernel
def attitude(place):
    """Attitude in a record."""
    q = place.q_I2B
    return q[0], q[1], q[2], q[3]


@kernel
def apart(planet, r, believed, t):
    """Error of a position, upwards the difference of altitude: some hundred metres to the side the planet has
    fallen away by as much as the height is known.
    """
    _, _, up, altitude = level_axes(planet, believed, t)
    error, true_altitude = sub(r, believed), level_axes(planet, r, t)[3]
    return add(error, scale(true_altitude - altitude - dot(up, error), up))


@kernel
def begin(onboard, params, records, drawn, place, size, draws):
    """The solution at the first cycle: what tracking and the star tracker say."""
    unit, solution = onboard.instruments, records[2][0]
    r, v, q = place
    for i in range(3):
        solution.r_I[i] = r[i] + size * normal(draws) * sqrt(unit.tracking_position[i, i])
        solution.v_I[i] = v[i] + size * normal(draws) * sqrt(unit.tracking_velocity[i, i])
    put4(solution.q_I2B, star_fix(unit, q, drawn[4], size, draws))
    start(params, onboard, records[0][0], solution, records[4][0])


@kernel
def read_inertial(onboard, motion, solution, drawn, biases, increments, half, draws):
    """What the inertial unit counts in a cycle, its biases walked on."""
    unit, (bg, ba), (angle, gain) = onboard.instruments, biases, increments
    walk(bg, half * unit.gyro_bias_walk, draws)
    walk(ba, half * unit.accelerometer_bias_walk, draws)
    motion.dt, noise = DT, half * unit.gyro_noise
    for i in range(3):
        motion.angle[i] = spoilt(i, angle, drawn[2], noise, bg, solution.gyro_bias, draws)
        motion.rate[i] = motion.angle[i] / DT
    noise = half * unit.accelerometer_noise
    for i in range(3):
        motion.gain[i] = spoilt(i, gain, drawn[3], noise, ba, solution.accelerometer_bias, draws)


@kernel
def report(onboard, solution, biases, place, ground, errors):
    """Error states of the solution."""
    r, v, q = place
    put3(errors, 0, apart(onboard.planet, r, take3(solution.r_I, 0), solution.t))
    put3(errors, 3, sub(v, take3(solution.v_I, 0)))
    put3(errors, 6, rotation_vector(multiply(q, conjugate(attitude(solution)))))
    for i in range(3):
        errors[9 + i] = biases[0][i, 0] - solution.gyro_bias[i]
        errors[12 + i] = biases[1][i, 0] - solution.accelerometer_bias[i]
    errors[15] = ground[0] - solution.terrain
    for i in range(2):
        errors[16 + i] = ground[1 + i] - solution.slope[i]


@kernel
def claim(solution, claims):
    """Standard deviations that it claims."""
    for i in range(3):
        claims[i], claims[3 + i] = solution.sigma_r[i], solution.sigma_v[i]
        claims[6 + i] = solution.sigma_attitude[i]
    claims[9] = solution.sigma_height


@kernel
def fly_filter(
    onboard, params, records, flown, draws, drawn, biases, ground, size, stars_until, looks, reports, told
):
    """Let the filter follow one flight.

    Args:
        onboard, params: records.
        records: (sensed, motion, solution, health, memory), arrays of one, zeros but for the health.
        flown: what ``truth`` returned.
        draws: make the errors of this flight.
        drawn: errors of the instruments.
        biases: of gyros and accelerometers, that walk.
        ground: height of the ground in each cycle, and its rise towards north and east.
        size: factor of all errors.
        stars_until: time of the last star fix, s.
        looks: state of each beam in each cycle (see ``read_radar``).
        reports: cycles at which the errors are told.
        told: arrays, written: error states and covariances at the reports, innovations of ranges and speeds
            over their standard deviations and the beams used at each cycle, the claimed standard deviations
            of height and velocity.
    """
    rs, vs, qs, angles, gains, heights = flown
    sensed, motion, solution = records[0][0], records[1][0], records[2][0]
    health, memory = records[3][0], records[4][0]
    unit, half = onboard.instruments, size * np.sqrt(0.5)
    errors, covariances, innovations, used, claims = told
    at, wide = 0, memory.covariance.shape[1]
    put3(motion.centre, 0, CENTRE)
    motion.rate_known, motion.force_known = 1, 1
    for k in range(len(rs)):
        q = (qs[k, 0], qs[k, 1], qs[k, 2], qs[k, 3])
        place = (take3(rs[k], 0), take3(vs[k], 0), q)
        motion.fixes = k * DT <= stars_until
        if motion.fixes:
            put4(motion.fix_q_I2B, star_fix(unit, q, drawn[4], size, draws))
        if k == 0:
            begin(onboard, params, records, drawn, place, size, draws)
        else:
            turned = take3(angles[k], 0)
            read_inertial(onboard, motion, solution, drawn, biases, (turned, take3(gains[k], 0)), half, draws)
            strapdown(onboard, motion, solution)
            sensed.t = k * DT
            read_radar(
                *(onboard, params.relief, sensed.t, place[0], place[1], q),
                *(scale(1.0 / DT, turned), ground[k], drawn, looks[k], size, sensed.radar, draws),
            )
            solution.beams_used = 0
            correct(params, onboard, health, sensed, motion, solution, memory)
            if memory.radar_t == sensed.t:
                used[k] = solution.beams_used
                for b in range(unit.n_beams):
                    innovations[k, 0, b] = solution.range_innovation[b]
                    innovations[k, 1, b] = solution.speed_innovation[b]
        if at < len(reports) and k == reports[at]:
            report(onboard, solution, biases, place, ground[k], errors[at])
            claim(solution, claims[at])
            for i in range(STATES):
                for j in range(wide):
                    covariances[at, i, j] = memory.covariance[i, j]
            at += 1


def records():
    """Records of one flight, every instrument trusted."""
    made = tuple(np.zeros(1, dtype) for dtype in (SENSED, MOTION, SOLUTION, INSTRUMENT_HEALTH, ERROR_STATE))
    for name in INSTRUMENT_HEALTH.names:
        made[3][name] = 1
    return made


def fly(onboard, params, flown, reports, seed=1, size=1.0, stars_until=-1.0, looks=None):
    """What is told of one flight of the filter (see ``fly_filter``); the believed altitude of the site is set
    so that the landing is on ground.
    """
    steps, count, made = len(flown[0]), len(reports), records()
    if looks is None:
        looks = np.zeros((steps, 8), np.int64)
    draws = drawn_before(np.random.default_rng(seed), steps)
    drawn = draw_unit(onboard[0]["instruments"], size, draws)
    ground = lay_ground(params[0], flown[0], flown[1], flown[5], size, draws)
    onboard[0]["site"]["altitude"] = SITE - ground[-1, 0]
    told = (
        *(np.zeros((count, STATES)), np.zeros((count, *ERROR_STATE["covariance"].shape))),
        *(np.zeros((steps, 2, onboard[0]["instruments"]["n_beams"])), np.zeros(steps, np.int64)),
        np.zeros((count, 10)),
    )
    biases = drawn[0].copy(), drawn[1].copy()
    fly_filter(
        *(onboard[0], params[0], made, flown, draws, drawn, biases, ground, size, stars_until, looks),
        *(np.array(reports, np.int64), told),
    )
    return told


def stepped(onboard, flown, first, cycles, begin, records, looks=None):
    """Let a solution follow a piece of a flight without its filter, which the caller runs: ``begin(sensed,
    solution)`` at the start, and what it likes with the records after each cycle; yields the cycle.
    """
    rng = np.random.default_rng(3)
    rs, vs, qs, angles, gains, _ = flown
    sensed, motion, solution, _ = (record[0] for record in records[:4])
    solution["t"] = first * DT
    solution["r_I"] = rs[first] + rng.normal(0.0, 300.0, 3)
    solution["v_I"] = vs[first] + rng.normal(0.0, 0.5, 3)
    solution["q_I2B"], solution["terrain"] = qs[first], 20.0
    motion["centre"], motion["rate_known"], motion["force_known"] = CENTRE, 1, 1
    begin(sensed, solution)
    draws = drawn_before(rng, cycles)
    drawn = draw_unit(onboard[0]["instruments"], 1.0, draws)
    every = np.zeros((len(rs), 8), np.int64) if looks is None else looks
    for k in range(first + 1, first + cycles):
        motion["dt"] = DT
        motion["angle"], motion["gain"] = angles[k] + 1e-7, gains[k] + 1e-4
        motion["rate"] = motion["angle"] / DT
        strapdown(onboard[0], motion, solution)
        sensed["t"] = k * DT
        read_radar(
            *(onboard[0], 0.0, sensed["t"], tuple(rs[k]), tuple(vs[k]), tuple(qs[k])),
            *(tuple(angles[k] / DT), np.zeros(3), drawn, every[k], 1.0, sensed["radar"], draws),
        )
        yield k
