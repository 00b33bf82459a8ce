"""Thruster effectiveness: force and torque of each thruster at full duty, less a known loss of its thrust,
and a test of whether the fine thrusters suffice for a demand.

The allocator distributes the demand.  Estimation, diagnosis and modulation use the same effectiveness, so a
known loss is neither a disturbance nor a fault to them.
"""

from __future__ import annotations

from math import copysign

from edl6dof.interface.capacities import MAX_PARTS, MAX_THRUSTERS
from edl6dof.interface.effectors import FINE
from edl6dof.kernels import kernel
from edl6dof.records import record, whole
from edl6dof.spatial.vector import take3

ROWS = 6  # force x, y, z; torque x, y, z
NO_TORQUE = 1e-9  # N m: a demand up to this counts as none

EFFECTIVENESS = record(
    # N and N m, B: force, and torque about the centre of mass, of each thruster at full duty
    ("matrix", "f8", (MAX_THRUSTERS, ROWS)),
    ("of", whole(0, 2**MAX_PARTS)),  # number of its configuration, plus one; 0: not computed yet
    ("loss", "f8", (MAX_THRUSTERS,)),  # share of the thrust that each is known to have lost
    ("mark", "f8"),  # checksum of the matrix: derived values are invalid once it changes
)


@kernel
def effectiveness_matrix(thrusters, count, centre, matrix):
    """Write force (N) and torque (N m, B) of each thruster at full duty into the rows of ``matrix``;
    ``centre``: centre of mass, the point of reference of the torque (m, B).
    """
    for i in range(count):
        jet = thrusters[i]
        x, y, z = jet.thrust * jet.direction[0], jet.thrust * jet.direction[1], jet.thrust * jet.direction[2]
        px, py, pz = jet.position[0] - centre[0], jet.position[1] - centre[1], jet.position[2] - centre[2]
        matrix[i, 0], matrix[i, 1], matrix[i, 2] = x, y, z
        matrix[i, 3], matrix[i, 4], matrix[i, 5] = py * z - pz * y, pz * x - px * z, px * y - py * x


@kernel
def update_effectiveness(vehicle, configuration, loss, effectiveness):
    """Compute the effectiveness again when the configuration, and so the centre of mass, or the known
    ``loss`` of a thruster (share of its thrust) has changed.
    """
    changed = effectiveness.of != configuration + 1
    for i in range(vehicle.n_thrusters):
        changed = changed or effectiveness.loss[i] != loss[i]
    if changed:
        effectiveness.of = configuration + 1
        centre = take3(vehicle.configuration[configuration].centre, 0)
        effectiveness_matrix(vehicle.thrusters, vehicle.n_thrusters, centre, effectiveness.matrix)
        effectiveness.mark = 0.0
        for i in range(vehicle.n_thrusters):
            effectiveness.loss[i] = loss[i]
            for row in range(ROWS):
                effectiveness.matrix[i, row] *= 1.0 - loss[i]
                effectiveness.mark += (ROWS * i + row + 1.0) * effectiveness.matrix[i, row]


@kernel
def usable(i, thrusters, healthy, mask):
    """Return whether thruster ``i`` is healthy and its group is in the bit ``mask``."""
    return healthy[i] != 0 and (mask >> thrusters[i].group) & 1 == 1


@kernel
def fine_enough(share, matrix, thrusters, count, healthy, demand):
    """Return whether the healthy fine thrusters can give the torque of ``demand`` (a wrench, N and N m) with
    no more than ``share`` of their authority on each axis.
    """
    x, y, z = 0.0, 0.0, 0.0  # largest torque along the demanded direction of each axis
    for i in range(count):
        if healthy[i] != 0 and thrusters[i].group == FINE:
            x += max(copysign(1.0, demand[3]) * matrix[i, 3], 0.0)
            y += max(copysign(1.0, demand[4]) * matrix[i, 4], 0.0)
            z += max(copysign(1.0, demand[5]) * matrix[i, 5], 0.0)
    return (
        abs(demand[3]) <= share * x + NO_TORQUE
        and abs(demand[4]) <= share * y + NO_TORQUE
        and abs(demand[5]) <= share * z + NO_TORQUE
    )
