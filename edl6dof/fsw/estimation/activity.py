"""What the thrusters should have given during the cycle that the latest inertial measurement covers.

The measurement is some base cycles old, and thrust follows the valve a few milliseconds late.  So the valve
intervals commanded in the last control cycles are kept, and the share of the measured cycle in which each
thruster was to give thrust is worked out from them.
"""

from __future__ import annotations

import numpy as np

from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.kernels import kernel

#: Control cycles whose valve intervals are kept: the measured cycle lies within the last two, thrust lags
#: into the third.
KEPT = 3

ACTIVITY = np.dtype(
    [
        ("open_time", "f8", (KEPT, MAX_THRUSTERS)),
        ("close_time", "f8", (KEPT, MAX_THRUSTERS)),
        # of the measured cycle in which each thruster should have given thrust
        ("share", "f8", (MAX_THRUSTERS,)),
        ("wrench", "f8", (6,)),  # mean force and torque that gives
    ],
    align=True,
)


@kernel
def remember(valves, count, memory):
    """Keep the intervals of the ``valves`` (``MODULATION`` record) in a new control cycle."""
    for k in range(KEPT - 1, 0, -1):
        for i in range(count):
            memory.open_time[k, i] = memory.open_time[k - 1, i]
            memory.close_time[k, i] = memory.close_time[k - 1, i]
    for i in range(count):
        memory.open_time[0, i] = valves.open_time[i]
        memory.close_time[0, i] = valves.close_time[i]


@kernel
def expect(effectiveness, count, begin, end, lag, memory):
    """Work out ``memory.share`` and ``memory.wrench`` for the time from ``begin`` to ``end`` (s).

    Args:
        effectiveness: force and torque of each thruster at full thrust, rows of 6 (N, N m).
        count: how many thrusters there are.
        begin: start of the measured cycle.
        end: its end.
        lag: time by which thrust follows the valve, s.
        memory: ``ACTIVITY`` record.
    """
    for j in range(6):
        memory.wrench[j] = 0.0
    for i in range(count):
        on = 0.0
        for k in range(KEPT):
            if memory.close_time[k, i] > memory.open_time[k, i]:
                on += max(
                    min(memory.close_time[k, i] + lag, end) - max(memory.open_time[k, i] + lag, begin), 0.0
                )
        share = on / (end - begin)
        memory.share[i] = share
        if share > 0.0:
            for j in range(6):
                memory.wrench[j] += share * effectiveness[i, j]
