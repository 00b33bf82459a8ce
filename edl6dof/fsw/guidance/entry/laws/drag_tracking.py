"""Feedback-linearised tracking of a reference drag-energy profile, with range update.

The reference drag is scaled so that the range it predicts is the range to go; the second derivative of drag
is linear in cos(bank), so the bank angle follows by inversion. Source: Wu, Cui & Cui 2013, eqs. 9-19 (the law
called FL there).

Differences from the print: drag dynamics and range as in
:mod:`~edl6dof.fsw.guidance.entry.drag_dynamics` and
:mod:`~edl6dof.fsw.guidance.entry.range_update`; the gains are given as natural frequency and
damping, since K = [0.4 0.04] as printed gives a nearly undamped pair.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.airframe import believed_aero
from edl6dof.fsw.guidance.entry.drag_dynamics import LEAST_LIFT, bank_for, measured_drag_dynamics
from edl6dof.fsw.guidance.entry.range_update import TRACKING, drag_goal, tracking
from edl6dof.fsw.guidance.entry.reference import reference_bank
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.registry import Member


class DragTrackingParams(Params):
    """Feedback-linearised drag tracking."""

    frequency_rad_s: float = param(0.12, "natural frequency of the drag error", gt=0.0, le=1.0)
    damping: float = param(0.9, "damping ratio of the drag error", gt=0.0, le=2.0)


MEMORY = record(("tracking", TRACKING))


@kernel
def guide(params, plan, onboard, nav, memory, out):
    """Wanted bank angle from measured drag and the range to the aim point."""
    if not tracking(onboard, nav):
        return reference_bank(onboard, onboard.reference.shift, nav.speed)
    _, lift_to_drag = believed_aero(onboard.vehicle, nav.mach, nav.speed)
    lift = nav.drag * max(lift_to_drag * out.lift_ratio, LEAST_LIFT)
    rate, a, b = measured_drag_dynamics(onboard, nav, lift)
    goal, goal_rate, goal_acceleration = drag_goal(onboard, nav, memory.tracking, rate, out)
    omega = params.frequency
    wanted_acceleration = (
        goal_acceleration
        + 2.0 * params.damping * omega * (goal_rate - rate)
        + omega * omega * (goal - nav.drag)
    )
    return bank_for(wanted_acceleration, b, a)


MEMBER = Member(
    "drag_tracking", DragTrackingParams, {"guide": guide}, "Wu, Cui & Cui 2013, section 3 (FL)", MEMORY
)
