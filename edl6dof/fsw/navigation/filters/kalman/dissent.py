"""Which of several readings, all taken before any is believed, agrees least with the rest and the solution.

Taken in one after the other, a wrong reading may come first and make the others look wrong.  Here all are
looked at together: with innovations n and their covariance S, leaving out reading i lets n'S^-1 n fall by
(S^-1 n)_i^2 / (S^-1)_ii, the square of a standard normal number as long as i is sound.

Source: W. Baarda, A testing procedure for use in geodetic networks, Netherlands Geodetic Commission (1968):
data snooping.
"""

from __future__ import annotations

from edl6dof.kernels import kernel

#: No reading.
NONE = -1


@kernel
def dissenting(gate, count, spread, innovation):
    """The reading to leave out of ``count``, or ``NONE``.

    Args:
        gate: standard deviations beyond which one is.
        count: how many there are.
        spread: covariance S of the innovations, positive definite; its inverse is left in it.
        innovation: what each differs from the expected one.
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
