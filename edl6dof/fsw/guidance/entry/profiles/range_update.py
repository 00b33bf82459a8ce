"""The drag to follow: the reference drag, scaled so that the range it predicts is the range to go.

Range along a drag profile is the integral of cos(gamma) dE / D (Zheng & Cui 2015, eqs. 11-12; Wu, Cui & Cui
2013, eqs. 11 and 14-15); one number scales the rest of the profile, most in the middle of the energy that is
left.  The cosine of the flight-path angle, which the papers leave out, comes from the reference.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.prediction.reference import NODES, node_of
from edl6dof.jit import kernel
from edl6dof.spatial.interpolation import smooth
from edl6dof.spatial.lookups import cell
from edl6dof.spatial.vector import clamp


class TrackingParams(Params):
    """Following the reference drag: when it begins, and how far the range to go may change it."""

    start_drag_m_s2: float = param(
        1.0, "drag at which tracking begins; before, the reference bank is held", ge=0.0
    )
    update: bool = param(True, "whether the reference drag is scaled to meet the range to go")
    update_stop_m_s: float = param(900.0, "speed below which the range update is frozen", ge=0.0)
    scale_limit: float = param(0.4, "largest relative change of the reference drag", gt=0.0, lt=1.0)


#: Newton steps at most, and the change of the scale that needs no further one: 1 m in 100 km.
ITERATIONS, RESOLUTION = 3, 1e-5

#: What a law that follows the reference drag remembers.
TRACKING = np.dtype([("scale", "f8")], align=True)


@kernel
def shape(share):
    """Where along the remaining energy the reference is changed (eq. 15)."""
    return 2.0 * (1.0 - sqrt(2.0) * (share - 0.5) ** 2)


@kernel
def range_scale(reference, energy_speed, wanted, scale, limit):
    """Scale of the reference drag whose predicted range is ``wanted`` (m): Newton's method from the last
    value (eqs. 14-15).

    Range is the integral of cos(gamma) dE / D; the table runs over u = sqrt(2E), so dE = u du.
    """
    last, _ = cell((energy_speed - reference.first) / reference.spacing, NODES)
    if last < 3:
        return scale
    first2 = reference.first * reference.first
    per_span = 1.0 / (energy_speed * energy_speed - first2)
    edge = energy_speed - (reference.first + last * reference.spacing)
    here = (
        smooth(reference.drag, NODES, last, edge / reference.spacing)
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
        end = reference.ground[last] * energy_speed / (here * (1.0 + scale * shape(1.0)))
        total = total * reference.spacing + 0.5 * edge * (2.0 * piece + end)
        before = scale
        scale = clamp(scale - (total - wanted) / (slope * reference.spacing), -limit, limit)
        if abs(scale - before) < RESOLUTION:
            break
    return scale


@kernel
def tracking(onboard, nav):
    """Whether there is drag enough to follow the reference."""
    p = onboard.guidance.entry.tracking
    return nav.drag >= p.start_drag or (nav.speed <= p.update_stop and nav.drag > 0.0)


@kernel
def drag_goal(onboard, nav, memory, out):
    """Drag to follow and its first and second time derivative (m/s2, m/s3, m/s4), the range update included.

    ``memory`` is a ``TRACKING`` record; the goal is written to ``out.reference_drag``.
    """
    p, reference = onboard.guidance.entry.tracking, onboard.reference
    u = sqrt(2.0 * max(nav.energy, 0.0))
    if p.update and nav.speed > p.update_stop:
        memory.scale = range_scale(reference, u, out.range_to_go, memory.scale, p.scale_limit)
    i, f = node_of(reference, u)
    factor = 1.0 + memory.scale * shape(1.0)
    out.reference_drag = factor * smooth(reference.drag, NODES, i, f)
    goal_rate = factor * smooth(reference.drag_rate, NODES, i, f)
    return out.reference_drag, goal_rate, factor * smooth(reference.drag_acceleration, NODES, i, f)
