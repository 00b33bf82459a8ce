"""One control cycle of thruster fault diagnosis: residual, hypotheses, and isolation.

The confidence is the posterior probability of a hypothesis among all others and "no thruster has failed",
whose prior is the price of a false alarm; it is wanted in several cycles on end.  Then the thruster is taken
out of the allocation; one stuck on is stopped by the latch valve of its branch, and the others behind that
valve go with it.

Source: Hu et al. 2022, section 6.3, for the horizontal thrusters in hazard avoidance; here for every thruster
in every phase.  Left out: a fault of a thruster that is not used, which nobody can see and which does no
harm.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from edl6dof.config.base import Params, group, param
from edl6dof.fsw.diagnosis.exercise import EXERCISE, ExerciseParams
from edl6dof.fsw.diagnosis.hypotheses import (
    DEGRADED,
    HYPOTHESES,
    NOTHING,
    STUCK_OFF,
    STUCK_ON,
    compare,
    forget_all,
    weigh,
)
from edl6dof.fsw.diagnosis.probe import (
    FAILED,
    NONE,
    PROBE,
    SOUND,
    UNDECIDED,
    close_probe,
    follow_probe,
    next_suspect,
    open_probe,
)
from edl6dof.fsw.diagnosis.residual import RESIDUAL, restart_residual, without_slow_part
from edl6dof.fsw.mission.former import WING_PATIENCE
from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.jit import kernel
from edl6dof.records import COUNT, whole

MAX_ISOLATED = 4
#: Names of the kinds of fault, by number.
KIND_NAMES = {STUCK_OFF: "stuck off", STUCK_ON: "stuck on", DEGRADED: "degraded"}


class DiagnosisParams(Params):
    """Diagnosis of thruster faults."""

    former: ClassVar = {"wing_patience_s": WING_PATIENCE}

    enabled: bool = param(True, "whether thrusters are diagnosed and taken out of use")
    load_noise: float = param(
        0.01,
        (
            "lateral force over axial load, and pitch or yaw torque over it in m, by which air and riser "
            "fluctuate"
        ),
        status="estimate",
        ge=0.0,
    )
    load_noise_roll: float = param(0.001, "the same for roll torque", status="estimate", ge=0.0)
    torque_noise_nm: float = param(
        4.0, "torque residual of a sound vehicle on an axis", status="estimate", gt=0.0
    )
    force_noise_n: float = param(
        8.0, "lateral force residual of a sound vehicle on an axis", status="estimate", gt=0.0
    )
    model_error: float = param(
        0.1, "fraction by which believed thrust and inertia may be wrong", status="estimate", ge=0.0, le=1.0
    )
    memory_cycles: float = param(
        12.0, "cycles of evidence that count, of those in which a thruster was used", gt=1.0
    )
    prior: float = param(
        16.0, "log of the odds for a sound vehicle: the price of a false alarm", gt=0.0, le=100.0
    )
    confidence: float = param(0.999, "confidence at which a thruster is isolated", gt=0.5, lt=1.0)
    streak: int = param(2, "cycles on end with that confidence", ge=1, le=50)
    loss_least: float = param(
        0.3, "fraction of thrust lost from which a thruster counts as failed", gt=0.0, le=1.0
    )
    loss_dead: float = param(
        0.85, "fraction of thrust lost from which it counts as stuck off", gt=0.0, le=1.0
    )
    slow_s: float = param(0.4, "time constant of the mean that is taken for the slow disturbance", gt=0.0)
    exercise: ExerciseParams = group(ExerciseParams, "opposed test pulses in hazard avoidance")
    trust_s: float = param(
        5.0, "time for which a thruster that a probe found sound is not suspected again", ge=0.0
    )


#: A thruster taken out of use, and why.
ISOLATED = np.dtype(
    [
        ("thruster", whole(0, MAX_THRUSTERS - 1, of="thrusters")),
        ("kind", whole(NOTHING, DEGRADED)),
        ("confidence", "f8"),
        ("loss", "f8"),
        ("t", "f8"),
    ],
    align=True,
)
DIAGNOSIS = np.dtype(
    [
        ("residual", RESIDUAL),
        ("hypotheses", HYPOTHESES),
        ("probe", PROBE),
        ("exercise", EXERCISE),
        ("streak", COUNT),
        ("isolated", ISOLATED, (MAX_ISOLATED,)),
        ("n_isolated", whole(0, MAX_ISOLATED)),
    ],
    align=True,
)


@kernel
def restart(memory):
    """Forget evidence and slow disturbance: the vehicle, or what acts on it, has changed."""
    restart_residual(memory.residual)
    forget_all(memory.hypotheses)
    memory.streak = 0


@kernel
def isolate(i, kind, loss, confidence, t, count, branch, memory, healthy, shut):
    """Take a thruster out of use for good, and note why; one stuck on only stops with its branch."""
    one = memory.isolated[memory.n_isolated]
    one.thruster, one.kind, one.loss = i, kind, loss
    one.confidence, one.t = confidence, t
    memory.n_isolated += 1
    healthy[i] = 0
    if kind == STUCK_ON:
        shut[branch[i]] = 1
        for j in range(count):
            if branch[j] == branch[i]:
                healthy[j] = 0
    restart(memory)


@kernel
def follow_suspect(
    params, count, branch, effectiveness, activity, load, unexplained, t, dt, memory, healthy, shut
):
    """Go on with a probe, and end it when it has decided."""
    i = memory.probe.suspect
    state, confidence = follow_probe(
        params, count, effectiveness, activity, load, unexplained, t, dt, memory.probe
    )
    if state == FAILED:
        memory.probe.suspect = NONE
        isolate(i, STUCK_ON, 0.0, confidence, t, count, branch, memory, healthy, shut)
    elif state == SOUND:
        memory.probe.trusted_until[memory.probe.suspect] = t + params.trust
        close_probe(count, branch, memory.probe, healthy, shut)
    elif state == UNDECIDED:
        close_probe(count, branch, memory.probe, healthy, shut)


@kernel
def diagnose(params, count, branch, effectiveness, activity, load, unexplained, t, dt, memory, healthy, shut):
    """One control cycle of diagnosis.

    Args:
        params: diagnosis record.
        count: number of thrusters.
        branch: propellant branch of each.
        effectiveness: force and torque of each at full thrust, rows of 6 (N, N m).
        activity: what they should have done in the measured cycle.
        load: axial force of air and riser, N.
        unexplained: force and torque of that cycle that this does not explain (6).
        t: present time, s.
        dt: control cycle, s.
        memory: ``DIAGNOSIS`` record.
        healthy: written, 0 for a thruster that is not to be used.
        shut: written, 1 for a propellant branch whose latch valve is to be shut.
    """
    if memory.probe.suspect != NONE:
        if memory.residual.taken == 0:
            close_probe(count, branch, memory.probe, healthy, shut)
        else:
            follow_suspect(
                params,
                count,
                branch,
                effectiveness,
                activity,
                load,
                unexplained,
                t,
                dt,
                memory,
                healthy,
                shut,
            )
        return
    known = without_slow_part(params.slow, unexplained, activity.share, count, dt, memory.residual)
    if params.enabled == 0 or memory.n_isolated == MAX_ISOLATED or known == 0:
        return
    best = memory.hypotheses
    before = (best.thruster, best.kind)
    weigh(params, count, effectiveness, activity, load, memory.residual, best)
    compare(params, count, healthy, memory.probe.trusted_until, t, best)
    if best.kind != NOTHING and best.confidence >= params.confidence:
        memory.streak = memory.streak + 1 if before == (best.thruster, best.kind) else 1
    else:
        memory.streak = 0
    if memory.streak >= params.streak:
        isolate(best.thruster, best.kind, best.loss, best.confidence, t, count, branch, memory, healthy, shut)
        return
    candidate = next_suspect(
        params, count, effectiveness, memory.residual, known, best, healthy, t, memory.probe
    )
    if candidate != NONE and memory.streak == 0:
        open_probe(params, candidate, t, count, branch, memory.residual, best, memory.probe, healthy, shut)
