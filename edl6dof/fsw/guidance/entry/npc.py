"""Fully numerical predictor-corrector: the bank magnitude whose predicted flight ends at the aim point.

Every call flies the onboard prediction to the parachute and corrects one parameter, the cosine of a constant bank angle, by Newton's
method with a finite-difference slope (Gauss-Newton for one unknown), from the last call's solution.  Density and lift-to-drag errors
enter as measured ratios.  Source: Lu 2014, "Entry guidance: a unified method", J. Guidance 37(3), section IV: the error z(sigma_0) is
eq. 22 there, the Gauss-Newton step eqs. 25-27.

Differences: the bank angle of the prediction is constant (sigma_f = sigma_0 in eq. 23), since the parachute conditions leave no load or
heat to shape; the unknown is cos(bank), in which range is nearly linear; the prediction ends at the parachute's Mach number, which the
mission table watches, instead of a final energy.
"""

from __future__ import annotations

from math import acos, cos

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.predictor import predict
from edl6dof.jit import kernel
from edl6dof.registry import Member
from edl6dof.spatial.vector import clamp

#: Change of cos(bank) by which the slope of the miss is measured.
NUDGE = 0.02


class NpcParams(Params):
    """Fully numerical predictor-corrector."""

    tolerance_m: float = param(50.0, "predicted miss at which the iteration stops", gt=0.0, le=10e3)
    iterations: int = param(4, "most Newton steps in one call", ge=1, le=20)
    start_drag_m_s2: float = param(0.3, "drag at which correction begins; before, the reference bank is held", ge=0.0)


MEMORY = np.dtype([("cosine", "f8"), ("started", "i8"), ("miss", "f8"), ("iterations", "i8")], align=True)


@kernel
def miss_of(onboard, nav, out, cosine):
    """Predicted downrange miss (m) at constant bank of this cosine, reversals cancelling."""
    miss, _, _, _ = predict(onboard, nav, out.drag_ratio, out.lift_ratio, acos(cosine), 0.0)
    return miss


@kernel
def solve(onboard, nav, out, start, low, high, memory):
    """Cosine of the bank angle between ``low`` and ``high`` whose predicted miss is zero; the nearer bound when out of reach."""
    p = onboard.guidance.entry.npc
    cosine = clamp(start, low, high)
    memory.iterations = 0
    memory.miss = miss_of(onboard, nav, out, cosine)
    for _ in range(p.iterations):
        if abs(memory.miss) < p.tolerance:
            break
        nudge = NUDGE if cosine + NUDGE <= high else -NUDGE
        slope = (miss_of(onboard, nav, out, cosine + nudge) - memory.miss) / nudge
        if slope <= 0.0:
            break
        better = clamp(cosine - memory.miss / slope, low, high)
        memory.iterations += 1
        if better == cosine:
            break
        cosine = better
        memory.miss = miss_of(onboard, nav, out, cosine)
    return cosine


@kernel
def guide(onboard, nav, mem, out):
    """Wanted bank angle: the one predicted to end at the aim point."""
    p, entry = onboard.guidance.entry.npc, onboard.guidance.entry
    memory = mem.npc
    if memory.started == 0:
        memory.cosine = cos(onboard.reference.bank)
        if nav.drag < p.start_drag:
            return onboard.reference.bank
        memory.started = 1
    if nav.speed > entry.align_speed:
        memory.cosine = solve(onboard, nav, out, memory.cosine, cos(entry.bank_max), cos(entry.bank_min), memory)
    return acos(memory.cosine)


MEMBER = Member("npc", NpcParams, {"guide": guide}, "Lu 2014, J. Guidance 37(3), section IV", MEMORY)
