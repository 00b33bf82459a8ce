"""Feedback linearisation of the drag: the comparison law of the extended high-gain observer.

Drag rate comes from the analytic expression with the measured drag; D'' = b + a cos(bank) is inverted with
the believed L/D and scale height.  Source: Wu, Cui & Cui 2013, section 3.3, eqs. 16-19.

Differences from the print: K = [0.4 0.04] is taken as [rate, error], not as [error, rate]: as printed the
error would oscillate with 3 % of critical damping. ``settings: as_printed`` uses these two values in the
corrected order; the defaults are slower, for a rigid body.
"""

from __future__ import annotations

from edl6dof.config.base import PrintedParams, group, param
from edl6dof.fsw.guidance.entry.drag_dynamics import bank_for, drag_dynamics_in_air
from edl6dof.fsw.guidance.entry.drag_energy import PROFILE, PolynomialParams, polynomial_goal
from edl6dof.fsw.guidance.entry.range_update import tracking
from edl6dof.fsw.guidance.entry.reference import reference_bank
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.registry import Member

PAPER = "Wu, Cui & Cui 2013, section 5"


class FlParams(PrintedParams):
    """Feedback linearisation of the drag."""

    error_gain: float = param(
        0.0144, "gain on the drag error, 1/s2", printed=0.04, source=PAPER, gt=0.0, le=10.0
    )
    rate_gain: float = param(0.216, "gain on the error rate, 1/s", printed=0.4, source=PAPER, gt=0.0, le=10.0)
    profile: PolynomialParams = group(PolynomialParams, "polynomial drag-energy profile")


MEMORY = record(("profile", PROFILE))


@kernel
def guide(params, plan, onboard, nav, memory, out):
    """Wanted bank angle from measured drag, its modelled rate, and the range to the aim point."""
    if not tracking(onboard, nav):
        return reference_bank(onboard, onboard.reference.shift, nav.speed)
    p = params
    rate, a, b = drag_dynamics_in_air(onboard, nav)
    out.drag_estimate, out.drag_rate = nav.drag, rate
    goal, goal_rate, goal_acceleration = polynomial_goal(
        onboard, nav, p=p.profile, memory=memory.profile, drag=nav.drag, drag_rate=rate, out=out
    )
    wanted = goal_acceleration + p.rate_gain * (goal_rate - rate) + p.error_gain * (goal - nav.drag)
    return bank_for(wanted, b, a)


MEMBER = Member("fl", FlParams, {"guide": guide}, "Wu, Cui & Cui 2013, section 3 (FL)", MEMORY)
