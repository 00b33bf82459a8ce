"""Bank of constant magnitude with crossrange reversals: the simplest lifting entry.

Source: the bank-angle steering of low-lift capsules in its plainest form; Wu, Cui & Cui 2013, section 4, for the reversals.
"""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import Params, group, param
from edl6dof.fsw.guidance.entry.geometry import REVERSAL, CorridorParams, bank_sign, to_target
from edl6dof.jit import kernel
from edl6dof.registry import Member


class ConstantBankParams(Params):
    """Bank of constant magnitude."""

    bank_deg: float = param(45.0, "bank magnitude", ge=0.0, le=180.0)
    corridor: CorridorParams = group(CorridorParams, "bank-reversal corridor")


MEMORY = np.dtype([("reversal", REVERSAL)], align=True)


@kernel
def guide(onboard, nav, mem, out):
    """Commanded bank angle: constant magnitude, sign from the corridor, zero below the alignment speed."""
    p = onboard.guidance.entry.constant_bank
    out.range_to_go, out.crossrange = to_target(onboard, nav)
    sign = bank_sign(p.corridor, mem.constant_bank.reversal, out.crossrange, nav.speed)
    out.bank = sign * p.bank if nav.speed > onboard.guidance.entry.align_speed else 0.0


MEMBER = Member("constant_bank", ConstantBankParams, {"guide": guide}, "Wu, Cui & Cui 2013, section 4 (reversals)", MEMORY)
