"""Measurement update of covariance and error state by one scalar reading, with considered errors; the outlier
tests of readings; and the update by the star tracker, three scalars.

Arrays: ``covariance`` of n states against m >= n states and considered errors; ``considered`` the variances
of the considered errors, from index n on; ``row`` the sensitivity of the reading to both; ``product`` = row
times covariance.

If readings are used one after the other and a wrong one comes first, the others seem wrong. All readings are
therefore tested together before use: with innovations n and their covariance S, leaving out reading i lets
n'S^-1 n fall by (S^-1 n)_i^2 / (S^-1)_ii, the square of a standard normal number as long as reading i is
correct (data snooping). Half the difference of the falls of two readings is the logarithm of the likelihood
ratio of the hypotheses that the one or the other is wrong: readings whose falls are nearly equal, such as
those of four beams on one cone, show that one of them is wrong, but not which. When most readings are refused
repeatedly, the solution counts as wrong instead of the readings.

Sources: P. D. Joseph's form for a scalar, in Bierman, Factorization Methods for Discrete Sequential
Estimation (1977), chapter V; with consider states (gain zero) Woodbury and Junkins, AIAA 2010-7752; W.
Baarda, A testing procedure for use in geodetic networks, Netherlands Geodetic Commission (1968); gate:
Bar-Shalom, Li and Kirubarajan, Estimation with Applications to Tracking and Navigation (2001), 5.4; weight:
Karlgaard and Schaub, "Huber-based divided difference filtering", JGCD 30 (2007), eqs. 23-26; star fix:
Markley and Crassidis, Fundamentals of Spacecraft Attitude Determination and Control (2014), 6.2.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.fsw.navigation.filters.kalman.states import (
    ACCELEROMETER_BIAS,
    ATTITUDE_ERROR,
    GYRO_BIAS,
    POSITION,
    SLOPE,
    STAR_BIAS,
    STATES,
    TERRAIN,
    VELOCITY,
    WIDTH,
)
from edl6dof.fsw.navigation.strapdown import attitude_at
from edl6dof.kernels import kernel
from edl6dof.spatial.quaternion import axes, conjugate, multiply, normalise, rotation_vector
from edl6dof.spatial.vector import dot, put3, put4, scale, take3, take4, unit


@kernel
def weighted_noise(innovation, variance, noise, gate, huber):
    """Noise variance with which to use a reading, or -1 if it is beyond the gate.

    Args:
        innovation: reading less expected reading.
        variance, noise: variance of the innovation, noise included; noise variance of the reading.
        gate: standard deviations beyond which the reading is refused.
        huber: standard deviations beyond which its noise is enlarged.
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
    """Update the count of looks in a row in which more than half of the ``usable`` readings were
    ``refused``.
    """
    if usable == 0:
        return count
    return count + 1 if 2 * refused > usable else 0


#: No reading; difference of the falls of two readings from which on the larger one identifies the wrong
#: reading (it is exp(4.5) = 90 times as likely).
NONE, DISTINCT = -1, 9.0


@kernel
def outlier(gate, count, spread, innovation):
    """Index of the reading to leave out of ``count``, or ``NONE``; and the largest square of a reading if one
    is wrong but not identified, as another one may be wrong instead; else one.

    Args:
        gate: standard deviations beyond which a reading is an outlier.
        count: number of readings.
        spread: covariance S of the innovations, positive definite; overwritten by its inverse.
        innovation: each reading less its expected value.
    """
    invert(count, spread)
    found, most, second = NONE, 0.0, 0.0
    for i in range(count):
        weighed = 0.0
        for j in range(count):
            weighed += spread[i, j] * innovation[j]
        fall = weighed * weighed / spread[i, i]
        if fall > most:
            found, most, second = i, fall, most
        else:
            second = max(second, fall)
    if most <= gate * gate:
        return NONE, 1.0
    return (found, 1.0) if most - second > DISTINCT else (NONE, most)


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


@kernel
def predicted_variance(covariance, considered, row, product):
    """Variance of the expected reading without noise; writes ``product``."""
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
    return explained_by(row, product)


@kernel
def explained_by(row, errors):
    """Part of a reading of sensitivity ``row``, most of it zero, that ``errors`` explain."""
    explained = 0.0
    for i in range(errors.shape[0]):
        if row[i] != 0.0:
            explained += row[i] * errors[i]
    return explained


@kernel
def find_outlier(gate, doubt, at, n_beams, present, healthy, memory):
    """Index of the wrong reading among the trusted ones, or ``NONE``; if one is wrong but not identified, the
    noise of all is increased, to which it then conforms.

    A missing reading enters with zero innovation and without correlations. The velocity, at index ``at`` of a
    row, may have a further error of standard deviation ``doubt`` (m/s).
    """
    spread, rest = memory.spread, memory.rest
    for i in range(n_beams):
        for j in range(i + 1):
            spread[i, j] = spread[j, i] = 0.0
        rest[i], spread[i, i] = 0.0, 1.0
        if present >> i & 1 and healthy[i] != 0:
            row = memory.rows[i]
            own = predicted_variance(memory.covariance, memory.considered, row, memory.product)
            rest[i] = memory.innovation[i] - explained_by(row, memory.correction)
            v = scale(doubt**2, take3(row, at))
            spread[i, i] = own + memory.noise[i] + dot(v, take3(row, at))
            for j in range(i):
                if present >> j & 1 and healthy[j] != 0:
                    common = explained_by(memory.rows[j], memory.product)
                    common += dot(v, take3(memory.rows[j], at))
                    spread[i, j] = spread[j, i] = common
    wrong, memory.doubted = outlier(gate, n_beams, spread, rest)
    for i in range(n_beams):
        if present >> i & 1:
            memory.noise[i] *= memory.doubted
    return wrong


@kernel
def optimal_gain(memory, variance):
    """Write the gain of least variance for a reading into ``memory``; ``variance``: of the innovation, noise
    included.
    """
    for i in range(memory.gain.shape[0]):
        memory.gain[i] = memory.product[i] / variance


@kernel
def apply_gain(memory, variance, innovation):
    """Update covariance and correction by a reading with ``memory.gain``, which need not be optimal;
    ``variance``: of the ``innovation``, noise included. The covariance stays symmetric to the last bit.
    """
    covariance, product, gain = memory.covariance, memory.product, memory.gain
    n, m = covariance.shape
    for i in range(n):
        memory.correction[i] += gain[i] * innovation
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

    Radar and star tracker observe the horizontal position only through the direction of the vertical: an
    error of a hundred metres changes it by as little as 3e-5 rad, which is less than the effect of misaligned
    beams, slopes and the gravity of mountains. The horizontal position is therefore considered, with its
    correlations, and not estimated.
    """
    put3(gain, POSITION, scale(dot(up, take3(gain, POSITION)), up))


@kernel
def update_by_reading(params, noise, innovation, up, trusted, row, memory):
    """Update with a reading of sensitivity ``row``, if it passes the gate and is ``trusted``. Returns its
    normalised innovation, and whether it passes the gate.
    """
    own = predicted_variance(memory.covariance, memory.considered, row, memory.product)
    rest = innovation - explained_by(row, memory.correction)
    variance = own + noise
    weighted = weighted_noise(rest, variance, noise, params.gate, params.huber)
    if trusted and weighted >= 0.0:
        optimal_gain(memory, own + weighted)
        hold_horizontal(up, memory.gain)
        apply_gain(memory, own + weighted, rest)
    return rest / sqrt(variance), weighted >= 0.0


@kernel
def apply_correction(memory, solution):
    """Add the estimated errors to the solution, and reset them."""
    found = memory.correction
    half = scale(0.5, take3(found, ATTITUDE_ERROR))
    q = take4(solution.q_I2B)
    q = normalise(multiply((1.0, half[0], half[1], half[2]), q))
    put4(solution.q_I2B, q)
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


@kernel
def reconsider(at, variance, share, memory):
    """Set the variance of the considered error ``at``: a ``share`` of the error before, and a new part."""
    memory.considered[at] = variance
    for i in range(STATES):
        memory.covariance[i, at] *= share


@kernel
def update_by_stars(params, onboard, sensed, motion, solution, memory):
    """Update covariance and correction with a star fix, the mean of all trackers in use."""
    q = attitude_at(solution, motion, sensed.t)
    turn = rotation_vector(multiply(take4(motion.fix_q_I2B), conjugate(q)))
    x, y, z = axes(q)
    row, refused = memory.row, 0
    noise = onboard.instruments.star_sigma**2 / motion.fixes + motion.fix_doubt
    bias = onboard.instruments.star_bias**2 / motion.fixes
    for at in range(STAR_BIAS, STAR_BIAS + 3):
        share = bias / max(memory.considered[at], 1e-30)
        reconsider(at, bias, min(share, 1.0), memory)
    up = unit(take3(solution.r_I, 0))
    for i in range(3):
        clear_row(row)
        row[ATTITUDE_ERROR + i] = 1.0
        row[STAR_BIAS], row[STAR_BIAS + 1], row[STAR_BIAS + 2] = x[i], y[i], z[i]
        _, taken = update_by_reading(params, noise, turn[i], up, True, row=row, memory=memory)
        refused += not taken
    memory.fixes_refused = refused_again(memory.fixes_refused, refused, 1)
    if memory.fixes_refused >= params.patience:
        for i in range(3):
            memory.covariance[ATTITUDE_ERROR + i, ATTITUDE_ERROR + i] += dot(turn, turn)
        memory.fixes_refused = 0
    memory.stars_t = sensed.t
