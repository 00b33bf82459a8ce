"""The standing lateral force: what acts across the thrust axis beside engine and thrusters as they are
believed, such as an engine out of line or wind.

It is the estimated disturbance force (Hu et al. 2022, eqs. 10-12), turned into north and east, and smoothed,
as each estimate holds the vibration of the engine; the axial part, which holds its thrust, is left out.
"""

from __future__ import annotations

import numpy as np

from edl6dof.kernels import kernel
from edl6dof.records import FLAG
from edl6dof.spatial.elementary import exp
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import dot, take3

STANDING_FORCE = np.dtype([("known", FLAG), ("force_N", "f8", (2,))], align=True)


@kernel
def standing_force(time_constant, nav, disturbance, dt, memory):
    """Standing lateral force, north and east (N).

    Args:
        time_constant: over which it is smoothed, s.
        nav: ``NAV`` record.
        disturbance: ``DISTURBANCE`` record.
        dt: time since the last call, s.
        memory: ``STANDING_FORCE`` record; at the first call it takes the estimate as it is.
    """
    q = (nav.q_I2B[0], nav.q_I2B[1], nav.q_I2B[2], nav.q_I2B[3])
    force = from_frame(q, (0.0, disturbance.force[1], disturbance.force[2]))
    step = 1.0 - exp(-dt / time_constant) if memory.known != 0 else 1.0
    memory.known = 1
    memory.force_N[0] += step * (dot(force, take3(nav.north_I, 0)) - memory.force_N[0])
    memory.force_N[1] += step * (dot(force, take3(nav.east_I, 0)) - memory.force_N[1])
    return memory.force_N[0], memory.force_N[1]
