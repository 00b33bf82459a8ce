"""Where a number lies in a table: the one place that makes an index out of a float.

Whatever the float, infinite or not a number, the index lies within the table; what is not a number stays one
in the share, so that what is read with it is none either.
"""

from __future__ import annotations

from math import floor

from edl6dof.kernels import kernel


@kernel
def cell(position, cells):
    """Index 0 .. ``cells`` - 1 of the cell that ``position`` (in cells from the first node) lies in, and the
    position from its lower node.

    The second is 0..1 inside the table, and outside it the distance beyond, from the node below the first or
    last cell.
    """
    if position >= cells - 1:
        return cells - 1, position - (cells - 1)
    if position >= 0.0:
        index = int(position)
        return index, position - index
    return 0, position


@kernel
def endless_cell(position):
    """Index of the cell that ``position`` (in cells) lies in, on a lattice that goes on for ever both ways; 0
    for what is no place on it.
    """
    return int(floor(position)) if abs(position) < 2.0**52 else 0


@kernel
def held(share):
    """A position within a cell, held at both ends of the table."""
    if share < 0.0:
        return 0.0
    if share > 1.0:
        return 1.0
    return share


@kernel
def held_cell(position, cells):
    """Index of the cell and share of the way to its upper node (0..1), both held beyond the ends of the
    table.
    """
    index, share = cell(position, cells)
    return index, held(share)


@kernel
def cell_among(nodes, count, value):
    """Index of the cell among the first ``count`` (2 or more) rising ``nodes`` that ``value`` lies in, and
    the share of the way across it.

    Both are held beyond the ends.
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
    """On the straight line from ``values[index]`` to the next."""
    return values[index] + share * (values[index + 1] - values[index])


@kernel
def wrapped(angle, turn):
    """``angle`` less whole turns: 0 .. ``turn``."""
    return angle - turn * endless_cell(angle / turn)
