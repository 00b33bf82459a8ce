"""Motion of the body from the readings of an inertial unit: least squares over all healthy gyros and
accelerometers, less the estimated biases, referred to the centre of mass.
"""

from __future__ import annotations

from edl6dof.fsw.navigation.gyro_gaps import RATE_BRIDGE, bridge_rate, end_bridge
from edl6dof.fsw.navigation.parity_test import NONE, PARITY, parity_test, restart_parity_test
from edl6dof.fsw.navigation.redundancy import (
    REDUNDANT,
    exclude_stale_flags,
    least_squares,
    prepare,
    take_increments,
    usable,
    usable_gyros,
    without_one,
)
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.spatial.vector import add, cross, norm, put3, scale, sub, take3

#: Largest bridged rate, over the range of the gyros.
MOST = 2.0

#: Memory of the processing of the inertial unit.
INERTIAL_MEMORY = record(
    ("t", "f8"),  # s, flight time of the last reading
    ("first", "f8"),  # s, flight time of the first reading
    ("begun", FLAG),  # there was a reading
    ("gyros", REDUNDANT),
    ("accelerometers", REDUNDANT),
    ("gyro_parity", PARITY),
    ("accelerometer_parity", PARITY),
    ("rate_bridge", RATE_BRIDGE),
    ("gain", "f8", (3,)),  # m/s, B: velocity gained at the unit in the last cycle
)


@kernel
def take_reading(instruments, t, inertial, memory):
    """Compute the increments from the counts of the ``inertial`` unit that arrive at ``t`` (s). Returns the
    time (s) between the last reading and this one: 0 at the start, while the delayed unit repeats its first
    reading.
    """
    if memory.begun == 0:
        memory.begun, memory.first, memory.t = 1, t, t
    before = memory.t
    memory.t = max(t - instruments.unit_delay, memory.first)
    take_increments(inertial.angle, instruments.n_gyros, memory.gyros)
    take_increments(inertial.gain, instruments.n_accelerometers, memory.accelerometers)
    return memory.t - before


@kernel
def read_motion(params, instruments, body, dt, inertial, solution, health, memory, motion):
    """Fill ``motion`` (``MOTION``) with the increments of a cycle of ``dt`` seconds, positive.

    Args:
        params: ``NavigationParams`` record.
        instruments, body: ``INSTRUMENTS`` record; believed configuration of the vehicle.
        inertial, solution: ``INERTIAL`` record; ``SOLUTION`` record with the estimated biases.
        health, memory: ``INSTRUMENT_HEALTH`` and ``INERTIAL_MEMORY`` records, updated.
    """
    put3(motion.last_angle, 0, take3(motion.angle, 0))
    put3(motion.last_gain, 0, scale(dt / motion.dt if motion.dt > 0.0 else 0.0, take3(motion.gain, 0)))
    motion.dt = dt
    rate_before = take3(motion.rate, 0)
    gain = _force(params, instruments, dt, inertial, solution, health=health, memory=memory, motion=motion)
    put3(memory.gain, 0, gain)
    known_before = motion.rate_known
    _rotation(params, instruments, dt, inertial, solution, health=health, memory=memory, motion=motion)
    lever = sub(take3(instruments.unit_position, 0), take3(body.centre, 0))
    arrived = known_before == 0 and motion.rate_known != 0
    bridge, most = memory.rate_bridge, MOST * instruments.gyro_range
    if motion.rate_known == 0:
        bridge_rate(body, lever, gain, most, dt, memory=bridge, motion=motion)
    elif bridge.push > 0.0:
        end_bridge(body, lever, gain, most, dt, rate_before=rate_before, memory=bridge, motion=motion)
    # from the unit to the centre of mass
    angle = scale(dt, take3(motion.rate, 0)) if arrived else take3(motion.angle, 0)
    turned = scale(1.0 / dt, cross(angle, cross(angle, lever)))
    if not arrived:
        turned = add(turned, cross(sub(take3(motion.rate, 0), rate_before), lever))
    put3(motion.gain, 0, sub(gain, turned))


@kernel
def _force(params, instruments, dt, inertial, solution, health, memory, motion):
    """Velocity gained at the unit (m/s, B); that of the last cycle while too few accelerometers are
    usable.
    """
    axis, number = instruments.accelerometer_axis, instruments.n_accelerometers
    redundant = memory.accelerometers
    in_use = usable(number, health.accelerometer, inertial.accelerometer_saturated)
    _choose(params.parity, axis, number, in_use, redundant, parity=memory.accelerometer_parity)
    motion.force_known = redundant.solvable
    if redundant.solvable == 0:
        return take3(motion.last_gain, 0)
    new = instruments.accelerometer_noise**2 * dt + instruments.accelerometer_step**2 / 6.0
    age = memory.t - memory.first
    lasting = (instruments.accelerometer_bias**2 + instruments.accelerometer_bias_walk**2 * age) * dt * dt
    gain, _, failed = _combine(
        params.parity,
        axis,
        number,
        new,
        lasting,
        relative=instruments.accelerometer_scale,
        dt=dt,
        redundant=redundant,
        parity=memory.accelerometer_parity,
    )
    if failed != NONE:
        health.accelerometer[failed] = 0
    exclude_stale_flags(
        params.parity.flag_patience,
        axis,
        number,
        end=instruments.accelerometer_range,
        flags=inertial.accelerometer_saturated,
        vector=gain,
        dt=dt,
        healthy=health.accelerometer,
        flagged=redundant.flagged,
    )
    return sub(gain, scale(dt, take3(solution.accelerometer_bias, 0)))


@kernel
def _rotation(params, instruments, dt, inertial, solution, health, memory, motion):
    """Write the rotation angle of the cycle and the rate at its end into ``motion``, if enough gyros are
    usable.
    """
    axis, number, redundant = instruments.gyro_axis, instruments.n_gyros, memory.gyros
    in_use = usable_gyros(
        params.saturation, instruments, dt, healthy=health.gyro, inertial=inertial, redundant=redundant
    )
    _choose(params.parity, axis, number, in_use, redundant, parity=memory.gyro_parity)
    motion.rate_known = redundant.solvable
    if redundant.solvable == 0:
        return
    new = instruments.gyro_noise**2 * dt + instruments.gyro_step**2 / 6.0
    age = memory.t - memory.first
    lasting = (instruments.gyro_bias**2 + instruments.gyro_bias_walk**2 * age) * dt * dt
    angle, left_out, failed = _combine(
        params.parity,
        axis,
        number,
        new,
        lasting,
        relative=instruments.gyro_scale,
        dt=dt,
        redundant=redundant,
        parity=memory.gyro_parity,
    )
    if failed != NONE:
        health.gyro[failed] = 0
    exclude_stale_flags(
        params.parity.flag_patience, axis, number, end=instruments.gyro_range,
        flags=inertial.gyro_saturated, vector=angle, dt=dt, healthy=health.gyro, flagged=redundant.flagged,
    )  # fmt: skip
    rate = least_squares(redundant, number, inertial.rate)
    if left_out != NONE:
        rate = without_one(axis, redundant, left_out, inertial.rate, rate)
    bias = take3(solution.gyro_bias, 0)
    put3(motion.angle, 0, sub(angle, scale(dt, bias)))
    put3(motion.rate, 0, sub(rate, bias))


@kernel
def _choose(params, axis, number, in_use, redundant, parity):
    """Prepare the least squares for the set ``in_use`` of instruments (bits), if it is another."""
    if in_use != redundant.in_use:
        prepare(axis, number, in_use, redundant)
        restart_parity_test(params, redundant.n_parity, parity)


@kernel
def _combine(params, axis, number, new, lasting, relative, dt, redundant, parity):
    """Combine the increments by least squares. Returns the vector, the instrument left out of it, and the
    instrument found to have failed.

    ``new``, ``lasting``: variances of an increment by noise, and by errors that are constant from cycle to
    cycle; ``relative``: standard deviation of constant errors that are proportional to the motion, over the
    motion.
    """
    vector = least_squares(redundant, number, redundant.increment)
    if params.enabled == 0:
        return vector, NONE, NONE
    lasting += (relative * norm(vector)) ** 2
    left_out, failed = parity_test(params, new, lasting, dt, redundant, number=number, memory=parity)
    if left_out != NONE:
        vector = without_one(axis, redundant, left_out, redundant.increment, vector)
    return vector, left_out, failed
