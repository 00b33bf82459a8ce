"""Finite-time drag tracking with a nonlinear disturbance observer.

Source: Yan, Sun & Guo 2016, eqs. 13-22. The error of drag is driven to zero in finite time by fractional
powers of error and error rate; the disturbance of the flight-path rate is observed and compensated. The paper
prints neither gains nor exponent; the values here are chosen for this software.

Differences from the print: eq. 22 has the sign of the reference acceleration reversed against eq. 20; the
drag dynamics include the decrease of g with height, which eq. 14 leaves out; beta is printed in m where 1/m
is meant.
"""

from __future__ import annotations

from math import copysign

from edl6dof.config.base import Params, group, param
from edl6dof.fsw.guidance.entry.disturbance_observers import MEMORY, PathObserverParams, disturbed_drag
from edl6dof.fsw.guidance.entry.drag_dynamics import bank_for
from edl6dof.fsw.guidance.entry.range_update import tracking
from edl6dof.fsw.guidance.entry.reference import reference_bank
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.elementary import pow


class FtcDobParams(Params):
    """Finite-time control with nonlinear disturbance observer."""

    error_gain: float = param(0.25, "k_1, weight of |D - D_r|^alpha_1", gt=0.0, le=100.0)
    rate_gain: float = param(
        0.8, "k_2, weight of the error rate to the power alpha_2 = 2 alpha_1/(1 + alpha_1)", gt=0.0, le=100.0
    )
    exponent: float = param(0.6, "alpha_1", gt=0.0, lt=1.0)
    observer: PathObserverParams = group(PathObserverParams, "disturbance observer")


@kernel
def power(x, exponent):
    """Return |x|^exponent with the sign of ``x``."""
    return copysign(pow(abs(x), exponent), x)


@kernel
def guide(params, plan, onboard, nav, memory, out):
    """Return the bank angle (rad) that the law demands: eq. 22, with the sign of the reference acceleration
    from eq. 20, which eq. 22 prints reversed.
    """
    if not tracking(onboard, nav):
        return reference_bank(onboard, onboard.reference.shift, nav.speed)
    p = params
    error, error_rate, drift, authority = disturbed_drag(onboard, nav, p.observer, memory, out)
    feedback = p.error_gain * power(error, p.exponent) + p.rate_gain * power(
        error_rate, 2.0 * p.exponent / (1.0 + p.exponent)
    )
    return bank_for(-feedback, drift, authority)


MEMBER = Member("ftc_dob", FtcDobParams, {"guide": guide}, "Yan, Sun & Guo 2016, eqs. 13-22", MEMORY)
