"""Opposed test pulses: a thruster and the opposite thruster fire together for their shortest pulse, so that
the vehicle neither turns nor moves sideways unless one of them fails.

A thruster that is not used cannot be known to work. Each thruster is tested once in every phase and again
after a long rest. In hazard avoidance a fault of any thruster has to be found within a second, while guidance
uses only some of them at a time: each horizontal pair that has rested for a while is tested in turn. If flow
is missing, each thruster of the pair is at once tested alone, and another one of the same branch is fired to
check the flow meter; where the propellant may be the cause of the loss, thrusters of other branches are
tested. If force and torque leave a thruster in doubt, the pair fires again when the last pulse has been
measured, until they decide: a train of pulses, as only their edges differ from a disturbance. A suspect that
fires steadily is closed for a cycle at a time instead. A test of two 250 N thrusters costs 8 g of propellant.
A 25 N thruster is tested alone while the opposite one is in use.

Source: none; Hu et al. 2022 wait for the thruster to be used.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from edl6dof.config.base import Params, param
from edl6dof.fsw.diagnosis.flow_evidence import NONE, is_waiting, needs_trial
from edl6dof.fsw.diagnosis.hypotheses import NOTHING
from edl6dof.fsw.diagnosis.residual import fires_steadily
from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.interface.effectors import FINE, HORIZONTAL, STUCK_ON
from edl6dof.kernels import kernel
from edl6dof.records import record

#: Largest axial force of a test, over the measured axial force.
AXIAL_SHARE = 0.2
#: Control cycles after the end of a pulse until its flow has been measured.
ANSWER = 3
#: Cycles of firing alone with a loss after which a thruster that is still in doubt is tested less often.
MOST_TRIALS = 24
#: Time from one test of such a thruster to the next, s.
TRIED_AGAIN = 3.0


class ExerciseParams(Params):
    """Opposed test pulses."""

    enabled: bool = param(True, "whether idle thrusters are tested")
    every_s: float = param(
        60.0, "time without use after which a thruster is tested; each is tested once in a phase", gt=0.0
    )
    settled_s: float = param(
        13.5, "time from the start of a phase to the first test: none while a parachute opens", ge=0.0
    )
    pause_s: float = param(1.0, "time from one test to the next", gt=0.0)
    rest_s: float = param(
        0.7, "replaces every_s for pairs of horizontal thrusters while the lander flies sideways", gt=0.0
    )
    spacing_s: float = param(0.04, "replaces pause_s while the lander flies sideways", gt=0.0)
    suspicion: float = param(4.0, "evidence from which a thruster is tested again at once", gt=0.0)


#: ``used``: flight time of the last use of each thruster; ``tested``: of the last test (s).
EXERCISE = record(("used", "f8", (MAX_THRUSTERS,)), ("tested", "f8"))


class ExerciseSignals(NamedTuple):
    """Signals that the test pulses need in a control cycle.

    Attributes:
        vehicle: believed vehicle (thrusters: group, minimum pulse).
        effectiveness: force and torque of each thruster at full thrust, rows of 6 (N, N m).
        healthy: whether each thruster may be used.
        diagnosis: ``DIAGNOSIS`` record: present state of the diagnosis.
        valves: ``MODULATION`` record: the valve intervals of this control cycle.
        sideways: whether the vehicle flies sideways.
        axial: measured axial force, N: drag and thrust are derived from it, so a test may add little.
        start: flight time at which the phase began, s.
        t: present time, s.
        dt: control cycle, s.
    """

    vehicle: Any
    effectiveness: Any
    healthy: Any
    diagnosis: Any
    valves: Any
    sideways: Any
    axial: Any
    start: Any
    t: Any
    dt: Any


#: The signals that the test pulses write.
WRITES = ()


@kernel
def opposite(effectiveness, count, i):
    """Return the thruster whose lateral force and torque cancel those of ``i`` best, at least to a third (it
    may have a known loss), or ``NONE``.
    """
    found, least = NONE, 0.0
    for row in range(1, 6):
        least += 0.1 * effectiveness[i, row] * effectiveness[i, row]
    for j in range(count):
        both = 0.0
        for row in range(1, 6):
            both += (effectiveness[i, row] + effectiveness[j, row]) ** 2
        if both < least:
            found, least = j, both
    return found


@kernel
def is_free(i, signals):
    """Return whether thruster ``i`` is in use, and its valve closed during this cycle."""
    if i == NONE or signals.healthy[i] == 0:
        return False
    valves = signals.valves
    return valves.close_time[i] <= valves.open_time[i] and valves.busy_until[i] <= signals.t


@kernel
def is_measured(i, signals, memory):
    """Return whether the effect of the last use of thruster ``i`` has been measured."""
    t, dt = signals.t, signals.dt
    return t >= max(signals.valves.busy_until[i], memory.used[i] + dt) + ANSWER * dt - 1e-9


@kernel
def branch_is_measured(b, signals, memory):
    """Return whether the last use of every thruster of branch ``b`` has been measured."""
    of = signals.vehicle.branches.of
    for i in range(signals.vehicle.n_thrusters):
        if of[i] == b and not is_measured(i, signals, memory):
            return False
    return True


@kernel
def suspect(params, diagnosis):
    """Return the thruster that force and torque suspect of a loss, or ``NONE``; ``diagnosis``: ``DIAGNOSIS``
    record.
    """
    best = diagnosis.hypotheses
    suspected = best.kind not in (NOTHING, STUCK_ON) and best.evidence > params.suspicion
    return best.thruster if suspected and not needs_trial(best.thruster, diagnosis.flow) else NONE


@kernel
def thruster_to_close(params, signals):
    """Return the suspected thruster if it fires steadily, to be closed for a control cycle; or ``NONE``."""
    i, valves = suspect(params, signals.diagnosis), signals.valves
    if params.enabled == 0 or i == NONE or signals.healthy[i] == 0 or valves.busy_until[i] > signals.t:
        return NONE
    return i if fires_steadily(i, signals.diagnosis.residual) else NONE


@kernel
def retest(params, signals, memory):
    """Return the thruster to test alone, of several the one longest without use, and ``NONE``; or the
    suspected thruster and its opposite; or twice ``NONE``.
    """
    vehicle, diagnosis, t = signals.vehicle, signals.diagnosis, signals.t
    rested, oldest = NONE, t
    for i in range(vehicle.n_thrusters):
        doubted = needs_trial(i, diagnosis.flow)
        if not (doubted or diagnosis.flow.test_requested[i] != 0) or memory.used[i] >= oldest:
            continue
        if not is_free(i, signals):
            continue
        long_tried = diagnosis.flow.off[i].cycles >= MOST_TRIALS
        doubted = (
            doubted
            and branch_is_measured(vehicle.branches.of[i], signals, memory)
            and not (long_tried and t < memory.used[i] + TRIED_AGAIN)
        )
        if doubted or diagnosis.flow.test_requested[i] != 0 and is_measured(i, signals, memory):
            rested, oldest = i, memory.used[i]
    if rested != NONE:
        return rested, NONE
    i = suspect(params, diagnosis)
    if i == NONE:
        return NONE, NONE
    j = opposite(signals.effectiveness, vehicle.n_thrusters, i)
    if is_free(i, signals) and is_free(j, signals) and is_measured(i, signals, memory):
        return i, j
    return NONE, NONE


@kernel
def longest_rested(params, signals, waiting, memory):
    """Return the pair that is due for a test and has rested longest, or twice ``NONE``; ``waiting``: as of
    :func:`.flow_evidence.is_waiting`.
    """
    vehicle, effectiveness, t = signals.vehicle, signals.effectiveness, signals.t
    first, second, oldest = NONE, NONE, t
    for i in range(vehicle.n_thrusters):
        often = waiting or signals.sideways and vehicle.thrusters[i].group == HORIZONTAL
        due = t - params.rest if often else max(signals.start, t - params.every)
        if memory.used[i] < min(due, oldest) and not needs_trial(i, signals.diagnosis.flow):
            j = opposite(effectiveness, vehicle.n_thrusters, i)
            alone = vehicle.thrusters[i].group == FINE and not is_free(j, signals)
            if is_free(i, signals) and (
                alone
                or is_free(j, signals)
                and abs(effectiveness[i, 0] + effectiveness[j, 0]) <= AXIAL_SHARE * signals.axial
            ):
                first, second, oldest = i, NONE if alone else j, memory.used[i]
    return first, second


@kernel
def pair_to_test(params, signals, memory):
    """Choose the two thrusters to fire against each other from this control cycle on; the second is ``NONE``
    for a single thruster, both are ``NONE`` for no test. ``signals``: ``ExerciseSignals``; ``memory``:
    ``EXERCISE``.
    """
    if params.enabled == 0:
        return NONE, NONE
    vehicle, valves, t = signals.vehicle, signals.valves, signals.t
    for i in range(vehicle.n_thrusters):
        if valves.close_time[i] > valves.open_time[i] + 0.5 * signals.dt:
            memory.used[i] = t
    i, j = retest(params, signals, memory)
    if i == NONE:
        waiting = is_waiting(vehicle.branches, signals.diagnosis.flow)
        soon = signals.sideways or waiting
        pause = params.spacing if soon else params.pause
        if t < memory.tested + pause - 1e-9 or t < signals.start + params.settled and not soon:
            return NONE, NONE
        i, j = longest_rested(params, signals, waiting, memory)
    if i != NONE:
        memory.tested = memory.used[i] = t
    if j != NONE:
        memory.used[j] = t
    return i, j
