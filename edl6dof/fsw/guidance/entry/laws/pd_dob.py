"""Proportional-derivative drag tracking with the disturbance observer of the finite-time law (``ftc_dob``),
for comparison with it.

Source: Yan, Sun & Guo 2016, section 3. The paper does not print the gains; the values here are chosen for
this software.
"""

from __future__ import annotations

from edl6dof.config.base import Params, group, param
from edl6dof.fsw.guidance.entry.disturbance_observers import MEMORY, PathObserverParams, disturbed_drag
from edl6dof.fsw.guidance.entry.drag_dynamics import bank_for
from edl6dof.fsw.guidance.entry.range_update import tracking
from edl6dof.fsw.guidance.entry.reference import reference_bank
from edl6dof.kernels import kernel
from edl6dof.registry import Member


class PdDobParams(Params):
    """Proportional-derivative control with nonlinear disturbance observer."""

    error_gain: float = param(
        0.25,
        "k_P, weight of the drag error, 1/s2",
        gt=0.0,
        le=100.0,
        usual=(0.01, 2.5, "the bandwidth of the law"),
    )
    rate_gain: float = param(0.8, "k_D, weight of the rate of the drag error, 1/s", gt=0.0, le=100.0)
    observer: PathObserverParams = group(PathObserverParams, "disturbance observer")


@kernel
def guide(params, plan, onboard, nav, memory, out):
    """Wanted bank angle (rad)."""
    if not tracking(onboard, nav):
        return reference_bank(onboard, onboard.reference.shift, nav.speed)
    p = params
    error, error_rate, drift, authority = disturbed_drag(onboard, nav, p.observer, memory, out)
    return bank_for(-p.error_gain * error - p.rate_gain * error_rate, drift, authority)


MEMBER = Member("pd_dob", PdDobParams, {"guide": guide}, "Yan, Sun & Guo 2016, section 3 (PD+DOB)", MEMORY)
