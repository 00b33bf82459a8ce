"""The drag to follow: the reference drag, scaled so that the range it predicts is the range to go.

Range along a drag profile is the integral of cos(gamma) dE / D (Zheng & Cui 2015, eqs. 11-12; Wu, Cui & Cui
2013, eqs. 11 and 14-15); one number scales the profile, with the largest change in the middle of its
energies. The cosine of the flight-path angle, which the papers leave out, comes from the reference.

Difference from the prints: the change is distributed over the energies of the whole reference, not over the
energy that is left, so that a profile followed without tracking error keeps its scale to the end.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.reference import NODES, node_of
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.spatial.elementary import sin
from edl6dof.spatial.table_index import catmull_rom, cell, held
from edl6dof.spatial.vector import clamp


class TrackingParams(Params):
    """Following the reference drag: when it begins, and how far the range to go may change it."""

    start_drag_m_s2: float = param(
        1.0, "drag at which tracking begins; before, the reference bank is flown", ge=0.0
    )
    update: bool = param(True, "whether the reference drag is scaled to meet the range to go")
    update_stop_m_s: float = param(900.0, "speed below which the range update is frozen", ge=0.0)
    scale_limit: float = param(0.4, "largest relative change of the reference drag", gt=0.0, lt=1.0)


#: Most Newton steps, and the change of the scale at which they stop: 1 m in 100 km.
ITERATIONS, RESOLUTION = 3, 1e-5

#: Second derivative of ``shape``.
SHAPE_CURVATURE = -4.0 * sqrt(2.0)

#: Memory of a law that follows the reference drag.
TRACKING = record(("scale", "f8"))


@kernel
def shape(share):
    """Return the factor f (eq. 15) of the change of the reference drag; ``share``: position in the energy
    range of the reference, 0 to 1.
    """
    return 2.0 * (1.0 - sqrt(2.0) * (share - 0.5) ** 2)


@kernel
def top_of(reference):
    """Square root of twice the energy (m/s) at which the reference begins."""
    return reference.first + (NODES - 1) * reference.spacing


@kernel
def range_scale(reference, energy_speed, wanted, scale, limit):
    """Scale of the reference drag whose predicted range is ``wanted`` (m): Newton's method from the last
    value (eqs. 14-15).  Range is the integral of cos(gamma) dE / D; the table runs over u = sqrt(2E), so dE =
    u du.
    """
    last, _ = cell((energy_speed - reference.first) / reference.spacing, NODES)
    if last < 3:
        return scale
    first2 = reference.first * reference.first
    per_span = 1.0 / (top_of(reference) ** 2 - first2)
    edge = energy_speed - (reference.first + last * reference.spacing)
    here = (
        catmull_rom(reference.drag, NODES, last, edge / reference.spacing)
        if last < NODES - 1
        else reference.drag[last]
    )
    for _ in range(ITERATIONS):
        total, slope, piece = 0.0, 0.0, 0.0
        for i in range(last + 1):
            u = reference.first + i * reference.spacing
            f = shape((u * u - first2) * per_span)
            g = 1.0 + scale * f
            weight = 0.5 if i == 0 or i == last else 1.0
            share = weight * reference.ground[i] * u / (reference.drag[i] * g * g)
            piece = share * g
            total += piece
            slope -= share * f
        # the piece between the last node and the present energy, by the trapezoid
        f = shape((energy_speed * energy_speed - first2) * per_span)
        end = reference.ground[last] * energy_speed / (here * (1.0 + scale * f))
        total = total * reference.spacing + 0.5 * edge * (2.0 * piece + end)
        before = scale
        scale = clamp(scale - (total - wanted) / (slope * reference.spacing), -limit, limit)
        if abs(scale - before) < RESOLUTION:
            break
    return scale


@kernel
def tracking(onboard, nav):
    """Return whether there is drag enough to follow the reference."""
    p = onboard.guidance.entry.tracking
    return nav.drag >= p.start_drag or (nav.speed <= p.update_stop and nav.drag > 0.0)


@kernel
def drag_goal(onboard, nav, memory, drag_rate, out):
    """Drag to follow and its first and second time derivative (m/s2, m/s3, m/s4) at the measured drag and its
    rate, after the range update. ``memory``: ``TRACKING`` record; ``out.reference_drag`` is written.
    """
    p, reference = onboard.guidance.entry.tracking, onboard.reference
    u = sqrt(2.0 * max(nav.energy, 0.0))
    if p.update and nav.speed > p.update_stop:
        memory.scale = range_scale(reference, u, out.range_to_go, memory.scale, p.scale_limit)
    along = nav.gravity * sin(nav.flight_path_angle)
    out.reference_drag, rate, acceleration = scaled(
        reference, memory.scale, u, nav.speed, along, drag=nav.drag, drag_rate=drag_rate
    )
    return out.reference_drag, rate, acceleration


@kernel
def scaled(reference, scale, energy_speed, speed, along, drag, drag_rate):
    """Reference drag times F = 1 + ``scale`` f, and its first and second time derivative (m/s2, m/s3, m/s4),
    while the energy falls with the actual ``drag``: E' = -V D. ``energy_speed``: sqrt(2E), m/s; ``along``:
    gravity against the velocity, m/s2.
    """
    i, f = node_of(reference, energy_speed)
    d = catmull_rom(reference.drag, NODES, i, f)
    first2, top = reference.first * reference.first, top_of(reference)
    span = 0.5 * (top * top - first2)
    share = held(0.5 * (energy_speed * energy_speed - first2) / span)
    # derivatives by energy: of the reference, whose rates are along its own loss of energy, and of F
    d_rate = catmull_rom(reference.drag_rate, NODES, i, f)
    planned_rate, planned_acceleration = -speed * d, (d + along) * d - speed * d_rate
    slope = d_rate / planned_rate
    bend = catmull_rom(reference.drag_acceleration, NODES, i, f) - slope * planned_acceleration
    bend /= planned_rate * planned_rate
    factor = 1.0 + scale * shape(share)
    factor_slope, factor_bend = (
        scale * (SHAPE_CURVATURE * (share - 0.5)) / span,
        scale * SHAPE_CURVATURE / (span * span),
    )
    goal_slope = factor * slope + factor_slope * d
    goal_bend = factor * bend + 2.0 * factor_slope * slope + factor_bend * d
    energy_rate, energy_acceleration = -speed * drag, (drag + along) * drag - speed * drag_rate
    return (
        factor * d,
        goal_slope * energy_rate,
        goal_bend * energy_rate * energy_rate + goal_slope * energy_acceleration,
    )
