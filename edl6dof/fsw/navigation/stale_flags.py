"""Whether a flag of saturation can be true: an instrument that says it is at the end of its range for long,
while the others read a motion along its axis that is far inside it, has failed.
"""

from __future__ import annotations

from edl6dof.kernels import kernel
from edl6dof.spatial.vector import dot, take3

#: Share of the range below which a motion is far inside it.
_FAR_INSIDE = 0.5


@kernel
def exclude_stale_flags(patience, axis, number, end, flags, vector, dt, healthy, flagged):
    """Exclude instruments that have been flagged without need for more than ``patience`` s.

    Args:
        patience: s.
        axis: of each of ``number`` instruments.
        end: of the range, rad/s or m/s2.
        flags: which are saturated, as they say.
        vector: increment of ``dt`` seconds that the others read.
        healthy: flags, updated.
        flagged: s, how long each has been flagged without need, updated.
    """
    for i in range(number):
        if flags[i] == 0 or abs(dot(take3(axis[i], 0), vector)) > _FAR_INSIDE * end * dt:
            flagged[i] = 0.0
        elif healthy[i] != 0:
            flagged[i] += dt
            if flagged[i] > patience:
                healthy[i] = 0
