"""What the error state gains by chance: random walks of the instruments, their wandering biases, ground that
rises and falls, and motion that no instrument followed.
"""

from __future__ import annotations

from math import pi

from edl6dof.fsw.navigation.filters.kalman.states import (
    ACCELEROMETER_BIAS,
    ATTITUDE_ERROR,
    GYRO_BIAS,
    SLOPE,
    TERRAIN,
    VELOCITY,
)
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import tan
from edl6dof.spatial.quaternion import axes
from edl6dof.spatial.vector import cross, dot, inertia_solve, norm, scale, sub

#: Variance about one axis (rad2) of an attitude of which nothing is known.
ANYHOW = pi * pi / 3.0
#: Height (m) below which the beams meet the same ground.
LOWEST = 5.0


@kernel
def in_use(healthy, count):
    """Bits of the instruments in use."""
    bits = 0
    for k in range(count):
        if healthy[k] != 0:
            bits |= 1 << k
    return bits


@kernel
def spread_of(axis, bits, count, out):
    """Write the inverse of H'H of the instruments in ``bits`` into ``out``; leave it where they do not span
    the space.
    """
    xx, yy, zz, xy, xz, yz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(count):
        if bits >> k & 1:
            x, y, z = axis[k, 0], axis[k, 1], axis[k, 2]
            xx, yy, zz = xx + x * x, yy + y * y, zz + z * z
            xy, xz, yz = xy + x * y, xz + x * z, yz + y * z
    tensor = (xx, yy, zz, xy, xz, yz)
    volume = dot((xx, xy, xz), cross((xy, yy, yz), (xz, yz, zz)))
    if volume > 1e-6:
        for i in range(3):
            unit = (1.0 if i == 0 else 0.0, 1.0 if i == 1 else 0.0, 1.0 if i == 2 else 0.0)
            out[i, 0], out[i, 1], out[i, 2] = inertia_solve(tensor, unit)


@kernel
def add_block(covariance, at, variance, spread):
    """Add ``variance`` times a 3 x 3 matrix to a diagonal block."""
    for i in range(3):
        for j in range(3):
            covariance[at + i, at + j] += variance * spread[i, j]


@kernel
def add_turned(covariance, at, variance, spread, q):
    """Add ``variance`` times a 3 x 3 matrix, given in B, to a diagonal block in I."""
    x, y, z = axes(q)
    for i in range(3):
        half = (
            x[i] * spread[0, 0] + y[i] * spread[1, 0] + z[i] * spread[2, 0],
            x[i] * spread[0, 1] + y[i] * spread[1, 1] + z[i] * spread[2, 1],
            x[i] * spread[0, 2] + y[i] * spread[1, 2] + z[i] * spread[2, 2],
        )
        for j in range(i + 1):
            value = variance * dot(half, (x[j], y[j], z[j]))
            covariance[at + i, at + j] += value
            if j != i:
                covariance[at + j, at + i] += value


@kernel
def mind_exclusions(instruments, health, memory):
    """When instruments go out of use the three axes are other means of other biases."""
    gyros = in_use(health.gyro, instruments.n_gyros)
    if gyros != memory.gyros_in_use:
        memory.gyros_in_use = gyros
        spread_of(instruments.gyro_axis, gyros, instruments.n_gyros, memory.gyro_spread)
        add_block(memory.covariance, GYRO_BIAS, instruments.gyro_bias**2, memory.gyro_spread)
    units = in_use(health.accelerometer, instruments.n_accelerometers)
    if units != memory.accelerometers_in_use:
        memory.accelerometers_in_use = units
        spread = memory.accelerometer_spread
        spread_of(instruments.accelerometer_axis, units, instruments.n_accelerometers, spread)
        add_block(memory.covariance, ACCELEROMETER_BIAS, instruments.accelerometer_bias**2, spread)


@kernel
def add_process_noise(params, instruments, v_rel_I, up, height, q, memory):
    """Add what chance brings in ``memory.interval`` to the covariance; ``height``: m above the ground.

    The slope is that of the ground between the beams, which changes as they move on or draw together.
    """
    covariance, interval = memory.covariance, memory.interval
    gyro, accelerometer, dt = memory.gyro_spread, memory.accelerometer_spread, interval.dt
    add_turned(covariance, ATTITUDE_ERROR, instruments.gyro_noise**2 * dt, gyro, q)
    add_turned(covariance, VELOCITY, instruments.accelerometer_noise**2 * dt, accelerometer, q)
    add_block(covariance, GYRO_BIAS, instruments.gyro_bias_walk**2 * dt, gyro)
    walk = instruments.accelerometer_bias_walk**2 * dt
    add_block(covariance, ACCELEROMETER_BIAS, walk, accelerometer)
    along = norm(sub(v_rel_I, scale(dot(v_rel_I, up), up)))
    covariance[TERRAIN, TERRAIN] += params.terrain_change**2 * along * dt / 1000.0
    moved = norm(v_rel_I) * dt / max(height, LOWEST)
    for i in range(SLOPE, SLOPE + 2):
        room = max(tan(params.slope_sigma) ** 2 - covariance[i, i], 0.0)
        covariance[i, i] += min(tan(params.slope_change) ** 2 * moved, room)
    gravity = 2.0 * params.gravity**2 * params.gravity_time * dt  # white noise of the same long-term growth
    for i in range(3):
        covariance[VELOCITY + i, VELOCITY + i] += interval.unknown_gain + gravity
        room = max(ANYHOW - covariance[ATTITUDE_ERROR + i, ATTITUDE_ERROR + i], 0.0)
        covariance[ATTITUDE_ERROR + i, ATTITUDE_ERROR + i] += min(interval.unknown_turn, room)
