"""Measurement update of covariance and error state by one scalar reading, with considered errors.

Arrays: ``covariance`` of n states against m >= n states and considered errors; ``considered`` the variances
of the latter, from place n on; ``row`` the sensitivity of the reading to both; ``product`` = row times
covariance.

Source: P. D. Joseph's form for a scalar, in Bierman, Factorization Methods for Discrete Sequential Estimation
(1977), chapter V; with consider states (gain zero) Woodbury and Junkins, AIAA 2010-7752.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.fsw.navigation.filters.kalman.outlier_test import weighted_noise
from edl6dof.fsw.navigation.filters.kalman.states import (
    ACCELEROMETER_BIAS,
    ATTITUDE_ERROR,
    GYRO_BIAS,
    POSITION,
    SLOPE,
    STATES,
    TERRAIN,
    VELOCITY,
    WIDTH,
)
from edl6dof.kernels import kernel
from edl6dof.spatial.quaternion import multiply, normalise
from edl6dof.spatial.vector import dot, put3, scale, take3


@kernel
def predicted_variance(covariance, considered, row, product):
    """Variance of the expected reading, without its own noise; writes ``product``."""
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
def explained_by(row, correction):
    """Part of an innovation that the correction found so far explains."""
    explained = 0.0
    for i in range(correction.shape[0]):
        explained += row[i] * correction[i]
    return explained


@kernel
def optimal_gain(product, variance, gain):
    """Write the ``gain`` of least variance for a reading of ``variance``, noise included."""
    for i in range(gain.shape[0]):
        gain[i] = product[i] / variance


@kernel
def apply_gain(covariance, product, gain, correction, variance, innovation):
    """Update covariance and correction with a reading of the ``innovation`` and its ``variance``, noise
    included, by any ``gain``.

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


@kernel
def clear_row(row):
    """Set a row to zero."""
    for j in range(WIDTH):
        row[j] = 0.0


@kernel
def hold_horizontal(up, gain):
    """Restrict the position update to the direction ``up``.

    Radar and stars observe the horizontal position through the direction of the vertical alone: a few
    micrometres per second squared for a hundred metres, less than the effect of misaligned beams, slopes and
    the gravity of mountains.  It is therefore considered, with its correlations, and not estimated.
    """
    put3(gain, POSITION, scale(dot(up, take3(gain, POSITION)), up))


@kernel
def update_by_reading(params, noise, innovation, up, trusted, row, memory):
    """Update covariance and correction with a reading of sensitivity ``row``, if it passes the gate and is
    ``trusted``.

    Returns its innovation over its standard deviation, and whether it passes the gate.
    """
    own = predicted_variance(memory.covariance, memory.considered, row, memory.product)
    rest = innovation - explained_by(row, memory.correction)
    variance = own + noise
    weighted = weighted_noise(rest, variance, noise, params.gate, params.huber)
    if trusted and weighted >= 0.0:
        optimal_gain(memory.product, own + weighted, memory.gain)
        hold_horizontal(up, memory.gain)
        apply_gain(
            memory.covariance,
            memory.product,
            memory.gain,
            memory.correction,
            variance=own + weighted,
            innovation=rest,
        )
    return rest / sqrt(variance), weighted >= 0.0


@kernel
def apply_correction(memory, solution):
    """Move the estimated error from the filter into the solution."""
    found = memory.correction
    half = scale(0.5, take3(found, ATTITUDE_ERROR))
    q = (solution.q_I2B[0], solution.q_I2B[1], solution.q_I2B[2], solution.q_I2B[3])
    q = normalise(multiply((1.0, half[0], half[1], half[2]), q))
    for i in range(4):
        solution.q_I2B[i] = q[i]
    for i in range(3):
        solution.r_I[i] += found[POSITION + i]
        solution.v_I[i] += found[VELOCITY + i]
        solution.gyro_bias[i] += found[GYRO_BIAS + i]
        solution.accelerometer_bias[i] += found[ACCELEROMETER_BIAS + i]
    solution.terrain += found[TERRAIN]
    for i in range(2):
        solution.slope[i] += found[SLOPE + i]
    for i in range(STATES):
        found[i] = 0.0
