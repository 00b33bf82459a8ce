"""What every method of allocation works with: the effect of each thruster, their authority, and the record of
one allocation.
"""

from __future__ import annotations

from math import copysign

import numpy as np

from edl6dof.interface.capacities import MAX_PARTS, MAX_THRUSTERS
from edl6dof.interface.thrusters import FINE
from edl6dof.jit import kernel
from edl6dof.records import whole
from edl6dof.spatial.vector import take3

ROWS = 6  # force x, y, z; torque x, y, z
NO_TORQUE = 1e-9  # N m, a demand that is none

ALLOCATOR = np.dtype(
    [
        ("effect", "f8", (MAX_THRUSTERS, ROWS)),
        # configuration that these effects belong to, plus one; 0 before the first
        ("effect_of", whole(0, 2**MAX_PARTS)),
        ("duty", "f8", (MAX_THRUSTERS,)),
        ("undelivered", "f8", (ROWS,)),
        # least squares: who may fire, in turn; slope of half the squared error with the duty of each, and
        # slope that pays for its use; products of the weighted effects, duty for each slope, and what these
        # were worked out for
        ("order", whole(0, MAX_THRUSTERS - 1, of="thrusters"), (MAX_THRUSTERS,)),
        ("slope", "f8", (MAX_THRUSTERS,)),
        ("price", "f8", (MAX_THRUSTERS,)),
        ("gram", "f8", (MAX_THRUSTERS, MAX_THRUSTERS)),
        ("gain", "f8", (MAX_THRUSTERS,)),
        ("gram_of", whole(0, 4 * 2**MAX_PARTS + 4)),
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
def fine_enough(share, effect, thrusters, count, healthy, demand):
    """Whether the healthy fine thrusters alone have the torque authority for ``demand``, up to a ``share`` of
    it.
    """
    x, y, z = 0.0, 0.0, 0.0  # largest torque along the demanded direction of each axis
    for i in range(count):
        if healthy[i] != 0 and thrusters[i].group == FINE:
            x += max(copysign(1.0, demand[3]) * effect[i, 3], 0.0)
            y += max(copysign(1.0, demand[4]) * effect[i, 4], 0.0)
            z += max(copysign(1.0, demand[5]) * effect[i, 5], 0.0)
    return (
        abs(demand[3]) <= share * x + NO_TORQUE
        and abs(demand[4]) <= share * y + NO_TORQUE
        and abs(demand[5]) <= share * z + NO_TORQUE
    )


@kernel
def keep_effects(vehicle, configuration, memory):
    """Work out ``memory.effect`` when the vehicle has another configuration, and so another centre of mass,
    than before.
    """
    if memory.effect_of != configuration + 1:
        memory.effect_of = configuration + 1
        effects(
            vehicle.thrusters,
            vehicle.n_thrusters,
            take3(vehicle.configuration[configuration].centre, 0),
            memory.effect,
        )
