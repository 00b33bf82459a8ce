"""Bounded least squares: minimise |W (B u - d)|^2 + c u over 0 <= u <= 1.

Cyclic coordinate descent needs no matrix factorisation and keeps the bounds exactly; without the upper bound it would be non-negative
least squares.  The weights W set the priority: torque before force.  It starts from nothing, as an earlier solution would keep opposing
thrusters running.  Small demands go to the fine thrusters alone (Hu et al. 2022, section 4.3).  Source: coordinate descent for bounded
least squares, Bertsekas, Nonlinear Programming, section 2.7.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.fsw.allocation.wrench import AXIAL, FINE, ROWS, fine_enough, usable
from edl6dof.jit import kernel
from edl6dof.registry import Member


class LeastSquaresParams(Params):
    """Bounded least squares over all thrusters."""

    sweeps: int = param(16, "largest number of passes over the thrusters", ge=1, le=100000)
    tolerance: float = param(1e-3, "change of duty at which the iteration stops", gt=0.0, lt=1.0)
    force_scale_n: float = param(600.0, "lateral force error that weighs one while translating: torque comes first", gt=0.0)
    stray_force_scale_n: float = param(5000.0, "force error that weighs one otherwise", gt=0.0)
    axial_force_scale_n: float = param(1000.0, "axial force error that weighs one while the axial thrusters help the engine", gt=0.0)
    use_cost: float = param(0.002, "cost of running a 250 N thruster", ge=0.0)


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
    p = params.least_squares
    effect, duty, residual = memory.effect, memory.duty, memory.undelivered
    small = not (translating or boosting) and fine_enough(params.fine_share, effect, thrusters, count, healthy, demand)
    only_fine = small and (allowed >> FINE) & 1 == 1
    mask = 1 << FINE if only_fine else allowed
    force_weight = 1.0 / (p.force_scale if translating else p.stray_force_scale) ** 2
    axial_weight = 1.0 / p.axial_force_scale**2 if boosting else 0.0
    torque_weight = 1.0 / params.torque_scale**2
    for row in range(ROWS):
        residual[row] = demand[row]
    order, n = memory.order, 0
    # fine thrusters take their share first: the coarse ones then only get what is left, not the last few newton metres
    for fine_turn in (True, False):
        for i in range(count):
            if usable(i, thrusters, healthy, mask) and (thrusters[i].group == FINE) == fine_turn:
                order[n] = i
                n += 1
    gain, price = memory.gain, memory.price
    for i in range(count):
        duty[i] = 0.0
    for k in range(n):
        i = order[k]
        stray = effect[i, 1] * effect[i, 1] + effect[i, 2] * effect[i, 2]
        turn = effect[i, 3] * effect[i, 3] + effect[i, 4] * effect[i, 4] + effect[i, 5] * effect[i, 5]
        curve = axial_weight * effect[i, 0] * effect[i, 0] + force_weight * stray + torque_weight * turn
        gain[k] = 1.0 / curve if curve > 0.0 else 0.0
        # axial thrusters that are to help the engine cost nothing: any price would only shorten their pulses
        price[k] = 0.0 if boosting and thrusters[i].group == AXIAL else 0.5 * p.use_cost * thrusters[i].thrust / 250.0
    for _ in range(p.sweeps):
        change = 0.0
        for k in range(n):
            i = order[k]
            slope = axial_weight * effect[i, 0] * residual[0]
            slope += force_weight * (effect[i, 1] * residual[1] + effect[i, 2] * residual[2])
            slope += torque_weight * (effect[i, 3] * residual[3] + effect[i, 4] * residual[4] + effect[i, 5] * residual[5])
            new = min(max(duty[i] + (slope - price[k]) * gain[k], 0.0), 1.0)
            move = new - duty[i]
            if move != 0.0:
                duty[i] = new
                change = max(change, abs(move))
                for row in range(ROWS):
                    residual[row] -= effect[i, row] * move
        if change < p.tolerance:
            break


MEMBER = Member("least_squares", LeastSquaresParams, {"allocate": allocate}, "Bertsekas, Nonlinear Programming, section 2.7")
