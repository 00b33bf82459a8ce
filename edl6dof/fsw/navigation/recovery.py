"""Recovery of the vertical after the attitude was lost, as when all gyros saturate at the parachute opening.

Parachute and air pull against the velocity relative to the air.  While the attitude is sound, what the
direction of the specific force shows of the velocity across it (the wind, and the lift) is remembered.  After
a gap the attitude is turned until force and velocity, less what is remembered, point the same way again.
How far it is turned in a cycle follows from the variance of the attitude across the force against that of the
swinging of the force (a scalar Kalman filter).  A parachute pulls some degrees beside the velocity relative
to the air: an attitude that is off by less is left as it was bridged.  The rotation about the force cannot be
seen so: it is held over the gap (:mod:`.bridge`), and turns into azimuth as the path becomes steep.

Source: this project; gravity direction and velocity as references after a loss of attitude: Li et al., J.
Astronautics 43(1), 2022.
"""

from __future__ import annotations

from math import atan2

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.fsw.navigation.strapdown import turn_by
from edl6dof.jit import kernel
from edl6dof.spatial.quaternion import from_frame, to_frame
from edl6dof.spatial.vector import add, cross, dot, norm, put3, scale, sub, take3, unit


class RecoveryParams(Params):
    """Recovery of the vertical after the attitude was lost."""

    enabled: bool = param(True, "whether the attitude is turned")
    bridged_rate_deg_s: float = param(
        5.0, "standard deviation of the rate while it is bridged", status="estimate", gt=0.0, le=1000.0
    )
    slack_deg: float = param(
        6.0, "how far beside the velocity the force may point", status="estimate", ge=0.0, le=90.0
    )
    swing_deg: float = param(
        3.0, "standard deviation of the direction of the force", status="estimate", gt=0.0, le=90.0
    )
    swing_time_s: float = param(0.5, "correlation time of it", status="estimate", gt=0.0, le=100.0)
    found_deg: float = param(
        1.5, "standard deviation of the attitude at which it is found again", gt=0.0, le=90.0
    )
    window_s: float = param(3.0, "time constant of what is remembered of the velocity", gt=0.0, le=1000.0)
    force_m_s2: float = param(2.0, "least specific force whose direction is used", gt=0.0, le=1000.0)


RECOVERY = np.dtype(
    [
        ("across_I", "f8", (3,)),  # m/s, I: planet-relative velocity across the force, low-passed
        ("gap", "f8"),  # s: for how long the rate has been bridged; 0 while it is known
        ("variance", "f8"),  # rad2: of the attitude about each axis across the force; 0 once it is found
    ],
    align=True,
)


@kernel
def recover(params, rotation_rate, ignited, motion, memory, solution):
    """Remember, or turn the attitude of ``solution`` (``SOLUTION``), after a cycle of ``motion``.

    Args:
        params: ``RecoveryParams`` record.
        rotation_rate: of the planet, rad/s.
        ignited: whether an engine burns, so that the force is not that of parachute and air.
        motion: ``MOTION`` record.
        memory: ``RECOVERY`` record, updated.
        solution: updated.
    """
    dt = motion.dt
    if motion.rate_known == 0:
        memory.variance += params.bridged_rate**2 * dt * (2.0 * memory.gap + dt)
        memory.gap += dt
        return
    memory.gap = 0.0
    gain = take3(motion.gain, 0)
    if ignited != 0 or motion.force_known == 0 or norm(gain) < params.force * dt:
        return
    q = (solution.q_I2B[0], solution.q_I2B[1], solution.q_I2B[2], solution.q_I2B[3])
    force = unit(from_frame(q, gain))
    r, v = take3(solution.r_I, 0), take3(solution.v_I, 0)
    v_rel = (v[0] + rotation_rate * r[1], v[1] - rotation_rate * r[0], v[2])
    across = take3(memory.across_I, 0)
    if memory.variance == 0.0:
        seen = sub(v_rel, scale(dot(v_rel, force), force))
        share = min(dt / params.window, 1.0)
        put3(memory.across_I, 0, add(across, scale(share, sub(seen, across))))
        return
    if params.enabled == 0:
        return
    wanted = unit(sub(across, v_rel))
    axis = cross(force, wanted)
    angle = max(atan2(norm(axis), dot(force, wanted)) - params.slack, 0.0)
    swing = 2.0 * params.swing**2 * params.swing_time
    share = memory.variance * dt / (memory.variance * dt + swing)
    turned = turn_by(q, to_frame(q, scale(share * angle, unit(axis))))
    for i in range(4):
        solution.q_I2B[i] = turned[i]
    memory.variance *= 1.0 - share
    if memory.variance < params.found**2:
        memory.variance = 0.0
