"""Extended high-gain observer with feedback linearisation.

The observer of :mod:`~edl6dof.fsw.guidance.entry.disturbance_observers` gives drag, drag rate and the
perturbation phi = b - b^ + (a - a^) u; the law cancels b^ and phi^ and places the poles of the drag error.
The control is saturated (|cos(bank)| <= 1 and the bank limits of all laws), and the observer uses the flown
bank angle, so that saturation, reversals and slow banking do not affect phi^. Source: Wu, Cui & Cui 2013,
section 3.3, eqs. 20-23.

Differences from the print: those of :mod:`~edl6dof.fsw.guidance.entry.disturbance_observers` and
:mod:`~edl6dof.fsw.guidance.entry.laws.fl`; b^ is taken at the measured drag with the drag rate that the model
gives there; the difference is part of phi. The printed time scale and gains (``settings: as_printed``) suit a
point mass in an exponential atmosphere. In air with density waves phi is many times the authority of the bank
angle, and the angle of attack of a rigid body oscillates: the defaults are slower and have a smaller gain on
the estimated rate, and phi^ is limited before it is cancelled, where Freidovich & Khalil 2008 saturate
against peaking.
"""

from __future__ import annotations

from edl6dof.config.base import PrintedParams, group, param
from edl6dof.fsw.guidance.entry.disturbance_observers import OBSERVER, observe
from edl6dof.fsw.guidance.entry.drag_dynamics import bank_for, drag_dynamics_in_air
from edl6dof.fsw.guidance.entry.drag_energy import PROFILE, PolynomialParams, polynomial_goal
from edl6dof.fsw.guidance.entry.laws.fl import PAPER
from edl6dof.fsw.guidance.entry.range_update import tracking
from edl6dof.fsw.guidance.entry.reference import reference_bank
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.registry import Member
from edl6dof.spatial.elementary import cos
from edl6dof.spatial.vector import clamp


class EhgoFlParams(PrintedParams):
    """Extended high-gain observer with feedback linearisation."""

    error_gain: float = param(
        0.0144, "gain on the drag error, 1/s2", printed=0.04, source=PAPER, gt=0.0, le=10.0
    )
    rate_gain: float = param(0.216, "gain on the error rate, 1/s", printed=0.4, source=PAPER, gt=0.0, le=10.0)
    epsilon_s: float = param(
        2.0,
        "time scale of the observer error",
        printed=0.1,
        source=PAPER,
        gt=0.0,
        le=100.0,
        usual=(0.05, 20, "the printed 0.1 s to what noise allows"),
    )
    share: float = param(
        0.3,
        "largest phi^ that is cancelled, over the authority of the bank angle; 100: no limit",
        printed=100.0,
        source=PAPER,
        ge=0.0,
        le=100.0,
        usual=(0.03, 100, "of the lift; 100 is no limit"),
    )
    start_share: float = param(1.0, "initial drag of the observer, over the measured drag", ge=0.0, le=10.0)
    profile: PolynomialParams = group(PolynomialParams, "polynomial drag-energy profile")


MEMORY = record(("observer", OBSERVER), ("profile", PROFILE))


@kernel
def guide(params, plan, onboard, nav, memory, out):
    """Wanted bank angle from the observed drag and the range to the aim point."""
    p, observer = params, memory.observer
    if not tracking(onboard, nav):
        return reference_bank(onboard, onboard.reference.shift, nav.speed)
    _, a, b = drag_dynamics_in_air(onboard, nav)
    observe(
        observer, p.epsilon, start=p.start_share * nav.drag, t=nav.t, drag=nav.drag, a=a, b=b, u=cos(nav.bank)
    )
    drag, rate = observer.drag, observer.rate
    out.drag_estimate, out.drag_rate, out.drag_disturbance = drag, rate, observer.phi
    goal, goal_rate, goal_acceleration = polynomial_goal(
        onboard, nav, p=p.profile, memory=memory.profile, drag=drag, drag_rate=rate, out=out
    )
    wanted = goal_acceleration + p.rate_gain * (goal_rate - rate) + p.error_gain * (goal - drag)
    limit = -p.share * a
    return bank_for(wanted, b + clamp(observer.phi, -limit, limit), a)


MEMBER = Member("ehgo_fl", EhgoFlParams, {"guide": guide}, "Wu, Cui & Cui 2013, section 3.3", MEMORY)
