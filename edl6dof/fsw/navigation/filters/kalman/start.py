"""The covariance with which the filter starts."""

from __future__ import annotations

from edl6dof.fsw.navigation.filters.kalman.process_noise import add_block, spread_of
from edl6dof.fsw.navigation.filters.kalman.states import (
    ACCELEROMETER_BIAS,
    ACCELEROMETER_SCALE,
    ATTITUDE_ERROR,
    GYRO_BIAS,
    GYRO_SCALE,
    POSITION,
    RANGE_BIAS,
    RANGE_SCALE,
    SLOPE,
    SPEED_SCALE,
    STAR_BIAS,
    STATES,
    TERRAIN,
    VELOCITY,
    WIDTH,
)
from edl6dof.fsw.navigation.filters.kalman.transition import begin_interval
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import tan
from edl6dof.spatial.quaternion import axes


@kernel
def consider(instruments, gyro_spread, accelerometer_spread, considered):
    """Write the variances of the errors that the readings share."""
    for k in range(9):
        i = k % 3
        considered[GYRO_SCALE + k] = instruments.gyro_scale**2 * gyro_spread[i, i]
        considered[ACCELEROMETER_SCALE + k] = instruments.accelerometer_scale**2 * accelerometer_spread[i, i]
    for i in range(3):
        considered[STAR_BIAS + i] = instruments.star_bias**2
    for beam in range(instruments.n_beams):
        considered[RANGE_SCALE + beam] = instruments.range_scale**2
        considered[SPEED_SCALE + beam] = instruments.speed_scale**2
        considered[RANGE_BIAS + beam] = instruments.range_bias**2


@kernel
def reopen_slope(params, covariance):
    """Let the slope be any that ground may have."""
    for i in range(SLOPE, SLOPE + 2):
        covariance[i, i] = max(covariance[i, i], tan(params.slope_sigma) ** 2)


@kernel
def begin(params, instruments, solution, memory):
    """Fill ``memory`` for a solution that ground tracking and the star tracker have just started.

    The attitude errs as the fix does, by its noise and by the bias that all later fixes share.
    """
    covariance = memory.covariance
    for i in range(STATES):
        memory.correction[i] = 0.0
        for j in range(WIDTH):
            covariance[i, j] = 0.0
    q = (solution.q_I2B[0], solution.q_I2B[1], solution.q_I2B[2], solution.q_I2B[3])
    x, y, z = axes(q)
    fix = instruments.star_sigma**2 + instruments.star_bias**2
    for i in range(3):
        covariance[POSITION + i, POSITION + i] = instruments.tracking_position_sigma[i] ** 2
        covariance[VELOCITY + i, VELOCITY + i] = instruments.tracking_velocity_sigma[i] ** 2
        covariance[ATTITUDE_ERROR + i, ATTITUDE_ERROR + i] = fix
        covariance[ATTITUDE_ERROR + i, STAR_BIAS] = -x[i] * instruments.star_bias**2
        covariance[ATTITUDE_ERROR + i, STAR_BIAS + 1] = -y[i] * instruments.star_bias**2
        covariance[ATTITUDE_ERROR + i, STAR_BIAS + 2] = -z[i] * instruments.star_bias**2
    covariance[TERRAIN, TERRAIN] = params.terrain_sigma**2
    reopen_slope(params, covariance)
    _begin_biases(instruments, memory)
    consider(instruments, memory.gyro_spread, memory.accelerometer_spread, memory.considered)
    begin_interval(memory.interval)
    memory.ranges_refused, memory.speeds_refused, memory.fixes_refused = 0, 0, 0
    memory.plane_seen = 0
    memory.unknown_rate_time, memory.unknown_force_time = 0.0, 0.0
    memory.stars_t = memory.radar_t = solution.t


@kernel
def _begin_biases(instruments, memory):
    """With all instruments in use, whose biases are as their sheets say."""
    healthy = (1 << instruments.n_gyros) - 1
    memory.gyros_in_use = healthy
    spread_of(instruments.gyro_axis, healthy, instruments.n_gyros, memory.gyro_spread)
    add_block(memory.covariance, GYRO_BIAS, instruments.gyro_bias**2, memory.gyro_spread)
    healthy = (1 << instruments.n_accelerometers) - 1
    memory.accelerometers_in_use = healthy
    spread = memory.accelerometer_spread
    spread_of(instruments.accelerometer_axis, healthy, instruments.n_accelerometers, spread)
    add_block(memory.covariance, ACCELEROMETER_BIAS, instruments.accelerometer_bias**2, spread)
