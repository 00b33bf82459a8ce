"""Disturbance observers of the entry laws: an extended high-gain observer of the drag, and a nonlinear
observer of the flight-path rate.

Drag, drag rate, and the part of the drag's second derivative that the model leaves out: the continuous
observer of eqs. 20-21 integrates D'' = phi + b + a u with phi constant, corrected by the measured drag; the
printed alpha = (6, 11, 6) puts its poles at -1, -2 and -3 over the time scale eps. Between two samples the
integrator chain is solved exactly, and the correction gains are those that put the poles of the sampled error
at exp(pole dt): stable at any rate, with the same decay, and the estimates of a steady phi carry no error.
(With an explicit Euler step and the printed eps at 10 Hz, the error would double in each step.) Source: Wu,
Cui & Cui 2013, section 3.3, eqs. 20-23; Freidovich & Khalil 2008.

Differences from the print: the states are drag and drag rate instead of their errors: as the reference is
known, the observer is the same, but it does not jump when the reference is updated; eq. 20's gain vector
carries a stray sqrt(a^2 + b^2), left out here, and eqs. 22 and 23 a sigma-hat where phi-hat belongs; n = 2,
as printed only by implication.

Disturbance of the flight-path rate, which two laws compensate in the drag dynamics: gamma' = f(x, u) + d,
estimate d^ = z + l gamma, whose error obeys e' = d' - l e. Sampled form: over one interval gamma changes by
the mean of f plus the mean of d; the error decays by exp(-l dt), exactly, so that the observer is stable at
any guidance rate (the printed form, integrated by Euler steps, is not when l dt > 2). Source: Yan, Sun & Guo
2016, eqs. 5 and 16-17.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.drag_dynamics import measured_drag_dynamics
from edl6dof.fsw.guidance.entry.range_update import TRACKING, drag_goal
from edl6dof.fsw.navigation.derived import model_atmosphere
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.spatial.elementary import cos, exp

#: Longest time (s) between two samples; after a longer one the observer is restarted.
MEMORY_S = 3.0

#: Estimates of drag (m/s2), drag rate (m/s3) and phi (m/s4); a, b (m/s4) and time (s) of the last sample.
OBSERVER = record(
    ("drag", "f8"), ("rate", "f8"), ("phi", "f8"), ("a", "f8"), ("b", "f8"), ("t", "f8"), ("started", FLAG)
)


@kernel
def observer_gains(epsilon, dt):
    """Gains on drag, rate, phi: poles of the sampled error at z = exp(-dt/eps), z^2 and z^3."""
    z1 = exp(-dt / epsilon)
    z2, z3 = z1 * z1, z1 * z1 * z1
    total, pairs, product = z1 + z2 + z3, z1 * z2 + z1 * z3 + z2 * z3, z1 * z2 * z3
    k3 = 1.0 - total + pairs - product
    k2 = 2.0 + product - total - 0.5 * k3
    return 1.0 - product, k2 / dt, k3 / (dt * dt)


@kernel
def observe(memory, epsilon, start, t, drag, a, b, u):
    """Bring the estimates of ``memory`` (``OBSERVER``) to time ``t`` with the measured ``drag`` (m/s2);
    ``start``: initial drag estimate (m/s2).

    ``a`` and ``b`` (m/s4) are the present ones of D'' = b + a u, ``u`` is the cosine of the bank angle flown
    since the last sample. The model acceleration is the mean of both ends of the interval: the value at the
    beginning alone would delay phi by half an interval.
    """
    dt = t - memory.t
    if memory.started == 0 or dt > MEMORY_S:
        memory.drag, memory.rate, memory.phi = start, 0.0, 0.0
    elif dt > 0.0:
        acceleration = memory.phi + 0.5 * (memory.b + b + (memory.a + a) * u)
        ahead = memory.drag + dt * (memory.rate + 0.5 * dt * acceleration)
        k1, k2, k3 = observer_gains(epsilon, dt)
        error = drag - ahead
        memory.drag = ahead + k1 * error
        memory.rate += dt * acceleration + k2 * error
        memory.phi += k3 * error
    memory.a, memory.b, memory.t, memory.started = a, b, t, 1


class PathObserverParams(Params):
    """Observer of a disturbance of the flight-path rate."""

    gain: float = param(10.0, "l, rate at which the estimate converges, 1/s", gt=0.0, le=1000.0)


#: At the last call: time (s), flight-path angle (rad), lift over speed and path rate without lift (rad/s);
#: estimated disturbance (rad/s).
PATH_OBSERVER = record(
    ("started", FLAG),
    ("t", "f8"),
    ("gamma", "f8"),
    ("lift_rate", "f8"),
    ("free_rate", "f8"),
    ("disturbance", "f8"),
)

#: Memory of a law that tracks drag with the observer of the path rate.
MEMORY = record(("tracking", TRACKING), ("observer", PATH_OBSERVER))


@kernel
def observe_path(p, memory, nav, lift):
    """Update and return the estimated disturbance of the flight-path rate (rad/s); ``lift``: m/s2."""
    lift_rate = lift / nav.speed
    free_rate = (nav.speed / nav.radius - nav.gravity / nav.speed) * cos(nav.flight_path_angle)
    dt = nav.t - memory.t
    if memory.started != 0 and dt > 0.0:
        # the present bank angle stands for the whole interval, exactly if it follows its command at once
        model = 0.5 * ((lift_rate + memory.lift_rate) * cos(nav.bank) + free_rate + memory.free_rate)
        seen = (nav.flight_path_angle - memory.gamma) / dt - model
        memory.disturbance += (1.0 - exp(-p.gain * dt)) * (seen - memory.disturbance)
    memory.started, memory.t, memory.gamma = 1, nav.t, nav.flight_path_angle
    memory.lift_rate, memory.free_rate = lift_rate, free_rate
    return memory.disturbance


@kernel
def disturbed_drag(onboard, nav, p, memory, out):
    """Return the drag errors and the drag dynamics with the observed disturbance (eqs. 14 and 19): (D - D_r,
    D' - D_r', c, a), in m/s2, m/s3, m/s4 and m/s4.

    Without a disturbance D'' = b + a cos(bank), with the drag D and its reference D_r. The second derivative
    of the error is c + a cos(bank), with c = b + f w - D_r''. Here w is the estimated disturbance of the
    flight-path rate (rad/s). It acts like lift, which changes this rate by L cos(bank) / V, so f = a V / L.
    """
    _, _, scale_height = model_atmosphere(onboard.atmosphere, nav.altitude)
    lift = nav.drag * onboard.vehicle.lift_to_drag
    rate, authority, free = measured_drag_dynamics(onboard, nav, lift)
    goal, goal_rate, goal_acceleration = drag_goal(onboard, nav, memory.tracking, rate, out)
    disturbance = observe_path(p, memory.observer, nav, lift)
    out.path_disturbance = disturbance
    path_authority = (
        -nav.drag * cos(nav.flight_path_angle) * (nav.speed / scale_height + 2.0 * nav.gravity / nav.speed)
    )
    drift = free + path_authority * disturbance - goal_acceleration
    return nav.drag - goal, rate - goal_rate, drift, authority
