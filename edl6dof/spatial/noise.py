"""Noise that kernels make in flight: numbers that follow from a key and a counter alone.

So a flight has the same noise alone, in threads, or continued from a saved state.  Source: the mixing
function of SplitMix64 (Steele, Lea and Flood, OOPSLA 2014); Box and Muller (1958).
"""

from __future__ import annotations

from math import cos, log, pi, sin, sqrt

import numpy as np

from edl6dof.jit import kernel

_GOLDEN = np.uint64(0x9E37_79B9_7F4A_7C15)
_FIRST, _SECOND = np.uint64(0xBF58_476D_1CE4_E5B9), np.uint64(0x94D0_49BB_1331_11EB)
_30, _27, _31, _32, _11 = (np.uint64(bits) for bits in (30, 27, 31, 32, 11))
_LOW = np.uint64(0xFFFF_FFFF)


@kernel
def random_bits(key, counter):
    """64 random bits of (``key``, ``counter``), two whole numbers, as ``uint64``."""
    z = np.uint64(key) + np.uint64(counter) * _GOLDEN
    z = (z ^ (z >> _30)) * _FIRST
    z = (z ^ (z >> _27)) * _SECOND
    return z ^ (z >> _31)


@kernel
def normal_pair(key, counter):
    """Two independent standard normals of (``key``, ``counter``); none beyond 6.8, as they come from 32 bits
    each.
    """
    bits = random_bits(key, counter)
    radius = sqrt(-2.0 * log((float(bits >> _32) + 0.5) * 2.0**-32))
    angle = 2.0 * pi * float(bits & _LOW) * 2.0**-32
    return radius * cos(angle), radius * sin(angle)


@kernel
def uniform(key, counter):
    """A number of (``key``, ``counter``) spread evenly over 0 .. 1, without 1."""
    return float(random_bits(key, counter) >> _11) * 2.0**-53
