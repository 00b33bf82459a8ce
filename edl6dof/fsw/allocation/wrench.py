"""What every method of allocation works with: the effect of each thruster, their authority, and the record of one allocation."""

from __future__ import annotations

import numpy as np

from edl6dof.jit import kernel

MAX_THRUSTERS = 32
ROWS = 6  # force x, y, z; torque x, y, z
HORIZONTAL, AXIAL, ATTITUDE, FINE = range(4)

ALLOCATOR = np.dtype(
    [
        ("effect", "f8", (MAX_THRUSTERS, ROWS)),
        ("duty", "f8", (MAX_THRUSTERS,)),
        ("undelivered", "f8", (ROWS,)),
        # least squares: duty per slope of the squared error (0: may not fire), and slope that pays for the use
        ("gain", "f8", (MAX_THRUSTERS,)),
        ("price", "f8", (MAX_THRUSTERS,)),
    ],
    align=True,
)


@kernel
def effects(thrusters, count, centre, effect):
    """Force and torque about ``centre`` of each thruster at full duty: rows of ``effect``."""
    for i in range(count):
        jet = thrusters[i]
        x, y, z = jet.thrust * jet.direction[0], jet.thrust * jet.direction[1], jet.thrust * jet.direction[2]
        px, py, pz = jet.position[0] - centre[0], jet.position[1] - centre[1], jet.position[2] - centre[2]
        effect[i, 0], effect[i, 1], effect[i, 2] = x, y, z
        effect[i, 3], effect[i, 4], effect[i, 5] = py * z - pz * y, pz * x - px * z, px * y - py * x


@kernel
def usable(i, thrusters, healthy, mask):
    """Whether thruster ``i`` works and belongs to a group in the bit mask."""
    return healthy[i] != 0 and (mask >> thrusters[i].group) & 1 == 1


@kernel
def authority(effect, thrusters, count, healthy, group, row, sign):
    """Largest demand along one row that the healthy thrusters of a group can meet together."""
    total = 0.0
    for i in range(count):
        if healthy[i] != 0 and thrusters[i].group == group:
            total += max(sign * effect[i, row], 0.0)
    return total


@kernel
def fine_enough(share, effect, thrusters, count, healthy, demand):
    """Whether the fine thrusters alone have the torque authority for ``demand``, up to a ``share`` of it."""
    for row in range(3, 6):
        if abs(demand[row]) > 1e-9:
            sign = 1.0 if demand[row] > 0.0 else -1.0
            if abs(demand[row]) > share * authority(effect, thrusters, count, healthy, FINE, row, sign):
                return False
    return True
