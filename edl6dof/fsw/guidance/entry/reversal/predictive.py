"""Predictive bank reversal: reverse when the predicted crossrange of a reversal now is a set share of that
without reversal.

Each call makes two predictions with the bank to one side up to the end: to the present side, and to the other
one from now on. A reversal when the second miss has fallen to ``ratio`` times the first makes each leg
smaller than the one before by this ratio, whatever density and lift are; the ratio alone determines the
number of reversals. Source: Smith 2016, "Predictive lateral logic for numerical entry guidance algorithms",
AAS 16-216 (the damping-ratio idea); the reversal is predicted at the vehicle's bank rate.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.predictor import predict, shifted
from edl6dof.fsw.guidance.entry.reach import reversed_in_reach
from edl6dof.fsw.guidance.entry.reference import reference_bank
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.elementary import cos
from edl6dof.spatial.vector import clamp


class PredictiveParams(Params):
    """Predictive bank reversal."""

    ratio: float = param(
        0.5,
        "predicted crossrange with a reversal now, divided by that without, at which the reversal is made",
        gt=0.0,
        lt=1.0,
    )
    dead_zone_m: float = param(
        500.0, "predicted crossrange without reversal up to which no reversal is made", ge=0.0, le=100e3
    )
    least_drag_m_s2: float = param(1.0, "drag below which no reversal is made", ge=0.0)


@kernel
def side(params, onboard, nav, memory, out, wanted, sign):
    """Return the side to bank to (+1 right, -1 left), which changes when the predicted crossrange miss after
    a reversal now has the other sign and is at most ``ratio`` times the miss without reversal.
    """
    p, entry = params, onboard.guidance.entry
    if nav.drag < p.least_drag:
        return sign
    shift = cos(clamp(abs(wanted), out.least_bank, entry.bank_max)) - cos(
        reference_bank(onboard, 0.0, nav.speed)
    )
    _, going_on, _, _ = predict(onboard, nav, out, shifted(shift, sign, 0.0, 0.0))
    if sign * going_on < p.dead_zone:
        return sign
    _, reversed_now, _, _ = predict(onboard, nav, out, shifted(shift, -sign, 0.0, 0.0))
    if sign * reversed_now <= -p.ratio * sign * going_on:
        return sign
    return reversed_in_reach(onboard, nav, out, sign)


MEMBER = Member("predictive", PredictiveParams, {"side": side}, "Smith 2016, AAS 16-216")
