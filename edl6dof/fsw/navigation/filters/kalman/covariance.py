"""Covariance of the error state: initial values, process noise, and the standard deviations reported.

Process noise models random walks of the instruments and of their biases, the relief of the ground, and motion
that no instrument measured.
"""

from __future__ import annotations

from math import pi, sqrt

from edl6dof.fsw.navigation.filters.kalman.states import (
    ACCELEROMETER_BIAS,
    ACCELEROMETER_SCALE,
    ATTITUDE_ERROR,
    GYRO_BIAS,
    GYRO_SCALE,
    MAP_OFFSET,
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
    begin_interval,
)
from edl6dof.fsw.navigation.strapdown import level_axes
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import tan
from edl6dof.spatial.quaternion import axes
from edl6dof.spatial.vector import cross, dot, inertia_solve, norm, scale, sub, take3, take4

#: Variance about one axis (rad2) of an unknown attitude.
ANYHOW = pi * pi / 3.0
#: Least height (m) in the change of the slope: below it the beams meet the same ground.
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
def axes_covariance(axis, bits, count, out):
    """Write the inverse of H'H (H: their axes) of the instruments in ``bits`` into ``out``, unless the axes
    do not span space.
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
    """Add ``variance`` times the matrix ``spread`` to the diagonal 3 x 3 block at index ``at``."""
    for i in range(3):
        for j in range(3):
            covariance[at + i, at + j] += variance * spread[i, j]


@kernel
def add_rotated_block(covariance, at, variance, spread, q):
    """Add ``variance`` times the matrix ``spread`` (B) to the diagonal 3 x 3 block in I at index ``at``;
    ``q``: ``q_I2B``.
    """
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
def follow_exclusions(instruments, health, memory):
    """Add the bias variance of the remaining instruments when some are excluded, as the mean of their biases
    differs.
    """
    gyros = in_use(health.gyro, instruments.n_gyros)
    if gyros != memory.gyros_in_use:
        memory.gyros_in_use = gyros
        axes_covariance(instruments.gyro_axis, gyros, instruments.n_gyros, memory.gyro_spread)
        add_block(memory.covariance, GYRO_BIAS, instruments.gyro_bias**2, memory.gyro_spread)
    units = in_use(health.accelerometer, instruments.n_accelerometers)
    if units != memory.accelerometers_in_use:
        memory.accelerometers_in_use = units
        spread = memory.accelerometer_spread
        axes_covariance(instruments.accelerometer_axis, units, instruments.n_accelerometers, spread)
        add_block(memory.covariance, ACCELEROMETER_BIAS, instruments.accelerometer_bias**2, spread)


@kernel
def add_process_noise(params, instruments, v_rel_I, up, height, q, memory):
    """Add the process noise of ``memory.interval`` to the covariance; ``up``: unit vector (I), ``height``:
    above the ground (m).

    The slope is that of the ground between the beams, which changes as the vehicle moves or descends.
    """
    covariance, interval = memory.covariance, memory.interval
    gyro, accelerometer, dt = memory.gyro_spread, memory.accelerometer_spread, interval.dt
    add_rotated_block(covariance, ATTITUDE_ERROR, instruments.gyro_noise**2 * dt, gyro, q)
    add_rotated_block(covariance, VELOCITY, instruments.accelerometer_noise**2 * dt, accelerometer, q)
    add_block(covariance, GYRO_BIAS, instruments.gyro_bias_walk**2 * dt, gyro)
    walk = instruments.accelerometer_bias_walk**2 * dt
    add_block(covariance, ACCELEROMETER_BIAS, walk, accelerometer)
    along = norm(sub(v_rel_I, scale(dot(v_rel_I, up), up)))
    covariance[TERRAIN, TERRAIN] += params.terrain_change**2 * along * dt / 1000.0
    moved = norm(v_rel_I) * dt / max(height, LOWEST)
    for i in range(SLOPE, SLOPE + 2):
        room = max(tan(params.slope_sigma) ** 2 - covariance[i, i], 0.0)
        covariance[i, i] += min(tan(params.slope_change) ** 2 * moved, room)
    for i in range(3):
        covariance[VELOCITY + i, VELOCITY + i] += interval.unknown_gain
        room = max(ANYHOW - covariance[ATTITUDE_ERROR + i, ATTITUDE_ERROR + i], 0.0)
        covariance[ATTITUDE_ERROR + i, ATTITUDE_ERROR + i] += min(interval.unknown_turn, room)


@kernel
def fill_considered(instruments, gyro_spread, accelerometer_spread, considered):
    """Write the variances of the considered errors, which the readings share."""
    for k in range(9):
        i = k % 3
        considered[GYRO_SCALE + k] = instruments.gyro_scale**2 * gyro_spread[i, i]
        considered[ACCELEROMETER_SCALE + k] = instruments.accelerometer_scale**2 * accelerometer_spread[i, i]
    for i in range(3):
        considered[STAR_BIAS + i] = instruments.star_bias**2 / max(instruments.n_trackers, 1)
        considered[MAP_OFFSET + i] = instruments.landmarks.map_offset**2
    for beam in range(instruments.n_beams):
        considered[RANGE_SCALE + beam] = instruments.range_scale**2
        considered[SPEED_SCALE + beam] = instruments.speed_scale**2
        considered[RANGE_BIAS + beam] = instruments.range_bias**2


@kernel
def reopen_slope(params, covariance):
    """Raise the variance of the slope to its initial value."""
    for i in range(SLOPE, SLOPE + 2):
        covariance[i, i] = max(covariance[i, i], tan(params.slope_sigma) ** 2)


@kernel
def start_covariance(params, instruments, solution, memory):
    """Initialise ``memory`` for a solution that ground tracking and the star tracker have just started.

    The attitude error is that of the star fix: noise, and the bias of all later fixes.
    """
    covariance = memory.covariance
    for i in range(STATES):
        memory.correction[i] = 0.0
        for j in range(WIDTH):
            covariance[i, j] = 0.0
    q = take4(solution.q_I2B)
    x, y, z = axes(q)
    bias = instruments.star_bias**2 / max(instruments.n_trackers, 1)
    fix = instruments.star_sigma**2 + bias
    for i in range(3):
        covariance[ATTITUDE_ERROR + i, ATTITUDE_ERROR + i] = fix
        covariance[ATTITUDE_ERROR + i, STAR_BIAS] = -x[i] * bias
        covariance[ATTITUDE_ERROR + i, STAR_BIAS + 1] = -y[i] * bias
        covariance[ATTITUDE_ERROR + i, STAR_BIAS + 2] = -z[i] * bias
    add_block(covariance, POSITION, 1.0, instruments.tracking_position)
    add_block(covariance, VELOCITY, 1.0, instruments.tracking_velocity)
    covariance[TERRAIN, TERRAIN] = params.terrain_sigma**2
    reopen_slope(params, covariance)
    _begin_biases(params, instruments, memory)
    fill_considered(instruments, memory.gyro_spread, memory.accelerometer_spread, memory.considered)
    begin_interval(memory.interval)
    memory.ranges_refused, memory.speeds_refused, memory.fixes_refused = 0, 0, 0
    memory.plane_seen = 0
    memory.unknown_rate_time, memory.unknown_force_time = 0.0, 0.0
    memory.stars_t = memory.radar_t = solution.t


@kernel
def _begin_biases(params, instruments, memory):
    """Initialise with all instruments in use and the biases of their data sheets.

    The error of the gravity model changes slowly, like a bias of the accelerometers, and is a part of it.
    """
    healthy = (1 << instruments.n_gyros) - 1
    memory.gyros_in_use = healthy
    axes_covariance(instruments.gyro_axis, healthy, instruments.n_gyros, memory.gyro_spread)
    add_block(memory.covariance, GYRO_BIAS, instruments.gyro_bias**2, memory.gyro_spread)
    healthy = (1 << instruments.n_accelerometers) - 1
    memory.accelerometers_in_use = healthy
    spread = memory.accelerometer_spread
    axes_covariance(instruments.accelerometer_axis, healthy, instruments.n_accelerometers, spread)
    add_block(memory.covariance, ACCELEROMETER_BIAS, instruments.accelerometer_bias**2, spread)
    for i in range(ACCELEROMETER_BIAS, ACCELEROMETER_BIAS + 3):
        memory.covariance[i, i] += params.gravity**2


@kernel
def deviation(covariance, at, a):
    """Standard deviation of the component along ``a`` of the three errors from index ``at``."""
    total = 0.0
    for i in range(3):
        for j in range(3):
            total += a[i] * covariance[at + i, at + j] * a[j]
    return sqrt(max(total, 0.0))


@kernel
def relative_deviation(covariance, spin, a):
    """Standard deviation (m/s) along ``a`` of the planet-relative velocity, with error dv - W x dr for the
    planet rotation W = ``spin`` (rad/s).
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
def report_covariance(planet, covariance, solution):
    """Write the standard deviations of position (m), velocity (m/s) and attitude (rad) along north, east and
    up, and that of the height above ground (m), into ``solution``.
    """
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
