"""Drag-velocity tracking by adaptive H-infinity control.

The profile of :mod:`~edl6dof.fsw.guidance.entry.drag_velocity`, scaled to the range to go, is followed with
the uncertain drag dynamics of :mod:`~edl6dof.fsw.guidance.entry.drag_dynamics` inverted at the estimate p of
theta, a state feedback that bounds the effect of a disturbance on the tracking error, and p adapted inside
its box.  Source: Lu & Bayard, sections 2 and 3, eqs. 12-20; Lu & Packard 1997.

State feedback.  Error dynamics z' = A z + B (v + d), z = (e, e'), two integrators.  P > 0 solves P A + A' P +
P B (1/lambda^2 - 1/rho) B' P + C' C = 0 with C = (1, 0) and the weight rho on the control; v = F z, F = -B' P
/ (2 rho), then gives d/dt (z' P z) <= lambda^2 d^2 - e^2, so int e^2 <= lambda^2 int d^2 + z(0)' P z(0).  For
two integrators P is known in closed form (checked in the tests against scipy.linalg.solve_continuous_are); it
exists when lambda^2 > rho.

Differences from the print, in addition to those of the two modules: F = +B' P / 2 lacks the minus sign that
its own equation P (A + B F) + (A + B F)' P + ... = 0 needs; the L2 inequality holds from z(0) = 0, otherwise
z(0)' P z(0) is added; rho, which sets the bandwidth, is 1 in the print (``settings: as_printed``): in seconds
that is a drag loop of 0.7 rad/s, faster than a capsule can bank; eq. 16 divides by 1 + theta_5 instead of 1 -
theta_4; there and in section 3.3 the reference acceleration has the wrong sign; D_r'' contains u, because V''
does, and this part is moved to the left-hand side; the drag rate, which the paper measures, is the analytic
one at the measured drag.
"""

from __future__ import annotations

from math import sqrt
from typing import Self

import numpy as np
from pydantic import model_validator

from edl6dof.config.base import PrintedParams, param
from edl6dof.fsw.guidance.entry.drag_dynamics import believed_lift, drag_dynamics_in_air, uncertain_drag
from edl6dof.fsw.guidance.entry.drag_velocity import (
    DRAG_VELOCITY,
    ceiling,
    fill_drag_velocity,
    profile_drag,
    profile_range,
)
from edl6dof.fsw.guidance.entry.reference import reference_bank
from edl6dof.fsw.navigation.derived import model_atmosphere
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.registry import Member
from edl6dof.spatial.elementary import acos, cos, sin, sincos
from edl6dof.spatial.vector import clamp


@kernel
def riccati(disturbance_gain, control_weight):
    """(P11, P12, P22) for lambda (``disturbance_gain``) in s^2 and rho (``control_weight``) in s^4; lambda^2
    must exceed rho.
    """
    strength = 1.0 / control_weight - 1.0 / (disturbance_gain * disturbance_gain)
    p12 = 1.0 / sqrt(strength)
    p22 = sqrt(2.0 * p12 / strength)
    return strength * p12 * p22, p12, p22


@kernel
def feedback(disturbance_gain, control_weight):
    """Gains F = (F1, F2) on drag error (1/s2) and its rate (1/s)."""
    _, p12, p22 = riccati(disturbance_gain, control_weight)
    return -0.5 * p12 / control_weight, -0.5 * p22 / control_weight


@kernel
def adapt(estimate, low, high, regressor, adjoint, energy, dt):
    """Integrate p' = projection of -Q^-1 g1' (P z)_2 (eq. 20) over ``dt`` (s), in place; ``regressor``: g1,
    ``adjoint``: (P z)_2.

    Q is diagonal, such that (p - theta)' Q (p - theta) <= ``energy`` (epsilon of the inequality) for any two
    points of the box ``low`` .. ``high``; the projection onto a box limits each component.
    """
    n = estimate.shape[0]
    for i in range(n):
        width = high[i] - low[i]
        estimate[i] = clamp(
            estimate[i] - dt * n * width * width / energy * regressor[i] * adjoint, low[i], high[i]
        )


PARAMETERS = 5
#: Longest step (s) of the adaptation, also after a longer pause.
STEP_S = 1.0


class AdaptiveHinfParams(PrintedParams):
    """Adaptive H-infinity tracking of a drag-velocity profile.

    Of these parameters, the paper prints only the value of rho (``control_weight``).
    """

    start_drag_m_s2: float = param(
        4.0, "drag where the profile begins; before, the reference bank is flown", gt=0.0, le=1000.0
    )
    disturbance_gain: float = param(
        200.0, "lambda: bound on the gain from disturbance to drag error, s2", gt=0.0, le=1e6
    )
    control_weight: float = param(
        10000.0,
        "rho: weight of the control in the Riccati equation, s4",
        printed=1.0,
        source="Lu & Bayard, section 3.3",
        gt=0.0,
        le=1e9,
    )
    adaptation_energy: float = param(
        100.0, "epsilon: bound on the error energy due to the parameters, m2/s3", gt=0.0, le=1e9
    )
    coefficient_rate_limit: float = param(
        2e-3, "bound on theta 1, the relative rate of the drag coefficient, 1/s", gt=0.0, le=1.0
    )
    coefficient_acceleration_limit: float = param(
        1e-4, "bound on theta 2, its derivative, 1/s2", gt=0.0, le=1.0
    )
    path_limit_deg: float = param(30.0, "flight-path angle that bounds theta 3, 4 and 5", gt=0.0, lt=90.0)

    @model_validator(mode="after")
    def _riccati_has_a_solution(self) -> Self:
        if self.disturbance_gain * self.disturbance_gain <= self.control_weight:
            least = sqrt(self.control_weight)
            raise ValueError(
                f"disturbance_gain must be above the root of control_weight, {least:g} (got "
                f"{self.disturbance_gain:g})"
            )
        return self


MEMORY = record(
    ("theta", "f8", (PARAMETERS,)),
    ("low", "f8", (PARAMETERS,)),
    ("high", "f8", (PARAMETERS,)),
    ("scale", "f8"),  # factor on the profile
    ("t", "f8"),
    ("started", FLAG),
)


@kernel
def begin(p, memory):
    """Set the bounds of theta, and its first estimate in their middle."""
    rate, acceleration, s = p.coefficient_rate_limit, p.coefficient_acceleration_limit, sin(p.path_limit)
    memory.low[0], memory.high[0] = -rate, rate
    memory.low[1], memory.high[1] = -acceleration, acceleration
    memory.low[2], memory.high[2] = 0.0, s * s
    memory.low[3], memory.high[3] = 0.0, 1.0 - cos(p.path_limit)
    memory.low[4], memory.high[4] = 0.0, s * s
    for i in range(PARAMETERS):
        memory.theta[i] = 0.5 * (memory.low[i] + memory.high[i])
    memory.scale, memory.started = 1.0, 1


@kernel
def scaled_profile(profile, onboard, nav, memory, out):
    """Drag to follow and its two derivatives by speed, scaled to the range to go, under the ceiling."""
    shared = onboard.guidance.entry.tracking
    if shared.update and nav.speed > shared.update_stop:
        wanted = profile_range(profile, nav.speed) / max(out.range_to_go, 1.0)
        memory.scale = clamp(wanted, 1.0 - shared.scale_limit, 1.0 + shared.scale_limit)
    drag, slope, curvature = profile_drag(profile, nav.speed)
    scale = min(memory.scale, ceiling(onboard, nav.speed) / drag)
    out.reference_drag = scale * drag
    return scale * drag, scale * slope, scale * curvature


@kernel
def goal_rates(nav, drag, drag_rate, slope, curvature):
    """Return the time derivatives of the drag reference D_r along the actual flight: D_r' (m/s3), and the two
    parts of D_r'' = free + per_u u (m/s4) with the input u = (L/D) cos(bank).
    """
    (s, c), g, v = sincos(nav.flight_path_angle), nav.gravity, nav.speed
    speed_rate = -drag - g * s
    path_free = (v / nav.radius - g / v) * c
    speed_free = -drag_rate - g * c * path_free + 2.0 * g * v * s * s / nav.radius
    return (
        slope * speed_rate,
        curvature * speed_rate * speed_rate + slope * speed_free,
        -slope * g * c * drag / v,
    )


@kernel
def track(p, memory, dt, flown, error, error_rate, dynamics, goal_free, goal_per_u):
    """Update theta by the effect of the input ``flown`` over the last ``dt`` seconds, and return the wanted
    input u = (L/D) cos(bank), not limited.

    ``dynamics`` is the result of :func:`~edl6dof.fsw.guidance.entry.drag_dynamics.uncertain_drag`;
    ``goal_free`` and ``goal_per_u`` are the two parts of D_r''.
    """
    free, unknown, per_u = dynamics
    _, p12, p22 = riccati(p.disturbance_gain, p.control_weight)
    regressor = (unknown[0], unknown[1], unknown[2], per_u * flown, unknown[4])
    adapt(
        memory.theta,
        memory.low,
        memory.high,
        regressor,
        adjoint=p12 * error + p22 * error_rate,
        energy=p.adaptation_energy,
        dt=dt,
    )
    theta, (f1, f2) = memory.theta, feedback(p.disturbance_gain, p.control_weight)
    known = unknown[0] * theta[0] + unknown[1] * theta[1] + unknown[2] * theta[2] + unknown[4] * theta[4]
    wanted = f1 * error + f2 * error_rate + goal_free
    return (wanted + free + known) / ((1.0 - theta[3]) * per_u - goal_per_u)


@kernel
def guide(params, plan, onboard, nav, memory, out):
    """Return the commanded bank angle (rad) from measured drag, speed, and the range to the aim point."""
    p, planet = params, onboard.planet
    if nav.drag < p.start_drag and nav.speed > onboard.guidance.entry.tracking.update_stop:
        return reference_bank(onboard, onboard.reference.shift, nav.speed)
    if memory.started == 0:
        begin(p, memory)
        memory.t = nav.t
    _, _, scale_height = model_atmosphere(onboard.atmosphere, nav.altitude)
    drag, lift_to_drag = max(nav.drag, 1e-3), believed_lift(onboard.vehicle, nav)
    rate, _, _ = drag_dynamics_in_air(onboard, nav)
    out.drag_estimate, out.drag_rate = drag, rate
    goal, slope, curvature = scaled_profile(plan, onboard, nav, memory, out)
    goal_rate, goal_free, goal_per_u = goal_rates(nav, drag, rate, slope, curvature)
    error, error_rate = drag - goal, rate - goal_rate
    gravity = planet.mu / (planet.equatorial_radius * planet.equatorial_radius)
    dynamics = uncertain_drag(
        drag, rate, nav.speed, gravity, radius=planet.equatorial_radius, scale_height=scale_height
    )
    dt = clamp(nav.t - memory.t, 0.0, STEP_S)
    memory.t = nav.t
    u = track(
        p,
        memory,
        dt,
        flown=lift_to_drag * cos(nav.bank),
        error=error,
        error_rate=error_rate,
        dynamics=dynamics,
        goal_free=goal_free,
        goal_per_u=goal_per_u,
    )
    return acos(clamp(u / lift_to_drag, -1.0, 1.0))


def lay_plan(onboard: np.ndarray, planned: np.ndarray) -> None:
    """Fit the drag-velocity profile to the planned reference."""
    start = float(onboard["guidance"]["entry"]["adaptive_hinf"]["start_drag"][0])
    fill_drag_velocity(onboard, planned, start, onboard["plan"]["adaptive_hinf"][0])


MEMBER = Member(
    "adaptive_hinf",
    AdaptiveHinfParams,
    {"guide": guide},
    "Lu & Bayard, sections 2 and 3",
    MEMORY,
    tables=DRAG_VELOCITY,
    plan=lay_plan,
)
