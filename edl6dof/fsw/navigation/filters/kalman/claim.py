"""From the error state to the solution: what is taken out of it, and how sure the filter says it is."""

from __future__ import annotations

from math import sqrt

from edl6dof.fsw.navigation.filters.kalman.antenna import level_axes
from edl6dof.fsw.navigation.filters.kalman.states import (
    ACCELEROMETER_BIAS,
    ATTITUDE_ERROR,
    GYRO_BIAS,
    POSITION,
    SLOPE,
    STATES,
    TERRAIN,
    VELOCITY,
)
from edl6dof.kernels import kernel
from edl6dof.spatial.quaternion import multiply, normalise
from edl6dof.spatial.vector import scale, take3


@kernel
def apply_correction(memory, solution):
    """Take the estimated error out of the solution."""
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


@kernel
def deviation(covariance, at, a):
    """Standard deviation of the component along ``a`` of the three states from ``at``."""
    total = 0.0
    for i in range(3):
        for j in range(3):
            total += a[i] * covariance[at + i, at + j] * a[j]
    return sqrt(max(total, 0.0))


@kernel
def relative_deviation(covariance, spin, a):
    """Standard deviation along ``a`` of the velocity relative to the planet, which a wrong position errs by
    ``spin`` (rad/s): dv - W x dr.
    """
    b = (-spin * a[1], spin * a[0], 0.0)
    total = 0.0
    for i in range(3):
        for j in range(3):
            total += a[i] * covariance[VELOCITY + i, VELOCITY + j] * a[j]
            total += b[i] * covariance[POSITION + i, POSITION + j] * b[j]
            total += 2.0 * a[i] * covariance[VELOCITY + i, POSITION + j] * b[j]
    return sqrt(max(total, 0.0))


@kernel
def claim(planet, covariance, solution):
    """Fill the standard deviations of the solution."""
    r_I, spin = take3(solution.r_I, 0), planet.rotation_rate
    north, east, up, _ = level_axes(planet, r_I, solution.t)
    for i, axis in enumerate((north, east, up)):
        solution.sigma_r[i] = deviation(covariance, POSITION, axis)
        solution.sigma_v[i] = relative_deviation(covariance, spin, axis)
        solution.sigma_attitude[i] = deviation(covariance, ATTITUDE_ERROR, axis)
    height = covariance[TERRAIN, TERRAIN] + deviation(covariance, POSITION, up) ** 2
    for i in range(3):
        height -= 2.0 * up[i] * covariance[POSITION + i, TERRAIN]
    solution.sigma_height = sqrt(max(height, 0.0))
