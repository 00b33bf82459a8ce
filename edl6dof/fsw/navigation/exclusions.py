"""The log of instruments that go out of use and come back, in the order of time.

Parity test and watches say by ``INSTRUMENT_HEALTH`` what is in use; here every change of it is noted, once a
cycle.  The last of the things that may go out of use is the inertial unit: too few of its gyros in range for
the rate to be known.
"""

from __future__ import annotations

import numpy as np

from edl6dof.interface.capacities import MAX_ACCELEROMETERS, MAX_BEAMS, MAX_GYROS
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, whole

#: Number of the first gyro, accelerometer and beam, of the star tracker and of the inertial unit among all
#: that may go out of use.
GYROS = 0
ACCELEROMETERS = GYROS + MAX_GYROS
BEAMS = ACCELEROMETERS + MAX_ACCELEROMETERS
STAR_TRACKER = BEAMS + MAX_BEAMS
INERTIAL_UNIT = STAR_TRACKER + 1
#: Changes that the log holds.
MAX_CHANGES = 32

CHANGE = np.dtype(
    [
        ("t", "f8"),  # s, flight time
        ("number", whole(0, INERTIAL_UNIT)),  # of what changed
        ("back", FLAG),  # 0: it went out of use; 1: it came back
    ],
    align=True,
)
EXCLUSIONS = np.dtype(
    [
        ("out", FLAG, (INERTIAL_UNIT + 1,)),  # what is out of use
        ("changes", CHANGE, (MAX_CHANGES,)),
        ("n_changes", whole(0, MAX_CHANGES)),
    ],
    align=True,
)


@kernel
def note_changes(instruments, t, health, motion, memory):
    """Note at ``t`` (s) what has changed in ``health`` (``INSTRUMENT_HEALTH``) and in ``motion`` since the
    last cycle.
    """
    for i in range(instruments.n_gyros):
        _note(t, GYROS + i, health.gyro[i], memory)
    for i in range(instruments.n_accelerometers):
        _note(t, ACCELEROMETERS + i, health.accelerometer[i], memory)
    for i in range(instruments.n_beams):
        _note(t, BEAMS + i, health.beam_range[i] & health.beam_speed[i], memory)
    _note(t, STAR_TRACKER, health.star_tracker, memory)
    _note(t, INERTIAL_UNIT, motion.rate_known, memory)


@kernel
def _note(t, number, in_use, memory):
    """Note a change of one; what finds no room is lost."""
    if memory.out[number] == 1 - in_use:
        return
    memory.out[number] = 1 - in_use
    if memory.n_changes < MAX_CHANGES:
        change = memory.changes[memory.n_changes]
        change.t, change.number, change.back = t, number, in_use
        memory.n_changes += 1
