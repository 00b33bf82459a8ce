"""Fully numerical predictor-corrector: the bank magnitude whose predicted flight ends at the aim point.

Every call flies the onboard prediction to the parachute and corrects one number, the shift of the reference's
cos(bank), by Newton's method with a finite-difference slope (Gauss-Newton for one unknown), from the solution
of the last call. The prediction includes the reversals at the speeds of the plan, in order, for the range
that rolling through lift up adds at the bank rate of the vehicle. Density and lift-to-drag errors enter as
measured ratios. Source: Lu 2014, "Entry guidance: a unified method", J. Guidance, Control, and Dynamics
37(3), section IV: one-parameter bank profile, terminal range error as a function of it, Gauss-Newton
iteration.

Differences: the bank profile is the reference's over speed (by default a constant) instead of one linear in
energy; the unknown is added to cos(bank), in which range is nearly linear, instead of to the bank angle; the
prediction ends at the Mach number of the parachute in the mission table, instead of a final energy.
"""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.predictor import in_plane_shifted, predict
from edl6dof.fsw.guidance.entry.reference import reference_bank
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, FLAG, record
from edl6dof.registry import Member
from edl6dof.spatial.elementary import acos, cos
from edl6dof.spatial.vector import clamp

#: Change of cos(bank) by which the slope of the miss is measured.
NUDGE = 0.02


class NpcParams(Params):
    """Fully numerical predictor-corrector."""

    tolerance_m: float = param(50.0, "predicted miss at which the iteration stops", gt=0.0, le=10e3)
    iterations: int = param(4, "most Newton steps in one call", ge=1, le=20)
    start_drag_m_s2: float = param(
        0.3, "drag at which correction begins; before, the reference bank is flown", ge=0.0
    )


#: Most reversals of the plan that are used.
MAX_TURNS = 12

MEMORY = record(
    ("shift", "f8"),
    ("started", FLAG),
    ("miss", "f8"),
    ("iterations", COUNT),
    ("side", "f8"),  # side of the bank at the last call, +1 right, -1 left
    ("done", COUNT),  # reversals begun
)

#: Speeds (m/s) at which the plan reverses, falling, zero after the last.
PLAN = record(("turn", "f8", (MAX_TURNS,)))


@kernel
def miss_of(onboard, nav, out, shift, turn, later):
    """Predicted downrange miss (m) with the next two reversals at ``turn`` and ``later`` (m/s; 0: none)."""
    miss, _, _, _ = predict(onboard, nav, out, in_plane_shifted(shift, turn, later))
    return miss


@kernel
def next_turns(plan, memory, out):
    """Speeds (m/s) of the next two planned reversals, counted by the reversals begun; 0: none."""
    if memory.side != 0.0 and out.side != memory.side:
        memory.done += 1
    memory.side = out.side
    i = memory.done
    return plan.turn[i] if i < MAX_TURNS else 0.0, plan.turn[i + 1] if i + 1 < MAX_TURNS else 0.0


@kernel
def solve(p, onboard, nav, out, low, high, turn, later, memory):
    """Move ``memory.shift`` to zero predicted miss, or to the nearer of ``low`` and ``high``."""
    memory.shift = clamp(memory.shift, low, high)
    memory.iterations = 0
    memory.miss = miss_of(onboard, nav, out, memory.shift, turn, later=later)
    while abs(memory.miss) > p.tolerance and memory.iterations < p.iterations:
        nudge = NUDGE if memory.shift + NUDGE <= high else -NUDGE
        beside = miss_of(onboard, nav, out, shift=memory.shift + nudge, turn=turn, later=later)
        slope = (beside - memory.miss) / nudge
        if slope <= 0.0:
            return
        better = clamp(memory.shift - memory.miss / slope, low, high)
        memory.iterations += 1
        if better == memory.shift:
            return
        memory.shift = better
        memory.miss = miss_of(onboard, nav, out, shift=better, turn=turn, later=later)


@kernel
def guide(params, plan, onboard, nav, memory, out):
    """Wanted bank angle: the one predicted to end at the aim point."""
    entry = onboard.guidance.entry
    if memory.started == 0:
        memory.shift = onboard.reference.shift
        if nav.drag >= params.start_drag:
            memory.started = 1
    turn, later = next_turns(plan, memory, out)
    if memory.started != 0 and nav.speed > max(entry.align_speed, entry.heading.speed):
        # the shifted bank angle stays within its limits
        own = cos(reference_bank(onboard, 0.0, nav.speed))
        low, high = cos(entry.bank_max) - own, cos(entry.bank_min) - own
        solve(params, onboard, nav, out, low, high=high, turn=turn, later=later, memory=memory)
    return acos(clamp(cos(reference_bank(onboard, memory.shift, nav.speed)), -1.0, 1.0))


def lay_plan(onboard: np.ndarray, planned: np.ndarray) -> None:
    """Store the speeds at which the plan reverses."""
    side = planned["side"]
    changes = np.flatnonzero((side[1:] != side[:-1]) & (side[:-1] != 0.0)) + 1
    turns = planned["speed"][changes][:MAX_TURNS]
    table = onboard["plan"]["npc"][0]["turn"]
    table[:] = 0.0
    table[: len(turns)] = turns


MEMBER = Member(
    "npc", NpcParams, {"guide": guide}, "Lu 2014, J. Guidance 37(3)", MEMORY, tables=PLAN, plan=lay_plan
)
