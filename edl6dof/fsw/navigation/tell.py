"""What navigation tells the rest of the flight software: the solution, brought forward from the time of the
last reading to the cycle with the latest rate and specific force.
"""

from __future__ import annotations

from edl6dof.fsw.navigation.strapdown import gravity_I, turn_by
from edl6dof.kernels import kernel
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import add, put3, scale, take3


@kernel
def tell(planet, motion, solution, estimate):
    """Fill ``estimate`` (``ESTIMATE``), of which the time is set, from ``motion`` and ``solution``, but for
    the height.
    """
    age = estimate.t - solution.t
    q = (solution.q_I2B[0], solution.q_I2B[1], solution.q_I2B[2], solution.q_I2B[3])
    r, v = take3(solution.r_I, 0), take3(solution.v_I, 0)
    rate = take3(motion.rate, 0)
    force = scale(1.0 / motion.dt if motion.dt > 0.0 else 0.0, take3(motion.gain, 0))
    gained = scale(age, add(from_frame(q, force), gravity_I(planet, r)))
    r = add(r, scale(age, add(v, scale(0.5, gained))))
    put3(estimate.r_I, 0, r)
    put3(estimate.v_I, 0, add(v, gained))
    turned = turn_by(q, scale(age, rate))
    for i in range(4):
        estimate.q_I2B[i] = turned[i]
    put3(estimate.w_B, 0, rate)
    put3(estimate.specific_force_B, 0, force)
    put3(estimate.imu_rate_B, 0, rate)
