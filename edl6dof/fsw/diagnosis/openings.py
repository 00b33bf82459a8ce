"""Opening of a valve that nothing commanded, as force and torque show it: the evidence for it, and what the
latch valve of its branch would show.

An opening leaves the signature of a step in the stored innovations of :mod:`edl6dof.fsw.diagnosis.residual`;
the cycle is known, the time within it is not. Evidence against noise of unknown size as in
:mod:`edl6dof.fsw.diagnosis.hypotheses`.

Source: Basseville & Nikiforov 1993, section 2.2 (likelihood ratio of a known change).
"""

from __future__ import annotations

from edl6dof.fsw.diagnosis.flow_evidence import LARGEST, NONE, is_read
from edl6dof.fsw.diagnosis.hypotheses import HIDDEN, plane_evidence
from edl6dof.fsw.diagnosis.residual import PLANES, TAPS, WINDOW, add_response, compare_signature
from edl6dof.interface.effectors import STUCK_ON
from edl6dof.kernels import kernel

SUDDEN = 25.0  # weighted square of innovations from which forces change suddenly
SEEN = 16.0  # the same of two cycles from which openings are looked for: 10 are expected of noise


@kernel
def onset_evidence(i, effectiveness, residual):
    """Return the evidence that the valve of thruster ``i`` has opened within the oldest stored cycle, at the
    most probable of five times, and stays open; negative evidence excludes it.
    """
    first, most = residual.taken - WINDOW, -LARGEST
    for quarters in range(5):
        residual.product[:] = 0.0
        for j in range(WINDOW):
            residual.signature[:] = 0.0
            for m in range(j + 1):
                level = 1.0 - residual.share[(first + m) % TAPS, i]
                add_response(level if m > 0 else 0.25 * quarters * level, j - m, effectiveness, residual)
            compare_signature(first + j, residual)
        found = 0.0
        for g in range(PLANES):
            explained = 2.0 * residual.product[0, g] - residual.product[1, g]
            found += plane_evidence(WINDOW, stored_square(g, WINDOW, residual), explained)
        most = max(most, found)
    return most


@kernel
def stored_square(g, cycles, residual):
    """Return the weighted sum of squares of the ``cycles`` oldest stored innovations of plane ``g``."""
    square = 0.0
    for j in range(cycles):
        square += residual.square[(residual.taken + j) % WINDOW, g]
    return square


@kernel
def total_square(cycles, residual):
    """Return the weighted sum of squares of the ``cycles`` oldest stored innovations of all planes."""
    square = 0.0
    for g in range(PLANES):
        square += stored_square(g, cycles, residual)
    return square


@kernel
def changes(cycles, residual):
    """Return whether the ``cycles`` oldest of the stored innovations show that forces change suddenly."""
    return total_square(cycles, residual) >= SUDDEN


@kernel
def expected_evidence(cycles, effectiveness, residual):
    """Return the evidence of the next ``cycles`` for a leak that is shut off now, if the innovations stay as
    large as the stored ones; ``effectiveness``: force and torque of the thruster (6; N, N m).
    """
    found = 0.0
    residual.product[:] = residual.signature[:] = 0.0
    for j in range(cycles):
        # the response to a step
        add_response(1.0, j, effectiveness, residual)
        compare_signature(residual.taken - 1, residual)
    for g in range(PLANES):
        others, own = stored_square(g, WINDOW, residual) * cycles / WINDOW, residual.product[1, g]
        found += plane_evidence(cycles, others + own, own)
    return found


@kernel
def suspect_leak(params, signals, residual, flow, leak, memory):
    """Make the opening of a valve the best hypothesis if the stored innovations show one. Its confidence
    stays low: moving the latch valve decides. The first cycles of a dead thruster resemble the opening of
    the opposite one; so its evidence has to be twice that of the best loss. Where a meter shows no flow, the
    meter must have failed as well, and twice the evidence is needed.

    ``leak``: ``LEAK`` record; thrusters whose opening may have been hidden are marked. While a latch valve is
    moved, no other is suspected.
    """
    if total_square(2, residual) < SEEN:
        return
    most = LARGEST if leak.branch != NONE else max(params.onset, 2.0 * memory.evidence)
    for i in range(signals.vehicle.n_thrusters):
        b = signals.vehicle.branches.of[i]
        if signals.healthy[i] != 0:
            found = onset_evidence(i, signals.effectiveness[i], residual)
            if found > HIDDEN and leak.unverified[i] == 0:
                leak.unverified[i] = residual.taken
            if is_read(signals.metered, b, flow):
                found -= params.onset
            if found > most:
                most = found
                memory.thruster, memory.branch, memory.kind, memory.loss = i, NONE, STUCK_ON, 0.0
                memory.evidence, memory.confidence = found, 0.0
