"""Evidence of the flow meters of the propellant branches for faults of each thruster.

A thruster i with the full flow f_i that was commanded to fire for the share e of a cycle causes the flow e
f_i in its branch. The reading of a meter less the expected flow of the branch is

    - L e f_i if it loses the fraction L of its flow (L = 1: stuck off) + (1 - e) f_i if its valve stays open

whatever forces air, riser and engine exert, and for as long as the fault lasts. The errors of a meter are
known, so the evidence is the plain log likelihood ratio against "healthy": a running sum that never falls
below zero for a valve that stays open (Page's test), a regression over the last cycles of use for a loss. A
cycle with another loss than those before it restarts the regression: the fault is younger than they are. If
flow is missing while several thrusters of a branch fire, each of them is doubtful and is then tested alone.

A loss that all branches show has its cause in the propellant: only the excess over this common loss counts
for a thruster. So before a thruster is called degraded, other branches have to be seen in use since the first
sign of its loss; a thruster without flow is dead, whatever the other branches show.

A meter that has failed shows a loss for every thruster of its branch, so the other thrusters of the branch
are fired too. Only readings with their flow decide, and only after the loss has shown in two cycles: in the
cycle in which a meter or a thruster fails, the flow is a fraction of the expected one, and a frozen reading
may equal the flow of any thruster. A meter that reads the flow of the others works; if they show the same
loss, the meter or the latch valve has failed. The thrusters of the branch are then tested alone until force
and torque distinguish these two, and stay in use until then. No valve causes a negative reading, or a flow at
rest that is smaller than that of an open valve, unless it leaks. While a meter reads such a flow, its
readings are no evidence of a loss; closing the latch valve distinguishes a leak from a failed meter.

Source: Basseville & Nikiforov 1993, sections 2.2 and 4.3; Hu et al. 2022, section 6.3, diagnose by force and
torque alone.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.config.base import Params, param
from edl6dof.config.units import G0
from edl6dof.interface.capacities import MAX_BRANCHES, MAX_THRUSTERS
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, FLAG, record, whole

LEAST_USE = 0.1  # share of a cycle from which a commanded pulse, or a closed valve, gives evidence
LARGEST = 200.0  # upper limit of evidence
MOST_A_CYCLE = 10.0  # most evidence for an open valve in a cycle: one reading alone is not enough
STEADY = 0.15  # losses of two cycles that differ by less count as the same loss
POOLED = 0.9  # factor on the earlier cycles in the loss of a branch, at each cycle of use
ALONE = 0.1  # flow of the others in the branch, over its own, up to which a thruster fires alone
DOUBT = 4.0  # standard deviations of a meter from which flow is missing
LEAST_CYCLES = 2  # cycles of use before a loss is confirmed: the fault may begin within the first
SURE = 900.0  # inverse variance of the loss of a branch from which it counts: sigma of 3 %
LEAST_BRANCHES = 3  # branches that must show a loss before it is attributed to the propellant
METER_ERROR = 6.0  # standard deviations of a meter from which a reading is no error of a zero flow
LEAST_OPEN = 0.5  # least flow of an open valve, over that of the smallest thruster of the branch
MOST_UNEXPLAINED = 3  # cycles of rest in a row with a smaller flow: a valve leaks, or the meter has failed
NONE = -1
#: Check of a meter by the other thrusters of a branch in which one shows a loss: open; the meter reads their
#: flow; it shows the same loss for them.
UNCHECKED, CONFIRMED, CONTRADICTED = range(3)
LEAST_CHECK_FLOW = 0.15  # flow of the others, over the full flow of the branch, from which the check decides
SHARED = 0.6  # loss of the others, over that of the thruster, from which it is the same


class FlowParams(Params):
    """Evidence of the flow meters."""

    model_error: float = param(
        0.03,
        "relative error of the flow that is computed from the commands of a cycle, including "
        "that of the valve times",
        status="estimate",
        ge=0.0,
        le=1.0,
    )
    loss_least: float = param(
        0.12, "fraction of flow lost from which a thruster is reported", status="estimate", gt=0.0, le=1.0
    )
    common_least: float = param(
        0.03,
        "loss in all branches from which it is attributed to the propellant supply",
        status="estimate",
        gt=0.0,
        le=1.0,
    )


#: Weighted sums over cycles: residual times prediction, prediction squared; number of cycles.
LOSS = record(("cross", "f8"), ("own", "f8"), ("cycles", COUNT))

FLOW = record(
    ("used", "f8", (MAX_BRANCHES,)),  # kg: last counts of the meters
    ("started", FLAG),
    ("expected", "f8", (MAX_BRANCHES,)),  # kg/s: mean flow by the commands in the last cycle
    ("residual", "f8", (MAX_BRANCHES,)),  # kg/s: flow read less expected
    ("weight", "f8", (MAX_BRANCHES,)),  # 1/(kg/s)2: inverse variance of the residual
    ("unexplained_rest", COUNT, (MAX_BRANCHES,)),  # cycles of rest in a row with an impossible flow
    ("pool", LOSS, (MAX_BRANCHES,)),  # loss of each branch, while suspecting since the first sign
    ("seen", COUNT),  # branches whose loss is known well enough
    ("suspecting", FLAG),  # a thruster shows a loss
    ("common", "f8"),  # fraction of flow that all branches lack
    ("known_loss", "f8", (MAX_THRUSTERS,)),  # fraction of flow lost by degraded thrusters that stay in use
    ("shows_loss", FLAG, (MAX_BRANCHES,)),  # whether a thruster of each branch shows a loss
    # check of each meter by the other thrusters
    ("meter_check", whole(UNCHECKED, CONTRADICTED), (MAX_BRANCHES,)),
    ("test_requested", FLAG, (MAX_THRUSTERS,)),  # whether each is to fire for the check
    ("meter_failed", FLAG, (MAX_BRANCHES,)),
    ("failed_at", "f8", (MAX_BRANCHES,)),  # s, flight time at which the failure was found
    ("off", LOSS, (MAX_THRUSTERS,)),  # loss of each thruster, from cycles in which it fired alone
    ("on", "f8", (MAX_THRUSTERS,)),  # evidence for a valve that stays open
    # flow was missing while others of its branch fired too, or its meter may have failed
    ("doubtful", FLAG, (MAX_THRUSTERS,)),
)


@kernel
def full_flow(thruster):
    """Return the propellant flow of a thruster at full thrust, kg/s."""
    return thruster.thrust / (thruster.specific_impulse * G0)


@kernel
def is_read(metered, b, memory):
    """Return whether branch ``b`` has a flow meter that has not failed."""
    return metered and memory.meter_failed[b] == 0


@kernel
def forget_loss(loss):
    """Reset the sums of a ``LOSS`` record."""
    loss.cross = loss.own = 0.0
    loss.cycles = 0


@kernel
def read_meters(params, instruments, vehicle, used, share, dt, memory):
    """Compute residual and weight of each branch for the measured cycle. Returns whether there was an earlier
    reading, without which they are not valid.

    Args:
        params: flow record.
        instruments, vehicle: errors of the meters; believed thrusters and branches.
        used: counts of the meters at the end of the measured cycle, kg.
        share: share of that cycle in which each thruster should have given thrust.
        dt: control cycle, s.
        memory: ``FLOW`` record, updated.
    """
    branches = vehicle.branches
    idle = instruments.flow_noise_share**2 / dt + instruments.flow_bias_share**2
    running = instruments.flow_scale_sigma**2 + params.model_error**2
    for b in range(branches.count):
        memory.residual[b] = (used[b] - memory.used[b]) / dt
        memory.used[b] = used[b]
        memory.expected[b] = 0.0
    for i in range(vehicle.n_thrusters):
        memory.expected[branches.of[i]] += (
            share[i] * (1.0 - memory.known_loss[i]) * full_flow(vehicle.thrusters[i])
        )
    for b in range(branches.count):
        expected, full = memory.expected[b], branches.full_flow[b]
        memory.weight[b] = 1.0 / (idle * full * full + running * expected * expected)
        memory.residual[b] -= expected
    monitor_rest(vehicle, memory)
    started = memory.started != 0
    memory.started = 1
    return started


@kernel
def monitor_rest(vehicle, memory):
    """Count for each meter the cycles of rest in a row with an impossible flow, one smaller than that of an
    open valve.
    """
    for b in range(vehicle.branches.count):
        if memory.expected[b] > 0.0:
            continue
        flow = memory.residual[b]
        unexplained_rest = is_impossible(b, flow, memory) and flow < LEAST_OPEN * least_flow(vehicle, b)
        memory.unexplained_rest[b] = memory.unexplained_rest[b] + 1 if unexplained_rest else 0


@kernel
def least_flow(vehicle, b):
    """Return the flow of the smallest thruster of branch ``b``, kg/s."""
    least = vehicle.branches.full_flow[b]
    for i in range(vehicle.n_thrusters):
        if vehicle.branches.of[i] == b:
            least = min(least, full_flow(vehicle.thrusters[i]))
    return least


@kernel
def impossible_meter(metered, branches, memory):
    """Return the first branch whose trusted meter reads a negative flow, or ``NONE``."""
    for b in range(branches.count):
        flow = memory.residual[b] + memory.expected[b]
        if is_read(metered, b, memory) and flow < 0.0 and is_impossible(b, flow, memory):
            return b
    return NONE


@kernel
def is_impossible(b, flow, memory):
    """Return whether ``flow`` (kg/s) exceeds the largest error of the meter of branch ``b`` at zero flow."""
    return flow * flow * memory.weight[b] > METER_ERROR * METER_ERROR


@kernel
def find_common_loss(params, branches, memory):
    """Update the losses of the branches, and compute the loss that all branches in use share."""
    memory.seen, least = 0, 1.0
    for b in range(branches.count):
        pool, expected = memory.pool[b], memory.expected[b]
        if memory.meter_failed[b] == 0 and expected > 0.0:
            pool.cross = POOLED * pool.cross - expected * memory.residual[b] * memory.weight[b]
            pool.own = POOLED * pool.own + expected * expected * memory.weight[b]
            pool.cycles += 1
        if pool.own > SURE:
            memory.seen += 1
            least = min(least, pool.cross / pool.own)
    if memory.seen >= min(LEAST_BRANCHES, branches.count):
        memory.common = least if least > params.common_least else 0.0


@kernel
def restart_pools(count, branches, memory):
    """Reset the losses of the branches at the first sign of a loss of a thruster."""
    signs = 0
    for i in range(count):
        signs += memory.off[i].cycles
    if signs > 0 and memory.suspecting == 0:
        for b in range(branches.count):
            forget_loss(memory.pool[b])
        memory.seen = 0
    memory.suspecting = 1 if signs > 0 else 0


@kernel
def cross_check(params, vehicle, share, memory):
    """Check the meter of each branch in which a thruster shows a loss by the flow of its other thrusters;
    request their firing until the check has decided.
    """
    of, count = vehicle.branches.of, vehicle.n_thrusters
    for i in range(count):
        memory.test_requested[i] = 0
    for b in range(vehicle.branches.count):
        most, least = 0, LEAST_CHECK_FLOW * vehicle.branches.full_flow[b]
        for i in range(count if memory.suspecting != 0 else 0):
            if of[i] == b:
                most = max(most, memory.off[i].cycles)
        memory.shows_loss[b] = 1 if most > 0 else 0
        if most < LEAST_CYCLES:
            memory.meter_check[b] = UNCHECKED
            continue
        for i in range(count):
            if of[i] == b and memory.off[i].cycles >= LEAST_CYCLES:
                loss = memory.off[i].cross / memory.off[i].own
                given = share[i] * (1.0 - memory.known_loss[i]) * full_flow(vehicle.thrusters[i])
                others = memory.expected[b] - given
                lost = -memory.residual[b] - memory.common * others
                shared = SHARED * (loss - memory.common) * others
                # a fault that began within a pulse shows too small a loss at first: the others are impeached
                # only by what the thruster does not explain even if it lets nothing through
                if others > least and lost - given > shared:
                    memory.meter_check[b] = CONTRADICTED
                elif others > least and lost - loss * given <= shared:
                    memory.meter_check[b] = CONFIRMED
        for i in range(count):
            if of[i] == b:
                asked = memory.meter_check[b] == UNCHECKED and memory.off[i].cycles == 0
                memory.test_requested[i] = 1 if asked else 0
                memory.doubtful[i] = 1 if memory.meter_check[b] == CONTRADICTED else memory.doubtful[i]


@kernel
def is_waiting(branches, memory):
    """Return whether a loss is suspected and too few branches have been in use to attribute it."""
    return memory.suspecting != 0 and memory.seen < min(LEAST_BRANCHES, branches.count)


@kernel
def fires_alone(expected, given):
    """Return whether nearly all of the ``expected`` flow of a branch is the ``given`` flow of one thruster
    (kg/s).
    """
    return expected - given < ALONE * given


@kernel
def add_loss_cycle(params, residual, prediction, weight, keep, common, loss):
    """Add a cycle to the sums of ``loss``; ``residual`` and ``prediction``, the residual of a dead thruster:
    kg/s; ``weight``: inverse variance; ``keep``: factor on the sums so far; ``common``: loss of all branches.
    """
    cross, own = residual * prediction * weight, prediction * prediction * weight
    now = cross / own
    before = loss.cross / loss.own if loss.cycles > 0 else now
    if now - common < params.loss_least:
        forget_loss(loss)
        return
    if abs(now - before) > max(STEADY, 3.0 / sqrt(own)):
        forget_loss(loss)
    loss.cross = keep * loss.cross + cross
    loss.own = keep * loss.own + own
    loss.cycles += 1


@kernel
def update_flow_evidence(params, keep, vehicle, share, closed, memory):
    """Add one cycle to the evidence for every thruster whose meter is trusted and whose branch is open.

    Args:
        params: flow record.
        keep: factor on the evidence so far.
        vehicle: believed thrusters and branches.
        share: share of the measured cycle in which each thruster should have given thrust.
        closed: flags of the branches whose latch valve is closed.
        memory: ``FLOW`` record, updated.
    """
    find_common_loss(params, vehicle.branches, memory)
    for i in range(vehicle.n_thrusters):
        b = vehicle.branches.of[i]
        if memory.meter_failed[b] != 0 or closed[b] != 0:
            memory.on[i] = 0.0
            forget_loss(memory.off[i])
            continue
        residual, weight, flow = memory.residual[b], memory.weight[b], full_flow(vehicle.thrusters[i])
        if share[i] > LEAST_USE:
            given = share[i] * (1.0 - memory.known_loss[i]) * flow
            if fires_alone(memory.expected[b], given):
                common, loss = memory.common, memory.off[i]
                add_loss_cycle(params, residual, -given, weight, keep, common=common, loss=loss)
                memory.doubtful[i] = 0
            elif (
                -residual > (params.loss_least + memory.common) * given
                and residual * residual * weight > DOUBT * DOUBT
            ):
                memory.doubtful[i] = 1
        idle = (1.0 - share[i]) * flow
        gained = min((residual - 0.5 * idle) * idle * weight, MOST_A_CYCLE)
        memory.on[i] = min(max(memory.on[i] + gained, 0.0), LARGEST)
    restart_pools(vehicle.n_thrusters, vehicle.branches, memory)
    cross_check(params, vehicle, share, memory)


@kernel
def forget_branch(vehicle, named, memory):
    """Reset the flow evidence of the branch of thruster ``named``, which explains it. The loss that another
    thruster showed when it fired alone is kept.
    """
    b = vehicle.branches.of[named]
    memory.meter_check[b] = UNCHECKED
    forget_loss(memory.off[named])
    for i in range(vehicle.n_thrusters):
        if vehicle.branches.of[i] == b:
            memory.on[i] = 0.0
            memory.doubtful[i] = 0


@kernel
def needs_trial(i, memory):
    """Return whether thruster ``i`` has to be tested alone before a loss can be confirmed or refuted."""
    return memory.doubtful[i] != 0 or 0 < memory.off[i].cycles < LEAST_CYCLES


@kernel
def confirmed_loss(params, common, loss):
    """Return the loss beyond the ``common`` one and the evidence for it; zeros if unconfirmed or too
    small.
    """
    if loss.cycles < LEAST_CYCLES:
        return 0.0, 0.0
    beyond = min(loss.cross / loss.own, 1.0) - common
    if beyond < params.loss_least:
        return 0.0, 0.0
    return beyond / (1.0 - common), min(0.5 * beyond * beyond * loss.own, LARGEST)
