"""Random numbers, the same on every machine: in flight by key and counter, on the host one after another.

A number that kernels draw follows from a key and a counter alone, so a flight has the same noise alone, in
threads, or continued from a saved state.  On the host, :class:`Stream` takes the raw bits of the
counter-based generator Philox, started by numpy's ``SeedSequence``; numpy keeps both unchanged.  numpy does
not guarantee this for its ``Generator``, whose normals call the C library in their tails; the normals here
are quantiles of the bits.

Sources: SplitMix64 (Steele, Lea and Flood, OOPSLA 2014); quantiles in flight: Wichura, Applied Statistics
37(3), 1988, algorithm AS 241 (PPND7), seven digits in half the time; Philox: Salmon et al., SC11 (2011).
"""

from __future__ import annotations

from math import prod, sqrt
from typing import Any

import numpy as np

from edl6dof.kernels import kernel
from edl6dof.spatial import arrays
from edl6dof.spatial.elementary import log

_GOLDEN = np.uint64(0x9E37_79B9_7F4A_7C15)
_FIRST, _SECOND = np.uint64(0xBF58_476D_1CE4_E5B9), np.uint64(0x94D0_49BB_1331_11EB)
_2, _11, _27, _30, _31, _32 = (np.uint64(bits) for bits in (2, 11, 27, 30, 31, 32))
_LOW = np.uint64(0xFFFF_FFFF)


@kernel
def random_bits(key, counter):
    """64 random bits of (``key``, ``counter``), two whole numbers, as ``uint64``."""
    z = np.uint64(key) + np.uint64(counter) * _GOLDEN
    z = (z ^ (z >> _30)) * _FIRST
    z = (z ^ (z >> _27)) * _SECOND
    return z ^ (z >> _31)


@kernel
def random_bits_at(key, i, j):
    """64 random bits of (``key``, ``i``, ``j``), three whole numbers, of the last two the lower 32 bits."""
    return random_bits(key, (np.uint64(i) << _32) | (np.uint64(j) & _LOW))


@kernel
def normal_pair(key, counter):
    """Two independent standard normals of (``key``, ``counter``), each of 32 bits: none exceeds 6.4."""
    bits = random_bits(key, counter)
    low, high = float(bits & _LOW), float(bits >> _32)
    return normal_quantile((low + 0.5) * 2.0**-32), normal_quantile((high + 0.5) * 2.0**-32)


@kernel
def normal_quantile(share):
    """Quantile of the standard normal distribution at probability ``share``, 0 .. 1, to seven digits."""
    q = share - 0.5
    if abs(q) <= 0.425:
        r = 0.180625 - q * q
        over = ((59.109374720 * r + 159.29113202) * r + 50.434271938) * r + 3.3871327179
        return q * over / (((67.187563600 * r + 78.757757664) * r + 17.895169469) * r + 1.0)
    r = sqrt(-log(share if q < 0.0 else 1.0 - share))
    if r <= 5.0:
        r -= 1.6
        over = ((0.17023821103 * r + 1.3067284816) * r + 2.7568153900) * r + 1.4234372777
        size = over / ((0.12021132975 * r + 0.73700164250) * r + 1.0)
    else:
        r -= 5.0
        over = ((0.017337203997 * r + 0.42868294337) * r + 3.0812263860) * r + 6.6579051150
        size = over / ((0.012258202635 * r + 0.24197894225) * r + 1.0)
    return -size if q < 0.0 else size


@kernel
def uniform(key, counter):
    """Number of (``key``, ``counter``), uniform over 0 .. 1, without 1."""
    return float(random_bits(key, counter) >> _11) * 2.0**-53


class Stream:
    """Random numbers that belong to a seed of several integers."""

    def __init__(self, *seed: int) -> None:
        self._bits = np.random.Philox(np.random.SeedSequence(seed))

    def uniform(self, shape: Any = ()) -> Any:
        """Numbers spread evenly over 0 .. 1, without 1."""
        return (self._raw(shape) >> _11).astype(float) * 2.0**-53

    def standard_normal(self, shape: Any = ()) -> Any:
        """Standard normals; none beyond 8.3."""
        return arrays.normal_quantile(((self._raw(shape) >> _11).astype(float) + 0.5) * 2.0**-53)

    def integers(self, below: int, shape: Any = ()) -> Any:
        """Integers from 0 on, below a number of at most 32 bits."""
        return ((self._raw(shape) >> _32) * np.uint64(below) >> _32).astype(np.int64)

    def keys(self, shape: Any = ()) -> Any:
        """Keys of 62 bits for :func:`random_bits`."""
        return (self._raw(shape) >> _2).astype(np.int64)

    def _raw(self, shape: Any) -> Any:
        shape = tuple(np.atleast_1d(np.asarray(shape, dtype=int)))
        return np.asarray(self._bits.random_raw(prod(shape))).reshape(shape)
