"""Numbers drawn one after another on the host, the same on every machine and with every version of numpy.

The raw bits are those of the counter-based generator Philox (Salmon et al., SC11, 2011), started by numpy's
``SeedSequence``; numpy keeps both as they are for good.  It does not promise that of its ``Generator``, whose
normals call the C library in their tails; normals are made of the bits by their quantiles instead.
"""

from __future__ import annotations

from math import prod
from typing import Any

import numpy as np

from edl6dof.spatial.arrays import normal_quantile

_32, _11, _2 = np.uint64(32), np.uint64(11), np.uint64(2)


class Stream:
    """The numbers that belong to a seed of several integers."""

    def __init__(self, *seed: int) -> None:
        self._bits = np.random.Philox(np.random.SeedSequence(seed))

    def uniform(self, shape: Any = ()) -> Any:
        """Numbers spread evenly over 0 .. 1, without 1."""
        return (self._raw(shape) >> _11).astype(float) * 2.0**-53

    def standard_normal(self, shape: Any = ()) -> Any:
        """Standard normals; none beyond 8.3."""
        return normal_quantile(((self._raw(shape) >> _11).astype(float) + 0.5) * 2.0**-53)

    def integers(self, below: int, shape: Any = ()) -> Any:
        """Integers from 0 on, below a number of at most 32 bits."""
        return ((self._raw(shape) >> _32) * np.uint64(below) >> _32).astype(np.int64)

    def keys(self, shape: Any = ()) -> Any:
        """Keys of 62 bits for :mod:`edl6dof.spatial.noise`."""
        return (self._raw(shape) >> _2).astype(np.int64)

    def _raw(self, shape: Any) -> Any:
        shape = tuple(np.atleast_1d(np.asarray(shape, dtype=int)))
        return np.asarray(self._bits.random_raw(prod(shape))).reshape(shape)
