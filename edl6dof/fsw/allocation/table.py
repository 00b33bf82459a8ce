"""Table-based selection as flown: for each axis and sign a row of thrusters, chosen by the size of the
demand.

Hu et al. 2022, section 4.3: a demand below the authority of the 25 N thrusters goes to them, otherwise to the
250 N ones, and to both where those do not suffice.  A row holds the healthy thrusters that act mainly along
its axis, all with the same duty, so a failed one only makes the others work longer.  Lateral force comes
first (section 6.3: two thrusters to a direction), then roll, pitch and yaw out
of the pulse time that is left: a thruster that serves two directions shares it between them.  What a row does
to the other axes is carried over to theirs; what the last one leaves is reported as undelivered.

The order of the axes is the priority between them.  Left out: any search for a better combination; a row is
taken whole or not at all.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.fsw.allocation.wrench import ROWS, usable
from edl6dof.interface.thrusters import AXIAL, FINE, HORIZONTAL
from edl6dof.jit import kernel
from edl6dof.registry import Member


class TableParams(Params):
    """Selection from a table of thrusters for each axis and sign."""

    alignment: float = param(
        0.6,
        "cosine between thruster's torque, or lateral force, and axis from which it is in the row",
        gt=0.0,
        lt=1.0,
    )


@kernel
def in_row(effect, i, row, sign, alignment):
    """Whether thruster ``i`` belongs to the row of the table for an axis and sign."""
    first = 1 if row < 3 else 3
    square = 0.0
    for k in range(first, 3 if row < 3 else 6):
        square += effect[i, k] * effect[i, k]
    return sign * effect[i, row] > 0.0 and effect[i, row] * effect[i, row] > alignment * alignment * square


@kernel
def row_authority(params, effect, thrusters, count, healthy, mask, row, sign):
    """Force or torque along an axis of a row of the table at full duty."""
    total = 0.0
    for i in range(count):
        if usable(i, thrusters, healthy, mask) and in_row(effect, i, row, sign, params.table.alignment):
            total += abs(effect[i, row])
    return total


@kernel
def add_row(params, thrusters, count, healthy, mask, row, memory):
    """Give the demand left along an axis to the thrusters of its row in the groups of ``mask``, within the
    pulse time they have left.
    """
    effect, duty, left = memory.effect, memory.duty, memory.undelivered
    sign = 1.0 if left[row] > 0.0 else -1.0
    total = row_authority(params, effect, thrusters, count, healthy, mask, row, sign)
    if total <= 0.0:
        return
    wanted = min(abs(left[row]) / total, 1.0)
    for i in range(count):
        if usable(i, thrusters, healthy, mask) and in_row(effect, i, row, sign, params.table.alignment):
            more = min(wanted, 1.0 - duty[i])
            duty[i] += more
            for k in range(ROWS):
                left[k] -= effect[i, k] * more


@kernel
def allocate(params, thrusters, count, healthy, allowed, translating, boosting, demand, memory):
    """Duties for a demanded force and torque by table; arguments as in
    :func:`edl6dof.fsw.allocation.least_squares.allocate`.
    """
    effect, duty, left = memory.effect, memory.duty, memory.undelivered
    for row in range(ROWS):
        left[row] = demand[row]
    for i in range(count):
        duty[i] = 0.0
        if boosting and thrusters[i].group == AXIAL and healthy[i] != 0:
            duty[i] = 1.0
            for row in range(ROWS):
                left[row] -= effect[i, row]
    fine, coarse = allowed & (1 << FINE), allowed & ~(1 << FINE)
    if translating:
        add_row(params, thrusters, count, healthy, allowed & (1 << HORIZONTAL), 1, memory)
        add_row(params, thrusters, count, healthy, allowed & (1 << HORIZONTAL), 2, memory)
    for row in range(3, 6):
        need, sign = abs(left[row]), 1.0 if left[row] > 0.0 else -1.0
        if need <= 1e-9:
            continue
        if need > params.fine_share * row_authority(
            params, effect, thrusters, count, healthy, fine, row, sign
        ):
            # axial thrusters stand in only where nobody else is left
            mask = coarse & ~(1 << AXIAL)
            if row_authority(params, effect, thrusters, count, healthy, mask, row, sign) == 0.0:
                mask = coarse
            add_row(params, thrusters, count, healthy, mask, row, memory)
        if sign * left[row] > 1e-9:
            add_row(params, thrusters, count, healthy, fine, row, memory)


MEMBER = Member("table", TableParams, {"allocate": allocate}, "Hu et al. 2022, section 4.3")
