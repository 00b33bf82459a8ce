"""The rotation of the body while too few gyros read within their range.

The accelerometers go on reading, and what they read tells the torque: under a parachute the riser pulls at
a known place of a body of known mass, centre and inertia.  The rate follows from Euler's equations with the
pull m f at that place, and without any torque where nothing pulls.  What is read at the unit, l off the
centre, is f and w' x l + w x (w x l) together: one linear equation for w'.
Once the gyros read again they show by how much the rate is off.  A torque in proportion to the force, as of
a pull beside the believed centre of mass, makes an error of the angle in proportion to that of the rate:
it is taken off, roughly; :mod:`~edl6dof.fsw.navigation.hindsight` does it better a little later.
Left out: torque of air and thrusters, but for what grows in the same way.

Source: this project; Euler's equations; a vector and one product: Sherman and Morrison 1950.
"""

from __future__ import annotations

import numpy as np

from edl6dof.jit import kernel
from edl6dof.spatial.vector import add, clamp, cross, dot, norm, put3, scale, sub, take3

#: Force (m/s2) to which the torque of air and thrusters, which does not go with the pull, is taken to belong.
_OTHER = 2.0

BRIDGE = np.dtype(
    [
        ("push", "f8"),  # m/s: integral of the force over the gap; 0 while the rate is known
        ("reach", "f8"),  # m: integral of that
        ("added", "f8", (3,)),  # rad, B: what was added to the angle after the last gap
    ],
    align=True,
)


@kernel
def acceleration_of(body, lever, force, rate):
    """Angular acceleration, rad/s2, B.

    Args:
        body: believed configuration: ``mass``, ``centre``, ``inertia`` (principal) and ``hung_at``.
        lever: from the centre of mass to the accelerometers, m, B.
        force: that they read, m/s2, B.
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
def bridge(body, lever, gain, most, dt, memory, motion):
    """Fill angle and rate of ``motion`` (``MOTION``), which holds those of the cycle before, from the
    velocity ``gain`` (m/s, B) that the accelerometers counted in this cycle.

    No component of the rate is taken to be above ``most`` (rad/s): the centripetal part of what is read grows
    with its square, and a rate that is off would run away.
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
def arrive(body, lever, gain, most, dt, rate_before, memory, motion):
    """Add to the angle of ``motion``, which the gyros read again, what the bridged angle lacks;
    ``rate_before`` is the last rate that was bridged.
    """
    angle, rate = take3(motion.angle, 0), take3(motion.rate, 0)
    put3(motion.rate, 0, rate_before)
    bridge(body, lever, gain, most, dt, memory=memory, motion=motion)
    off = scale(1.0 / dt, sub(angle, take3(motion.angle, 0)))
    put3(memory.added, 0, scale(memory.reach / memory.push, off))
    put3(motion.angle, 0, add(angle, take3(memory.added, 0)))
    put3(motion.rate, 0, rate)
    memory.push = memory.reach = 0.0
