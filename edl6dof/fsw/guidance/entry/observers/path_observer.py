"""Nonlinear observer of a disturbance in the flight-path rate, shared by the two laws that take it out of the
drag dynamics.

Source: Yan, Sun & Guo 2016, eqs. 5 and 16-17: gamma' = f(x, u) + d, estimate d^ = z + l gamma, which makes
the error obey e' = d' - l e.
Sampled form: over one interval gamma changes by the mean of f plus the mean of d; the error decays by exp(-l
dt), exactly, so that the observer is stable at any guidance rate (the printed form, integrated by Euler
steps, is not when l dt > 2).
"""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.prediction.drag_dynamics import measured_drag_dynamics
from edl6dof.fsw.guidance.entry.profiles.range_update import TRACKING, drag_goal
from edl6dof.fsw.navigation.derived import model_atmosphere
from edl6dof.jit import kernel
from edl6dof.records import FLAG
from edl6dof.spatial.elementary import cos, exp


class PathObserverParams(Params):
    """Observer of a disturbance of the flight-path rate."""

    gain: float = param(10.0, "l, rate at which the estimate converges, 1/s", gt=0.0, le=1000.0)


#: State at the last call: time, flight-path angle, lift over speed, the rest of the path rate; and the
#: estimate, rad/s.
PATH_OBSERVER = np.dtype(
    [
        ("started", FLAG),
        ("t", "f8"),
        ("gamma", "f8"),
        ("lift_rate", "f8"),
        ("free_rate", "f8"),
        ("disturbance", "f8"),
    ],
    align=True,
)

#: What a law that tracks drag with this observer remembers.
MEMORY = np.dtype([("tracking", TRACKING), ("observer", PATH_OBSERVER)], align=True)


@kernel
def observe_path(p, memory, nav, lift):
    """Update and return the estimated disturbance of the flight-path rate, rad/s; ``lift`` in m/s2."""
    lift_rate = lift / nav.speed
    free_rate = (nav.speed / nav.radius - nav.gravity / nav.speed) * cos(nav.flight_path_angle)
    dt = nav.t - memory.t
    if memory.started != 0 and dt > 0.0:
        # the bank angle of now is the one of the whole interval when it follows its command at once
        model = 0.5 * ((lift_rate + memory.lift_rate) * cos(nav.bank) + free_rate + memory.free_rate)
        seen = (nav.flight_path_angle - memory.gamma) / dt - model
        memory.disturbance += (1.0 - exp(-p.gain * dt)) * (seen - memory.disturbance)
    memory.started, memory.t, memory.gamma = 1, nav.t, nav.flight_path_angle
    memory.lift_rate, memory.free_rate = lift_rate, free_rate
    return memory.disturbance


@kernel
def disturbed_drag(onboard, nav, p, memory, out):
    """Drag errors and drag dynamics with the observed disturbance (eqs. 14 and 19).

    Returns (D - D_r, D' - D_r', a + f d^ - D_r'', b): the error's second derivative is the third plus b
    cos(bank).  A disturbance d of the
    path rate acts as lift does: f = b V/L.
    """
    _, _, scale_height = model_atmosphere(onboard.atmosphere, nav.altitude)
    lift = nav.drag * onboard.vehicle.lift_to_drag
    rate, authority, free = measured_drag_dynamics(onboard, nav, lift)
    goal, goal_rate, goal_acceleration = drag_goal(
        onboard, nav, memory=memory.tracking, drag=nav.drag, drag_rate=rate, out=out
    )
    disturbance = observe_path(p, memory.observer, nav, lift)
    out.path_disturbance = disturbance
    path_authority = (
        -nav.drag * cos(nav.flight_path_angle) * (nav.speed / scale_height + 2.0 * nav.gravity / nav.speed)
    )
    drift = free + path_authority * disturbance - goal_acceleration
    return nav.drag - goal, rate - goal_rate, drift, authority
