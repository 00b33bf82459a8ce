"""No reversal logic: the sign of the bank angle is that of the law, for open-loop profiles and laws that
control downrange and crossrange.

Source: none, this is the null member of the family.
"""

from __future__ import annotations

from edl6dof.config.base import Params
from edl6dof.kernels import kernel
from edl6dof.registry import Member


class OwnSignParams(Params):
    """The sign of the law."""


@kernel
def side(params, onboard, nav, memory, out, wanted, sign):
    """Side of the bank angle that the law wants."""
    return -1.0 if wanted < 0.0 else 1.0


MEMBER = Member("own_sign", OwnSignParams, {"side": side}, "null member")
