"""State vector, considered errors and memory of the error-state filter, and propagation between updates.

The error is truth less solution: truth = solution + error, and for the attitude C_true = (1 + [psi x]) C with
C from B to I, psi in I. The covariance is one array of the states against the states and the considered
errors: constants of the instruments, which all readings share; the filter allows for them but does not
estimate them.

The propagation includes the gravity gradient, the specific force rotated by the attitude error, and biases,
scale factors and misalignments of the instruments. Specific force and attitude enter only through their
integrals over an interval, which are summed in every base cycle, so that the covariance may be propagated at
a low rate.

Source: S. F. Schmidt, "Application of state-space methods to navigation problems", Advances in Control
Systems 3 (1966); Farrell, Aided Navigation (2008), chapter 11; propagation: Titterton and Weston, Strapdown
Inertial Navigation Technology (2004), 12.3.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.interface.capacities import MAX_ACCELEROMETERS, MAX_BEAMS, MAX_GYROS
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, FLAG, record, whole
from edl6dof.spatial.quaternion import axes, from_frame
from edl6dof.spatial.vector import add, cross, dot, put3, scale, take3, take4

#: First index of each part of the error state: m, m/s, rad (all I), rad/s, m/s2 (B), m, and the rise of the
#: ground per metre towards north and east.
POSITION, VELOCITY, ATTITUDE_ERROR, GYRO_BIAS, ACCELEROMETER_BIAS, TERRAIN, SLOPE = 0, 3, 6, 9, 12, 15, 16
STATES = 18
#: First index of the considered errors.  Scale and misalignment of gyros: error of the measured rate (B) for
#: a unit rate about each axis of B in turn; of accelerometers: for a unit specific force.  Bias of the star
#: tracker (rad, B). Scale of the range of each beam, and of its speed; bias of its range (m). Displacement of
#: the map of landmarks (m, I).
GYRO_SCALE, ACCELEROMETER_SCALE = STATES, STATES + 9
STAR_BIAS, RANGE_SCALE = STATES + 18, STATES + 21
SPEED_SCALE, RANGE_BIAS = RANGE_SCALE + MAX_BEAMS, RANGE_SCALE + 2 * MAX_BEAMS
MAP_OFFSET = RANGE_BIAS + MAX_BEAMS
WIDTH = MAP_OFFSET + 3
#: Number of states that change within an interval, and of errors that act on them; both are the first
#: indices.
MOVING, ACTING = 9, STAR_BIAS

#: Integrals since the last propagation of the covariance.
INTERVAL = record(
    ("dt", "f8"),  # s
    ("gain", "f8", (3,)),  # m/s, I: integral of the specific force
    ("path", "f8", (3,)),  # m, I: integral of gain
    ("frame", "f8", (3, 3)),  # s: integral of the matrix from B to I
    # integrals of this matrix times rate (rad), and times force (m/s), about each axis of B in turn
    ("turned", "f8", (3, 3, 3)),
    ("pushed", "f8", (3, 3, 3)),
    ("unknown_turn", "f8"),  # rad2: variance about each axis of a rotation that no gyro measured
    ("unknown_gain", "f8"),  # m2/s2: variance of a velocity gain that no accelerometer measured
)

ERROR_STATE = record(
    ("covariance", "f8", (STATES, WIDTH)),
    ("considered", "f8", (WIDTH,)),  # variances, from index STATES on
    ("correction", "f8", (STATES,)),  # estimated error, not yet added to the solution
    ("interval", INTERVAL),
    # inverse of H'H of the instruments in use, B: variance of three axes over that of one instrument
    ("gyro_spread", "f8", (3, 3)),
    ("accelerometer_spread", "f8", (3, 3)),
    ("gyros_in_use", whole(0, 2**MAX_GYROS - 1)),  # a bit for each
    ("accelerometers_in_use", whole(0, 2**MAX_ACCELEROMETERS - 1)),
    ("unknown_rate_time", "f8"),  # s: for how long the rate has been unknown
    ("unknown_force_time", "f8"),  # s: for how long the force has been unknown
    ("stars_t", "f8"),  # s: flight time of the last star fix used
    ("radar_t", "f8"),  # s: flight time of the last use of the radar
    # looks in a row in which most ranges, most speeds, or the star fix were refused
    ("ranges_refused", COUNT),
    ("plane_seen", FLAG),  # whether three ranges have agreed
    ("speeds_refused", COUNT),
    ("doubted", "f8"),  # factor on the noise of the last look, as a reading is wrong but not identified
    ("fixes_refused", COUNT),
    # workspace
    ("transition", "f8", (MOVING, ACTING)),
    ("moved", "f8", (MOVING, WIDTH)),
    ("row", "f8", (WIDTH,)),
    ("rows", "f8", (MAX_BEAMS, WIDTH)),
    ("innovation", "f8", (MAX_BEAMS,)),
    ("noise", "f8", (MAX_BEAMS,)),
    ("rest", "f8", (MAX_BEAMS,)),
    ("spread", "f8", (MAX_BEAMS, MAX_BEAMS)),
    ("product", "f8", (WIDTH,)),
    ("gain", "f8", (STATES,)),
)


@kernel
def accumulate(params, motion, solution, memory):
    """Add the cycle of ``motion`` to the integrals of ``memory.interval``."""
    interval, dt = memory.interval, motion.dt
    q = take4(solution.q_I2B)
    gained, before = from_frame(q, take3(motion.gain, 0)), take3(interval.gain, 0)
    put3(interval.path, 0, add(take3(interval.path, 0), scale(dt, add(before, scale(0.5, gained)))))
    put3(interval.gain, 0, add(before, gained))
    frame = axes(q)
    for j in range(3):
        for i in range(3):
            interval.frame[i, j] += dt * frame[j][i]
            for k in range(3):
                interval.turned[k, i, j] += motion.angle[k] * frame[j][i]
                interval.pushed[k, i, j] += motion.gain[k] * frame[j][i]
    interval.dt += dt
    # an error that lasts: its variance grows with the square of the time
    memory.unknown_rate_time = 0.0 if motion.rate_known != 0 else memory.unknown_rate_time + dt
    interval.unknown_turn += params.unknown_rate**2 * 2.0 * memory.unknown_rate_time * dt
    interval.unknown_turn += solution.new_attitude_variance
    solution.new_attitude_variance = 0.0
    memory.unknown_force_time = 0.0 if motion.force_known != 0 else memory.unknown_force_time + dt
    interval.unknown_gain += params.unknown_force**2 * 2.0 * memory.unknown_force_time * dt


@kernel
def begin_interval(interval):
    """Set the integrals to zero."""
    interval.dt, interval.unknown_turn, interval.unknown_gain = 0.0, 0.0, 0.0
    for i in range(3):
        interval.gain[i] = 0.0
        interval.path[i] = 0.0
        for j in range(3):
            interval.frame[i, j] = 0.0
            for k in range(3):
                interval.turned[k, i, j] = 0.0
                interval.pushed[k, i, j] = 0.0


@kernel
def _turned(transition, to, of, v, factor):
    """Write factor [v x] into the block at row ``to`` and column ``of``."""
    x, y, z = factor * v[0], factor * v[1], factor * v[2]
    transition[to, of + 1], transition[to, of + 2] = -z, y
    transition[to + 1, of], transition[to + 1, of + 2] = z, -x
    transition[to + 2, of], transition[to + 2, of + 1] = -y, x


@kernel
def fill_transition(mu, r_I, interval, transition):
    """Write the rows of the changing states of the transition matrix of an ``interval``, to second order in
    its length; products of attitude and force use their means over it.
    """
    dt, gain, path, frame = interval.dt, take3(interval.gain, 0), take3(interval.path, 0), interval.frame
    for i in range(MOVING):
        for j in range(ACTING):
            transition[i, j] = 0.0
    square = dot(r_I, r_I)
    rate2 = mu / (square * sqrt(square))
    for i in range(3):
        for j in range(3):
            gradient = rate2 * (3.0 * r_I[i] * r_I[j] / square - (1.0 if i == j else 0.0))
            transition[POSITION + i, POSITION + j] = 0.5 * dt * dt * gradient
            transition[VELOCITY + i, POSITION + j] = dt * gradient
            transition[VELOCITY + i, VELOCITY + j] = 0.5 * dt * dt * gradient
        transition[POSITION + i, VELOCITY + i] = dt
        transition[POSITION + i, POSITION + i] += 1.0
        transition[VELOCITY + i, VELOCITY + i] += 1.0
        transition[ATTITUDE_ERROR + i, ATTITUDE_ERROR + i] = 1.0
    _turned(transition, POSITION, ATTITUDE_ERROR, path, -1.0)
    _turned(transition, VELOCITY, ATTITUDE_ERROR, gain, -1.0)
    _act_on_attitude(frame, gain, path, GYRO_BIAS, transition)
    _act_on_velocity(frame, dt, ACCELEROMETER_BIAS, transition)
    for k in range(3):
        _act_on_attitude(interval.turned[k], gain, path, GYRO_SCALE + 3 * k, transition)
        _act_on_velocity(interval.pushed[k], dt, ACCELEROMETER_SCALE + 3 * k, transition)


@kernel
def _act_on_attitude(turned, gain, path, of, transition):
    """Write the effect of the attitude error minus ``turned`` times the three errors from index ``of``."""
    for j in range(3):
        column = (turned[0, j], turned[1, j], turned[2, j])
        _put_column(transition, ATTITUDE_ERROR, of + j, scale(-1.0, column))
        _put_column(transition, VELOCITY, of + j, scale(0.5, cross(gain, column)))
        _put_column(transition, POSITION, of + j, scale(1.0 / 3.0, cross(path, column)))


@kernel
def _act_on_velocity(pushed, dt, of, transition):
    """Write the effect of the velocity error minus ``pushed`` times the three errors from index ``of``."""
    for i in range(3):
        for j in range(3):
            transition[VELOCITY + i, of + j] = -pushed[i, j]
            transition[POSITION + i, of + j] = -0.5 * dt * pushed[i, j]


@kernel
def _put_column(a, row, column, v):
    """Write a vector into a column of a matrix."""
    a[row, column], a[row + 1, column], a[row + 2, column] = v


@kernel
def move_covariance(transition, considered, moved, covariance):
    """Propagate the covariance P to F P F', which changes only the rows and columns of the changing
    states.
    """
    for i in range(MOVING):
        for k in range(WIDTH):
            moved[i, k] = 0.0
        for j in range(STATES):
            factor = transition[i, j]
            if factor != 0.0:
                for k in range(WIDTH):
                    moved[i, k] += factor * covariance[j, k]
        for j in range(STATES, ACTING):
            factor = transition[i, j]
            for k in range(STATES):
                moved[i, k] += factor * covariance[k, j]
            moved[i, j] += factor * considered[j]
    for i in range(MOVING):
        for k in range(MOVING, WIDTH):
            covariance[i, k] = moved[i, k]
        for k in range(MOVING, STATES):
            covariance[k, i] = moved[i, k]
        for k in range(i + 1):
            value = 0.0
            for j in range(ACTING):
                value += moved[i, j] * transition[k, j]
            covariance[i, k] = value
            covariance[k, i] = value


@kernel
def follow_slope(north, east, solution, covariance):
    """Move the reference point of the ground height by ``north`` and ``east`` (m): correct height and
    covariance by the slope.
    """
    solution.terrain += solution.slope[0] * north + solution.slope[1] * east
    for j in range(WIDTH):
        covariance[TERRAIN, j] += north * covariance[SLOPE, j] + east * covariance[SLOPE + 1, j]
    for j in range(STATES):
        if j != TERRAIN:
            covariance[j, TERRAIN] = covariance[TERRAIN, j]
    covariance[TERRAIN, TERRAIN] += north * covariance[TERRAIN, SLOPE] + east * covariance[TERRAIN, SLOPE + 1]
