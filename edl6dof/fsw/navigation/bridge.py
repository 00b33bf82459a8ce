"""The rotation of the body while too few gyros read within their range.

Under a parachute or in the air the specific force keeps its direction in I over a second or two, so that
its change of direction in B tells the rotation about the axes across it.  About x of B, near which it points,
the last known roll rate is held: an axisymmetric body that only lateral moments act on keeps it.  Where the
force is too weak or points elsewhere, the whole last rate is held.  Once the gyros read again, half of the
change of roll rate over the gap is made up for, as if it had changed evenly.
Left out: the turn of the force direction with the path, gravity / speed, about 0.5 deg/s.

Source: this project; conservation of roll, Euler's equations with Iyy = Izz.
"""

from __future__ import annotations

import numpy as np

from edl6dof.jit import kernel
from edl6dof.records import FLAG
from edl6dof.spatial.vector import add, cross, put3, scale, unit

#: Least specific force (m/s2) whose direction is followed, and least share of it along x of B.
_LEAST_FORCE, _LEAST_AXIAL = 2.0, 0.5

BRIDGE = np.dtype(
    [
        ("roll_rate", "f8"),  # rad/s, the last known, held over the gap
        ("duration", "f8"),  # s, of the gap until now; 0 while the rate is known
        ("followed", FLAG),  # whether the force direction was followed in this cycle
    ],
    align=True,
)


@kernel
def bridge(gain, last_gain, dt, memory, motion):
    """Fill angle and rate of ``motion`` (``MOTION``), which holds those of the cycle before, from the
    velocity gained (m/s, B) in this cycle and the last.
    """
    if memory.duration == 0.0:
        memory.roll_rate = motion.rate[0]
    memory.duration += dt
    now, before = unit(gain), unit(last_gain)
    least = _LEAST_FORCE * dt
    weak = gain[0] ** 2 + gain[1] ** 2 + gain[2] ** 2 < least**2
    if weak or abs(now[0]) < _LEAST_AXIAL or motion.force_known == 0:
        memory.followed = 0
        for i in range(3):
            motion.angle[i] = motion.rate[i] * dt
        return
    memory.followed = 1
    across = cross(now, before)
    along = (memory.roll_rate * dt - across[0]) / now[0]
    angle = add(across, scale(along, now))
    put3(motion.angle, 0, angle)
    put3(motion.rate, 0, scale(1.0 / dt, angle))


@kernel
def bridged_roll(roll_rate, memory):
    """What the roll angle lacks when the gyros read ``roll_rate`` (rad/s) again after the gap, rad."""
    lacking = 0.5 * (roll_rate - memory.roll_rate) * memory.duration
    memory.duration = 0.0
    return lacking
