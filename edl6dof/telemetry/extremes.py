"""Extremes of what columns of a telemetry log give together: one pass over the rows, as a log is larger than
the caches.

A log is looked at as rows of eight-byte words, and a column is its place in a row.
"""

from __future__ import annotations

from math import isnan, nan, sqrt

import numpy as np

from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import tan

#: Rows that stay in the nearest cache while one column after the other is looked at.
_BLOCK = 64
#: All bits of a number but its sign.  Magnitudes are in the order of these as integers, what is not a number
#: above all.
_MAGNITUDE = np.int64(0x7FFF_FFFF_FFFF_FFFF)


def largest(log: np.ndarray, words: np.ndarray) -> np.ndarray:
    """Largest magnitude over all rows of the numbers that stand ``words`` eight-byte words from the start of
    a row.

    ``nan`` of no rows, and where a number is not one.
    """
    if not len(log):
        return np.full(len(words), nan)
    found = np.zeros(len(words), np.int64)
    _largest(rows_of_words(log, np.int64), words, found)
    return found.view(np.float64)


def longest(log: np.ndarray, words: np.ndarray) -> float:
    """Largest length over all rows of the vector of some columns; ``nan`` of no rows, and where a number is
    not one.
    """
    return sqrt(_longest(rows_of_words(log), words)) if len(log) else nan


def nearest(log: np.ndarray, a: np.ndarray, b: np.ndarray) -> float:
    """Least distance of two points, columns ``a`` and ``b``, over the rows that have both; ``nan`` where none
    has.
    """
    return _nearest(rows_of_words(log), a, b)


def fastest_turns(log: np.ndarray, rates: np.ndarray, roll: int, angles: np.ndarray) -> np.ndarray:
    """Largest magnitude over all rows of rate - roll tan(angle) for each rate and angle, rad/s.

    ``nan`` of no rows, and where a number is not one.
    """
    found = np.full(len(rates), 0.0 if len(log) else nan)
    _fastest_turns(rows_of_words(log), rates, roll, angles, found)
    return found


def rows_of_words(log: np.ndarray, kind: type = np.float64) -> np.ndarray:
    """A log as a table of numbers of eight bytes."""
    return log.view(kind).reshape(len(log), log.itemsize // 8)


@kernel
def _largest(rows, words, found):
    for first in range(0, len(rows), _BLOCK):
        last = min(first + _BLOCK, len(rows))
        for k in range(len(words)):
            column, best = words[k], found[k]
            for i in range(first, last):
                best = max(best, rows[i, column] & _MAGNITUDE)
            found[k] = best


@kernel
def _longest(rows, words):
    best = 0.0
    for i in range(len(rows)):
        square = 0.0
        for k in range(len(words)):
            square += rows[i, words[k]] * rows[i, words[k]]
        if not square <= best:
            best = square
        if isnan(square):
            break
    return best


@kernel
def _nearest(rows, a, b):
    best, found = 0.0, False
    for i in range(len(rows)):
        square = 0.0
        for k in range(len(a)):
            apart = rows[i, a[k]] - rows[i, b[k]]
            square += apart * apart
        if square <= best or (not found and not isnan(square)):
            best, found = square, True
    return sqrt(best) if found else nan


@kernel
def _fastest_turns(rows, rates, roll, angles, found):
    for i in range(len(rows)):
        p = rows[i, roll]
        for k in range(len(rates)):
            rate, angle = rows[i, rates[k]], rows[i, angles[k]]
            # most rows need no tangent, which below half a radian is less than 1.1 times its angle
            if abs(angle) < 0.5 and abs(rate) + 1.1 * abs(p * angle) <= found[k]:
                continue
            turn = abs(rate - p * tan(angle))
            if turn > found[k] or isnan(turn):
                found[k] = turn
