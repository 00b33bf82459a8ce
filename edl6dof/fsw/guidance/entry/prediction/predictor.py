"""Onboard prediction of the entry, from the navigated state to the parachute.

Flown with the bank profile of the reference shifted by one number, and with level wings where the shared
steering aligns the heading or levels them.  Steps are taken for a fixed loss of speed, so they are steps of
energy wherever drag counts.  Source: Lu 2014, "Entry guidance: a unified method", section II (there with
energy as independent variable); the equations: :mod:`~edl6dof.fsw.guidance.entry.prediction.motion`; left
out: the time a bank reversal takes.
"""

from __future__ import annotations

from math import asin, atan2, cos, sqrt

from edl6dof.fsw.guidance.entry.prediction.motion import (
    acceleration,
    fixed_state,
    height_above_ellipsoid,
    step,
)
from edl6dof.fsw.guidance.entry.prediction.reference import reference_bank
from edl6dof.jit import kernel
from edl6dof.spatial.frames import from_geodetic
from edl6dof.spatial.vector import add, clamp, cross, dot, norm, scale, sub, unit

SPEED_STEP = 40.0  # m/s lost in one step
LONGEST_STEP, SHORTEST_STEP = 4.0, 0.05  # s
MAX_STEPS = 400


@kernel
def predict(onboard, nav, out, shift, lateral):
    """Fly on from ``nav`` to the parachute with the reference bank profile, its cosine shifted by ``shift``.

    ``lateral`` scales the sideways part of the lift: 0 for a flight in the plane, whose reversals cancel, +1
    or -1 to bank right or left all the way.  Drag and lift-to-drag ratio are the believed ones times the
    ratios measured so far, from ``out``.

    Returns:
        downrange miss (m, positive beyond the aim point), crossrange miss (m, positive right of it), both
        relative to the great circle from here to the aim point; altitude (m) and time (s) at the end.
    """
    planet, entry = onboard.planet, onboard.guidance.entry
    r, v = fixed_state(planet, nav)
    here, target = unit(r), aim_direction(onboard)
    ahead = unit(sub(target, scale(dot(target, here), here)))
    least, most = cos(entry.bank_max), cos(entry.bank_min)
    steered_above = max(entry.align_speed, entry.heading.speed)
    t, dt = 0.0, 0.0
    r_old, speed, excess, excess_old = r, norm(v), 0.0, 0.0
    for _ in range(MAX_STEPS):
        cos_bank, sin_bank = 1.0, 0.0
        if speed >= steered_above:
            cos_bank = clamp(cos(reference_bank(onboard, shift, speed)), least, most)
            sin_bank = lateral * sqrt(1.0 - cos_bank * cos_bank)
        a, drag, mach = acceleration(onboard, out.drag_ratio, out.lift_ratio, r, v, cos_bank, sin_bank)
        end_speed = (
            entry.final_mach * speed / max(mach, 1e-3) if entry.final_mach > 0.0 else entry.final_speed
        )
        excess = speed - end_speed
        if excess <= 0.0 or height_above_ellipsoid(planet, r) < -5000.0:
            break
        dt = clamp(SPEED_STEP / max(drag, 1e-3), SHORTEST_STEP, LONGEST_STEP)
        r_old, excess_old = r, excess
        r, v = step(onboard, out.drag_ratio, out.lift_ratio, r, v, a, cos_bank, sin_bank, dt)
        speed = norm(v)
        t += dt
    if excess < 0.0 < excess_old:
        back = excess / (excess - excess_old)
        r = add(scale(1.0 - back, r), scale(back, r_old))
        t -= back * dt
    there = unit(r)
    beyond = atan2(dot(there, ahead), dot(there, here)) - atan2(dot(target, ahead), dot(target, here))
    aside = asin(clamp(dot(there, cross(ahead, here)), -1.0, 1.0))
    return (
        beyond * planet.equatorial_radius,
        aside * planet.equatorial_radius,
        height_above_ellipsoid(planet, r),
        t,
    )


@kernel
def aim_direction(onboard):
    """Unit vector (F) to the aim point, by its geodetic latitude as ``to_target`` measures range."""
    planet, site = onboard.planet, onboard.site
    return unit(
        from_geodetic(planet.equatorial_radius, planet.flattening, site.aim_latitude, site.aim_longitude, 0.0)
    )
