"""FNPEG, fully numerical predictor-corrector entry guidance: a bank angle linear in energy and the speeds of
its reversals are solved for, so that the predicted flight ends at the aim point in range and crossrange.

The plan, its corrections and their sources are those of :mod:`~edl6dof.fsw.guidance.entry.energy_plan`, in
the air that :mod:`~edl6dof.fsw.guidance.entry.air_data` estimates. Sources: Lu 2014, "Entry guidance: a
unified method", J. Guidance, Control, and Dynamics 37(3), sections IV and V; Smith 2016, AAS 16-216.

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
