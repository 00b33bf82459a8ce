"""Thruster allocation: which duties give the demanded torque and lateral force best, and what stays undelivered.

Bounded least squares: minimise |W (B u - d)|^2 + c u over 0 <= u <= 1, by cyclic coordinate descent, which needs no matrix
factorisation and keeps the bounds exactly.  It starts from nothing: an earlier solution would keep opposing thrusters running.
Small demands go to the fine thrusters alone (Hu et al. 2022, section 4.3).
"""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.jit import kernel

MAX_THRUSTERS = 32
ROWS = 6  # force x, y, z; torque x, y, z
AXIAL, ATTITUDE, FINE = 1, 2, 3


class AllocationParams(Params):
    """Thruster allocation."""

    sweeps: int = param(16, "largest number of passes over the thrusters", ge=1, le=100000)
    tolerance: float = param(1e-3, "change of duty at which the iteration stops", gt=0.0, lt=1.0)
    torque_scale_nm: float = param(250.0, "torque error that weighs one", gt=0.0)
    force_scale_n: float = param(600.0, "lateral force error that weighs one while translating: torque comes first", gt=0.0)
    stray_force_scale_n: float = param(5000.0, "force error that weighs one otherwise", gt=0.0)
    axial_force_scale_n: float = param(1000.0, "axial force error that weighs one while the axial thrusters help the engine", gt=0.0)
    use_cost: float = param(0.002, "cost of running a 250 N thruster", ge=0.0)
    fine_share: float = param(0.8, "share of the fine thrusters' authority up to which they work alone", ge=0.0, le=1.0)


ALLOCATOR = np.dtype(
    [
        ("effect", "f8", (MAX_THRUSTERS, ROWS)),
        ("duty", "f8", (MAX_THRUSTERS,)),
        ("undelivered", "f8", (ROWS,)),
        # of one allocation: duty per slope of the squared error (0: may not fire), and slope that pays for the use
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
def authority(effect, thrusters, count, healthy, group, row, sign):
    """Largest demand along one row that the healthy thrusters of a group can meet together."""
    total = 0.0
    for i in range(count):
        if healthy[i] != 0 and thrusters[i].group == group:
            total += max(sign * effect[i, row], 0.0)
    return total


@kernel
def fine_enough(params, effect, thrusters, count, healthy, demand):
    """Whether the fine thrusters alone have the torque authority for ``demand``."""
    for row in range(3, 6):
        if abs(demand[row]) > 1e-9:
            sign = 1.0 if demand[row] > 0.0 else -1.0
            if abs(demand[row]) > params.fine_share * authority(effect, thrusters, count, healthy, FINE, row, sign):
                return False
    return True


@kernel
def allocate(params, thrusters, count, healthy, allowed, translating, boosting, demand, memory):
    """Duties for a demanded force and torque; ``memory.duty`` and ``memory.undelivered`` are written.

    Args:
        params: allocation record.
        thrusters: believed thrusters (group, thrust).
        count: how many there are.
        healthy: whether each may be used (0 for no).
        allowed: bit mask of the groups that may fire.
        translating: whether lateral force is demanded; otherwise stray force is only discouraged.
        boosting: whether axial force is demanded; otherwise it is left alone.
        demand: (force x, y, z, torque x, y, z) in B, N and N m.
        memory: ``ALLOCATOR`` record whose ``effect`` is filled.
    """
    effect, duty, residual = memory.effect, memory.duty, memory.undelivered
    small = not (translating or boosting) and fine_enough(params, effect, thrusters, count, healthy, demand)
    only_fine = small and (allowed >> FINE) & 1 == 1
    mask = 1 << FINE if only_fine else allowed
    force_weight = 1.0 / (params.force_scale if translating else params.stray_force_scale) ** 2
    axial_weight = 1.0 / params.axial_force_scale**2 if boosting else 0.0
    torque_weight = 1.0 / params.torque_scale**2
    for row in range(ROWS):
        residual[row] = demand[row]
    gain, price = memory.gain, memory.price
    for i in range(count):
        stray = effect[i, 1] * effect[i, 1] + effect[i, 2] * effect[i, 2]
        turn = effect[i, 3] * effect[i, 3] + effect[i, 4] * effect[i, 4] + effect[i, 5] * effect[i, 5]
        curve = axial_weight * effect[i, 0] * effect[i, 0] + force_weight * stray + torque_weight * turn
        usable = healthy[i] != 0 and (mask >> thrusters[i].group) & 1 == 1
        gain[i] = 1.0 / curve if usable and curve > 0.0 else 0.0
        # axial thrusters that are to help the engine cost nothing: any price would only shorten their pulses
        price[i] = 0.0 if boosting and thrusters[i].group == AXIAL else 0.5 * params.use_cost * thrusters[i].thrust / 250.0
        duty[i] = 0.0
    for sweep in range(2 * params.sweeps):
        # fine thrusters take their share first: the coarse ones then only get what is left, not the last few newton metres
        fine_turn = sweep % 2 == 0
        if fine_turn:
            change = 0.0
        for i in range(count):
            if gain[i] == 0.0 or (thrusters[i].group == FINE) != fine_turn:
                continue
            slope = axial_weight * effect[i, 0] * residual[0]
            slope += force_weight * (effect[i, 1] * residual[1] + effect[i, 2] * residual[2])
            slope += torque_weight * (effect[i, 3] * residual[3] + effect[i, 4] * residual[4] + effect[i, 5] * residual[5])
            new = min(max(duty[i] + (slope - price[i]) * gain[i], 0.0), 1.0)
            move = new - duty[i]
            if move != 0.0:
                duty[i] = new
                change = max(change, abs(move))
                for row in range(ROWS):
                    residual[row] -= effect[i, row] * move
        if change < params.tolerance and not fine_turn:
            break
