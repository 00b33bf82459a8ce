"""Sliding-mode drag tracking with a linear disturbance observer and a virtual state for input saturation.

Source: Zheng & Cui 2015, eqs. 13-29. Everything in the drag dynamics but the known input b u, u = cos(bank),
is one lumped disturbance d; the observer estimates it from the motion of the sliding surface s, and the law
compensates it. While the bank angle is at its limits the virtual state zeta offsets the surface, which
prevents wind-up.

Sampled form. Between two calls the input is constant, so s grows by (d + v_fb) dt with the mean d of the
interval and the feedback v_fb; the first-order filter Q = 1/(tau p + 1), the virtual state and the adaptation
are integrated exactly over the interval: stable at any guidance rate. The input used is the cosine of the
navigated bank angle, which includes the bank limits (30 to 90 deg in the paper), the bank rate and attitude
control; the saturation of eq. 16 is the special case of ideal banking.

Differences from the print: eqs. 13-14 as in :mod:`~edl6dof.fsw.guidance.entry.drag_dynamics`; the
scale height printed as 9354 km is in metres; eq. 29 has xi where eq. 25 has zeta, which is meant; c0 = 2 +
b_n^2/4 is the printed choice of eq. 42 with 4 for the constant.
"""

from __future__ import annotations

from edl6dof.config.base import PrintedParams, param
from edl6dof.fsw.guidance.entry.drag_dynamics import measured_drag_dynamics
from edl6dof.fsw.guidance.entry.range_update import TRACKING, drag_goal, tracking
from edl6dof.fsw.guidance.entry.reference import reference_bank
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.registry import Member
from edl6dof.spatial.elementary import acos, cos, exp
from edl6dof.spatial.vector import clamp

PAPER = "Zheng & Cui 2015, section 5"


class DobSlidingParams(PrintedParams):
    """Sliding mode with linear disturbance observer and virtual saturation state."""

    filter_time_s: float = param(
        0.1,
        "time constant tau of the observer's filter",
        status="published",
        source=PAPER,
        gt=0.0,
        le=100.0,
        usual=(0.01, 20, "the bandwidth of the observer"),
    )
    error_gain: float = param(
        2.1,
        "k_e, weight of the drag error in the surface, 1/s",
        status="published",
        source=PAPER,
        gt=0.0,
        le=100.0,
        usual=(0.01, 20, "the bandwidth of the law"),
    )
    surface_gain: float = param(
        0.1, "k_s, rate of approach to the surface, 1/s", status="published", source=PAPER, ge=0.0, le=100.0
    )
    boundary_m_s3: float = param(
        0.1, "c_s, boundary layer of the surface", status="published", source=PAPER, gt=0.0, le=100.0
    )
    adaptation: float = param(
        0.01, "l, growth of eta per second and surface", status="published", source=PAPER, ge=0.0, le=100.0
    )
    virtual_gain: float = param(
        2.0, "constant part of c_0, decay of the virtual state, 1/s", status="published", source=PAPER, gt=0.0
    )


#: State at the last call: sliding surface and virtual state (m/s3), estimated disturbance (m/s4), eta, input
#: u without limits, feedback v_fb (m/s4), authority b (m/s4), decay c_0 (1/s).
MEMORY = record(
    ("tracking", TRACKING),
    ("started", FLAG),
    ("t", "f8"),
    ("surface", "f8"),
    ("virtual", "f8"),
    ("disturbance", "f8"),
    ("eta", "f8"),
    ("input", "f8"),
    ("feedback", "f8"),
    ("authority", "f8"),
    ("decay", "f8"),
)


@kernel
def observe(p, memory, dt, error, error_rate, applied):
    """Update surface, virtual state, disturbance estimate and eta for the ``dt`` seconds in which cos(bank)
    was ``applied``; ``error`` and ``error_rate`` (m/s2, m/s3) are those at the end. Source: eqs. 19, 23, 26,
    28 and Fig. 1.
    """
    if memory.started == 0 or dt <= 0.0:
        memory.started = 1
        memory.surface = error_rate + p.error_gain * error - memory.virtual
        return
    decayed = exp(-memory.decay * dt)
    memory.virtual = decayed * memory.virtual + (1.0 - decayed) / memory.decay * memory.authority * (
        applied - memory.input
    )
    surface = error_rate + p.error_gain * error - memory.virtual
    seen = (surface - memory.surface) / dt - memory.feedback
    memory.disturbance += (1.0 - exp(-dt / p.filter_time)) * (seen - memory.disturbance)
    memory.surface = surface
    memory.eta += p.adaptation * abs(surface) * dt


@kernel
def guide(params, plan, onboard, nav, memory, out):
    """Wanted bank angle (rad), eq. 29."""
    if not tracking(onboard, nav):
        return reference_bank(onboard, onboard.reference.shift, nav.speed)
    p = params
    lift = nav.drag * onboard.vehicle.lift_to_drag
    rate, authority, _ = measured_drag_dynamics(onboard, nav, lift)
    goal, goal_rate, goal_acceleration = drag_goal(onboard, nav, memory.tracking, rate, out)
    error, error_rate = nav.drag - goal, rate - goal_rate
    observe(p, memory, dt=nav.t - memory.t, error=error, error_rate=error_rate, applied=cos(nav.bank))

    memory.t, memory.authority = nav.t, min(authority, -1e-12)
    memory.decay = p.virtual_gain + 0.25 * authority * authority
    reaching = p.surface_gain * memory.surface + 2.0 * memory.eta * memory.surface / (
        abs(memory.surface) + p.boundary
    )
    memory.feedback = -memory.disturbance - reaching
    memory.input = (
        goal_acceleration - p.error_gain * error_rate - memory.decay * memory.virtual + memory.feedback
    ) / memory.authority
    out.surface, out.virtual, out.drag_disturbance = memory.surface, memory.virtual, memory.disturbance
    return acos(clamp(memory.input, -1.0, 1.0))


MEMBER = Member("dob_sliding", DobSlidingParams, {"guide": guide}, "Zheng & Cui 2015, eqs. 13-29", MEMORY)
