"""Index and interpolation in tables: the one module that makes an index out of a float.

Whatever the float, infinite or not a number, the index lies within the table.  A float that is not a number
gives a share that is not a number, and so does the interpolated value.
"""

from __future__ import annotations

from math import floor

from edl6dof.kernels import kernel


@kernel
def cell(position, cells):
    """Index 0 .. ``cells`` - 1 of the cell with ``position`` (in cells), and the position from its lower
    node: 0..1 inside the table, outside it the distance beyond.
    """
    if position >= cells - 1:
        return cells - 1, position - (cells - 1)
    if position >= 0.0:
        index = int(position)
        return index, position - index
    return 0, position


@kernel
def endless_cell(position):
    """Index of the cell at ``position`` (in cells) on an endless lattice; 0 where that is not finite."""
    return int(floor(position)) if abs(position) < 2.0**52 else 0


@kernel
def held(share):
    """Position within a cell, limited to 0..1 at the ends of the table."""
    if share < 0.0:
        return 0.0
    if share > 1.0:
        return 1.0
    return share


@kernel
def held_cell(position, cells):
    """Index of the cell, and share of the way across it (0..1), held beyond the ends of the table."""
    index, share = cell(position, cells)
    return index, held(share)


@kernel
def cell_among(nodes, count, value):
    """Index of the cell among the first ``count`` (2 or more) rising ``nodes`` that contains ``value``, and
    the share of the way across it, both constant beyond the ends.
    """
    low, high = 0, count - 1
    while high - low > 1:
        middle = (low + high) // 2
        if value < nodes[middle]:
            high = middle
        else:
            low = middle
    if value <= nodes[low]:
        return low, 0.0
    if value >= nodes[high]:
        return low, 1.0
    return low, (value - nodes[low]) / (nodes[high] - nodes[low])


@kernel
def between(values, index, share):
    """Linear interpolation from ``values[index]`` to the next value."""
    return values[index] + share * (values[index + 1] - values[index])


@kernel
def wrapped(angle, turn):
    """``angle`` less whole turns: 0 .. ``turn``."""
    return angle - turn * endless_cell(angle / turn)


@kernel
def catmull_rom(profile, rows, row, t):
    """Evaluate the Catmull-Rom cubic through ``profile`` between ``row`` (t = 0) and the next row (t = 1)."""
    p1 = profile[row]
    p2 = profile[row + 1]
    p0 = profile[max(row - 1, 0)]
    p3 = profile[min(row + 2, rows - 1)]
    s1 = 0.5 * (p2 - p0)
    s2 = 0.5 * (p3 - p1)
    rise = p2 - p1
    return p1 + t * (s1 + t * (3.0 * rise - 2.0 * s1 - s2 + t * (s1 + s2 - 2.0 * rise)))
