"""Table-based selection as flown: for each axis and sign a row of thrusters, chosen by the size of the
demand.

Hu et al. 2022, section 4.3: a demand below the authority of the 25 N thrusters goes to these, a larger one to
the 250 N thrusters, and to both where the 250 N thrusters do not suffice. A row consists of the healthy
thrusters that act mainly along its axis, all with the same duty, so that the others fire longer when one has
failed. Lateral force comes first (section 6.3: two thrusters for each direction), then roll, pitch and yaw
with the pulse time that is left: a thruster that serves two directions divides its time between them. The
effect of a row on the other axes is subtracted from their demand; the demand that remains after the last axis
is reported as unallocated.

The order of the axes is the priority between them. Left out: any search for a better combination; a row is
used as a whole or not at all.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.fsw.allocation.effectiveness import ROWS, usable
from edl6dof.interface.effectors import AXIAL, FINE, HORIZONTAL
from edl6dof.kernels import kernel
from edl6dof.registry import Member


class TableParams(Params):
    """Selection from a table of thrusters for each axis and sign."""

    alignment: float = param(
        0.6,
        "least cosine between torque, or lateral force, of a thruster and axis of its row",
        gt=0.0,
        lt=1.0,
    )


@kernel
def in_row(matrix, i, row, sign, alignment):
    """Return whether thruster ``i`` belongs to the row of the table for an axis and sign."""
    first = 1 if row < 3 else 3
    square = 0.0
    for k in range(first, 3 if row < 3 else 6):
        square += matrix[i, k] * matrix[i, k]
    return sign * matrix[i, row] > 0.0 and matrix[i, row] * matrix[i, row] > alignment * alignment * square


@kernel
def row_authority(alignment, matrix, vehicle, healthy, mask, row, sign):
    """Return force (N) or torque (N m) of the thrusters of a row at full duty, along the axis of the row."""
    total = 0.0
    for i in range(vehicle.n_thrusters):
        if usable(i, vehicle.thrusters, healthy, mask) and in_row(matrix, i, row, sign, alignment):
            total += abs(matrix[i, row])
    return total


@kernel
def add_row(alignment, matrix, vehicle, healthy, mask, row, duty, left):
    """Distribute the demand ``left`` (a wrench) along axis ``row`` evenly over the thrusters of its row, up
    to a duty of one, and subtract the wrench that they give.
    """
    sign = 1.0 if left[row] > 0.0 else -1.0
    total = row_authority(alignment, matrix, vehicle, healthy, mask, row=row, sign=sign)
    if total <= 0.0:
        return
    wanted = min(abs(left[row]) / total, 1.0)
    for i in range(vehicle.n_thrusters):
        if usable(i, vehicle.thrusters, healthy, mask) and in_row(matrix, i, row, sign, alignment):
            more = min(wanted, 1.0 - duty[i])
            duty[i] += more
            for k in range(ROWS):
                left[k] -= matrix[i, k] * more


@kernel
def add_axis(alignment, fine_share, matrix, vehicle, healthy, groups, row, duty, left):
    """Allocate the torque ``left`` along axis ``row`` to the fine thrusters, or to the coarse ones, or to
    both.
    """
    need, sign = abs(left[row]), 1.0 if left[row] > 0.0 else -1.0
    if need <= 1e-9:
        return
    fine, coarse = groups & (1 << FINE), groups & ~(1 << FINE)
    if need > fine_share * row_authority(alignment, matrix, vehicle, healthy, mask=fine, row=row, sign=sign):
        # axial thrusters stand in only where no other thruster is left
        mask = coarse & ~(1 << AXIAL)
        if row_authority(alignment, matrix, vehicle, healthy, mask, row=row, sign=sign) == 0.0:
            mask = coarse
        add_row(alignment, matrix, vehicle, healthy, mask, row=row, duty=duty, left=left)
    if sign * left[row] > 1e-9:
        add_row(alignment, matrix, vehicle, healthy, mask=fine, row=row, duty=duty, left=left)


@kernel
def share_out(params, shared, vehicle, healthy, effectiveness, demand, memory, duty, unallocated):
    """Compute the duties by table; arguments as in :func:`edl6dof.fsw.allocation.least_squares.share_out`."""
    matrix, alignment = effectiveness.matrix, params.alignment
    for row in range(ROWS):
        unallocated[row] = demand.wrench[row]
    for i in range(vehicle.n_thrusters):
        duty[i] = 0.0
        if demand.boosting != 0 and vehicle.thrusters[i].group == AXIAL and healthy[i] != 0:
            duty[i] = 1.0
            for row in range(ROWS):
                unallocated[row] -= matrix[i, row]
    if demand.translating != 0:
        for row in (1, 2):
            mask = demand.groups & (1 << HORIZONTAL)
            add_row(alignment, matrix, vehicle, healthy, mask, row=row, duty=duty, left=unallocated)
    for row in range(3, ROWS):
        add_axis(
            alignment,
            shared.fine_share,
            matrix,
            vehicle,
            healthy,
            groups=demand.groups,
            row=row,
            duty=duty,
            left=unallocated,
        )


MEMBER = Member("table", TableParams, {"share_out": share_out}, "Hu et al. 2022, section 4.3")
