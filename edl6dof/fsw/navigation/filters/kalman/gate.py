"""Which readings are believed, and how far: chi-square gate, Huber weight, the beams against each other, and
the way back when the solution is wrong and not the beams.

Source: Bar-Shalom, Li and Kirubarajan, Estimation with Applications to Tracking and Navigation (2001), 5.4;
Karlgaard and Schaub, "Huber-based divided difference filtering", JGCD 30 (2007), eqs. 23-26.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.kernels import kernel


@kernel
def weighted_noise(innovation, variance, noise, gate, huber):
    """Noise variance with which a reading is taken in, or -1 where it lies beyond the gate.

    Args:
        innovation: what the reading differs from the expected one.
        variance: variance of that difference, noise included.
        noise: noise variance of the reading.
        gate: standard deviations beyond which it is refused.
        huber: those beyond which it counts less: as if its noise made it lie there.
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
    """Looks in a row, ``count`` before this one, in which more than half of the ``usable`` readings were
    ``refused``: one beam against the others is wrong itself, most beams at once are not.
    """
    if usable == 0:
        return count
    return count + 1 if 2 * refused > usable else 0
