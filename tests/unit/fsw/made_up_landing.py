"""A made-up Mars landing for navigation filters: the true course of ``made_up_course``, with instruments that
err as the flight computer believes.

The solution is integrated by the rule by which the truth was made, so that instruments alone make errors.
"""

import numpy as np
from made_up_course import DT, MU, RADIUS, SITE, SPIN

from edl6dof.dispatch import NOTHING, on_its_own
from edl6dof.fsw.navigation.filters import error_state
from edl6dof.fsw.navigation.filters.kalman.antenna import level_axes
from edl6dof.fsw.navigation.filters.kalman.states import ERROR_STATE, STATES
from edl6dof.fsw.navigation.solution import INSTRUMENT_HEALTH, MOTION, SOLUTION
from edl6dof.interface.sensed import SENSED
from edl6dof.jit import kernel
from edl6dof.spatial.quaternion import (
    about_axis,
    conjugate,
    from_frame,
    multiply,
    normalise,
    rotation_vector,
)
from edl6dof.spatial.vector import cross, sub, take3

ARM, CENTRE = (0.3, 0.6, -0.2), (-0.9, 0.02, 0.01)

#: The filter as flights call it: what is compiled for them is not compiled again with what flies it here.
start, correct = (on_its_own(NOTHING)(one) for one in (error_state.start, error_state.correct))


@kernel
def true_range(u, up, height):
    """Range along ``u`` to a sphere of the planet's radius."""
    c = -(u[0] * up[0] + u[1] * up[1] + u[2] * up[2])
    far = RADIUS + height
    return far * c - np.sqrt(RADIUS**2 - far**2 * (1.0 - c * c))


@kernel
def strapdown(onboard, motion, solution):
    """One cycle of the solution, by the rule by which the truth was made."""
    r, v = solution.r_I.copy(), solution.v_I.copy()
    q = (solution.q_I2B[0], solution.q_I2B[1], solution.q_I2B[2], solution.q_I2B[3])
    a = motion.angle
    half = normalise(multiply(q, (1.0, 0.25 * a[0], 0.25 * a[1], 0.25 * a[2])))
    gained = from_frame(half, (motion.gain[0], motion.gain[1], motion.gain[2]))
    size = np.sqrt(np.sum(a * a))
    if size > 0.0:
        q = multiply(q, about_axis((a[0] / size, a[1] / size, a[2] / size), size))
    g = -MU / np.sum(r * r) ** 1.5 * r
    later = v + DT * g + np.array(gained)
    solution.r_I[:] = r + 0.5 * DT * (v + later)
    solution.v_I[:] = later
    solution.q_I2B[:] = np.array(normalise(q))
    solution.t += DT


@kernel
def draw_unit(unit, size, rng):
    """Errors of the instruments of one flight: biases (B) and matrices of scale and misalignment of gyros and
    accelerometers, bias of the star tracker, scales and biases of the radar.  ``size``: factor of all.
    """
    half = size * np.sqrt(0.5)  # six instruments on a cone: H'H = 2
    return (
        half * unit.gyro_bias * rng.standard_normal(3),
        half * unit.accelerometer_bias * rng.standard_normal(3),
        half * unit.gyro_scale * rng.standard_normal((3, 3)),
        half * unit.accelerometer_scale * rng.standard_normal((3, 3)),
        size * unit.star_bias * rng.standard_normal(3),
        size * unit.range_scale * rng.standard_normal(unit.n_beams),
        size * unit.speed_scale * rng.standard_normal(unit.n_beams),
        size * unit.range_bias * rng.standard_normal(unit.n_beams),
    )


@kernel
def walk(bias, size, rng):
    """A cycle of the random walk of a bias."""
    for i in range(3):
        bias[i] += size * np.sqrt(DT) * rng.standard_normal()


@kernel
def spoil(increment, scale, noise, bias, believed, rng):
    """Make of a true increment over a cycle the one that is counted and corrected by the believed bias."""
    x, y, z = increment[0], increment[1], increment[2]
    for i in range(3):
        increment[i] += scale[i, 0] * x + scale[i, 1] * y + scale[i, 2] * z
        increment[i] += noise * np.sqrt(DT) * rng.standard_normal() + DT * (bias[i] - believed[i])


@kernel
def star_fix(unit, q, bias, size, rng):
    """What the star tracker says of the attitude ``q``."""
    noise = size * unit.star_sigma * rng.standard_normal(3)
    turned = from_frame(q, (bias[0], bias[1], bias[2]))
    e = 0.5 * (noise + np.array(turned))
    return normalise(multiply((1.0, e[0], e[1], e[2]), q))


@kernel
def read_radar(onboard, change, t, r, v, q, rate, terrain, drawn, looks, size, radar, rng):
    """Fill ``radar``; ``looks``: state of each beam (0 sound, 1 lost, 2 locked on something 60 m away)."""
    unit, planet = onboard.instruments, onboard.planet
    arm = sub(ARM, CENTRE)
    place = r + np.array(from_frame(q, arm))
    swing = np.array(from_frame(q, cross(take3(rate, 0), arm)))
    _, _, up, altitude = level_axes(planet, (place[0], place[1], place[2]), t)
    height = altitude - onboard.site.altitude - terrain
    velocity = v + swing - np.array([-SPIN * place[1], SPIN * place[0], 0.0])
    radar.fresh = 5.0 < height < 7500.0
    for b in range(unit.n_beams):
        axis = unit.beam_axis[b]
        u = np.array(from_frame(q, (axis[0], axis[1], axis[2])))
        slope = -(u[0] * up[0] + u[1] * up[1] + u[2] * up[2])
        reach, speed = true_range(u, up, height), np.sum(u * velocity)
        ground = change * np.sqrt(reach * np.sqrt(1.0 - slope**2) / 1000.0)
        noise = size * (unit.range_sigma + unit.range_sigma_relative * reach) * rng.standard_normal()
        noise += size * ground / slope * rng.standard_normal()
        radar.range[b] = reach * (1.0 + drawn[5][b]) + drawn[7][b] + noise
        noise = unit.speed_sigma + unit.speed_sigma_relative * abs(speed)
        radar.speed[b] = speed * (1.0 + drawn[6][b]) + size * noise * rng.standard_normal()
        radar.locked[b] = looks[b] != 1
        if looks[b] == 2:
            radar.range[b], radar.speed[b] = 60.0, 12.0


@kernel
def lay_ground(params, rs, vs, size, rng):
    """Height of the ground below each cycle above what is believed of the site."""
    ground = np.zeros(len(rs))
    ground[0] = size * params.terrain_sigma * rng.standard_normal()
    for k in range(1, len(rs)):
        moved = vs[k] - np.array([-SPIN * rs[k, 1], SPIN * rs[k, 0], 0.0])
        up = rs[k] / np.sqrt(np.sum(rs[k] ** 2))
        along = np.sqrt(max(np.sum(moved**2) - np.sum(moved * up) ** 2, 0.0))
        change = params.terrain_change * np.sqrt(along * DT / 1000.0)
        ground[k] = ground[k - 1] + size * change * rng.standard_normal()
    return ground


@kernel
def apart(planet, r, believed, t):
    """Error of a position, upwards the difference of altitude: some hundred metres to the side the planet has
    fallen away by as much as the height is known.
    """
    _, _, up, altitude = level_axes(planet, (believed[0], believed[1], believed[2]), t)
    true_altitude = level_axes(planet, (r[0], r[1], r[2]), t)[3]
    error, axis = r - believed, np.array(up)
    return error + (true_altitude - altitude - np.sum(axis * error)) * axis


@kernel
def fly_filter(onboard, params, records, flown, rng, size, stars_until, looks, reports):
    """Let the filter follow one flight.

    Args:
        onboard, params: records; the believed altitude of the site is set so that the landing is on ground.
        records: (sensed, motion, solution, health, memory), arrays of one, zeros but for the health.
        flown: what ``truth`` returned.
        rng: makes the errors of this flight.
        size: factor of all errors.
        stars_until: time of the last star fix, s.
        looks: state of each beam in each cycle (see ``read_radar``).
        reports: cycles at which the errors are told.

    Returns error states and covariances at the reports, innovations of ranges and speeds over their standard
    deviations and the beams used at each cycle, the claimed standard deviations of height and velocity.
    """
    rs, vs, qs, angles, gains, heights = flown
    sensed, motion, solution = records[0][0], records[1][0], records[2][0]
    health, memory = records[3][0], records[4][0]
    unit, half = onboard.instruments, size * np.sqrt(0.5)
    drawn = draw_unit(unit, size, rng)
    bg, ba = drawn[0].copy(), drawn[1].copy()
    ground = lay_ground(params, rs, vs, size, rng)
    onboard.site.altitude = SITE - ground[-1]
    told, count = 0, len(reports)
    errors, covariances = np.zeros((count, STATES)), np.zeros((count, STATES, memory.covariance.shape[1]))
    claims = np.zeros((count, 10))
    steps = len(rs)
    innovations, used = np.zeros((steps, 2, unit.n_beams)), np.zeros(steps, np.int64)
    motion.centre[:] = np.array(CENTRE)
    motion.rate_known, motion.force_known = 1, 1
    for k in range(steps):
        q = (qs[k, 0], qs[k, 1], qs[k, 2], qs[k, 3])
        sensed.stars.valid = k * DT <= stars_until
        if sensed.stars.valid:
            sensed.stars.q_I2B[:] = np.array(star_fix(unit, q, drawn[4], size, rng))
        if k == 0:
            for i in range(3):
                wide = size * rng.standard_normal()
                solution.r_I[i] = rs[0, i] + wide * unit.tracking_position_sigma[i]
                wide = size * rng.standard_normal()
                solution.v_I[i] = vs[0, i] + wide * unit.tracking_velocity_sigma[i]
            solution.q_I2B[:] = np.array(star_fix(unit, q, drawn[4], size, rng))
            start(params, onboard, sensed, solution, memory)
        else:
            walk(bg, half * unit.gyro_bias_walk, rng)
            walk(ba, half * unit.accelerometer_bias_walk, rng)
            angle, gain = angles[k].copy(), gains[k].copy()
            spoil(angle, drawn[2], half * unit.gyro_noise, bg, solution.gyro_bias, rng)
            spoil(gain, drawn[3], half * unit.accelerometer_noise, ba, solution.accelerometer_bias, rng)
            motion.dt = DT
            for i in range(3):
                motion.angle[i], motion.gain[i], motion.rate[i] = angle[i], gain[i], angle[i] / DT
            strapdown(onboard, motion, solution)
            sensed.t = k * DT
            read_radar(
                *(onboard, params.terrain_change, sensed.t, rs[k], vs[k], q, angles[k] / DT, ground[k]),
                *(drawn, looks[k], size, sensed.radar, rng),
            )
            solution.beams_used = 0
            correct(params, onboard, health, sensed, motion, solution, memory)
            if memory.radar_t == sensed.t:
                used[k] = solution.beams_used
                for b in range(unit.n_beams):
                    innovations[k, 0, b] = solution.range_innovation[b]
                    innovations[k, 1, b] = solution.speed_innovation[b]
        if told < count and k == reports[told]:
            p = solution.q_I2B
            turn = rotation_vector(multiply(q, conjugate((p[0], p[1], p[2], p[3]))))
            errors[told, 0:3] = apart(onboard.planet, rs[k], solution.r_I, solution.t)
            errors[told, 3:6] = vs[k] - solution.v_I
            errors[told, 6:9] = np.array(turn)
            errors[told, 9:12], errors[told, 12:15] = (
                bg - solution.gyro_bias,
                ba - solution.accelerometer_bias,
            )
            errors[told, 15] = ground[k] - solution.terrain
            covariances[told] = memory.covariance
            claims[told, 0:3], claims[told, 3:6] = solution.sigma_r, solution.sigma_v
            claims[told, 6:9], claims[told, 9] = solution.sigma_attitude, solution.sigma_height
            told += 1
    return errors, covariances, innovations, used, claims


def records():
    """Records of one flight, every instrument trusted."""
    made = tuple(np.zeros(1, dtype) for dtype in (SENSED, MOTION, SOLUTION, INSTRUMENT_HEALTH, ERROR_STATE))
    for name in INSTRUMENT_HEALTH.names:
        made[3][name] = 1
    return made


def fly(onboard, params, flown, reports, seed=1, size=1.0, stars_until=-1.0, looks=None):
    """One flight of the filter (see ``fly_filter``)."""
    if looks is None:
        looks = np.zeros((len(flown[0]), 8), np.int64)
    return fly_filter(
        *(onboard[0], params[0], records(), flown, np.random.default_rng(seed), size, stars_until, looks),
        np.array(reports, np.int64),
    )


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
    drawn = draw_unit(onboard[0]["instruments"], 1.0, rng)
    every = np.zeros((len(rs), 8), np.int64) if looks is None else looks
    for k in range(first + 1, first + cycles):
        motion["dt"] = DT
        motion["angle"], motion["gain"] = angles[k] + 1e-7, gains[k] + 1e-4
        motion["rate"] = motion["angle"] / DT
        strapdown(onboard[0], motion, solution)
        sensed["t"] = k * DT
        read_radar(
            *(onboard[0], 0.0, sensed["t"], rs[k], vs[k], tuple(qs[k]), angles[k] / DT, 0.0),
            *(drawn, every[k], 1.0, sensed["radar"], rng),
        )
        yield k
