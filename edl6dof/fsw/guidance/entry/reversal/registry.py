"""The bank-reversal logics.

A member has one kernel, ``side(params, onboard, nav, memory, out, wanted, sign)``: the side to bank to (+1
right, -1 left), given the bank angle that the law wants (rad), the present side, and range and crossrange in
``out``.  ``params`` and ``memory`` are its own.
"""

from __future__ import annotations

from edl6dof.fsw.guidance.entry.reversal import crossrange_corridor, heading_corridor, own_sign, predictive
from edl6dof.registry import Family

REVERSALS = Family(
    "bank-reversal logic",
    (
        crossrange_corridor.MEMBER,
        heading_corridor.MEMBER,
        own_sign.MEMBER,
        predictive.MEMBER,
    ),
)

bank_side = REVERSALS.role(
    "side", "params", "onboard", "nav", "memory", "out", "wanted", "sign", own=("params", "memory")
)
