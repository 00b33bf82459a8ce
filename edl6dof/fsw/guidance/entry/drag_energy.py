"""Drag-energy profile as a polynomial of order six, refitted whenever the range to go is updated.

Range along a drag profile is the integral of cos(gamma) dE / D. At each update the profile is multiplied by 1
+ eta f(E) with the eta that makes it predict the range to go, and the product is fitted again: the polynomial
covers the energy that is left until range control ends. Source: Wu, Cui & Cui 2013, section 3.1-3.2, eqs.
9-15.

Differences from the print: the profile ends with range control, and the planned range from there is added;
the range integral carries the ground distance per path length of the reference trajectory, which eqs. 11 and
14 leave out (1 % of the range of an entry at 14 deg); the argument of the polynomial is the share of energy
left, 0 at the terminal and 1 at the last update, because E^6 in J/kg makes the least-squares problem
ill-conditioned; the fit stays within a factor of the reference, so that it does not drift with each update
for an aim point out of reach.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.range_update import shape
from edl6dof.fsw.guidance.entry.reference import node_of
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.spatial import arrays
from edl6dof.spatial.elementary import sin
from edl6dof.spatial.vector import clamp

ORDER = 6
#: Samples between the ends of the remaining energy; odd, for Simpson's rule.
SAMPLES = 33
_ANGLE = np.linspace(0.0, np.pi, SAMPLES)
#: Share of the energy left at each sample, dense at both ends, where drag is low and range is long; and
#: Simpson's weights of an integral over this share.
SHARE = 0.5 * (1.0 - arrays.cos(_ANGLE))
WEIGHT = (
    np.array([1.0, *[4.0, 2.0] * (SAMPLES // 2 - 1), 4.0, 1.0])
    * np.pi
    / (3.0 * (SAMPLES - 1))
    * 0.5
    * arrays.sin(_ANGLE)
)
#: Coefficients of the least-squares polynomial from its samples, shape (ORDER + 1, SAMPLES).
FIT = arrays.pseudo_inverse(np.vander(SHARE, ORDER + 1, increasing=True))

#: Range to go, over that planned after range control, down to which the profile is refitted.
LEAST_RANGE = 1.4

#: The present profile: coefficients (m/s2), energy (J/kg) at its argument 1, time (s) of the last update;
#: ``drag`` and ``ground`` are workspace.
PROFILE = record(
    ("coefficient", "f8", (ORDER + 1,)),
    ("energy", "f8"),
    ("updated", "f8"),
    ("started", FLAG),
    ("drag", "f8", (SAMPLES,)),
    ("ground", "f8", (SAMPLES,)),
)


class PolynomialParams(Params):
    """Polynomial drag-energy profile."""

    update_every_s: float = param(
        5.0, "time between two updates of the profile by the range to go", gt=0.0, le=1000.0
    )


@kernel
def evaluate(coefficient, x):
    """Value, first and second derivative of a polynomial at ``x`` (Horner)."""
    value, first, second = 0.0, 0.0, 0.0
    for i in range(coefficient.shape[0] - 1, -1, -1):
        second = second * x + 2.0 * first
        first = first * x + value
        value = value * x + coefficient[i]
    return value, first, second


@kernel
def predicted_range(memory, span, eta, coast):
    """Range (m) along the sampled drag times 1 + ``eta`` f over an energy ``span`` (J/kg), and its derivative
    by eta (Simpson). ``coast``: range (m) times drag (m/s2) after range control, where range is inversely
    proportional to the drag at its end.
    """
    f = shape(1.0 - SHARE[0])
    total = coast / (memory.drag[0] * (1.0 + eta * f))
    slope = -total * f / (1.0 + eta * f)
    for i in range(SAMPLES):
        f = shape(1.0 - SHARE[i])
        piece = span * WEIGHT[i] * memory.ground[i] / (memory.drag[i] * (1.0 + eta * f))
        total += piece
        slope -= piece * f / (1.0 + eta * f)
    return total, slope


@kernel
def refit(reference, energy, wanted, limit, memory):
    """Fit the drag profile between ``energy`` (J/kg) and the end of range control of the reference, so that
    its range to the aim point is ``wanted`` (m) (eqs. 13-15); ``limit``: largest magnitude of eta, the
    parameter of the fit; 0 gives the reference profile.
    """
    terminal = 0.5 * reference.handover * reference.handover
    span = energy - terminal
    widest = 1.0 + 2.0 * limit
    for i in range(SAMPLES):
        e = terminal + span * SHARE[i]
        j, f = node_of(reference, sqrt(2.0 * e))
        nominal = reference.drag[j] + f * (reference.drag[j + 1] - reference.drag[j])
        memory.ground[i] = reference.ground[j] + f * (reference.ground[j + 1] - reference.ground[j])
        memory.drag[i] = nominal
        if memory.started != 0:
            now, _, _ = evaluate(memory.coefficient, (e - terminal) / (memory.energy - terminal))
            memory.drag[i] = clamp(now, nominal / widest, nominal * widest)
    j, f = node_of(reference, reference.handover)
    coast = reference.coast * (reference.drag[j] + f * (reference.drag[j + 1] - reference.drag[j]))
    eta = 0.0
    for _ in range(4):
        predicted, slope = predicted_range(memory, span, eta, coast)
        eta = clamp(eta - (predicted - wanted) / slope, -limit, limit)
    for i in range(SAMPLES):
        memory.drag[i] *= 1.0 + eta * shape(1.0 - SHARE[i])
    for j in range(ORDER + 1):
        memory.coefficient[j] = 0.0
        for i in range(SAMPLES):
            memory.coefficient[j] += FIT[j, i] * memory.drag[i]
    memory.energy, memory.started = energy, 1


@kernel
def polynomial_goal(onboard, nav, p, memory, drag, drag_rate, out):
    """Return the drag to follow and its first and second time derivative (m/s2, m/s3, m/s4) along the actual
    flight, with dE/dt = -V D; refit the profile in ``memory`` (``PROFILE``) first if an update is due.

    ``p``: ``PolynomialParams`` of the law; ``drag``, ``drag_rate``: measured values (m/s2, m/s3).
    """
    shared, reference = onboard.guidance.entry.tracking, onboard.reference
    terminal = 0.5 * reference.handover * reference.handover
    updating = shared.update and nav.speed > shared.update_stop
    updating = updating and out.range_to_go > LEAST_RANGE * reference.coast
    if memory.started == 0 or updating and nav.t >= memory.updated + p.update_every:
        # nothing is left to fit at the terminal energy
        limit = shared.scale_limit if updating else 0.0
        refit(reference, max(nav.energy, 1.01 * terminal), out.range_to_go, limit, memory)
        memory.updated = nav.t
    span = memory.energy - terminal
    goal, slope, curvature = evaluate(memory.coefficient, clamp((nav.energy - terminal) / span, 0.0, 1.0))
    speed_rate = -drag - nav.gravity * sin(nav.flight_path_angle)
    energy_rate = -nav.speed * drag
    energy_acceleration = -speed_rate * drag - nav.speed * drag_rate
    goal_rate = slope / span * energy_rate
    goal_acceleration = (
        curvature / (span * span) * energy_rate * energy_rate + slope / span * energy_acceleration
    )
    out.reference_drag = goal
    return goal, goal_rate, goal_acceleration
