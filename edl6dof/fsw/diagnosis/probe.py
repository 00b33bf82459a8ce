"""Shutting a suspect off for a moment: does the disturbance go with it?

A thruster that has been stuck on for some time is part of the slow disturbance, and one whose opposite number
fires against it leaves the same residual as that one stuck off.  Where the residual cannot decide, the
suspect is isolated for a fraction of a second.  If it has failed, force and torque change by minus what it
gave unasked, its effectiveness times the share in which it was to rest; if it is sound, nothing happens.
A dead thruster that stops being commanded just then leaves the same change: every other thruster's use is
weighed against the suspect.  A probe that decides nothing in its time gives the suspect back and proves
nothing; only one that was found sound is trusted.

Suspected is a thruster for which "stuck on" has evidence, or whose thrust accounts for most of a slow
disturbance that is larger than the misalignments of engine, drag and riser explain, and for half of what the
single cycles before left unexplained: the mean of a swing is no standing thrust.
"""

from __future__ import annotations

from math import exp

import numpy as np

from edl6dof.fsw.diagnosis.hypotheses import SUMS, collect, evidence, for_loss, for_stuck_on, forget, weights
from edl6dof.fsw.diagnosis.residual import WINDOW, product
from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.jit import kernel
from edl6dof.records import FLAG, whole

NONE = -1
UNDER_WAY, SOUND, FAILED, UNDECIDED = range(4)
SLOW_KNOWN = (
    25  # cycles for which the slow disturbance must have been known before a thruster is suspected of it
)
LEAST_CYCLES = 3
BEFORE = 3  # cycles before a probe that what follows is compared with
# lateral force over axial load, and torque over axial load in m, that no thruster is suspected of
MISALIGNMENT = 0.01
LEAST_FORCE, LEAST_TORQUE = 30.0, 40.0  # the same without load, N and N m: tank imbalance, air
SUSPICIOUS = 2.5  # square of a slow disturbance in these units from which a thruster is suspected of it

PROBE = np.dtype(
    [
        ("suspect", whole(NONE, MAX_THRUSTERS - 1, of="thrusters")),
        ("rested", FLAG, (MAX_THRUSTERS,)),  # thrusters in use but for the probe
        ("since", "f8"),
        ("before", "f8", (6,)),
        ("share_before", "f8", (MAX_THRUSTERS,)),
        ("sums", SUMS),
        ("rivals", SUMS, (MAX_THRUSTERS,)),
        # evidence, before the probe, that another one is dead, less that the suspect is stuck on
        ("head_start", "f8", (MAX_THRUSTERS,)),
        ("trusted_until", "f8", (MAX_THRUSTERS,)),
    ],
    align=True,
)


@kernel
def explains_slow_part(count, effectiveness, residual, healthy, t, memory):
    """The thruster whose standing thrust accounts for four fifths of a large slow disturbance, or
    ``NONE``.
    """
    slow = residual.slow
    force, torque = LEAST_FORCE + MISALIGNMENT * abs(slow[0]), LEAST_TORQUE + MISALIGNMENT * abs(slow[0])
    weight = (1.0 / (force * force), 1.0 / (torque * torque), 1.0 / (torque * torque))
    size = product(slow, slow, weight)
    found, least = NONE, 0.2 * size
    if size < SUSPICIOUS:
        return found
    for i in range(count):
        if healthy[i] == 0 or t < memory.trusted_until[i]:
            continue
        idle = 1.0 - residual.mean_share[i]
        along = product(slow, effectiveness[i], weight)
        left = size - 2.0 * idle * along + idle * idle * product(effectiveness[i], effectiveness[i], weight)
        if left < least:
            found, least = i, left
    return found if found == NONE or stands(found, effectiveness, residual, weight) else NONE


@kernel
def stands(i, effectiveness, residual, weight):
    """Whether the thrust of ``i``, where it was not asked for, accounts for half of what the last cycles left
    unexplained.
    """
    size, left = 0.0, 0.0
    for k in range(WINDOW):
        seen, idle = residual.recent[k], 1.0 - residual.recent_share[k, i]
        square = product(seen, seen, weight)
        size += square
        left += square - 2.0 * idle * product(seen, effectiveness[i], weight)
        left += idle * idle * product(effectiveness[i], effectiveness[i], weight)
    return left < 0.5 * size


@kernel
def next_suspect(params, count, effectiveness, residual, known, hypotheses, healthy, t, memory):
    """The thruster to shut off for a moment, or ``NONE``."""
    candidate = hypotheses.on_thruster
    if hypotheses.on_evidence > params.prior and t >= memory.trusted_until[candidate]:
        return candidate
    if known < SLOW_KNOWN:
        return NONE
    return explains_slow_part(count, effectiveness, residual, healthy, t, memory)


@kernel
def open_probe(params, i, t, count, branch, residual, hypotheses, memory, healthy, shut):
    """Shut the branch of thruster ``i``, and note force, torque and evidence before."""
    suspected = for_stuck_on(hypotheses.on[i], 0.0)
    for j in range(6):
        memory.before[j] = 0.0
        for back in range(1, BEFORE + 1):
            memory.before[j] += residual.recent[(residual.taken - back) % WINDOW, j] / BEFORE
    for j in range(MAX_THRUSTERS):
        memory.share_before[j] = 0.0
        for back in range(1, BEFORE + 1):
            memory.share_before[j] += residual.recent_share[(residual.taken - back) % WINDOW, j] / BEFORE
        forget(memory.rivals[j])
        memory.head_start[j] = for_loss(params, hypotheses.off[j], 0.0, False)[1] - suspected
    memory.suspect, memory.since = i, t
    forget(memory.sums)
    shut[branch[i]] = 1
    for j in range(count):
        memory.rested[j] = 1 if branch[j] == branch[i] and healthy[j] != 0 else 0
        if memory.rested[j] != 0:
            healthy[j] = 0


@kernel
def close_probe(count, branch, memory, healthy, shut):
    """Put the suspect, and what lies behind the same latch valve, back into use."""
    shut[branch[memory.suspect]] = 0
    for j in range(count):
        if memory.rested[j] != 0:
            healthy[j] = 1
    memory.suspect = NONE


@kernel
def follow_probe(params, count, effectiveness, activity, load, unexplained, t, dt, memory):
    """Let one cycle of a probe count: what is thought of the suspect, and the confidence that it failed."""
    if t < memory.since + 3.0 * dt:
        return UNDER_WAY, 0.0
    weight = weights(params, activity.wrench, load)
    b = effectiveness[memory.suspect]
    before = memory.before
    change = (
        0.0,
        unexplained[1] - before[1],
        unexplained[2] - before[2],
        unexplained[3] - before[3],
        unexplained[4] - before[4],
        unexplained[5] - before[5],
    )
    every = product(change, change, weight)
    unasked = 1.0 - memory.share_before[memory.suspect]
    collect(memory.sums, 1.0, -unasked, product(change, b, weight), product(b, b, weight), every)
    found = evidence(memory.sums, 1.0)
    failed, rivals = exp(found), 0.0
    for j in range(count):
        if j != memory.suspect:
            b = effectiveness[j]
            less = memory.share_before[j] - activity.share[j]
            collect(memory.rivals[j], 1.0, less, product(change, b, weight), product(b, b, weight), every)
            rivals += exp(for_loss(params, memory.rivals[j], 0.0, False)[1] + memory.head_start[j])
    confidence = failed / (failed + exp(params.prior) + rivals)
    if memory.sums.cycles >= LEAST_CYCLES:
        if confidence >= params.confidence:
            return FAILED, confidence
        if found <= -params.prior:
            return SOUND, confidence
    if t >= memory.since + WINDOW * dt:
        refuted = failed <= (1.0 - params.confidence) * (1.0 + rivals)
        return SOUND if refuted else UNDECIDED, confidence
    return UNDER_WAY, confidence
