"""Feedback-linearised tracking of a reference drag-energy profile, with range update.

The reference drag is scaled so that the range it predicts is the range to go; the second derivative of drag is linear in cos(bank),
so the bank angle is found by inverting it.  Source: Wu, Cui & Cui 2013, eqs. 9-19 (the law called FL there).

Differences from the print: the drag dynamics are derived here from D = k rho V^2 and eqs. 1-3 (checked by finite difference in the
tests) rather than taken from eq. 12; the range integral carries the cosine of the flight-path angle, which eq. 11 leaves out; the gains
are given as natural frequency and damping, since K = [0.4 0.04] as printed gives a nearly undamped pair.
"""

from __future__ import annotations

from math import acos, cos, sin, sqrt

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.reference import NODES
from edl6dof.fsw.navigation import model_atmosphere
from edl6dof.jit import kernel
from edl6dof.registry import Member
from edl6dof.spatial.vector import clamp


class DragTrackingParams(Params):
    """Feedback-linearised drag tracking."""

    start_drag_m_s2: float = param(1.0, "drag at which tracking begins; before, the reference bank is held", ge=0.0)
    frequency_rad_s: float = param(0.08, "natural frequency of the drag error", gt=0.0, le=1.0)
    damping: float = param(0.9, "damping ratio of the drag error", gt=0.0, le=2.0)
    update_stop_m_s: float = param(900.0, "speed below which the range update is frozen", ge=0.0)
    scale_limit: float = param(0.4, "largest relative change of the reference drag", gt=0.0, lt=1.0)


MEMORY = np.dtype([("scale", "f8")], align=True)


@kernel
def shape(share):
    """Where along the remaining energy the reference is changed (eq. 15)."""
    return 2.0 * (1.0 - sqrt(2.0) * (share - 0.5) ** 2)


@kernel
def range_scale(reference, energy_speed, wanted, scale, limit):
    """Scale of the reference drag whose predicted range is ``wanted`` (m): Newton's method from the last value (eqs. 14-15).

    Range is the integral of cos(gamma) dE / D; the table runs over u = sqrt(2E), so dE = u du.
    """
    last = min(int((energy_speed - reference.first) / reference.spacing), NODES - 1)
    if last < 3:
        return scale
    first2 = reference.first * reference.first
    span = energy_speed * energy_speed - first2
    for _ in range(3):
        total, slope = 0.0, 0.0
        for i in range(last + 1):
            u = reference.first + i * reference.spacing
            f = shape((u * u - first2) / span)
            weight = 0.5 if i == 0 or i == last else 1.0
            piece = weight * reference.cos_path[i] * u / (reference.drag[i] * (1.0 + scale * f))
            total += piece
            slope -= piece * f / (1.0 + scale * f)
        # the piece between the last node and the present energy
        edge = energy_speed - (reference.first + last * reference.spacing)
        here = reference.drag[last] * (1.0 + scale * shape(1.0))
        total = total * reference.spacing + edge * reference.cos_path[last] * energy_speed / here
        scale = clamp(scale - (total - wanted) / (slope * reference.spacing), -limit, limit)
    return scale


@kernel
def drag_dynamics(drag, speed, gamma, radius, gravity, lift, scale_height):
    """Drag rate and the two parts of its derivative: D'' = b + a cos(bank).  Returns (D', a, b).

    D' = D (-V sin(gamma)/h_s + 2 V'/V) with V' = -D - g sin(gamma); the rest follows by differentiation with
    gamma' = L cos(bank)/V + (V/r - g/V) cos(gamma), g' = -2 g V sin(gamma)/r and constant h_s.
    """
    s, c = sin(gamma), cos(gamma)
    v_rate = -drag - gravity * s
    relative = -speed * s / scale_height + 2.0 * v_rate / speed
    drag_rate = drag * relative
    path_free = (speed / radius - gravity / speed) * c
    gravity_rate = -2.0 * gravity * speed * s / radius

    # derivative of `relative` with the flight-path rate as gamma' = path_free + (lift/speed) u
    def_free = (
        -(v_rate * s + speed * c * path_free) / scale_height
        - 2.0 * (drag_rate + gravity_rate * s + gravity * c * path_free) / speed
        - 2.0 * v_rate * v_rate / (speed * speed)
    )
    per_u = -(speed * c / scale_height + 2.0 * gravity * c / speed) * lift / speed
    return drag_rate, drag * per_u, drag * def_free + drag_rate * relative


@kernel
def guide(onboard, nav, mem, out):
    """Wanted bank angle from measured drag and the range to the aim point."""
    p = onboard.guidance.entry.drag_tracking
    memory = mem.drag_tracking
    reference = onboard.reference
    if nav.drag < p.start_drag and nav.speed > p.update_stop:
        return reference.bank
    u = sqrt(2.0 * max(nav.energy, 0.0))
    if nav.speed > p.update_stop:
        memory.scale = range_scale(reference, u, out.range_to_go, memory.scale, p.scale_limit)
    position = clamp((u - reference.first) / reference.spacing, 0.0, NODES - 1.001)
    i = int(position)
    f = position - i
    factor = 1.0 + memory.scale * shape(1.0)
    goal = factor * (reference.drag[i] + f * (reference.drag[i + 1] - reference.drag[i]))
    goal_rate = factor * (reference.drag_rate[i] + f * (reference.drag_rate[i + 1] - reference.drag_rate[i]))
    goal_acceleration = factor * (
        reference.drag_acceleration[i] + f * (reference.drag_acceleration[i + 1] - reference.drag_acceleration[i])
    )
    out.reference_drag = goal
    _, _, scale_height = model_atmosphere(onboard.atmosphere, nav.altitude)
    lift = nav.drag * onboard.vehicle.lift_to_drag
    rate, a, b = drag_dynamics(nav.drag, nav.speed, nav.flight_path_angle, nav.radius, nav.gravity, lift, scale_height)
    omega = p.frequency
    wanted_acceleration = goal_acceleration + 2.0 * p.damping * omega * (goal_rate - rate) + omega * omega * (goal - nav.drag)
    return acos(clamp((wanted_acceleration - b) / a, -1.0, 1.0))


MEMBER = Member("drag_tracking", DragTrackingParams, {"guide": guide}, "Wu, Cui & Cui 2013, section 3 (FL)", MEMORY)
