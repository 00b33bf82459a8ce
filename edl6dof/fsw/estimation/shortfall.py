"""What pulse modulation owes: the torque of the valve intervals against that of the duties they stand for.

Pulses are never shorter than the minimum and small duties fall into the deadband, so on average a thruster
set gives a little less, or more, than it was asked for.  Hu et al. 2022, eq. 9, takes the *commanded* torque
as the vehicle's own, which makes this difference part of the disturbance; here the estimator of the
disturbance sees the valve intervals, and the difference is kept apart: filtered with the same pole, the two
add up to the estimate of the paper.
"""

from __future__ import annotations

from math import exp

import numpy as np

from edl6dof.jit import kernel
from edl6dof.spatial.vector import take3

SHORTFALL = np.dtype([("torque", "f8", (3,))], align=True)


@kernel
def shortfall(pole, effect, count, opens, closes, duty, dt, memory):
    """Update and return the torque (N m, B) that modulation gave beyond what was asked, low-pass filtered.

    Args:
        pole: of the filter, rad/s.
        effect: force and torque of each thruster at full thrust, rows of 6.
        count: how many thrusters there are.
        opens: valve openings commanded for the last control cycle, s.
        closes: valve closings, s.
        duty: duties they stand for.
        dt: cycle, s.
        memory: ``SHORTFALL`` record.
    """
    step = 1.0 - exp(-pole * dt)
    for j in range(3):
        given = 0.0
        for i in range(count):
            given += ((closes[i] - opens[i]) / dt - duty[i]) * effect[i, 3 + j]
        memory.torque[j] += step * (given - memory.torque[j])
    return take3(memory.torque, 0)
