"""Opposed test pulses: a thruster and its opposite number fire together for one pulse, so that nothing moves
unless one of them fails.

In hazard avoidance a fault is to be known within a second, whichever thruster it is, and guidance uses
only some of them at a time.  Each horizontal pair on one line of action that has rested for a while is
tested in turn; a thruster that one test makes suspect is tested again at once.  One suspected to be stuck on
is not: its own pulse would hide that, and its opposite's would look dead.  A test costs 8 g of propellant;
how long a pair rests sets how many there are (docs/descent.md).
Beyond Hu et al. 2022, who wait for the thruster to be used.
"""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.fsw.diagnosis.hypotheses import NOTHING, STUCK_ON
from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.interface.thrusters import HORIZONTAL
from edl6dof.jit import kernel

NONE = -1


class ExerciseParams(Params):
    """Opposed test pulses while flying sideways."""

    enabled: bool = param(True, "whether resting thrusters are tested")
    rest_s: float = param(0.7, "time without use after which a pair is tested", gt=0.0)
    spacing_s: float = param(0.04, "time from one test to the next", gt=0.0)
    suspicion: float = param(4.0, "evidence from which a thruster is tested again at once", gt=0.0)


EXERCISE = np.dtype([("used", "f8", (MAX_THRUSTERS,)), ("tested", "f8")], align=True)


@kernel
def opposite(effectiveness, count, i):
    """The thruster whose force and torque cancel those of ``i`` to a tenth, or ``NONE``."""
    own = 0.0
    for row in range(6):
        own += effectiveness[i, row] * effectiveness[i, row]
    for j in range(count):
        both = 0.0
        for row in range(6):
            both += (effectiveness[i, row] + effectiveness[j, row]) ** 2
        if both < 0.01 * own:
            return j
    return NONE


@kernel
def can_be_tested(i, j, t, dt, thrusters, healthy, busy_until, opens, closes):
    """Whether two thrusters are in use, shut during this cycle, and able to give a pulse within it."""
    if j == NONE or healthy[i] == 0 or healthy[j] == 0:
        return False
    shut = closes[i] <= opens[i] and closes[j] <= opens[j] and busy_until[i] <= t and busy_until[j] <= t
    return shut and thrusters[i].minimum_pulse <= dt + 1e-9 and thrusters[j].minimum_pulse <= dt + 1e-9


@kernel
def next_pair(
    params, thrusters, count, effectiveness, healthy, hypotheses, busy_until, opens, closes, t, dt, memory
):
    """The pair to test now: a suspect's, or the one that has rested longest; twice ``NONE`` for none."""
    if hypotheses.kind not in (NOTHING, STUCK_ON) and hypotheses.evidence > params.suspicion:
        i = hypotheses.thruster
        j = opposite(effectiveness, count, i)
        if can_be_tested(i, j, t, dt, thrusters, healthy, busy_until, opens, closes):
            return i, j
    first, second, oldest = NONE, NONE, t - params.rest
    if t < memory.tested + params.spacing - 1e-9:
        return first, second
    for i in range(count):
        if thrusters[i].group == HORIZONTAL and memory.used[i] < oldest:
            j = opposite(effectiveness, count, i)
            if can_be_tested(i, j, t, dt, thrusters, healthy, busy_until, opens, closes):
                first, second, oldest = i, j, memory.used[i]
    return first, second


@kernel
def pair_to_test(
    params, vehicle, effectiveness, healthy, hypotheses, busy_until, opens, closes, t, dt, memory
):
    """The two thrusters to fire against each other in this control cycle; (``NONE``, ``NONE``) for none.

    Args:
        params: exercise record.
        vehicle: believed vehicle (thrusters: group, minimum pulse).
        effectiveness: force and torque of each thruster at full thrust, rows of 6 (N, N m).
        healthy: whether each may be used.
        hypotheses: what diagnosis thinks at present.
        busy_until: end of the shortest pulse under way of each, s.
        opens: valve openings of this control cycle, s.
        closes: valve closings, s.
        t: present time, s.
        dt: control cycle, s.
        memory: ``EXERCISE`` record.
    """
    if params.enabled == 0:
        return NONE, NONE
    thrusters, count = vehicle.thrusters, vehicle.n_thrusters
    for i in range(count):
        if closes[i] > opens[i] + 0.5 * dt:
            memory.used[i] = t
    i, j = next_pair(
        params, thrusters, count, effectiveness, healthy, hypotheses, busy_until, opens, closes, t, dt, memory
    )
    if i != NONE:
        memory.used[i] = memory.used[j] = memory.tested = t
    return i, j
