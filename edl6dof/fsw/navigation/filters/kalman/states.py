"""State vector, considered errors and memory of the error-state filter.

The error is truth less solution: truth = solution + error, and for the attitude C_true = (1 + [psi x]) C with
C from B to I, psi in I. The covariance is one array of the states against the states and the considered
errors: constants of the instruments, which all readings share; the filter allows for them but does not
estimate them.

Source: S. F. Schmidt, "Application of state-space methods to navigation problems", Advances in Control
Systems 3 (1966); Farrell, Aided Navigation (2008), chapter 11.
"""

from __future__ import annotations

from edl6dof.interface.capacities import MAX_ACCELEROMETERS, MAX_BEAMS, MAX_GYROS
from edl6dof.records import COUNT, FLAG, record, whole

#: First place of each part of the error state: m, m/s, rad (all I), rad/s, m/s2 (B), m, and the rise of the
#: ground per metre towards north and east.
POSITION, VELOCITY, ATTITUDE_ERROR, GYRO_BIAS, ACCELEROMETER_BIAS, TERRAIN, SLOPE = 0, 3, 6, 9, 12, 15, 16
STATES = 18
#: First place of the considered errors.  Scale and misalignment: what a rate of one about each axis of B in
#: turn adds to the measured one, B; the same for the specific force.  Bias of the star tracker (rad, B).
#: Scale of the range of each beam, and of its speed; bias of its range (m).
GYRO_SCALE, ACCELEROMETER_SCALE = STATES, STATES + 9
STAR_BIAS, RANGE_SCALE = STATES + 18, STATES + 21
SPEED_SCALE, RANGE_BIAS = RANGE_SCALE + MAX_BEAMS, RANGE_SCALE + 2 * MAX_BEAMS
WIDTH = RANGE_BIAS + MAX_BEAMS
#: Number of states that change within an interval, and of errors that may act on them: the first of each.
MOVING, ACTING = 9, STAR_BIAS

#: Integrals since the last propagation of the covariance.
INTERVAL = record(
    ("dt", "f8"),  # s
    ("gain", "f8", (3,)),  # m/s, I: integral of the specific force
    ("path", "f8", (3,)),  # m, I: integral of that
    ("frame", "f8", (3, 3)),  # s: integral of the matrix from B to I
    # of that matrix times the rate about each axis of B in turn (rad), and times the force (m/s)
    ("turned", "f8", (3, 3, 3)),
    ("pushed", "f8", (3, 3, 3)),
    ("unknown_turn", "f8"),  # rad2: variance about each axis of a rotation that no gyro measured
    ("unknown_gain", "f8"),  # m2/s2: variance of a velocity gain that no accelerometer measured
)

ERROR_STATE = record(
    ("covariance", "f8", (STATES, WIDTH)),
    ("considered", "f8", (WIDTH,)),  # variances, from place STATES on
    ("correction", "f8", (STATES,)),  # estimated error, not yet taken out of the solution
    ("interval", INTERVAL),
    # inverse of H'H of the instruments in use, B: variance of three axes over that of one instrument
    ("gyro_spread", "f8", (3, 3)),
    ("accelerometer_spread", "f8", (3, 3)),
    ("gyros_in_use", whole(0, 2**MAX_GYROS - 1)),  # a bit for each
    ("accelerometers_in_use", whole(0, 2**MAX_ACCELEROMETERS - 1)),
    ("unknown_rate_time", "f8"),  # s: how long the rate has not been known
    ("unknown_force_time", "f8"),  # s
    ("stars_t", "f8"),  # s: flight time of the last star fix used
    ("radar_t", "f8"),  # s: and of the last look at the radar
    # looks in a row in which most ranges, most speeds, or the star fix were refused
    ("ranges_refused", COUNT),
    ("plane_seen", FLAG),  # whether three ranges have agreed
    ("speeds_refused", COUNT),
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
