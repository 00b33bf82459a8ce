"""What powered guidance gives up, in this order, where no landing keeps all of its constraints.

A law relaxes what it plans with, one more constraint at a time; the last resort, full thrust against the
velocity, is common to all laws (:mod:`~edl6dof.fsw.guidance.powered.stopping`).
"""

from __future__ import annotations

import numpy as np

from edl6dof.kernels import kernel

#: The constraints, in the order in which they are relaxed.
CONSTRAINTS = ("throttle dwell", "arrival height", "glide slope", "tilt", "target", "throttle band")
#: How many of them are relaxed.
DWELL, ARRIVAL, GLIDE_SLOPE, TILT, TARGET, EVERYTHING = range(1, len(CONSTRAINTS) + 1)

#: For each number of constraints that were relaxed: when first (s, flight time; 0: never), and how far from
#: rest at the target the landing was then still expected to end (m).
RELAXED = np.dtype([("t", "f8", (EVERYTHING,)), ("landing_error", "f8", (EVERYTHING,))], align=True)


def in_words(relaxed: int) -> str:
    """What guidance does with so many constraints relaxed."""
    if relaxed == EVERYTHING:
        return "braking at full thrust"
    return f"constraints relaxed up to the {CONSTRAINTS[relaxed - 1]}"


@kernel
def note_relaxed(t, goal, memory):
    """Note in a ``RELAXED`` record what the ``GUIDE`` record ``goal`` gives up at time ``t`` (s)."""
    last = goal.relaxed - 1
    if last >= 0 and memory.t[last] == 0.0:
        memory.t[last], memory.landing_error[last] = t, goal.landing_error
