"""Redundant instruments along individual axes: the vector that they measure, by least squares; their parity
vector; and the treatment of saturation flags.

The matrices are computed when the set of instruments in use changes. With axes as rows of H the vector is
(H'H)^-1 H' z. The parity vector p = V z is the part of the readings z that no vector explains: V H = 0, V V'
= 1, and V upper triangular.

A gyro with a flag is left out, or is assumed to read the end of its range. A flag that stays on while the
other instruments read a motion far inside the range is itself a failure, and the instrument is excluded.

Source: Potter and Deckert, Minimax failure detection and identification in redundant gyro and accelerometer
systems, J. Spacecraft 10(4), 1973: V is the Cholesky factor of 1 - H (H'H)^-1 H'; flags: T. Tolker-Nielsen,
EXOMARS 2016 Schiaparelli Anomaly Inquiry, ESA DG-I/2017/546/TTN (2017): as long as the flag stayed on, the
limit of the range was integrated as a constant rate, while the body oscillated.
"""

from __future__ import annotations

from math import copysign, sqrt

from edl6dof.config.base import Params, param
from edl6dof.interface.capacities import MAX_ACCELEROMETERS, MAX_GYROS
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record, whole
from edl6dof.spatial.vector import dot, inertia_solve, scale, sub, take3

#: Most instruments of one kind, and most components of the parity vector.
MAX_AXES = max(MAX_GYROS, MAX_ACCELEROMETERS)
MAX_PARITY = MAX_AXES - 3
#: Least determinant of H'H of axes that span space (1 for orthogonal axes), and least squared pivot of a row
#: of V.
_SPANS, _NEW = 1e-3, 1e-9

REDUNDANT = record(
    ("in_use", whole(0, 2**MAX_AXES - 1)),  # a bit for each instrument used in the matrices
    ("solvable", FLAG),  # the axes in use span space
    ("n_parity", whole(0, MAX_PARITY)),  # rows of V: instruments in use less three
    ("inverse", "f8", (3, MAX_AXES)),  # (H'H)^-1 H'; columns of instruments out of use are zero
    ("parity", "f8", (MAX_PARITY, MAX_AXES)),  # V; columns of instruments out of use are zero
    ("count", "f8", (MAX_AXES,)),  # count of each at the last reading
    ("increment", "f8", (MAX_AXES,)),  # change of the count since the reading before
    ("flagged", "f8", (MAX_AXES,)),  # s: for how long the motion has contradicted a saturation flag
    # end of the range, +1 or -1, that a gyro is assumed to read while its flag is on; 0: none
    ("end", "f8", (MAX_AXES,)),
)


@kernel
def usable(number, healthy, saturated):
    """Bits of the instruments, of ``number``, that are ``healthy`` and not ``saturated``."""
    bits = 0
    for i in range(number):
        if healthy[i] != 0 and saturated[i] == 0:
            bits |= 1 << i
    return bits


@kernel
def take_increments(counts, number, memory):
    """Compute increments from the counts of this and the last reading."""
    for i in range(number):
        memory.increment[i] = counts[i] - memory.count[i]
        memory.count[i] = counts[i]


@kernel
def prepare(axis, number, in_use, memory):
    """Compute the matrices of ``memory`` (``REDUNDANT``) for the set ``in_use`` along ``axis``."""
    memory.in_use, memory.n_parity, memory.solvable = in_use, 0, 0
    xx = yy = zz = xy = xz = yz = 0.0
    for i in range(number):
        if in_use >> i & 1:
            x, y, z = take3(axis[i], 0)
            xx, yy, zz = xx + x * x, yy + y * y, zz + z * z
            xy, xz, yz = xy + x * y, xz + x * z, yz + y * z
    determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - xz * yz) + xz * (xy * yz - xz * yy)
    if determinant < _SPANS:
        return
    memory.solvable = 1
    for i in range(number):
        column = (0.0, 0.0, 0.0)
        if in_use >> i & 1:
            column = inertia_solve((xx, yy, zz, xy, xz, yz), take3(axis[i], 0))
        for k in range(3):
            memory.inverse[k, i] = column[k]
    _factor(axis, number, in_use, memory)


@kernel
def _factor(axis, number, in_use, memory):
    """Cholesky factor V of 1 - H (H'H)^-1 H', a row for each instrument that adds a direction."""
    inverse, parity = memory.inverse, memory.parity
    row = 0
    for i in range(number):
        if row == MAX_PARITY or not in_use >> i & 1:
            continue
        root = 0.0
        for j in range(number):
            parity[row, j] = 0.0
            if j < i or not in_use >> j & 1:
                continue
            left = 1.0 if j == i else 0.0
            for k in range(3):
                left -= axis[i, k] * inverse[k, j]
            for k in range(row):
                left -= parity[k, i] * parity[k, j]
            if j == i:
                root = sqrt(left) if left > _NEW else 0.0
            if root > 0.0:
                parity[row, j] = left / root
        if root > 0.0:
            row += 1
    memory.n_parity = row


@kernel
def least_squares(memory, number, readings):
    """The vector (B) that best explains the readings of the instruments in use."""
    x = y = z = 0.0
    for i in range(number):
        reading = readings[i]
        x += memory.inverse[0, i] * reading
        y += memory.inverse[1, i] * reading
        z += memory.inverse[2, i] * reading
    return x, y, z


@kernel
def without_one(axis, memory, left_out, readings, vector):
    """Least-squares vector without the instrument ``left_out``, from the ``vector`` with all in use."""
    a = take3(axis[left_out], 0)
    column = (memory.inverse[0, left_out], memory.inverse[1, left_out], memory.inverse[2, left_out])
    excess = (readings[left_out] - dot(a, vector)) / (1.0 - dot(a, column))
    return sub(vector, scale(excess, column))


class SaturationParams(Params):
    """Gyros at the end of their range."""

    left_out: bool = param(
        True, "whether saturated gyros are left out; otherwise they are read as the end of their range"
    )


@kernel
def usable_gyros(params, instruments, dt, healthy, inertial, redundant):
    """Bits of the gyros to use. Where saturated gyros are not left out, their increments are replaced by the
    end of the range that they reached first.
    """
    number = instruments.n_gyros
    if params.left_out != 0:
        return usable(number, healthy, inertial.gyro_saturated)
    bits = 0
    for i in range(number):
        if healthy[i] != 0:
            bits |= 1 << i
        if inertial.gyro_saturated[i] == 0:
            redundant.end[i] = 0.0
            continue
        if redundant.end[i] == 0.0:
            redundant.end[i] = copysign(1.0, redundant.increment[i])
        redundant.increment[i] = redundant.end[i] * instruments.gyro_range * dt
    return bits


#: Motion, over the range, below which it is far inside the range.
_FAR_INSIDE = 0.5


@kernel
def exclude_stale_flags(patience, axis, number, end, flags, vector, dt, healthy, flagged):
    """Exclude instruments whose flag has been contradicted by the motion for more than ``patience`` s.

    Args:
        axis: unit vector of each of ``number`` instruments, B.
        end: end of the range, rad/s or m/s2.
        flags: reported saturation flags.
        vector: measured increment of ``dt`` seconds, B.
        healthy, flagged: health flags; duration of each contradicted flag, s; updated.
    """
    for i in range(number):
        if flags[i] == 0 or abs(dot(take3(axis[i], 0), vector)) > _FAR_INSIDE * end * dt:
            flagged[i] = 0.0
        elif healthy[i] != 0:
            flagged[i] += dt
            if flagged[i] > patience:
                healthy[i] = 0
