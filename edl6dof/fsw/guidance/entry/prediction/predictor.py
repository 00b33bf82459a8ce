"""Onboard prediction of the entry: a point mass over the rotating ellipsoid with the believed air and
airframe.

Flown in Cartesian planet-fixed axes from the navigated state to the parachute, with the bank profile of the
reference shifted by one number, and with level wings where the shared steering aligns the heading or levels
them.  Steps are taken for a fixed loss of speed, so they are steps of energy wherever drag counts.  Source:
equations of motion of Lu 2014, "Entry guidance: a unified method", section II (there in spherical
coordinates, with energy as independent variable); left out: J2, wind, the time a bank reversal takes.
"""

from __future__ import annotations

from math import asin, atan2, cos, sin, sqrt

from edl6dof.fsw.guidance.entry.prediction.airframe import believed_aero
from edl6dof.fsw.guidance.entry.prediction.reference import reference_bank
from edl6dof.fsw.navigation.derived import model_atmosphere
from edl6dof.jit import kernel
from edl6dof.spatial.frames import from_geodetic, ned_to_fixed
from edl6dof.spatial.vector import add, clamp, cross, dot, norm, scale, sub, unit

SPEED_STEP = 40.0  # m/s lost in one step
LONGEST_STEP, SHORTEST_STEP = 4.0, 0.05  # s
MAX_STEPS = 400


@kernel
def height_above_ellipsoid(planet, r):
    """Height (m) along the radius; within 20 m of the geodetic height in the atmosphere of Mars."""
    size = norm(r)
    squash = 1.0 - planet.flattening
    sine2 = r[2] * r[2] / (size * size)
    return size - planet.equatorial_radius / sqrt(1.0 + (1.0 / (squash * squash) - 1.0) * sine2)


@kernel
def accelerations(onboard, r, v, out, cos_bank, sin_bank):
    """Planet-relative acceleration (m/s2, F), the drag in it (m/s2) and the Mach number, at position and
    velocity in F.
    """
    planet, vehicle = onboard.planet, onboard.vehicle
    size, speed = norm(r), max(norm(v), 1e-3)
    density, sound, _ = model_atmosphere(onboard.atmosphere, height_above_ellipsoid(planet, r))
    mach = speed / sound
    area, lift_to_drag = believed_aero(vehicle, mach)
    drag = out.drag_ratio * 0.5 * density * speed * speed * area / vehicle.entry_mass
    lift = out.lift_ratio * lift_to_drag * drag
    x = scale(1.0 / speed, v)
    right = unit(cross(x, r))
    lifted = add(scale(cos_bank, cross(right, x)), scale(sin_bank, right))
    a = add(scale(-drag, x), scale(lift, lifted))
    a = sub(a, scale(planet.mu / (size * size * size), r))
    w = planet.rotation_rate
    a = add(a, (2.0 * w * v[1] + w * w * r[0], -2.0 * w * v[0] + w * w * r[1], 0.0))
    return a, drag, mach


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
    lat, lon = nav.latitude, nav.longitude
    r = from_geodetic(planet.equatorial_radius, planet.flattening, lat, lon, nav.altitude)
    v = ned_to_fixed(sin(lat), cos(lat), sin(lon), cos(lon), (nav.v_N[0], nav.v_N[1], nav.v_N[2]))
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
        a1, drag, mach = accelerations(onboard, r, v, out, cos_bank, sin_bank)
        end_speed = (
            entry.final_mach * speed / max(mach, 1e-3) if entry.final_mach > 0.0 else entry.final_speed
        )
        excess = speed - end_speed
        if excess <= 0.0 or height_above_ellipsoid(planet, r) < -5000.0:
            break
        dt = clamp(SPEED_STEP / max(drag, 1e-3), SHORTEST_STEP, LONGEST_STEP)
        v2 = add(v, scale(0.5 * dt, a1))
        a2, _, _ = accelerations(onboard, add(r, scale(0.5 * dt, v)), v2, out, cos_bank, sin_bank)
        v3 = add(v, scale(0.5 * dt, a2))
        a3, _, _ = accelerations(onboard, add(r, scale(0.5 * dt, v2)), v3, out, cos_bank, sin_bank)
        v4 = add(v, scale(dt, a3))
        a4, _, _ = accelerations(onboard, add(r, scale(dt, v3)), v4, out, cos_bank, sin_bank)
        r_old, excess_old = r, excess
        r = add(r, scale(dt / 6.0, add(add(v, v4), scale(2.0, add(v2, v3)))))
        v = add(v, scale(dt / 6.0, add(add(a1, a4), scale(2.0, add(a2, a3)))))
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
