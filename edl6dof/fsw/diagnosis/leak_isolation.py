"""Isolation of the leaking thruster of a branch: the latch valve is closed, and the change of force and
torque shows which thruster has stopped.

The meter of a branch detects a flow that was not commanded within two cycles, and the branch is closed at
once, its healthy thrusters included. Then the latch valve is opened and closed again at changing intervals:
the thrust of a leak follows it, that of air and riser does not. The movements give each thruster of the
branch a known signature in the whitened residual, and hence evidence as in
:mod:`edl6dof.fsw.diagnosis.hypotheses`; each movement adds to it, and the test goes on until it decides.

If the meter reads a flow while the branch is closed, the meter has failed and the branch is used again; so it
is if the meter reads none while the branch is open, as when a slow valve has shut at last.
Without a meter, a leak is suspected when force and torque show that a valve opens, and of any thruster that
does not respond; the branch is used again if nothing changes when it is closed. Where a shock (a separation,
an opening canopy) may have hidden the opening of a valve, the branch is closed for a moment as soon as this
would show a leak, unless its thrusters respond to commands before that. All branches that can be verified
are closed and opened together: a single valve leaks, and force and torque show which one. If thrusters of
two branches explain the movements almost equally well, the best branch is tested again, alone.

A valve that opens and shuts at random follows the latch valve in some looks only, and the others do not
exclude it: the likelihood of a look is the mean of those of "open" and "shut". No look counts for more than
its share of what names a thruster, so that no jerk is taken for such a valve.

Source: none; to switch an input on and off in order to separate its effect from drifts is the lock-in
technique of measurement.
"""

from __future__ import annotations

from edl6dof.fsw.diagnosis.flow_evidence import (
    LARGEST,
    MOST_UNEXPLAINED,
    NONE,
    full_flow,
    is_impossible,
    is_read,
)
from edl6dof.fsw.diagnosis.hypotheses import (
    SUMS,
    add_innovation,
    evidence,
    forget,
)
from edl6dof.fsw.diagnosis.openings import changes, expected_evidence
from edl6dof.fsw.diagnosis.residual import (
    AXES,
    PLANES,
    TAPS,
    WINDOW,
    add_response,
    decorrelate,
    fires_mostly,
    is_settled,
)
from edl6dof.interface.capacities import MAX_BRANCHES, MAX_THRUSTERS
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, FLAG, record, whole
from edl6dof.spatial.elementary import exp, log

UNDER_WAY, NAMED, METER_FAILED, HEALTHY = range(4)
#: Control cycles after a movement of the latch valve whose flow is not used, and the following ones that make
#: a look.
MIXED, LOOK = 1, 3
PATIENCE = 25  # cycles in which a thruster in use may respond before its branch is closed to verify it
FEW_LOOKS = 4  # a branch is closed to verify it only if so many looks are expected to decide
LEAST_LOOKS = 3  # in fewer an opening parachute can resemble a thruster; one less if a meter shows the leak
MOST_LOOKS = 20  # looks after which a leak that a meter shows is named, and any other suspicion dropped
ALIKE = 0.5  # share of the evidence for the best candidate from which another one may be the leaking one
SUPPORT = 1.0  # evidence of looks above which they support a leak; in a large disturbance chance gives less

LEAK = record(
    ("branch", whole(NONE, MAX_BRANCHES - 1)),  # under suspicion; NONE: no leak is being isolated
    ("tested", FLAG, (MAX_BRANCHES,)),  # this branch, and those that are closed and opened with it
    ("latch_closed", FLAG, (MAX_BRANCHES,)),  # branches whose latch valve is to be closed
    ("candidate", FLAG, (MAX_THRUSTERS,)),  # thrusters of these branches that were in use
    ("metered", FLAG),  # a meter shows that one of them leaks
    ("doubt", "f8"),  # without a meter, log prior odds that none leaks
    ("size", "f8", (MAX_THRUSTERS,)),  # thrust of each if it leaks, share of the full thrust
    ("open", FLAG),  # the latch valve is open
    ("cycles", COUNT),  # since the latch valve moved
    ("looks", COUNT),
    ("level", "f8", (TAPS,)),  # share of each cycle for which the latch valve was open, a ring
    ("flow", "f8"),  # kg/s: mean flow read after
    ("sums", SUMS, (MAX_THRUSTERS, PLANES)),  # of the present look
    ("found", "f8", (MAX_THRUSTERS,)),  # evidence of the looks before: the noise of each is unknown
    ("random", "f8", (MAX_THRUSTERS,)),  # the same for a valve that opens and shuts at random
    ("best", whole(0, MAX_THRUSTERS - 1, of="thrusters")),
    ("unverified", COUNT, (MAX_THRUSTERS,)),  # cycle since which the valve may be open unseen; 0: not
    ("next", whole(0, MAX_THRUSTERS - 1, of="thrusters")),  # the one that is verified next
)


@kernel
def leaking_branch(params, vehicle, healthy, flow):
    """Return the branch with the most evidence for a flow that was not commanded, else one with a small leak,
    or ``NONE``.
    """
    found, most = NONE, params.prior
    for i in range(vehicle.n_thrusters):
        b = vehicle.branches.of[i]
        if healthy[i] == 0 or flow.meter_failed[b] != 0:
            continue
        if flow.on[i] > most:
            found, most = b, flow.on[i]
        elif found == NONE and flow.unexplained_rest[b] >= MOST_UNEXPLAINED:
            found = b
    return found


@kernel
def is_commanded(b, vehicle, residual):
    """Return whether the latest innovation depends on commands to a thruster of branch ``b``."""
    idle = TAPS
    for i in range(vehicle.n_thrusters):
        if vehicle.branches.of[i] == b:
            idle = min(idle, residual.idle[i])
    return idle < TAPS


@kernel
def would_decide(params, signals, residual, b):
    """Return whether ``FEW_LOOKS`` movements of the latch valve of branch ``b`` are expected to show for each
    of its thrusters whether it leaks.
    """
    least = -log(1.0 - params.confidence) / FEW_LOOKS
    for i in range(signals.vehicle.n_thrusters):
        on_branch = signals.vehicle.branches.of[i] == b
        if on_branch and expected_evidence(LOOK, signals.effectiveness[i], residual) < least:
            return False
    return True


@kernel
def is_unverified(signals, i, flow, memory):
    """Return whether the valve of thruster ``i``, without a meter, may have opened without being seen."""
    unmetered = not is_read(signals.metered, signals.vehicle.branches.of[i], flow)
    return memory.unverified[i] != 0 and signals.healthy[i] != 0 and unmetered


@kernel
def branch_to_verify(params, signals, residual, flow, memory):
    """Return the branch of the next thruster without a meter whose valve may have opened without being seen,
    if the latch valve would decide that now, or ``NONE``. Thrusters in use have time to respond before that;
    one that fires is needed, and a leak adds little to it.
    """
    count = signals.vehicle.n_thrusters
    for _ in range(count):
        memory.next = (memory.next + 1) % count
        if is_unverified(signals, memory.next, flow, memory):
            break
    i, b = memory.next, signals.vehicle.branches.of[memory.next]
    opening = changes(WINDOW, residual) and not changes(1, residual)  # still to be evaluated
    if opening or not is_unverified(signals, i, flow, memory) or fires_mostly(i, residual):
        return NONE
    if residual.taken - memory.unverified[i] < PATIENCE and is_commanded(b, signals.vehicle, residual):
        return NONE
    return b if would_decide(params, signals, residual, b) else NONE


@kernel
def start_leak_isolation(signals, b, metered, leak, doubt, memory):
    """Take branch ``b`` out of use to isolate a leak, and close it if its meter shows the leak (``metered``),
    of the flow ``leak`` (kg/s); ``doubt``: otherwise the log prior odds that no thruster leaks.
    """
    memory.metered, memory.doubt = 1 if metered else 0, doubt
    memory.branch, memory.looks, memory.flow = b, 0, 0.0
    memory.open, memory.cycles = 0 if metered else 1, 0 if metered else MIXED + LOOK
    memory.found[:] = memory.random[:] = 0.0
    memory.candidate[:] = memory.tested[:] = 0
    for j in range(TAPS):
        memory.level[j] = memory.open
    take_branch(signals, b, leak, memory)


@kernel
def take_branch(signals, b, leak, memory):
    """Take branch ``b`` out of use, to close and to open it; ``leak``: its flow if a meter shows it, kg/s."""
    vehicle = signals.vehicle
    memory.tested[b], memory.latch_closed[b] = 1, 1 - memory.open
    for i in range(vehicle.n_thrusters):
        if vehicle.branches.of[i] == b:
            forget(memory.sums[i])
            memory.candidate[i], signals.healthy[i] = signals.healthy[i], 0
            memory.size[i] = min(leak / full_flow(vehicle.thrusters[i]), 1.0) if memory.metered != 0 else 1.0


@kernel
def take_others(params, signals, residual, flow, memory):
    """Test with the branch under suspicion all others at rest that are to be verified and would be decided:
    only one valve leaks, and the forces and torques of the thrusters differ.
    """
    vehicle = signals.vehicle
    for i in range(vehicle.n_thrusters):
        b = vehicle.branches.of[i]
        at_rest = is_unverified(signals, i, flow, memory) and not is_commanded(b, vehicle, residual)
        if at_rest and would_decide(params, signals, residual, b):
            take_branch(signals, b, 0.0, memory)


@kernel
def open_share(signals, cycles, memory):
    """Return the share of the cycle number ``cycles`` after the latch valve has moved in which it is open."""
    moved = min(max(cycles - signals.lag / signals.dt, 0.0), 1.0)
    return moved if memory.open != 0 else 1.0 - moved


@kernel
def predict_leak(cycle, effectiveness, residual, memory):
    """Write the innovation that a leak at full thrust causes in a cycle into ``residual.signature``;
    ``effectiveness``: force and torque of the thruster (6; N, N m).
    """
    residual.signature[:] = 0.0
    for j in range(TAPS):
        add_response(memory.level[(cycle - j) % TAPS], j, effectiveness, residual)


@kernel
def presume_leak(signals, residual, memory):
    """Keep the leak of the best candidate out of the noise model of the next cycle, if there is evidence for
    it: the movements of the latch valve would make the noise grow.
    """
    i = memory.best
    if memory.found[i] <= 0.0:
        return
    coming, effectiveness = residual.taken, signals.effectiveness[i]
    memory.level[coming % TAPS] = open_share(signals, memory.cycles + 1, memory)
    predict_leak(coming, effectiveness, residual, memory)
    decorrelate(residual.signature, residual)
    moved = memory.level[coming % TAPS] - memory.level[(coming - 1) % TAPS]
    for c in range(AXES):
        residual.presumed[0, c] = memory.size[i] * moved * effectiveness[c + 1]
        residual.presumed[1, c] = memory.size[i] * residual.signature[c]


@kernel
def add_cycle(signals, residual, memory):
    """Add a cycle to the evidence that each candidate leaks, unless an event has just changed the forces."""
    newest, count = residual.taken - 1, signals.vehicle.n_thrusters
    memory.level[newest % TAPS] = open_share(signals, memory.cycles, memory)
    for i in range(count if is_settled(residual) else 0):
        if memory.candidate[i] != 0:
            predict_leak(newest, signals.effectiveness[i], residual, memory)
            add_innovation(memory.sums[i], 1.0, residual)


@kernel
def end_look(params, i, memory):
    """Add the look that ends to the evidence that candidate ``i`` leaks, and return the sum. Its valve may
    open and shut at random, unless the flow or a missing response has raised the suspicion.
    """
    look = evidence(memory.sums[i], memory.size[i])
    forget(memory.sums[i])
    memory.found[i] += look
    if memory.metered != 0 or memory.doubt <= 0.0:
        return memory.found[i]
    most = (memory.doubt - log(1.0 - params.confidence)) / LEAST_LOOKS
    memory.random[i] += min(log(0.5 + 0.5 * exp(look)), most)
    return max(memory.found[i], memory.random[i]) if memory.random[i] > 0.0 else memory.found[i]


@kernel
def most_probable(params, count, memory):
    """End a look, and find the best candidate. Returns its evidence, and its probability among the
    candidates; without a meter "none leaks" is one more.
    """
    most, total = -LARGEST, 0.0
    for i in range(count):
        if memory.candidate[i] != 0:
            found = end_look(params, i, memory)
            if memory.metered == 0 and exp(found) < 1.0 - params.confidence:
                memory.unverified[i] = 0
            if found > most:
                total = total * exp(most - found) + 1.0
                memory.best, most = i, found
            else:
                total += exp(found - most)
    if memory.metered == 0:
        total += exp(min(memory.doubt - most, LARGEST))
    return most, 1.0 / total


@kernel
def is_in_vain(params, signals, residual, most, memory):
    """Return whether to stop without a decision, where no meter shows the leak: when the disturbance has
    become too large for a suspicion that the looks do not support, or after many looks. ``most``: evidence
    for the best candidate. The thrusters that are not excluded stay unverified.
    """
    if most > SUPPORT:
        return memory.looks >= 2 * MOST_LOOKS
    branch = signals.vehicle.branches.of[memory.best]
    too_noisy = memory.doubt > 0.0 and not would_decide(params, signals, residual, branch)
    return too_noisy or memory.looks >= MOST_LOOKS


@kernel
def step_leak_isolation(params, signals, flow, residual, memory):
    """Run one control cycle of leak isolation. Returns the result (``UNDER_WAY`` until it is decided) and its
    confidence.

    The time between movements varies, as a canopy that breathes at their frequency would resemble a thruster.
    """
    b, vehicle, count = memory.branch, signals.vehicle, signals.vehicle.n_thrusters
    memory.cycles += 1
    unmoved = memory.looks == 0 and memory.open != memory.metered
    # cycles in which the innovations still depend on the leak before the branch was closed: when it began is
    # not known, and its signature would have the wrong sign
    past = TAPS + signals.lag / signals.dt if memory.metered != 0 else 0.0
    if unmoved and (memory.cycles < past or is_commanded(b, vehicle, residual)):
        return UNDER_WAY, 0.0
    add_cycle(signals, residual, memory)
    if MIXED < memory.cycles <= MIXED + LOOK:
        memory.flow += (flow.residual[b] + flow.expected[b]) / LOOK
    if memory.cycles == MIXED + LOOK:
        flows = is_impossible(b, memory.flow, flow)
        if memory.open == 0 and flows:
            return METER_FAILED, 1.0
        if memory.open != 0 and memory.metered != 0 and not flows:
            return HEALTHY, 1.0
        if memory.looks < LEAST_LOOKS or not changes(WINDOW, residual):
            memory.looks += 1  # of those while forces change none is the last
        most, confidence = most_probable(params, count, memory)
        if memory.metered == 0 and exp(most) < 1.0 - params.confidence:
            return HEALTHY, confidence
        sure, least = confidence >= params.confidence, LEAST_LOOKS - memory.metered
        if memory.metered == 0 and not sure and is_in_vain(params, signals, residual, most, memory):
            return HEALTHY, confidence
        if sure and memory.looks >= least or memory.metered != 0 and memory.looks >= MOST_LOOKS:
            if not is_ambiguous(vehicle, most, memory):
                return NAMED, confidence
            confirm(signals, vehicle.branches.of[memory.best], memory)
    if memory.cycles >= MIXED + LOOK + memory.looks % 3:
        memory.open = 1 - memory.open
        for k in range(MAX_BRANCHES):
            if memory.tested[k] != 0:
                memory.latch_closed[k] = 1 - memory.open
        memory.flow, memory.cycles = 0.0, 0
    presume_leak(signals, residual, memory)
    return UNDER_WAY, 0.0


@kernel
def is_ambiguous(vehicle, most, memory):
    """Return whether a candidate of another branch explains the looks almost as well as the best one, which
    has the evidence ``most``: errors of effectiveness and noise model grow with the evidence.
    """
    branch = vehicle.branches.of[memory.best]
    for i in range(vehicle.n_thrusters):
        other = memory.candidate[i] != 0 and vehicle.branches.of[i] != branch
        if other and memory.found[i] > ALIKE * most:
            return True
    return False


@kernel
def confirm(signals, b, memory):
    """Test branch ``b`` alone, and use the others again: thrusters that act almost alike, and were shut off
    together, differ then.
    """
    for k in range(MAX_BRANCHES):
        if k != b:
            memory.tested[k] = memory.latch_closed[k] = 0
    for i in range(signals.vehicle.n_thrusters):
        if memory.candidate[i] != 0 and signals.vehicle.branches.of[i] != b:
            memory.candidate[i], signals.healthy[i] = 0, 1
    memory.branch, memory.looks = b, 0
    memory.found[:] = memory.random[:] = 0.0


@kernel
def end_test(vehicle, shut, memory, healthy):
    """Open the latch valves of the tested branches, and use their candidates again; only branch ``shut`` (or
    ``NONE``) is closed and stays out of use.
    """
    for b in range(MAX_BRANCHES):
        if memory.tested[b] != 0:
            memory.latch_closed[b] = 1 if b == shut else 0
    for i in range(vehicle.n_thrusters):
        if memory.candidate[i] != 0 and vehicle.branches.of[i] != shut:
            healthy[i] = 1
    memory.branch = NONE
