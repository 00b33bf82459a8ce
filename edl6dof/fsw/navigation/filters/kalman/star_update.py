"""Star tracker update of the filter: the rotation from the attitude of the solution to the measured one,
three scalars.

Source: Markley and Crassidis, Fundamentals of Spacecraft Attitude Determination and Control (2014), 6.2.
"""

from __future__ import annotations

from edl6dof.fsw.navigation.filters.kalman.measurement_update import clear_row, update_by_reading
from edl6dof.fsw.navigation.filters.kalman.outlier_test import refused_again
from edl6dof.fsw.navigation.filters.kalman.states import ATTITUDE_ERROR, STAR_BIAS
from edl6dof.fsw.navigation.strapdown import attitude_at
from edl6dof.kernels import kernel
from edl6dof.spatial.quaternion import axes, conjugate, multiply, rotation_vector
from edl6dof.spatial.vector import dot, take3, unit


@kernel
def update_by_stars(params, onboard, sensed, motion, solution, memory):
    """Update covariance and correction with a valid star fix."""
    q, measured = attitude_at(solution, motion, sensed.t), sensed.stars.q_I2B
    fix = (measured[0], measured[1], measured[2], measured[3])
    turn = rotation_vector(multiply(fix, conjugate(q)))
    x, y, z = axes(q)
    row, refused = memory.row, 0
    up = unit(take3(solution.r_I, 0))
    for i in range(3):
        clear_row(row)
        row[ATTITUDE_ERROR + i] = 1.0
        row[STAR_BIAS], row[STAR_BIAS + 1], row[STAR_BIAS + 2] = x[i], y[i], z[i]
        _, taken = update_by_reading(
            params,
            noise=onboard.instruments.star_sigma**2,
            innovation=turn[i],
            up=up,
            trusted=True,
            row=row,
            memory=memory,
        )
        refused += not taken
    memory.fixes_refused = refused_again(memory.fixes_refused, refused, 1)
    if memory.fixes_refused >= params.patience:
        for i in range(3):
            memory.covariance[ATTITUDE_ERROR + i, ATTITUDE_ERROR + i] += dot(turn, turn)
        memory.fixes_refused = 0
    memory.stars_t = sensed.t
