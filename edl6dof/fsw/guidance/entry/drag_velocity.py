"""The entry flight corridor in the plane of drag and velocity, and a drag-velocity profile inside it.

The upper bounds of drag are the stagnation heat rate (Sutton-Graves), the load factor and the dynamic
pressure; the lower bound is equilibrium glide: at less drag the full lift, pointed up, is less than weight
minus centrifugal force, and the path bends down. The lower bound vanishes above circular speed, and at the
end of its entry a capsule falls below it.

The profile has three segments c0 + c1 V + c2 V^2: quadratic, equilibrium glide (linear), constant drag. The
slope is continuous where the quadratic joins the glide. It is fitted by least squares along the reference
flight, under the ceiling of the corridor, and scaled to the range of that flight. Guidance multiplies the
profile by one factor to match the range to go: range along a drag profile is inversely proportional to drag.
Source: Lu & Bayard, sections 1 and 2.2, Fig. 1; Harpold & Graves 1979; McEneaney & Mease 1991.

Differences from the print: the profile ends with range control, and the planned range from there is added; R
= -int V cos(gamma) / (f + g sin(gamma)) dV keeps the flight-path angle, which the paper neglects at first and
later avoids by an energy variable; here the angle follows from the profile: with D = f(V), the rate of D = k
rho V^2 fixes the rate of climb.
"""

from __future__ import annotations

from math import inf, sqrt

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.reference import last_controlled
from edl6dof.fsw.navigation.derived import model_atmosphere
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.spatial.arrays import product, pseudo_inverse
from edl6dof.spatial.table_index import between, held_cell
from edl6dof.spatial.vector import clamp


class EntryLimitParams(Params):
    """Limits of the vehicle during entry for guidance; a profile keeps the margin from each upper bound."""

    heat_rate_w_cm2: float = param(200.0, "stagnation-point heat rate", status="estimate", gt=0.0)
    nose_radius_m: float = param(
        0.85, "nose radius of that heat rate", status="estimate", source="D/4, Viking family", gt=0.0
    )
    load_g0: float = param(20.0, "aerodynamic load", status="estimate", gt=0.0)
    dynamic_pressure_pa: float = param(25000.0, "dynamic pressure", status="estimate", gt=0.0)
    margin: float = param(0.1, "margin of a profile from each upper bound, over the bound", ge=0.0, lt=1.0)


@kernel
def corridor(onboard, speed):
    """Drag (m/s2) at ``speed`` (m/s) on the bounds of heat rate, load, dynamic pressure and equilibrium
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


RANGE_NODES = 129
#: Speeds tried for the two joints, over the initial and over the final speed.
_JOIN, _LEVEL = np.linspace(0.35, 0.85, 26), np.linspace(1.0, 2.4, 15)
_ROWS = 300
#: Weight of the share by which a profile exceeds the ceiling, against the misfit to the flight.
_STIFF = 100.0

DRAG_VELOCITY = record(
    ("start", "f8"),  # speed where the profile begins, m/s
    ("join", "f8"),  # m/s: speed at the joint of quadratic and glide
    ("level", "f8"),  # m/s: speed at the joint of glide and constant drag
    ("final", "f8"),  # m/s: speed where the profile ends
    ("coefficient", "f8", (3, 3)),  # c0, c1, c2 of each segment, from fast to slow
    ("coast", "f8"),  # m2/s2: planned range from the end of the profile to the aim point, times drag
    # m: ground range to the aim point from evenly spaced speeds, final to start
    ("range", "f8", (RANGE_NODES,)),
)


@kernel
def profile_drag(profile, speed):
    """Drag of the profile (m/s2) and its two derivatives by speed; constant beyond its first and last
    speed.
    """
    v = clamp(speed, profile.final, profile.start)
    segment = 0 if v > profile.join else (1 if v > profile.level else 2)
    c0, c1, c2 = (
        profile.coefficient[segment, 0],
        profile.coefficient[segment, 1],
        profile.coefficient[segment, 2],
    )
    return c0 + v * (c1 + v * c2), c1 + 2.0 * c2 * v, 2.0 * c2


@kernel
def profile_range(profile, speed):
    """Ground range (m) from ``speed`` to the aim point, linear between its nodes."""
    cells = RANGE_NODES - 1
    i, f = held_cell((speed - profile.final) / (profile.start - profile.final) * cells, cells)
    return between(profile.range, i, f)


@kernel
def path_sine(speed, drag, slope, gravity, scale_height):
    """Sine of the flight-path angle along a profile f with the value ``drag`` (m/s2) and the derivative
    ``slope`` by speed (1/s): from f' V' = f (-V sin(gamma)/H + 2 V'/V) with V' = -f - g sin(gamma).
    """
    stiff = slope - 2.0 * drag / speed
    return clamp(stiff / (speed * drag / (gravity * scale_height) - stiff) * drag / gravity, -0.99, 0.99)


@kernel
def altitude_of(onboard, speed, drag):
    """Altitude (m) at which the believed density gives ``drag`` at ``speed``, by bisection."""
    vehicle = onboard.vehicle
    wanted = 2.0 * drag * vehicle.entry_mass / (vehicle.drag_area * speed * speed)
    low, high = onboard.atmosphere.bottom, onboard.atmosphere.top
    for _ in range(40):
        middle = 0.5 * (low + high)
        density, _, _ = model_atmosphere(onboard.atmosphere, middle)
        if density > wanted:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


@kernel
def integrate_range(onboard, profile):
    """Fill ``profile.range`` by the trapezoidal rule, four steps a node, from the final speed upwards."""
    planet = onboard.planet
    step = (profile.start - profile.final) / (4.0 * (RANGE_NODES - 1))
    end, _, _ = profile_drag(profile, profile.final)
    total, before = profile.coast / end, 0.0
    for i in range(4 * (RANGE_NODES - 1) + 1):
        speed = profile.final + i * step
        drag, slope, _ = profile_drag(profile, speed)
        altitude = altitude_of(onboard, speed, drag)
        _, _, scale_height = model_atmosphere(onboard.atmosphere, altitude)
        radius = planet.equatorial_radius + altitude
        gravity = planet.mu / (radius * radius)
        sine = path_sine(speed, drag, slope, gravity, scale_height)
        rate = speed * sqrt(1.0 - sine * sine) / (drag + gravity * sine) * planet.equatorial_radius / radius
        if i > 0:
            total += 0.5 * step * (before + rate)
        before = rate
        if i % 4 == 0:
            profile.range[i // 4] = total


def fill_drag_velocity(onboard: np.ndarray, planned: np.ndarray, start_drag: float, profile: np.void) -> None:
    """Fit the profile to the planned reference flight.

    Args:
        onboard: onboard record array of length one, its reference planned.
        planned: rows of the planned entry, ``PLANNED``.
        start_drag: drag of the planned entry where the profile begins, m/s2.
        profile: ``DRAG_VELOCITY`` record to fill.
    """
    last = last_controlled(planned, onboard[0]["guidance"]["entry"])
    follow = planned[np.argmax(planned["drag"] >= start_drag) : last + 1]
    speed, drag = follow["speed"], follow["drag"]
    wanted = float(planned["beyond"][-1] - follow["beyond"][0])
    profile["coast"] = (planned["beyond"][-1] - follow["beyond"][-1]) * drag[-1]
    rows = np.unique(np.linspace(0, len(speed) - 1, _ROWS).astype(int))
    v, d = speed[rows], drag[rows]
    highest = np.array([ceiling(onboard[0], x) for x in v])
    profile["start"], profile["final"], scale = v[0], v[-1], 1.0
    for _ in range(4):
        profile["join"], profile["level"], profile["coefficient"] = _segments(v, d, highest / scale)
        profile["coefficient"] *= scale
        integrate_range(onboard[0], profile)
        scale *= profile["range"][-1] / wanted
    for _ in range(3):
        profile["coefficient"] *= profile["range"][-1] / wanted
        integrate_range(onboard[0], profile)


def _segments(v: np.ndarray, d: np.ndarray, highest: np.ndarray) -> tuple[float, float, np.ndarray]:
    """Joints and coefficients, shape (3, 3), of the best fit to the drag ``d`` at the speeds ``v`` that does
    not exceed ``highest``. For given joints the profile is linear in drag, slope and curvature at the first
    joint. A relative misfit is weighed by the range error that it causes.
    """
    weight, target = np.sqrt(np.abs(np.gradient(v)) * v) / d, np.minimum(d, highest)
    best, found = np.inf, (0.0, 0.0, np.zeros(3))
    for join in _JOIN * v[0]:
        bend = np.square(np.maximum(v - join, 0.0))
        for level in _LEVEL * v[-1]:
            columns = np.column_stack([np.ones_like(v), np.maximum(v, level) - join, bend])
            fit = product(pseudo_inverse(columns * weight[:, None]), target * weight)
            fitted = product(columns, fit)
            excess = max(np.max(fitted / highest) - 1.0, 0.0)
            error = np.sum(np.square(weight * (fitted - d))) + _STIFF * excess * excess * np.sum(
                np.square(weight * d)
            )
            if level < join and error < best and fitted.min() > 0.3 * d.min():
                best, found = error, (join, level, fit)
    join, level, (at_join, slope, curvature) = found
    quadratic = [at_join - slope * join + curvature * join * join, slope - 2.0 * curvature * join, curvature]
    return (
        join,
        level,
        np.array(
            [quadratic, [at_join - slope * join, slope, 0.0], [at_join + slope * (level - join), 0.0, 0.0]]
        ),
    )
