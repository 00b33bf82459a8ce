"""FNPEG, fully numerical predictor-corrector entry guidance: a bank angle linear in energy and the speeds of
its reversals are solved for, so that the predicted flight ends at the aim point in range and crossrange.

Every call flies the onboard prediction to the parachute: from the present bank angle, at the bank rate of the
vehicle, through the remaining reversals. The bank magnitude is linear in energy, from an unknown one now to a
fixed one at the end; the unknown is corrected by Gauss-Newton steps, halved until the predicted range
improves. The speed of the next reversal is corrected in the same way until the predicted crossrange is zero;
the reversal after it is assumed at a set share of that speed. Where even the largest bank angle ends beyond
the aim point, the reversal is moved to the speed with the least miss of range and crossrange together:
rolling through lift up adds range, the more the slower the vehicle rolls. Where the smallest bank angle ends
short, smaller ones are allowed (:mod:`~edl6dof.fsw.guidance.entry.reach`). Where load or heat rate would
exceed their limits, vertical lift is added until the altitude rate respects them. Sources: Lu 2014, "Entry
guidance: a unified method", J. Guidance, Control, and Dynamics 37(3), sections IV and V (range, altitude-rate
feedback, filters); Lu, Brunner, Stachowiak, Mendeck, Tigges & Cerimele 2017, "Verification of a fully
numerical entry guidance algorithm", J. Guidance 40(2); Smith 2016, AAS 16-216 (reversals by prediction).

Differences: energy here is kinetic energy, whose final value is known beforehand; Smith decides by the ratio
of two predicted crossranges, here the speed of the reversal is solved for. With ``reversal.logic: own_sign``
the planned reversals are flown; with another logic only the magnitude is used.
"""

from __future__ import annotations

from edl6dof.config.base import param
from edl6dof.fsw.guidance.entry.energy_plan import ENERGY_PLAN, EnergyPlanParams, fly_plan
from edl6dof.kernels import kernel
from edl6dof.registry import Member


class FnpegParams(EnergyPlanParams):
    """Fully numerical predictor-corrector entry guidance."""

    heading_speed_m_s: float | None = param(
        None, "this law's own value of heading.speed_m_s", status="design", record=False, ge=0.0, le=10e3
    )


@kernel
def guide(params, plan, onboard, nav, memory, out):
    """Wanted bank angle, its sign included."""
    return fly_plan(params, onboard, nav, memory, out)


MEMBER = Member("fnpeg", FnpegParams, {"guide": guide}, "Lu 2014, J. Guidance 37(3); Smith 2016", ENERGY_PLAN)
