"""The entry flight corridor in the plane of drag and velocity: what the vehicle stands, and what keeps it up.

From above drag is bounded by the stagnation heat rate (Sutton-Graves), the load factor and the dynamic
pressure; from below by
equilibrium glide: with less drag all the lift, pointed up, does not carry the weight left by the centrifugal
force, and the path bends down.  The lower bound vanishes above circular speed, and a capsule ends its entry
below it: it falls.
Source: Lu & Bayard, section 1, which names the bounds; Harpold & Graves 1979 for their form.
"""

from __future__ import annotations

from math import inf, sqrt

from edl6dof.config.base import Params, param
from edl6dof.kernels import kernel


class EntryLimitParams(Params):
    """Limits of the vehicle during entry, as guidance knows them; every bound is met with the margin."""

    heat_rate_w_cm2: float = param(200.0, "stagnation-point heat rate", status="estimate", gt=0.0)
    nose_radius_m: float = param(
        0.85,
        "nose radius that the heat rate belongs to",
        status="estimate",
        source="D/4, Viking family",
        gt=0.0,
    )
    load_g0: float = param(20.0, "aerodynamic load", status="estimate", gt=0.0)
    dynamic_pressure_pa: float = param(25000.0, "dynamic pressure", status="estimate", gt=0.0)
    margin: float = param(0.1, "share of each upper bound that a drag profile leaves free", ge=0.0, lt=1.0)


@kernel
def corridor(onboard, speed):
    """Drag (m/s2) at ``speed`` (m/s) on the bounds of heat rate, load, dynamic pressure, and equilibrium
    glide.
    """
    limits, vehicle, planet = onboard.guidance.entry.limits, onboard.vehicle, onboard.planet
    area = vehicle.drag_area / vehicle.entry_mass
    density = limits.nose_radius * (limits.heat_rate / (planet.sutton_graves_constant * speed**3)) ** 2
    heat = 0.5 * density * speed * speed * area
    load = limits.load / sqrt(1.0 + vehicle.lift_to_drag**2)
    weight = planet.mu / planet.equatorial_radius**2 - speed * speed / planet.equatorial_radius
    glide = inf
    if vehicle.lift_to_drag > 0.0 or weight <= 0.0:
        glide = max(weight, 0.0) / max(vehicle.lift_to_drag, 1e-9)
    return heat, load, limits.dynamic_pressure * area, glide


@kernel
def ceiling(onboard, speed):
    """Largest drag (m/s2) that a profile may ask for at ``speed``: the lowest upper bound less the margin."""
    heat, load, pressure, _ = corridor(onboard, max(speed, 1.0))
    return (1.0 - onboard.guidance.entry.limits.margin) * min(heat, load, pressure)
