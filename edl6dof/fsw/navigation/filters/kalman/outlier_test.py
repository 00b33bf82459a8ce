"""Outlier tests of readings: chi-square gate, Huber weight, and the beams against each other.

Readings that are used one after the other may meet a wrong one first, which makes the others look wrong.
Before any is used, all are therefore tested together: with innovations n and their covariance S, leaving out
reading i lets n'S^-1 n fall by (S^-1 n)_i^2 / (S^-1)_ii, the square of a standard normal number as long as
reading i is correct (data snooping).  When most readings are refused again and again, the solution is wrong
and not the readings.

Sources: W. Baarda, A testing procedure for use in geodetic networks, Netherlands Geodetic Commission (1968);
gate: Bar-Shalom, Li and Kirubarajan, Estimation with Applications to Tracking and Navigation (2001), 5.4;
weight: Karlgaard and Schaub, "Huber-based divided difference filtering", JGCD 30 (2007), eqs. 23-26.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.kernels import kernel


@kernel
def weighted_noise(innovation, variance, noise, gate, huber):
    """Noise variance to use for a reading, or -1 where it lies beyond the gate.

    Args:
        innovation: reading less expected reading.
        variance: variance of that difference, noise included.
        noise: noise variance of the reading.
        gate: standard deviations beyond which it is refused.
        huber: those beyond which its noise is enlarged, so that it lies there.
    """
    deviation = abs(innovation) / sqrt(variance)
    if deviation > gate:
        return -1.0
    if deviation > huber:
        return noise + variance * (deviation / huber - 1.0)
    return noise


@kernel
def median(values, count, ordered):
    """Median of the first ``count`` values, at least one; ``ordered`` is workspace."""
    for i in range(count):
        k = i
        while k > 0 and ordered[k - 1] > values[i]:
            ordered[k] = ordered[k - 1]
            k -= 1
        ordered[k] = values[i]
    return 0.5 * (ordered[(count - 1) // 2] + ordered[count // 2])


@kernel
def refused_again(count, refused, usable):
    """Count of looks in a row (``count`` before this one) in which more than half of the ``usable`` readings
    were ``refused``: one beam against the others is wrong itself, most beams at once are not.
    """
    if usable == 0:
        return count
    return count + 1 if 2 * refused > usable else 0


#: No reading.
NONE = -1


@kernel
def outlier(gate, count, spread, innovation):
    """Index of the reading to leave out of ``count``, or ``NONE``.

    Args:
        gate: standard deviations beyond which a reading is an outlier.
        count: number of readings.
        spread: covariance S of the innovations, positive definite; its inverse is left in it.
        innovation: each reading less its expected value.
    """
    invert(count, spread)
    found, most = NONE, gate * gate
    for i in range(count):
        weighed = 0.0
        for j in range(count):
            weighed += spread[i, j] * innovation[j]
        fall = weighed * weighed / spread[i, i]
        if fall > most:
            found, most = i, fall
    return found


@kernel
def invert(count, a):
    """Invert the first ``count`` rows and columns of a positive definite matrix in place (Gauss-Jordan)."""
    for k in range(count):
        pivot = 1.0 / a[k, k]
        a[k, k] = 1.0
        for j in range(count):
            a[k, j] *= pivot
        for i in range(count):
            if i != k:
                factor = a[i, k]
                a[i, k] = 0.0
                for j in range(count):
                    a[i, j] -= factor * a[k, j]
