"""Onboard prediction of the entry, from the navigated state to the parachute, with a bank plan.

Motion: a point mass over the rotating ellipsoid in Cartesian planet-fixed axes, with believed air, airframe
and gravity with J2, and the expected mean wind: drag is along the air-relative velocity, lift across it, at
the bank angle about it. The planning on the ground integrates the same equations. Source: Vinh, Busemann &
Culp 1980, "Hypersonic and Planetary Entry Flight Mechanics", chapter 2, here without a singular heading and
with wind; mean lift during a roll: derived.

Bank plan: one number sets its magnitude, two speeds set its reversals. Magnitude: the open-loop profile of
the reference with a shifted cosine, or linear in kinetic energy from one angle now to another at the end.
Side: the present one, changed at each of the two speeds. Sources: Lu 2014, "Entry guidance: a unified
method", section IV.A (linear in energy); Smith 2016, AAS 16-216 (reversals as part of the plan).

Prediction: the bank angle follows the plan from its present value at no more than the bank rate, reversals
included; below the speed of heading alignment it follows the heading error; last, the wings are level. Each
step has a fixed loss of speed, so it is a step of energy wherever drag is large. Source: Lu 2014, section II
(there with energy as independent variable).
"""

from __future__ import annotations

from math import sqrt

from edl6dof.fsw.guidance.entry.aim_point import heading_bank
from edl6dof.fsw.guidance.entry.air_data import drag_ratio_at
from edl6dof.fsw.guidance.entry.airframe import believed_aero
from edl6dof.fsw.guidance.entry.reference import reference_bank
from edl6dof.fsw.navigation.derived import expected_wind, model_atmosphere
from edl6dof.fsw.navigation.strapdown import gravity_I
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import asin, atan2, cos, sin, sincos
from edl6dof.spatial.frames import from_geodetic, ned_to_fixed
from edl6dof.spatial.vector import add, clamp, cross, dot, norm, scale, sub, unit


@kernel
def height_above_ellipsoid(planet, r):
    """Height (m) above the ellipsoid along the radius; within 20 m of the geodetic height in the atmosphere
    of Mars.
    """
    size = norm(r)
    squash = 1.0 - planet.flattening
    sine2 = r[2] * r[2] / (size * size)
    return size - planet.equatorial_radius / sqrt(1.0 + (1.0 / (squash * squash) - 1.0) * sine2)


@kernel
def fixed_state(planet, nav):
    """Position (m) and planet-relative velocity (m/s) of ``nav`` in planet-fixed axes F."""
    lat, lon = nav.latitude, nav.longitude
    r = from_geodetic(planet.equatorial_radius, planet.flattening, lat, lon, nav.altitude)
    return r, ned_to_fixed(sin(lat), cos(lat), sin(lon), cos(lon), (nav.v_N[0], nav.v_N[1], nav.v_N[2]))


@kernel
def velocity_in_air(atmosphere, r, v, height, shift):
    """Velocity (m/s, F) through the air of the expected mean wind at ``height`` (m), plus a ``shift`` of the
    wind towards north and east (m/s).
    """
    up = unit(r)
    across = max(sqrt(up[0] * up[0] + up[1] * up[1]), 1e-9)
    east = (-up[1] / across, up[0] / across, 0.0)
    to_north, to_east = expected_wind(atmosphere, height)
    return sub(v, add(scale(to_east + shift[1], east), scale(to_north + shift[0], cross(up, east))))


#: Corrections of the onboard model: none.
AS_BELIEVED = (1.0, 1.0, 0.0, 0.0)


@kernel
def acceleration(onboard, corrections, r, v, lift_shares):
    """Planet-relative acceleration (m/s2, F), the drag in it (m/s2) and the planet-relative Mach number.

    ``corrections``: factors on the believed drag and lift-to-drag ratio, and what is added to the expected
    wind towards north and east (m/s); ``lift_shares``: share of the lift up and to the right, cosine and sine
    of a steady bank angle.
    """
    planet, vehicle = onboard.planet, onboard.vehicle
    height = height_above_ellipsoid(planet, r)
    density, sound, _ = model_atmosphere(onboard.atmosphere, height)
    shift = corrections[2], corrections[3]
    through = velocity_in_air(onboard.atmosphere, r, v, height, shift)
    air_speed, mach = max(norm(through), 1e-3), norm(v) / sound
    area, lift_to_drag = believed_aero(vehicle, mach, norm(v))
    drag = corrections[0] * 0.5 * density * air_speed * air_speed * area / vehicle.entry_mass
    lift = corrections[1] * lift_to_drag * drag
    x = scale(1.0 / air_speed, through)
    right = unit(cross(x, r))
    a = sub(scale(lift * lift_shares[0], cross(right, x)), scale(drag, x))
    a = add(add(a, scale(lift * lift_shares[1], right)), gravity_I(planet, r))
    w = planet.rotation_rate
    return add(a, (w * (2.0 * v[1] + w * r[0]), w * (w * r[1] - 2.0 * v[0]), 0.0)), drag, mach


@kernel
def step(onboard, corrections, r, v, a, lift_shares, dt):
    """Position (m) and velocity (m/s) after ``dt`` (s) at constant lift, by one classical fourth-order
    Runge-Kutta step; ``a``: acceleration at its beginning (m/s2).
    """
    half = 0.5 * dt
    v2 = add(v, scale(half, a))
    r2 = add(r, scale(half, v))
    a2, _, _ = acceleration(onboard, corrections, r2, v2, lift_shares)
    v3 = add(v, scale(half, a2))
    r3 = add(r, scale(half, v2))
    a3, _, _ = acceleration(onboard, corrections, r3, v3, lift_shares)
    v4 = add(v, scale(dt, a3))
    a4, _, _ = acceleration(onboard, corrections, add(r, scale(dt, v3)), v4, lift_shares)
    sixth = dt / 6.0
    return (
        add(r, scale(sixth, add(add(v, v4), scale(2.0, add(v2, v3))))),
        add(v, scale(sixth, add(add(a, a4), scale(2.0, add(a2, a3))))),
    )


@kernel
def roll(bank, goal, rate, dt):
    """Bank angle (rad) after ``dt`` (s) of rolling through zero to ``goal`` at no more than ``rate`` (rad/s),
    and its mean cosine and sine over that time, which give the mean lift.
    """
    most = rate * dt
    after = clamp(goal, bank - most, bank + most)
    turned = after - bank
    if abs(turned) < 1e-6:
        s, c = sincos(after)
        return after, c, s
    share = abs(turned) / most
    up = (sin(after) - sin(bank)) / turned
    right = (cos(bank) - cos(after)) / turned
    return after, share * up + (1.0 - share) * cos(after), share * right + (1.0 - share) * sin(after)


#: Kinds of bank plan.
SHIFTED, LINEAR, IN_PLANE, HELD = range(4)


@kernel
def shifted(shift, side, first_turn, second_turn):
    """Plan: reference profile with its cosine shifted; ``side`` +1 right, -1 left; reversal speeds (m/s), 0:
    none.
    """
    return SHIFTED, shift, 0.0, 0.0, side, first_turn, second_turn


@kernel
def in_plane_shifted(shift, first_turn, second_turn):
    """Plan as :func:`shifted` without sideways lift, which reversals cancel; a reversal only adds the roll
    through lift up.
    """
    return IN_PLANE, shift, 0.0, 0.0, 1.0, first_turn, second_turn


@kernel
def linear(bank, last_bank, speed, side, first_turn, second_turn):
    """Plan linear in kinetic energy, from ``bank`` (rad) at ``speed`` (m/s) to ``last_bank`` at the final
    speed.
    """
    return LINEAR, bank, last_bank, speed, side, first_turn, second_turn


@kernel
def held(bank):
    """Plan of one constant bank angle (rad), its sign included, which may be below the smallest bank
    magnitude.
    """
    return HELD, abs(bank), 0.0, 0.0, -1.0 if bank < 0.0 else 1.0, 0.0, 0.0


@kernel
def planned_bank(onboard, plan, speed):
    """Bank angle (rad) of a plan at ``speed`` (m/s), within limits; for an in-plane plan positive on the
    present side.
    """
    entry = onboard.guidance.entry
    kind, first, last, start, side, first_turn, second_turn = plan
    if kind == HELD:
        return side * min(first, entry.bank_max)
    if kind == LINEAR:
        end2 = entry.final_speed * entry.final_speed
        share = clamp((speed * speed - end2) / max(start * start - end2, 1.0), 0.0, 1.0)
        magnitude = last + share * (first - last)
    else:
        magnitude = reference_bank(onboard, first, speed)
    if speed <= first_turn:
        side = -side
    if speed <= second_turn:
        side = -side
    return (-1.0 if side < 0.0 else 1.0) * clamp(magnitude, entry.bank_min, entry.bank_max)


@kernel
def in_plane(plan):
    """Return whether a plan leaves out the sideways lift."""
    return plan[0] == IN_PLANE


@kernel
def next_corner(onboard, plan, speed):
    """Highest speed (m/s) below ``speed`` at which the planned bank angle jumps; a step of the prediction
    ends there.
    """
    entry = onboard.guidance.entry
    corner = 0.0
    for other in (plan[5], plan[6], max(entry.align_speed, entry.heading.speed)):
        if corner < other < speed - 1e-3:
            corner = other
    return corner


SPEED_STEP = 40.0  # m/s lost in one step
LONGEST_STEP, SHORTEST_STEP = 4.0, 0.05  # s
MAX_STEPS = 400
OFF_COURSE = 0.87  # cosine of the angle between course and aim point up to which this is ahead
LOWEST = -5000.0  # m: below it a prediction has failed to slow down


@kernel
def predict(onboard, nav, out, plan):
    """Predict the flight from ``nav`` to the parachute with a bank plan.

    Drag and lift-to-drag ratio are those of the onboard model times the measured ratios in ``out``. The drag
    ratio follows its trend with height; ``out`` also holds the shift of the wind from the expected one.

    Returns:
        downrange miss (m, positive beyond the aim point), crossrange miss (m, positive right of it), altitude
        (m) and time (s) at the end.  The misses are relative to the great circle to the aim point, or to the
        course if the aim point lies far off the course.  With heading alignment, a plan that is not in plane
        returns the crossrange at the start of the alignment.
    """
    planet, entry = onboard.planet, onboard.guidance.entry
    r, v = fixed_state(planet, nav)
    here, target = unit(r), aim_direction(onboard)
    ahead, offset = direction_ahead(here, target, v)
    steered_above = max(entry.align_speed, entry.heading.speed)
    bank = present_bank(nav, out) if in_plane(plan) else nav.bank
    height_here = height_above_ellipsoid(planet, r)
    t, dt = 0.0, 0.0
    r_old, speed, excess, excess_old = r, norm(v), 0.0, 0.0
    lift_up, lift_right = 1.0, 0.0
    aligning, at_handover = False, 0.0
    for _ in range(MAX_STEPS):
        height = height_above_ellipsoid(planet, r)
        of_drag = drag_ratio_at(entry.air_data, out.drag_ratio, out.drag_trend, height - height_here)
        corrections = of_drag, out.lift_ratio, out.wind_shift_N[0], out.wind_shift_N[1]
        a, drag, mach = acceleration(onboard, corrections, r, v, (lift_up, lift_right))
        end_speed = (
            entry.final_mach * speed / max(mach, 1e-3) if entry.final_mach > 0.0 else entry.final_speed
        )
        excess = speed - end_speed
        if excess <= 0.0 or height < LOWEST:
            break
        dt = clamp(SPEED_STEP / max(drag, 1e-3), SHORTEST_STEP, LONGEST_STEP)
        slowing = -dot(a, v) / speed
        corner = next_corner(onboard, plan, speed)
        if slowing * dt > speed - corner:
            dt = max((speed - corner) / slowing, SHORTEST_STEP)
        goal = 0.0
        if speed > steered_above + 1e-3:
            goal = planned_bank(onboard, plan, speed - 1e-3)
        elif speed > entry.align_speed + 1e-3 and not in_plane(plan):
            range_to_go, crossrange = to_aim(planet, target, r, v)
            goal = heading_bank(entry.heading, range_to_go, crossrange)
            if not aligning:
                aligning, at_handover = True, crossrange
        bank, lift_up, lift_right = roll(bank, goal, entry.bank_rate, dt)
        if in_plane(plan):
            lift_right = 0.0
        a, _, _ = acceleration(onboard, corrections, r, v, (lift_up, lift_right))
        r_old, excess_old = r, excess
        r, v = step(onboard, corrections, r, v, a, lift_shares=(lift_up, lift_right), dt=dt)
        speed = norm(v)
        t += dt
    if excess < 0.0 < excess_old:
        back = excess / (excess - excess_old)
        r = add(scale(1.0 - back, r), scale(back, r_old))
        t -= back * dt
    there = unit(r)
    beyond = atan2(dot(there, ahead), dot(there, here)) - atan2(dot(target, ahead), dot(target, here))
    aside = planet.equatorial_radius * (asin(clamp(dot(there, cross(ahead, here)), -1.0, 1.0)) - offset)
    return (
        beyond * planet.equatorial_radius,
        at_handover if aligning else aside,
        height_above_ellipsoid(planet, r),
        t,
    )


@kernel
def direction_ahead(here, target, v):
    """Return the horizontal unit direction at ``here`` along which downrange is measured, and the angle (rad)
    by which the aim point in direction ``target`` lies right of it.

    The direction is that of the aim point; if the aim point is far off the course, abeam or behind, it is the
    course.
    """
    ahead = unit(sub(target, scale(dot(target, here), here)))
    along = unit(sub(v, scale(dot(v, here), here)))
    if dot(ahead, along) > OFF_COURSE:
        return ahead, 0.0
    return along, asin(clamp(dot(target, cross(along, here)), -1.0, 1.0))


@kernel
def present_bank(nav, out):
    """Bank angle (rad), positive on the commanded side; negative while a reversal has not reached lift up."""
    return abs(nav.bank) if out.side == 0.0 else out.side * nav.bank


@kernel
def to_aim(planet, target, r, v):
    """Great-circle range to ``target`` (unit vector) and crossrange (m), defined as in
    :func:`.aim_point.to_target`.
    """
    up = unit(r)
    left = unit(cross(up, v))
    radius = planet.equatorial_radius
    return radius * atan2(norm(cross(up, target)), dot(up, target)), radius * asin(
        clamp(dot(target, left), -1.0, 1.0)
    )


@kernel
def aim_direction(onboard):
    """Unit vector (F) to the aim point by its geodetic latitude, as in :func:`.aim_point.to_target`."""
    planet, site = onboard.planet, onboard.site
    return unit(
        from_geodetic(planet.equatorial_radius, planet.flattening, site.aim_latitude, site.aim_longitude, 0.0)
    )
