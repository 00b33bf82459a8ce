"""Hypotheses about single thrusters and the evidence for each, from force and torque and from the flow.

A thruster that was commanded to fire and has lost the fraction L of its thrust leaves L times its signature
in the innovations of :mod:`edl6dof.fsw.diagnosis.residual`. A valve that stays open does so with L = 1
whenever its thruster is commanded; in addition its opening leaves the signature of a step.

The evidence is the log likelihood ratio against "no thruster has failed" for noise of unknown size in each of
three planes (roll, and the two of a lateral force and its torque): with the weighted sum of squares S of the
innovations of a plane over n cycles, and S' of the innovations less the prediction of the hypothesis, it is
the sum of n (m / 2) ln((S + S0) / (S' + S0)). m counts a plane as one component; S0 is the sum that the
errors of the onboard models explain. A disturbance unlike a thruster, however large, leaves S' near S and is
no evidence; a cycle counts the less, the more of its innovation no fraction of the thrust explains.
Only cycles in which a hypothesis predicts an innovation count for it, and its sums are reset whenever the
evidence contradicts it, so the time of the fault need not be known (Page's test).

Where a flow meter is trusted, its evidence (:mod:`edl6dof.fsw.diagnosis.flow_evidence`) adds to that of force
and torque. The loss of flow then has several explanations, which compete by their posterior odds. Each fault
in an explanation costs the log prior odds P (``prior``) of a healthy vehicle; with F the evidence of the
flow, the log odds are, without one P that all explanations have in common,

    the thruster, or its meter     the flow of the others is not known     F + f_i        F
    the thruster, or its meter     the meter reads the flow of the others  F + f_i        F - P
    the branch, or its meter       the others show the same loss           F + f_b        F
    the thruster, another as well  the others show the same loss           F + f_i - P

f_i is the evidence of force and torque for a loss of thruster i, f_b for none of the branch giving thrust,
whose signature is the sum of those of its thrusters.
One failed meter, or one latch valve stuck shut, is thus more likely by P than two failed thrusters; between a
meter and a thruster or branch, force and torque decide.

Evidence of force and torque for a loss without a loss of flow means a bad catalyst; where flow is missing
too, it means a second fault, of the meter, and costs P more.

Source: signatures from Hu et al. 2022, section 6.3, extended to all thrusters; likelihood ratio and Page's
test from Basseville & Nikiforov 1993, sections 2.2 and 4.3; posterior odds: Bayes' theorem for faults that
occur independently of each other, all with the same prior. Left out: two thrusters that fail in the same
cycles and have the same force and torque.
"""

from __future__ import annotations

from edl6dof.fsw.diagnosis.flow_evidence import (
    CONFIRMED,
    LARGEST,
    NONE,
    UNCHECKED,
    confirmed_loss,
    fires_alone,
    full_flow,
    is_read,
    is_waiting,
)
from edl6dof.fsw.diagnosis.residual import (
    PLANES,
    TAPS,
    WINDOW,
    add_signature,
    compare_signature,
)
from edl6dof.interface.capacities import MAX_BRANCHES, MAX_THRUSTERS
from edl6dof.interface.effectors import DEGRADED, STUCK_OFF
from edl6dof.kernels import kernel
from edl6dof.records import record, whole
from edl6dof.spatial.elementary import exp, log

COMPONENTS = 1.0  # independent components of a plane
LEAST_SEEN = 0.05  # weighted square of a signature from which a cycle counts
OUTLIER = 25.0  # weighted square of the unexplained innovation that halves the weight of a cycle
HIDDEN = -1.0  # evidence for an opening from which it may have been hidden by the disturbance

#: No kind of fault.
NOTHING = 0

#: Weighted sums of a plane over the cycles that count: innovation times prediction, prediction squared,
#: innovation squared; number of cycles.
SUMS = record(("cross", "f8"), ("own", "f8"), ("all", "f8"), ("cycles", "f8"))

HYPOTHESES = record(
    ("off", SUMS, (MAX_THRUSTERS, PLANES)),
    ("dead", SUMS, (MAX_BRANCHES, PLANES)),  # nothing flows through the branch
    # the most probable hypothesis of the last cycle
    ("thruster", whole(0, MAX_THRUSTERS - 1, of="thrusters")),
    ("branch", whole(NONE, MAX_BRANCHES - 1)),  # branch whose thrusters have all failed; NONE: one thruster
    ("kind", whole(NOTHING, DEGRADED)),
    ("loss", "f8"),
    ("evidence", "f8"),
    ("confidence", "f8"),
    ("against", "f8", (MAX_BRANCHES,)),  # evidence that each meter has failed
    ("lost", "f8", (MAX_BRANCHES,)),  # evidence that nothing flows through each branch
    ("meter", whole(NONE, MAX_BRANCHES - 1)),  # meter that has failed with confidence; NONE: none
)


@kernel
def trust(along, square, every):
    """Return the weight of a cycle: the less, the more of the innovation no fraction of the predicted one
    explains; arguments as of :func:`collect`.
    """
    size = min(max(along / square, 0.0), 1.0) if square > 0.0 else 0.0
    return 1.0 / (1.0 + max(every - size * (2.0 * along - size * square), 0.0) / OUTLIER)


@kernel
def collect(sums, keep, along, square, every, share):
    """Add a cycle with the weight ``share`` to the sums of a hypothesis in a plane; ``along``, ``square`` and
    ``every``: weighted products innovation times prediction, prediction squared and innovation squared;
    ``keep``: factor on the sums so far.
    """
    if square < LEAST_SEEN:
        return
    sums.cross = keep * sums.cross + share * along
    sums.own = keep * sums.own + share * square
    sums.all = keep * sums.all + share * every
    sums.cycles = keep * sums.cycles + share


@kernel
def add_innovation(sums, keep, residual):
    """Add the latest innovation, compared with ``residual.signature``, to the sums of a hypothesis."""
    residual.product[:] = 0.0
    compare_signature(residual.taken - 1, residual)
    for g in range(PLANES):
        along, square = residual.product[0, g], residual.product[1, g]
        every = residual.square[(residual.taken - 1) % WINDOW, g]
        collect(sums[g], keep, along, square, every, share=trust(along, square, every))


@kernel
def forget(sums):
    """Reset the sums of a hypothesis."""
    for g in range(PLANES):
        sums[g].cross = sums[g].own = sums[g].all = sums[g].cycles = 0.0


@kernel
def forget_all(memory):
    """Reset every hypothesis."""
    for i in range(MAX_THRUSTERS):
        forget(memory.off[i])
    for b in range(MAX_BRANCHES):
        forget(memory.dead[b])
    memory.kind, memory.evidence, memory.confidence = NOTHING, 0.0, 0.0
    memory.branch = memory.meter = NONE


@kernel
def plane_evidence(cycles, every, explained):
    """Return the log likelihood ratio in a plane of a hypothesis that explains a part of the sum of squares
    ``every``.
    """
    floor = COMPONENTS * cycles
    if floor <= 0.0:
        return 0.0
    return 0.5 * floor * log((every + floor) / (max(every - explained, 0.0) + floor))


@kernel
def evidence(sums, size):
    """Return the log likelihood ratio of a hypothesis with amplitude ``size`` (fraction of thrust lost; 1 for
    an open valve) against no fault.
    """
    found = 0.0
    for g in range(PLANES):
        explained = size * (2.0 * sums[g].cross - size * sums[g].own)
        found += plane_evidence(sums[g].cycles, sums[g].all, explained)
    return min(found, LARGEST)


@kernel
def update_evidence(params, signals, residual, flow, memory):
    """Add one cycle to the evidence of every hypothesis with a prediction. Where flow is missing, a loss
    counts only while the thruster fires alone in its branch, so that force, torque and flow use the same
    cycles.

    Args:
        params: diagnosis record.
        signals: ``DiagnosisSignals``.
        residual: ``RESIDUAL`` record.
        flow: ``FLOW`` record.
        memory: ``HYPOTHESES`` record, updated.
    """
    vehicle, share, effectiveness = signals.vehicle, signals.activity.share, signals.effectiveness
    keep = 1.0 - 1.0 / params.memory_cycles
    for i in range(vehicle.n_thrusters):
        if residual.idle[i] >= TAPS or signals.healthy[i] == 0:
            continue
        b = vehicle.branches.of[i]
        if signals.metered and flow.shows_loss[b] != 0:
            expected = flow.expected[b]
            if expected > 0.0 and not fires_alone(expected, share[i] * full_flow(vehicle.thrusters[i])):
                continue
        residual.signature[:] = 0.0
        add_signature(i, effectiveness[i], residual)
        add_innovation(memory.off[i], keep, residual)
    for b in range(vehicle.branches.count if signals.metered else 0):
        if flow.shows_loss[b] == 0:
            forget(memory.dead[b])
            continue
        residual.signature[:] = 0.0
        for i in range(vehicle.n_thrusters):
            if vehicle.branches.of[i] == b:
                add_signature(i, effectiveness[i], residual)
        add_innovation(memory.dead[b], keep, residual)


@kernel
def loss_evidence(params, sums, least, afresh):
    """Return the fraction of thrust lost that fits force and torque best, and the evidence for it; zeros for
    too small a loss and for evidence below ``least``.

    Too small a loss resets the sums if ``afresh``.
    """
    cross = own = 0.0
    for g in range(PLANES):
        cross, own = cross + sums[g].cross, own + sums[g].own
    if own <= 0.0:
        return 0.0, 0.0
    if cross < params.loss_least * own:
        if afresh:
            forget(sums)
        return 0.0, 0.0
    loss = min(cross / own, 1.0)
    explained = loss * (2.0 * cross - loss * own)
    return (loss, evidence(sums, loss)) if explained >= 2.0 * least else (0.0, 0.0)  # ln(1 + x) <= x


@kernel
def kind_of(params, loss):
    """Return the kind of fault, stuck off or degraded, for a fraction ``loss`` of thrust lost."""
    return STUCK_OFF if loss >= params.loss_dead else DEGRADED


@kernel
def evidence_by_flow_and_thrust(params, vehicle, waiting, i, flow, memory, least):
    """Return (kind, loss, evidence, evidence of the flow alone) for a loss of thruster ``i``, by flow, force
    and torque; :func:`.leak_isolation.leaking_branch` finds open valves by the flow. A meter that reads an
    impossible flow at rest gives no evidence.
    """
    # a bad catalyst loses no flow: where flow is missing too, the meter would have to have failed as well;
    # then force and torque do not restart
    flows = flow.off[i].cycles == 0
    loss, lost = loss_evidence(params, memory.off[i], least, flows)
    kind = kind_of(params, loss)
    if flow.suspecting != 0:  # a loss of flow here or elsewhere would be a second fault
        lost -= params.prior
    if kind == DEGRADED and (waiting or loss < params.loss_least + flow.common):
        lost = 0.0
    less, by_flow = confirmed_loss(params.flow, flow.common, flow.off[i])
    if less < params.loss_dead and waiting or flow.unexplained_rest[vehicle.branches.of[i]] > 0:
        by_flow = 0.0
    felt = evidence(memory.off[i], less) if by_flow > 0.0 else 0.0
    if by_flow + felt > lost:
        return kind_of(params, less), less, by_flow + felt, by_flow
    return kind, loss, lost, by_flow


@kernel
def weigh_explanations(params, flow, memory, b, found):
    """Compare three explanations of a loss of flow at a thruster of branch ``b``: the meter has failed, the
    whole branch is dead, or the thruster has failed. Returns the evidence for the thruster.

    Args:
        memory: ``HYPOTHESES`` record; the evidence that the meter has failed (``against``) and that the
            branch is dead (``lost``) is updated.
        found: fraction of the flow lost; evidence for it by flow, force and torque; evidence by the flow
            alone.
    """
    loss, most, by_flow = found
    if flow.meter_check[b] == CONFIRMED:
        memory.against[b] = max(memory.against[b], by_flow - params.prior)
        return most
    memory.against[b] = max(memory.against[b], by_flow)
    if flow.meter_check[b] == UNCHECKED:
        return most
    if loss >= params.loss_dead:
        memory.lost[b] = max(memory.lost[b], by_flow + evidence(memory.dead[b], 1.0))
    return most - params.prior


@kernel
def compare(params, vehicle, metered, healthy, flow, leak, memory):
    """Find the best hypothesis and its posterior probability among all thrusters, dead branches, failed
    meters and "no fault".

    Of each thruster only the most probable fault counts: which thruster has failed matters more than how.
    Evidence below a quarter of the prior is noise: all thrusters together would have less than one per cent
    of probability with it. A thruster that responds does not leak (``leak``: ``LEAK`` record).
    """
    best, total, least = 0.0, exp(params.prior), 0.25 * params.prior
    for b in range(vehicle.branches.count):
        memory.against[b] = memory.lost[b] = 0.0
    waiting = metered and is_waiting(vehicle.branches, flow)
    memory.kind, memory.branch, memory.meter = NOTHING, NONE, NONE
    for i in range(vehicle.n_thrusters):
        if healthy[i] == 0:
            continue
        b = vehicle.branches.of[i]
        if is_read(metered, b, flow):
            kind, loss, most, by_flow = evidence_by_flow_and_thrust(
                params, vehicle, waiting, i, flow, memory=memory, least=least
            )
            if by_flow > 0.0:
                most = weigh_explanations(params, flow, memory, b, (loss, most, by_flow))
        else:
            if leak.unverified[i] != 0 and evidence(memory.off[i], 1.0) < HIDDEN:
                leak.unverified[i] = 0
            loss, most = loss_evidence(params, memory.off[i], least, True)
            kind = kind_of(params, loss)
        if most >= least:
            total += exp(most)
            if most > best:
                best = most
                memory.thruster, memory.branch, memory.kind, memory.loss = i, NONE, kind, loss
        if memory.lost[b] > best:
            best = memory.lost[b]
            memory.thruster, memory.branch, memory.kind, memory.loss = i, b, STUCK_OFF, 1.0
    for b in range(vehicle.branches.count):
        total += exp(memory.against[b]) if memory.against[b] > 0.0 else 0.0
        total += exp(memory.lost[b]) if memory.lost[b] > 0.0 else 0.0
    for b in range(vehicle.branches.count):
        if flow.meter_check[b] != UNCHECKED and exp(memory.against[b]) > params.confidence * total:
            memory.meter = b
    memory.evidence = best
    memory.confidence = exp(best) / total if memory.kind != NOTHING else 0.0
