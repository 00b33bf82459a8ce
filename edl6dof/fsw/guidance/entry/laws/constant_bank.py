"""Bank of constant magnitude; the shared steering reverses it: the simplest lifting entry.

Source: the bank-angle steering of low-lift capsules in its plainest form; Wu, Cui & Cui 2013, section 4, for
the reversals.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.kernels import kernel
from edl6dof.registry import Member


class ConstantBankParams(Params):
    """Bank of constant magnitude."""

    bank_deg: float = param(45.0, "bank magnitude", ge=0.0, le=180.0)


@kernel
def guide(params, plan, onboard, nav, memory, out):
    """Wanted bank angle: a constant."""
    return params.bank


MEMBER = Member(
    "constant_bank", ConstantBankParams, {"guide": guide}, "Wu, Cui & Cui 2013, section 4 (reversals)"
)
