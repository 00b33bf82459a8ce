"""Rotation of the body while too few gyros are within their range.

The accelerometers still measure, and their readings give the torque: under a parachute the riser pulls at a
known point of a body of known mass, centre and inertia. The rate follows from Euler's equations with the pull
m f at that point, and without torque where nothing pulls. The unit, l off the centre, reads f and w' x l + w
x (w x l) together: one linear equation for w'. When the gyros are back in range they show the error of the
rate. A torque in proportion to the force, as of a pull off the believed centre of mass, makes an angle error
in proportion to that rate error; a rough correction is added at once, and
:mod:`~edl6dof.fsw.navigation.gap_smoothing` improves it a little later. Left out: torque of air and
thrusters, except for the part that grows in the same way.

Source: this project; Euler's equations; a vector and one product: Sherman and Morrison 1950.
"""

from __future__ import annotations

from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.spatial.vector import add, clamp, cross, dot, norm, put3, scale, sub, take3

#: Force (m/s2) whose pull would give as much torque as air and thrusters do.
_OTHER = 2.0

RATE_BRIDGE = record(
    ("push", "f8"),  # m/s: integral of the force over the gap; 0 while the rate is known
    ("reach", "f8"),  # m: integral of that
    ("added", "f8", (3,)),  # rad, B: correction of the angle after the last gap
)


@kernel
def acceleration_of(body, lever, force, rate):
    """Angular acceleration, rad/s2, B.

    Args:
        body: believed configuration: ``mass``, ``centre``, ``inertia`` (principal) and ``hung_at``.
        lever: from the centre of mass to the accelerometers, m, B.
        force: reading of the accelerometers, m/s2, B.
        rate: rad/s, B.
    """
    arm, m = sub(take3(body.hung_at, 0), take3(body.centre, 0)), body.mass
    a, b, c = take3(body.inertia, 0)
    felt = sub(force, cross(rate, cross(rate, lever)))
    spin = (a * rate[0], b * rate[1], c * rate[2])
    torque = sub(scale(m, cross(arm, felt)), cross(rate, spin))
    more = m * dot(arm, lever)
    a, b, c = a + more, b + more, c + more
    x = (torque[0] / a, torque[1] / b, torque[2] / c)
    z = (m * lever[0] / a, m * lever[1] / b, m * lever[2] / c)
    return add(x, scale(dot(arm, x) / (1.0 - dot(arm, z)), z))


@kernel
def bridge_rate(body, lever, gain, most, dt, memory, motion):
    """Fill angle and rate of ``motion`` (``MOTION``), which holds those of the cycle before, from the
    velocity ``gain`` (m/s, B) that the accelerometers counted in this cycle.

    Each component of the rate is limited to ``most`` (rad/s): the centripetal part of the reading grows with
    its square, and a wrong rate would diverge.
    """
    force = scale(1.0 / dt, gain)
    rate = take3(motion.rate, 0)
    change = scale(dt, acceleration_of(body, lever, force, rate))
    put3(motion.angle, 0, scale(dt, add(rate, scale(0.5, change))))
    for i in range(3):
        motion.rate[i] = clamp(rate[i] + change[i], -most, most)
    memory.reach += dt * (memory.push + 0.5 * dt * (norm(force) + _OTHER))
    memory.push += dt * (norm(force) + _OTHER)


@kernel
def end_bridge(body, lever, gain, most, dt, rate_before, memory, motion):
    """Correct the angle of ``motion``, which the gyros read again, for the error of the bridged angle;
    ``rate_before`` is the last bridged rate.
    """
    angle, rate = take3(motion.angle, 0), take3(motion.rate, 0)
    put3(motion.rate, 0, rate_before)
    bridge_rate(body, lever, gain, most, dt, memory=memory, motion=motion)
    off = scale(1.0 / dt, sub(angle, take3(motion.angle, 0)))
    put3(memory.added, 0, scale(memory.reach / memory.push, off))
    put3(motion.angle, 0, add(angle, take3(memory.added, 0)))
    put3(motion.rate, 0, rate)
    memory.push = memory.reach = 0.0
