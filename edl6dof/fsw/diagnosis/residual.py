"""Residuals of diagnosis: the unexplained force and torque less their slow part, and the weight of each
component.

The slow part, which no thruster fault explains, is the mean of the time before the last fifteen cycles. The
slow part contains the steady effect of an older fault, but not that of a younger one. An old leak is then
indistinguishable from a dead thruster: either shows only in that it does not respond, and the latch valve has
to separate them (:mod:`edl6dof.fsw.diagnosis.leak_isolation`).
"""

from __future__ import annotations

from edl6dof.kernels import kernel
from edl6dof.records import COUNT, FLAG, record

# control cycles by which the mean lags behind: a fault has so long to be found before it is taken for a
# disturbance
WINDOW = 15
LEAST_MEAN = 3  # cycles that make up the first mean after a restart

RESIDUAL = record(
    ("value", "f8", (6,)),  # force and torque of the last cycle less the slow part
    ("slow", "f8", (6,)),
    ("recent", "f8", (WINDOW, 6)),
    ("taken", COUNT),  # cycles since the last restart
    ("restarted", FLAG),  # not in the free fall at the start any more
)


@kernel
def restart_residual(memory):
    """Reset the slow part: the vehicle or the forces on it have changed."""
    memory.taken, memory.restarted = 0, 1


@kernel
def without_slow_part(time_constant, unexplained, dt, memory):
    """Subtract the slow part of the ``unexplained`` force and torque of the last cycle (6; N, N m). Returns
    for how many cycles the slow part has been known (0: not yet). ``time_constant``: of the mean, s.

    At the start of the flight, in free fall, the slow part counts as zero.
    """
    row = memory.taken % WINDOW
    older = memory.taken - WINDOW
    memory.taken += 1
    if older >= 0 or memory.restarted == 0:
        step = min(dt / time_constant, 1.0)
        if memory.restarted != 0:
            step = max(step, 1.0 / (older + 1.0))
        for j in range(6):
            memory.slow[j] += step * (memory.recent[row, j] - memory.slow[j])
    for j in range(6):
        memory.recent[row, j] = unexplained[j]
        memory.value[j] = unexplained[j] - memory.slow[j]
    return memory.taken if memory.restarted == 0 else max(older + 1 - LEAST_MEAN, 0)


@kernel
def product(a, b, weight):
    """Return the weighted scalar product of two wrenches without their axial force, which engine and drag
    disturb.
    """
    return (
        weight[0] * (a[1] * b[1] + a[2] * b[2])
        + weight[1] * a[3] * b[3]
        + weight[2] * (a[4] * b[4] + a[5] * b[5])
    )
