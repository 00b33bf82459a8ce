"""Bank reversal when the crossrange leaves a corridor that narrows as a quadratic in velocity.

Source: the lateral logic of Apollo and of MSL (Mendeck & Craig McGrew 2014, "Entry guidance design and
postflight performance for 2011 Mars Science Laboratory mission", section on bank reversals); Wu, Cui & Cui
2013, section 4, uses the same form.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.reach import reversed_in_reach
from edl6dof.kernels import kernel
from edl6dof.registry import Member


class CrossrangeCorridorParams(Params):
    """Bank-reversal corridor: crossrange allowed as a quadratic in velocity, c0 + c1 V + c2 V^2."""

    c0_m: float = param(400.0, "half width at zero velocity", ge=0.0, le=1e6)
    c1_s: float = param(0.6, "growth with velocity", ge=0.0, le=1000.0)
    c2_s2_m: float = param(1.2e-4, "growth with the square of velocity", ge=0.0, le=1.0)


@kernel
def side(params, onboard, nav, memory, out, wanted, sign):
    """Return the side to bank to (+1 right, -1 left), which changes when the crossrange leaves the corridor
    on the present side.
    """
    p = params
    limit = p.c0 + p.c1 * nav.speed + p.c2 * nav.speed * nav.speed
    return reversed_in_reach(onboard, nav, out, sign) if sign * out.crossrange > limit else sign


MEMBER = Member(
    "crossrange_corridor", CrossrangeCorridorParams, {"side": side}, "Mendeck & Craig McGrew 2014"
)
