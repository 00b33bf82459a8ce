"""Bounded least squares: minimise |W (B u - d)|^2 + c u over 0 <= u <= 1, with the duties u, the
effectiveness B, the demand d, the weights W and the cost of use c.

Coordinate descent needs no matrix factorisation and keeps the bounds exactly; without the upper bound the
problem would be non-negative least squares. Each step sets the duty that is farthest from its best value to
that value (Gauss-Southwell rule); some twenty steps come as near to the optimum as eight cycles through all
thrusters. The slope of the error with each duty is updated by the products B' W^2 B, which change only with
the configuration of the vehicle and with W. The weights set the priority: torque before force. The iteration
starts from zero duties, as an earlier solution would keep opposing thrusters running. Small demands go to the
fine thrusters alone (Hu et al. 2022, section 4.3).

Source: coordinate descent for bounded least squares, Bertsekas, Nonlinear Programming, section 2.7; rule of
Gauss and Southwell, Luo and Tseng, J. Optim. Theory Appl. 72 (1992) 7-35.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.fsw.allocation.effectiveness import ROWS, fine_enough, usable
from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.interface.effectors import AXIAL, FINE
from edl6dof.kernels import kernel
from edl6dof.records import record, whole
from edl6dof.registry import Member
from edl6dof.spatial.vector import put3, take3


class LeastSquaresParams(Params):
    """Bounded least squares over all thrusters."""

    steps: int = param(200, "largest number of changes of a duty", ge=1, le=1000000)
    tolerance: float = param(4e-3, "change of a duty below which the iteration stops", gt=0.0, lt=1.0)
    translating_tolerance: float = param(
        2e-3, "tolerance while translating, where many small changes add up", gt=0.0, lt=1.0
    )
    force_scale_n: float = param(
        600.0, "lateral force error of weight one while translating: torque comes first", gt=0.0
    )
    stray_force_scale_n: float = param(5000.0, "lateral force error of weight one otherwise", gt=0.0)
    axial_force_scale_n: float = param(
        1000.0, "axial force error of weight one while the axial thrusters help the engine", gt=0.0
    )
    use_cost: float = param(0.002, "cost of running a 250 N thruster", ge=0.0)


#: ``order``: thrusters that may fire, in turn; ``slope``: negative derivative of half the squared error by
#: each duty; ``price``: derivative of the cost by each duty; ``gram``: B' W^2 B; ``gain``: inverse of its
#: diagonal; ``gram_weight`` and ``gram_mark``: the weights and the mark of the effectiveness of which
#: ``gram`` was computed.
MEMORY = record(
    ("order", whole(0, MAX_THRUSTERS - 1, of="thrusters"), (MAX_THRUSTERS,)),
    ("slope", "f8", (MAX_THRUSTERS,)),
    ("price", "f8", (MAX_THRUSTERS,)),
    ("gram", "f8", (MAX_THRUSTERS, MAX_THRUSTERS)),
    ("gain", "f8", (MAX_THRUSTERS,)),
    ("gram_weight", "f8", (3,)),
    ("gram_mark", "f8"),
)


@kernel
def share_out(params, shared, vehicle, healthy, effectiveness, demand, memory, duty, unallocated):
    """Compute the duties for a demanded force and torque.

    Args:
        params: least-squares record.
        shared: settings of all methods: torque scale, share of the fine thrusters.
        vehicle, healthy: believed thrusters, and flags of those in use.
        effectiveness: ``EFFECTIVENESS`` record.
        demand: ``DEMAND`` record: force and torque, groups that may fire, priorities.
        memory: ``MEMORY`` record.
        duty: written, 0..1 for each thruster.
        unallocated: written, demand less what the duties give (force and torque in B, N and N m).
    """
    p, thrusters, count = params, vehicle.thrusters, vehicle.n_thrusters
    translating, boosting = demand.translating != 0, demand.boosting != 0
    matrix, slope, price = effectiveness.matrix, memory.slope, memory.price
    small = not (translating or boosting) and fine_enough(
        shared.fine_share, matrix, thrusters, count, healthy, demand=demand.wrench
    )
    only_fine = small and (demand.groups >> FINE) & 1 == 1
    mask = 1 << FINE if only_fine else demand.groups
    axial = 1.0 / p.axial_force_scale**2 if boosting else 0.0
    lateral = 1.0 / (p.force_scale if translating else p.stray_force_scale) ** 2
    weight = (axial, lateral, 1.0 / shared.torque_scale**2)
    update_products(weight, count, effectiveness, memory)
    order, n = memory.order, 0
    # fine thrusters take their share first: the coarse ones then only get what is left, not the last few
    # newton metres
    for fine_first in (True, False):
        for i in range(count):
            if usable(i, thrusters, healthy, mask) and (thrusters[i].group == FINE) == fine_first:
                order[n] = i
                n += 1
    for i in range(count):
        duty[i] = 0.0
        slope[i] = product(weight, matrix[i], demand.wrench)
        # axial thrusters that are to help the engine cost nothing: any price would only shorten their pulses
        price[i] = (
            0.0
            if boosting and thrusters[i].group == AXIAL
            else 0.5 * p.use_cost * thrusters[i].thrust / 250.0
        )
    tolerance = p.translating_tolerance if translating else p.tolerance
    descend(p.steps, tolerance, n, count, memory, duty=duty)
    for row in range(ROWS):
        unallocated[row] = demand.wrench[row]
    for k in range(n):
        i = order[k]
        if duty[i] > 0.0:
            for row in range(ROWS):
                unallocated[row] -= matrix[i, row] * duty[i]


@kernel
def product(weight, a, b):
    """Return the scalar product of two wrenches; ``weight``: of axial force, lateral force and torque."""
    return (
        weight[0] * a[0] * b[0]
        + weight[1] * (a[1] * b[1] + a[2] * b[2])
        + weight[2] * (a[3] * b[3] + a[4] * b[4] + a[5] * b[5])
    )


@kernel
def update_products(weight, count, effectiveness, memory):
    """Compute ``memory.gram`` again when effectiveness or weights have changed."""
    if memory.gram_mark == effectiveness.mark and take3(memory.gram_weight, 0) == weight:
        return
    memory.gram_mark = effectiveness.mark
    put3(memory.gram_weight, 0, weight)
    for i in range(count):
        for j in range(count):
            memory.gram[i, j] = product(weight, effectiveness.matrix[i], effectiveness.matrix[j])
        memory.gain[i] = 1.0 / memory.gram[i, i] if memory.gram[i, i] > 0.0 else 0.0


@kernel
def farthest(n, memory, duty):
    """Return the thruster whose duty is farthest from its best value, and the change to that value; the first
    in order where several are equal.
    """
    order, slope, price, gain = memory.order, memory.slope, memory.price, memory.gain
    chosen, way, size = 0, 0.0, 0.0
    for k in range(n):
        i = order[k]
        move = min(max(duty[i] + (slope[i] - price[i]) * gain[i], 0.0), 1.0) - duty[i]
        if abs(move) > size:
            chosen, way, size = i, move, abs(move)
    return chosen, way


@kernel
def descend(steps, tolerance, n, count, memory, duty):
    """Change one duty after the other, the one farthest from its best value first, until all are within
    ``tolerance`` of it or ``steps`` changes have been made.
    """
    for _ in range(steps):
        i, move = farthest(n, memory, duty)
        if abs(move) < tolerance:
            break
        duty[i] += move
        for j in range(count):
            memory.slope[j] -= memory.gram[i, j] * move


MEMBER = Member(
    "least_squares", LeastSquaresParams, {"share_out": share_out}, "Bertsekas, section 2.7", MEMORY
)
