"""One control cycle of thruster fault diagnosis: residuals, hypotheses, and isolation.

The confidence is the posterior probability of a hypothesis among all others and "no thruster has failed",
whose prior is the price of a false alarm; a fault is isolated when the confidence is high in several cycles
in a row. A dead thruster is then not used any more; a weak one stays in use, and allocation, estimation and
diagnosis allow for its loss. A thruster that stays open is shut off by the latch valve of its branch, and the
other thrusters of the branch with it (:mod:`edl6dof.fsw.diagnosis.leak_isolation`). Without a flow meter the
latch valve is moved when force and torque show the opening of a valve, and before a thruster that does not
respond is isolated: it may be stuck open or closed.

Source: Hu et al. 2022, section 6.3, for the horizontal thrusters in hazard avoidance; here for every thruster
in every phase. Left out: a fault of a thruster that is not used, which is neither visible nor harmful; the
return of a thruster whose fault has ended.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from edl6dof.config.base import Params, group, param
from edl6dof.fsw.diagnosis.exercise import EXERCISE, ExerciseParams
from edl6dof.fsw.diagnosis.flow_evidence import (
    CONFIRMED,
    FLOW,
    NONE,
    FlowParams,
    forget_branch,
    impossible_meter,
    is_read,
    read_meters,
    update_flow_evidence,
)
from edl6dof.fsw.diagnosis.hypotheses import (
    HYPOTHESES,
    NOTHING,
    compare,
    forget_all,
    kind_of,
    update_evidence,
)
from edl6dof.fsw.diagnosis.leak_isolation import (
    HEALTHY,
    LEAK,
    METER_FAILED,
    NAMED,
    branch_to_verify,
    end_test,
    leaking_branch,
    start_leak_isolation,
    step_leak_isolation,
    take_others,
)
from edl6dof.fsw.diagnosis.openings import suspect_leak
from edl6dof.fsw.diagnosis.residual import RESIDUAL, is_settled, restart_residual, whiten
from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.interface.effectors import DEGRADED, STUCK_OFF, STUCK_ON, THRUSTER_FAILURES
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, record, whole

MAX_ISOLATED = 8
FLOW_MEMORY = 12.0  # cycles of use
#: Names of the kinds of fault, by number.
KIND_NAMES = {number: name.replace("_", " ") for number, name in enumerate(THRUSTER_FAILURES, 1)}


class DiagnosisParams(Params):
    """Diagnosis of thruster faults."""

    enabled: bool = param(True, "whether thrusters are diagnosed and taken out of use")
    torque_noise_nm: float = param(
        0.5, "smallest torque residual of a healthy vehicle about an axis", status="estimate", gt=0.0
    )
    force_noise_n: float = param(
        2.0, "smallest lateral force residual of a healthy vehicle along an axis", status="estimate", gt=0.0
    )
    model_error: float = param(
        0.1, "relative error of thrust and inertia of the on-board model", status="estimate", ge=0.0, le=1.0
    )
    memory_cycles: float = param(
        200.0, "memory of the evidence, in cycles in which the thruster was used", gt=1.0
    )
    prior: float = param(
        16.0,
        "natural logarithm of the prior odds of a healthy vehicle; a larger value gives fewer false alarms",
        gt=0.0,
        le=100.0,
    )
    confidence: float = param(0.999, "confidence at which a thruster is isolated", gt=0.5, lt=1.0)
    streak: int = param(2, "consecutive cycles in which the confidence must be reached", ge=1, le=50)
    loss_least: float = param(
        0.3, "fraction of thrust lost from which force and torque isolate a thruster", gt=0.0, le=1.0
    )
    loss_dead: float = param(
        0.7,
        "fraction of thrust lost from which a thruster counts as stuck off, or its valve as open, and is not "
        "used any more",
        gt=0.0,
        le=1.0,
    )
    onset: float = param(
        5.0, "evidence of an opening valve from which the latch valve of its branch is moved", gt=0.0
    )
    exercise: ExerciseParams = group(ExerciseParams, "opposed test pulses in hazard avoidance")
    flow: FlowParams = group(FlowParams, "evidence of the flow meters")


#: A fault that was isolated: thruster, kind of fault, confidence, fraction of thrust lost, flight time (s).
ISOLATED = record(
    ("thruster", whole(0, MAX_THRUSTERS - 1, of="thrusters")),
    ("kind", whole(NOTHING, DEGRADED)),
    ("confidence", "f8"),
    ("loss", "f8"),
    ("t", "f8"),
)
DIAGNOSIS = record(
    ("residual", RESIDUAL),
    ("hypotheses", HYPOTHESES),
    ("flow", FLOW),
    ("leak", LEAK),
    ("exercise", EXERCISE),
    ("streak", COUNT),
    ("isolated", ISOLATED, (MAX_ISOLATED,)),
    ("n_isolated", whole(0, MAX_ISOLATED)),
)


class DiagnosisSignals(NamedTuple):
    """Signals that diagnosis exchanges with other modules in a control cycle.

    Attributes:
        vehicle: believed vehicle (thrusters, branches).
        instruments: ``INSTRUMENTS`` record (errors of the flow meters).
        metered: whether there are flow meters.
        used: counts of the flow meters at the end of the measured cycle, kg.
        effectiveness: force and torque of each thruster at full thrust, rows of 6 (N, N m).
        activity: ``ACTIVITY`` record: commanded action of the thrusters in the measured cycle.
        unexplained: force and torque of the measured cycle that the commands do not explain (6; N, N m, B).
        lag: time by which a command precedes its effect in ``unexplained``, s.
        t: present time, s.
        dt: control cycle, s.
        healthy: updated, 0 for a thruster out of use.
        loss: updated, share of the thrust that a thruster in use has lost, allowed for in ``effectiveness``.
    """

    vehicle: Any
    instruments: Any
    metered: Any
    used: Any
    effectiveness: Any
    activity: Any
    unexplained: Any
    lag: Any
    t: Any
    dt: Any
    healthy: Any
    loss: Any


#: The signals that diagnosis writes.
WRITES = ("healthy", "loss")


@kernel
def restart(hidden, memory):
    """Reset the evidence.

    ``hidden``: 1 after a change of the vehicle or of the forces on it, which may have hidden the opening of a
    valve: every thruster without a meter is to be verified; 0 after a fault has been isolated.
    """
    restart_residual(memory.residual)
    forget_all(memory.hypotheses)
    memory.streak = 0
    for i in range(MAX_THRUSTERS):
        memory.leak.unverified[i] = hidden * memory.residual.taken


@kernel
def record_fault(vehicle, i, kind, loss, confidence, t, memory):
    """Record the fault of thruster ``i``, and restart the evaluation of the others."""
    if memory.n_isolated < MAX_ISOLATED:
        one = memory.isolated[memory.n_isolated]
        one.thruster, one.kind, one.loss = i, kind, loss
        one.confidence, one.t = confidence, t
        memory.n_isolated += 1
    forget_branch(vehicle, i, memory.flow)
    restart(0, memory)


@kernel
def isolate(params, signals, i, kind, loss, confidence, memory):
    """Record a thruster that gives too little thrust. A dead one is taken out of use; the loss of a
    weak one is allowed for from now on, in the expected flow only if its meter has shown it.
    """
    left, flow = 1.0 - loss, memory.flow
    if kind == DEGRADED:
        signals.loss[i] = 1.0 - left * (1.0 - signals.loss[i])
        if flow.off[i].cycles > 0:
            flow.known_loss[i] = 1.0 - left * (1.0 - flow.known_loss[i])
    else:
        signals.healthy[i] = 0
    record_fault(signals.vehicle, i, kind, loss, confidence, t=signals.t, memory=memory)


@kernel
def isolate_most_probable(params, signals, memory):
    """Isolate the thruster of the best hypothesis, or all thrusters of a branch without flow."""
    best, vehicle = memory.hypotheses, signals.vehicle
    thruster, branch, kind, loss, confidence = (
        best.thruster, best.branch, best.kind, best.loss, best.confidence,
    )  # fmt: skip
    for i in range(vehicle.n_thrusters):
        if i == thruster or vehicle.branches.of[i] == branch and signals.healthy[i] != 0:
            isolate(params, signals, i, kind, loss, confidence=confidence, memory=memory)


@kernel
def isolate_dead(params, signals, i, loss, memory):
    """Isolate a thruster that did not respond when tested alone; its confidence is the threshold."""
    kind = kind_of(params, loss)
    record_fault(signals.vehicle, i, kind, loss, params.confidence, t=signals.t, memory=memory)
    signals.healthy[i] = 0


@kernel
def exclude_meter(b, t, memory):
    """Exclude the flow meter of branch ``b`` as failed at flight time ``t`` (s)."""
    memory.flow.meter_failed[b], memory.flow.failed_at[b] = 1, t
    restart(0, memory)


@kernel
def continue_leak_isolation(params, signals, memory):
    """Run one step of the isolation of a leak, and evaluate its result. A suspected thruster that does not
    leak has lost its thrust.
    """
    leak, best, vehicle = memory.leak, memory.hypotheses, signals.vehicle
    found, confidence = step_leak_isolation(params, signals, memory.flow, memory.residual, leak)
    if found == NAMED:
        end_test(vehicle, vehicle.branches.of[leak.best], leak, signals.healthy)
        record_fault(vehicle, leak.best, STUCK_ON, 0.0, confidence, t=signals.t, memory=memory)
    elif found == METER_FAILED:
        exclude_meter(leak.branch, signals.t, memory)
        end_test(vehicle, NONE, leak, signals.healthy)
    elif found == HEALTHY:
        end_test(vehicle, NONE, leak, signals.healthy)
        memory.streak = 0
        # not suspected of leaking, or voided by an event
        if leak.metered == 0 and (best.kind == STUCK_OFF or best.kind == DEGRADED):
            isolate_most_probable(params, signals, memory)


@kernel
def may_be_open(metered, b, best, flow):
    """Return whether the thruster of branch ``b`` that does not respond may be stuck open instead of closed:
    no meter shows that it has no flow. A meter does so only if it has read the flow of another thruster.
    """
    shown = is_read(metered, b, flow) and flow.meter_check[b] == CONFIRMED
    return best.branch == NONE and not shown


@kernel
def update_streak(params, before, memory):
    """Count the cycles in a row with the same confident hypothesis; ``before``: (thruster, kind) of the last
    cycle.
    """
    best = memory.hypotheses
    if best.kind != NOTHING and best.confidence >= params.confidence:
        memory.streak = memory.streak + 1 if before == (best.thruster, best.kind) else 1
    else:
        memory.streak = 0


@kernel
def diagnose(params, signals, memory):
    """Run one control cycle of diagnosis on ``DiagnosisSignals`` with ``memory`` (``DIAGNOSIS``)."""
    best, flow, vehicle, metered = memory.hypotheses, memory.flow, signals.vehicle, signals.metered
    share, residual = signals.activity.share, memory.residual
    whiten(params, signals.unexplained, signals.activity, vehicle.n_thrusters, residual)
    if params.enabled == 0:
        return
    if metered and read_meters(
        params.flow, signals.instruments, vehicle, signals.used, share, dt=signals.dt, memory=flow
    ):
        keep = 1.0 - 1.0 / FLOW_MEMORY
        update_flow_evidence(params.flow, keep, vehicle, share, memory.leak.latch_closed, memory=flow)
    settled = is_settled(residual)
    if settled:
        update_evidence(params, signals, residual, flow, best)
    if memory.leak.branch != NONE:
        if settled:
            suspect_leak(params, signals, residual, flow, memory.leak, memory=best)
        continue_leak_isolation(params, signals, memory)
        return
    impossible = impossible_meter(metered, vehicle.branches, flow)
    if impossible != NONE:
        exclude_meter(impossible, signals.t, memory)
    leaking, metered_leak = leaking_branch(params, vehicle, signals.healthy, flow), True
    if leaking == NONE:
        before = (best.thruster, best.kind)
        compare(params, vehicle, metered, signals.healthy, flow, leak=memory.leak, memory=best)
        update_streak(params, before, memory)
        if settled:
            suspect_leak(params, signals, residual, flow, memory.leak, memory=best)
        no_response = memory.streak >= params.streak and best.loss >= params.loss_dead
        suspected = vehicle.branches.of[best.thruster]
        if best.kind == STUCK_ON or no_response and may_be_open(metered, suspected, best, flow):
            leaking, metered_leak = suspected, False
        elif settled and best.kind == NOTHING:
            leaking, metered_leak = branch_to_verify(params, signals, residual, flow, memory.leak), False
    if leaking != NONE:
        # an opening parachute resembles a valve that opens, and may follow the latch valve by chance; a
        # thruster that does not respond has failed in any case
        no_loss = best.kind == STUCK_ON or best.kind == NOTHING
        doubt, flowing = 1.5 * params.prior if no_loss else 0.0, flow.residual[leaking]
        start_leak_isolation(signals, leaking, metered_leak, flowing, doubt=doubt, memory=memory.leak)
        if not metered_leak:
            take_others(params, signals, residual, flow, memory.leak)
    elif memory.streak >= params.streak:
        isolate_most_probable(params, signals, memory)
    elif best.meter != NONE and settled:
        exclude_meter(best.meter, signals.t, memory)
