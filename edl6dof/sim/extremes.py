"""Largest magnitudes of columns of a telemetry log, which is larger than the caches: one pass over the rows for all of them."""

from __future__ import annotations

from math import nan

import numpy as np

from edl6dof.jit import kernel

#: Rows that stay in the nearest cache while one column after the other is looked at.
_BLOCK = 64
#: All bits of a number but its sign.  Magnitudes are in the order of these as integers, what is not a number above all.
_MAGNITUDE = np.int64(0x7FFF_FFFF_FFFF_FFFF)


def largest(log: np.ndarray, words: np.ndarray) -> np.ndarray:
    """Largest magnitude over all rows of the numbers that stand ``words`` eight-byte words from the start of a row.

    ``nan`` of no rows, and where a number is not one.
    """
    if not len(log):
        return np.full(len(words), nan)
    found = np.zeros(len(words), np.int64)
    _largest(log.view(np.int64).reshape(len(log), log.itemsize // 8), words, found)
    return found.view(np.float64)


@kernel
def _largest(rows, words, found):
    for first in range(0, len(rows), _BLOCK):
        last = min(first + _BLOCK, len(rows))
        for k in range(len(words)):
            column, best = words[k], found[k]
            for i in range(first, last):
                best = max(best, rows[i, column] & _MAGNITUDE)
            found[k] = best
