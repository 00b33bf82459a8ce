"""Telemetry of navigation: how far the estimate is from the truth, and how far it says it may be.

Errors are the estimate less the truth, in the axes north, east and down of the true place: of position, of
the velocity relative to the turning planet, and of attitude, the small rotation from the true to the
estimated body.
"""

from __future__ import annotations

from edl6dof.kernels import kernel
from edl6dof.spatial.frames import fixed_to_ned, rotate_z
from edl6dof.spatial.quaternion import conjugate, from_frame, multiply, rotation_vector
from edl6dof.spatial.vector import sub, take3
from edl6dof.vehicle.plant import ATTITUDE, POSITION, VELOCITY


@kernel
def record_errors(plant, outputs, estimate, spin, c, s, nav):
    """Write the errors of the ``estimate`` (``ESTIMATE``) into ``nav``, a group of a row of telemetry;
    ``spin``: the planet's rate of rotation (rad/s), ``c``, ``s``: cosine and sine of its angle.
    """
    y, out = plant.y, outputs
    sl, cl, so, co = out.sin_lat, out.cos_lat, out.sin_lon, out.cos_lon
    r = rotate_z(c, s, sub(take3(estimate.r_I, 0), take3(y, POSITION)))
    v_F = rotate_z(c, s, sub(take3(estimate.v_I, 0), take3(y, VELOCITY)))
    v = (v_F[0] + spin * r[1], v_F[1] - spin * r[0], v_F[2])
    q = (y[ATTITUDE], y[ATTITUDE + 1], y[ATTITUDE + 2], y[ATTITUDE + 3])
    p = (estimate.q_I2B[0], estimate.q_I2B[1], estimate.q_I2B[2], estimate.q_I2B[3])
    turned = rotate_z(c, s, from_frame(q, rotation_vector(multiply(conjugate(q), p))))
    nav.error_north, nav.error_east, nav.error_down = fixed_to_ned(sl, cl, so, co, r)
    nav.error_v_north, nav.error_v_east, nav.error_v_down = fixed_to_ned(sl, cl, so, co, v)
    nav.error_attitude_north, nav.error_attitude_east, nav.error_attitude_down = fixed_to_ned(
        sl, cl, so, co, turned
    )
    nav.error_height = estimate.height_above_ground - out.height


@kernel
def mask(flags):
    """Flags as one whole number: the sum of 2 to the power of the indices of those that are set."""
    total = 0
    for i in range(len(flags)):
        if flags[i] != 0:
            total |= 1 << i
    return total


@kernel
def record_readings(sensed, branches, tick):
    """Write which instruments of ``sensed`` (``SENSED``) are at the end of their range, the range (m) of each
    radar beam, 0 without an echo, and the count (kg) of the flow meter of each of some ``branches``, into a
    row of telemetry.
    """
    inertial, radar = sensed.inertial, sensed.radar
    tick.sensed.gyros_saturated = mask(inertial.gyro_saturated)
    tick.sensed.accelerometers_saturated = mask(inertial.accelerometer_saturated)
    for i in range(len(radar.range)):
        tick.range[i] = radar.range[i] if radar.locked[i] != 0 else 0.0
    for k in range(branches):
        tick.metered[k] = sensed.branch_used[k]


@kernel
def farthest(values):
    """Largest magnitude of some numbers."""
    largest = 0.0
    for i in range(len(values)):
        largest = max(largest, abs(values[i]))
    return largest


@kernel
def record_claims(navigation, nav):
    """Write what navigation (``NAVIGATION``) says of itself and of its instruments into ``nav``, a group of a
    row of telemetry.
    """
    solution, health = navigation.solution, navigation.health
    nav.sigma_north, nav.sigma_east, nav.sigma_down = take3(solution.sigma_r, 0)
    nav.sigma_v_north, nav.sigma_v_east, nav.sigma_v_down = take3(solution.sigma_v, 0)
    nav.sigma_attitude_north, nav.sigma_attitude_east, nav.sigma_attitude_down = take3(
        solution.sigma_attitude, 0
    )
    nav.sigma_height = solution.sigma_height
    nav.range_innovation = farthest(solution.range_innovation)
    nav.speed_innovation = farthest(solution.speed_innovation)
    nav.beams_used = solution.beams_used
    nav.gyros_in_use, nav.accelerometers_in_use = mask(health.gyro), mask(health.accelerometer)
    nav.beams_in_use = mask(health.beam_range) & mask(health.beam_speed)
