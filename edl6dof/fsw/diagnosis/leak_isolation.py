"""Isolation of the leaking thruster of a branch: the latch valve is closed, and the change of force and
torque shows which thruster has stopped.

The meter of a branch detects a flow that was not commanded within two cycles, and the branch is closed at
once, its healthy thrusters included. The leak shows in changes of the unexplained force and torque: when it
begins, and each time the latch valve moves. Each such change c, a look, is compared with the effect b_i of
each thruster i of the branch: over n looks the sum of squares S_i of c - b_i gives the evidence n (m / 2)
ln((S + S0) / (S_i + S0)) as in :mod:`edl6dof.fsw.diagnosis.hypotheses`. A change within some tenths of a
second is hardly disturbed by air or riser; where one look does not decide, the branch is opened and closed
again, and leaks meanwhile.

If the meter reads a flow while the branch is closed, the meter has failed and the branch is used again.
Without a meter, a leak is suspected of any thruster that does not respond by force and torque; the branch is
used again if nothing changes when it is closed.

Source: none; to switch an input on and off in order to separate its effect from drifts is the lock-in
technique of measurement.
"""

from __future__ import annotations

from edl6dof.fsw.diagnosis.flow_evidence import LARGEST, NONE, is_impossible
from edl6dof.fsw.diagnosis.hypotheses import SUMS, collect, evidence, forget, weights
from edl6dof.fsw.diagnosis.residual import WINDOW, product
from edl6dof.interface.capacities import MAX_BRANCHES, MAX_THRUSTERS
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, FLAG, record, whole
from edl6dof.spatial.elementary import exp

UNDER_WAY, NAMED, METER_FAILED, HEALTHY = range(4)
#: Control cycles after a movement of the latch valve that are not used, and the following ones that make a
#: look.
MIXED, LOOK = 1, 3
SURELY_BEFORE = 5  # cycles: so long ago a leak just detected had not begun
LEAST_LOOKS = 3  # in one or two looks an opening parachute can resemble another thruster
MOST_LOOKS = 20  # looks after which the most probable thruster is isolated in any case

LEAK = record(
    ("branch", whole(NONE, MAX_BRANCHES - 1)),  # NONE: no leak is being isolated
    ("latch_closed", FLAG, (MAX_BRANCHES,)),  # branches whose latch valve is to be closed
    ("candidate", FLAG, (MAX_THRUSTERS,)),  # thrusters of the branch that were in use
    ("metered", FLAG),  # a meter shows that one of them leaks
    ("open", FLAG),  # the latch valve is open
    ("cycles", COUNT),  # since the latch valve moved
    ("looks", COUNT),
    ("before", "f8", (6,)),  # N, N m: mean unexplained wrench before the latch valve moved
    ("after", "f8", (6,)),  # N, N m: mean after
    ("flow", "f8"),  # kg/s: mean flow read after
    # share of the cycle before in which each thruster was commanded closed, so that a leak shows
    ("idle", "f8", (MAX_THRUSTERS,)),
    ("sums", SUMS, (MAX_THRUSTERS,)),
    ("best", whole(0, MAX_THRUSTERS - 1, of="thrusters")),
)


@kernel
def leaking_branch(params, vehicle, healthy, flow):
    """Return the branch with the most evidence for a flow that was not commanded, or ``NONE``."""
    found, most = NONE, params.prior
    for i in range(vehicle.n_thrusters):
        b = vehicle.branches.of[i]
        if healthy[i] != 0 and flow.on[i] > most and flow.meter_failed[b] == 0:
            found, most = b, flow.on[i]
    return found


@kernel
def mean_of(residual, first, last, mean):
    """Write the mean unexplained force and torque of the cycles from ``last`` to ``first`` cycles ago."""
    for j in range(6):
        mean[j] = 0.0
        for back in range(first, last + 1):
            mean[j] += residual.recent[(residual.taken - back) % WINDOW, j] / (last - first + 1)


@kernel
def compare_change(params, signals, sign, memory):
    """Add a look: compare the change of the wrench with ``sign`` times the effect of each candidate; +1: the
    leak has begun, -1: it has stopped.
    """
    weight = weights(params, signals.activity.wrench, signals.load)
    before, after = memory.before, memory.after
    change = (
        0.0,
        after[1] - before[1],
        after[2] - before[2],
        after[3] - before[3],
        after[4] - before[4],
        after[5] - before[5],
    )
    every = product(change, change, weight)
    for i in range(signals.vehicle.n_thrusters):
        if memory.candidate[i] != 0:
            b = signals.effectiveness[i]
            along, square = product(change, b, weight), product(b, b, weight)
            signature = sign * memory.idle[i]
            collect(memory.sums[i], 1.0, signature, along, square, every=every)
    memory.looks += 1


@kernel
def start_leak_isolation(params, signals, b, metered, residual, memory):
    """Close branch ``b`` to isolate a leak; the beginning of the leak is the first look if its meter shows it
    (``metered``).
    """
    vehicle, healthy = signals.vehicle, signals.healthy
    memory.metered = 1 if metered else 0
    memory.branch, memory.open, memory.cycles, memory.looks, memory.flow = b, 0, 0, 0, 0.0
    for i in range(vehicle.n_thrusters):
        forget(memory.sums[i])
        memory.idle[i] = 1.0 - signals.activity.share[i]
        on_branch = vehicle.branches.of[i] == b
        memory.candidate[i] = 1 if on_branch and healthy[i] != 0 else 0
        if on_branch:
            healthy[i] = 0
    memory.latch_closed[b] = 1
    mean_of(residual, 1, 1, memory.after)
    if metered and residual.taken >= SURELY_BEFORE + LOOK:
        mean_of(residual, SURELY_BEFORE, SURELY_BEFORE + LOOK - 1, memory.before)
        compare_change(params, signals, 1.0, memory)
    restart_look(residual, memory)


@kernel
def restart_look(residual, memory):
    """Take the last cycles as those before a movement of the latch valve."""
    mean_of(residual, 1, 1 if memory.looks < 2 else LOOK, memory.before)
    for j in range(6):
        memory.after[j] = 0.0
    memory.flow, memory.cycles = 0.0, 0


@kernel
def most_probable(count, memory):
    """Find the best candidate. Returns its probability among the candidates; without a meter "none leaks" is
    one more.
    """
    most, total = -LARGEST, 0.0
    for i in range(count):
        if memory.candidate[i] != 0:
            found = evidence(memory.sums[i], 1.0)
            if found > most:
                total = total * exp(most - found) + 1.0
                memory.best, most = i, found
            else:
                total += exp(found - most)
    if memory.metered == 0:
        total += exp(min(-most, LARGEST))
    return 1.0 / total


@kernel
def step_leak_isolation(params, signals, flow, residual, memory):
    """Run one control cycle of leak isolation. Returns the result (``UNDER_WAY`` until it is decided) and its
    confidence.

    The time between looks varies, as a canopy that breathes at the frequency of the looks would resemble a
    thruster.
    """
    b, count = memory.branch, signals.vehicle.n_thrusters
    memory.cycles += 1
    if MIXED < memory.cycles <= MIXED + LOOK:
        for j in range(6):
            memory.after[j] += signals.unexplained[j] / LOOK
        memory.flow += (flow.residual[b] + flow.expected[b]) / LOOK
    if memory.cycles == MIXED + LOOK:
        if memory.open == 0 and is_impossible(b, memory.flow, flow):
            return METER_FAILED, 1.0
        sign = 1.0 if memory.open != 0 else -1.0
        compare_change(params, signals, sign, memory)
        for i in range(count):
            memory.idle[i] = 1.0
        confidence = most_probable(count, memory)
        if memory.metered == 0 and confidence < 1.0 - params.confidence:
            return HEALTHY, confidence
        if memory.looks >= LEAST_LOOKS and confidence >= params.confidence or memory.looks >= MOST_LOOKS:
            if memory.metered == 0 and confidence < params.confidence:
                return HEALTHY, confidence
            memory.open = 0
            memory.latch_closed[b] = 1
            return NAMED, confidence
    if memory.cycles >= MIXED + LOOK + 2 * (memory.looks % 3):
        memory.open = 1 - memory.open
        memory.latch_closed[b] = 1 - memory.open
        restart_look(residual, memory)
    return UNDER_WAY, 0.0


@kernel
def reopen_branch(count, memory, healthy):
    """Open the latch valve of the branch, and use its candidates again."""
    memory.latch_closed[memory.branch] = 0
    for i in range(count):
        if memory.candidate[i] != 0:
            healthy[i] = 1
