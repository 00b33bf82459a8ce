"""The bank-reversal logics, and the steering that all laws share: limits, sign, heading alignment, zero bank
at the end, and bank rate turn the bank angle that a law demands into the commanded one.

A member has one kernel, ``side(params, onboard, nav, memory, out, wanted, sign)``, which returns the sign of
the bank angle (+1 right, -1 left). ``wanted`` is the bank angle that the law demands (rad), ``sign`` the
present sign; ``out`` contains range and crossrange. ``params`` and ``memory`` belong to the member.

Source: the bank logic around the MSL entry guidance (Mendeck & Craig McGrew 2014): magnitude from the range
control, sign from the lateral logic; near the end range control stops and the bank angle removes the heading
error; last the lift is levelled for the parachute.
"""

from __future__ import annotations

from typing import Any

from edl6dof.fsw.guidance.entry.aim_point import first_side, heading_bank
from edl6dof.fsw.guidance.entry.reversal import crossrange_corridor, heading_corridor, own_sign, predictive
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, record
from edl6dof.registry import Family
from edl6dof.spatial.vector import clamp

REVERSALS = Family(
    "bank-reversal logic",
    (crossrange_corridor.MEMBER, heading_corridor.MEMBER, own_sign.MEMBER, predictive.MEMBER),
)

bank_side = REVERSALS.role(
    "side", "params", "onboard", "nav", "memory", "out", "wanted", "sign", own=("params", "memory")
)


_Logics: Any = REVERSALS.params_model("ReversalLogics", "logic", "crossrange_corridor", "Bank reversals.")


class ReversalParams(_Logics):
    """Bank reversals."""


STEERING = record(
    ("sign", "f8"), ("count", COUNT), ("bank", "f8"), ("t", "f8"), ("reversal", REVERSALS.memory)
)


@kernel
def limited(onboard, out, wanted):
    """Magnitude of the ``wanted`` bank angle (rad), limited to the smallest that the law allows now and the
    largest of all laws.
    """
    return clamp(abs(wanted), out.least_bank, onboard.guidance.entry.bank_max)


@kernel
def chosen_side(bank_side, onboard, nav, memory, out, wanted):
    """Return the side to bank to: in the first call that of :func:`.aim_point.first_side`, later that of the
    reversal logic. Reversals are counted.
    """
    p = onboard.guidance.entry.reversal
    if memory.sign == 0.0:
        memory.sign = first_side(out)
    sign = bank_side(
        p.logic, p, onboard, nav, memory=memory.reversal, out=out, wanted=wanted, sign=memory.sign
    )
    if sign != memory.sign:
        memory.count += 1
    memory.sign = out.side = sign
    return sign


@kernel
def steer_bank(bank_side, onboard, nav, memory, out, wanted):
    """Write the commanded bank angle into ``out``; ``wanted``: bank angle that the law demands (rad), whose
    sign only ``own_sign`` uses. The rate limit changes the sign of the command through zero bank, never
    through lift down.
    """
    p = onboard.guidance.entry
    if nav.speed < p.align_speed:
        goal = 0.0
    elif nav.speed < p.heading.speed:
        goal = heading_bank(p.heading, out.range_to_go, out.crossrange)
    else:
        goal = chosen_side(bank_side, onboard, nav, memory, out, wanted=wanted)
        goal *= limited(onboard, out, wanted)
    if memory.t > 0.0:
        step = p.bank_rate * (nav.t - memory.t)
        goal = clamp(goal, memory.bank - step, memory.bank + step)
    memory.bank, memory.t = goal, nav.t
    out.bank = goal
