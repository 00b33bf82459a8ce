"""The start of the navigation solution: position and velocity from ground tracking, attitude from the star
tracker, in the cycle in which both have arrived.
"""

from __future__ import annotations

from edl6dof.fsw.navigation.strapdown import gravity_I, turn_by
from edl6dof.kernels import kernel
from edl6dof.spatial.vector import put3, scale, sub, take3


@kernel
def align(planet, t, sensed, motion, solution):
    """Start ``solution`` (``SOLUTION``) at ``t``, the time of the last reading of the inertial unit: the
    state tracked is that of ``sensed.t``, and is brought back in free fall.
    """
    r, v, age = take3(sensed.tracking.r_I, 0), take3(sensed.tracking.v_I, 0), sensed.t - t
    fall = scale(age, gravity_I(planet, r))
    put3(solution.r_I, 0, sub(r, scale(age, sub(v, scale(0.5, fall)))))
    put3(solution.v_I, 0, sub(v, fall))
    solution.t, solution.started = t, 1
    adopt_attitude(sensed, motion, solution)


@kernel
def adopt_attitude(sensed, motion, solution):
    """Take the attitude that the star tracker says, turned back to the time of the solution."""
    stars = sensed.stars.q_I2B
    back = scale(solution.t - sensed.t, take3(motion.rate, 0))
    q = turn_by((stars[0], stars[1], stars[2], stars[3]), back)
    for i in range(4):
        solution.q_I2B[i] = q[i]
