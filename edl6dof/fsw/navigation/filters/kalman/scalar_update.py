"""The update of a covariance by one scalar reading, with considered errors.

Arrays: ``covariance`` of n states against m >= n states and considered errors; ``considered`` the variances
of the latter, from place n on; ``row`` what the reading sees of both; ``product`` = row times covariance.

Source: P. D. Joseph's form for a scalar, in Bierman, Factorization Methods for Discrete Sequential Estimation
(1977), chapter V; with consider states (gain zero) Woodbury and Junkins, AIAA 2010-7752.
"""

from __future__ import annotations

from edl6dof.kernels import kernel


@kernel
def predicted_variance(covariance, considered, row, product):
    """Variance of what the reading should be, its own noise left out; writes ``product``."""
    n, m = covariance.shape
    for j in range(m):
        product[j] = 0.0
    for i in range(n):
        if row[i] != 0.0:
            for j in range(m):
                product[j] += row[i] * covariance[i, j]
    for k in range(n, m):
        if row[k] != 0.0:
            product[k] += row[k] * considered[k]
            for i in range(n):
                product[i] += row[k] * covariance[i, k]
    variance = 0.0
    for j in range(m):
        variance += row[j] * product[j]
    return variance


@kernel
def expected_by(row, correction):
    """The part of an innovation that the correction found so far explains."""
    told = 0.0
    for i in range(correction.shape[0]):
        told += row[i] * correction[i]
    return told


@kernel
def weigh(product, variance, gain):
    """Write the ``gain`` that leaves the least variance, for a reading of ``variance``, noise included."""
    for i in range(gain.shape[0]):
        gain[i] = product[i] / variance


@kernel
def fold_in(covariance, product, gain, correction, variance, innovation):
    """Take in a reading of the ``innovation`` with its ``variance``, noise included, by any ``gain``.

    The covariance stays symmetric to the last bit.
    """
    n, m = covariance.shape
    for i in range(n):
        correction[i] += gain[i] * innovation
    for i in range(n):
        for j in range(n):
            covariance[i, j] += variance * (gain[i] * gain[j]) - (gain[i] * product[j] + product[i] * gain[j])
        for j in range(n, m):
            covariance[i, j] -= gain[i] * product[j]
