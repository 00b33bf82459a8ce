"""Motion of the entry as the flight computer believes it: a point mass over the rotating ellipsoid in
Cartesian planet-fixed axes.

Believed air, airframe and gravity with J2, and the mean wind that is expected: drag is along the velocity
through that air, lift across it, at the bank angle about it.  Everything that predicts or plans the entry
integrates these equations.  Source: Vinh, Busemann & Culp 1980, "Hypersonic and Planetary Entry Flight
Mechanics", chapter 2, here without a singular heading and with wind; the mean lift of a roll: derived.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.fsw.guidance.entry.airframe import believed_aero
from edl6dof.fsw.navigation.derived import expected_wind, model_atmosphere
from edl6dof.fsw.navigation.strapdown import gravity_I
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import cos, sin, sincos
from edl6dof.spatial.frames import from_geodetic, ned_to_fixed
from edl6dof.spatial.vector import add, clamp, cross, norm, scale, sub, unit


@kernel
def height_above_ellipsoid(planet, r):
    """Height (m) along the radius; within 20 m of the geodetic height in the atmosphere of Mars."""
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
def velocity_in_air(atmosphere, r, v, height):
    """Velocity (m/s, F) through the air of the expected mean wind, at ``height`` (m)."""
    up = unit(r)
    across = max(sqrt(up[0] * up[0] + up[1] * up[1]), 1e-9)
    east = (-up[1] / across, up[0] / across, 0.0)
    to_north, to_east = expected_wind(atmosphere, height)
    return sub(v, add(scale(to_east, east), scale(to_north, cross(up, east))))


@kernel
def acceleration(onboard, ratios, r, v, lift_shares):
    """Planet-relative acceleration (m/s2, F), the drag in it (m/s2) and the planet-relative Mach number.

    Drag and lift-to-drag ratio are the believed ones times the two ``ratios``; of the lift the two
    ``lift_shares``, cosine and sine of a steady bank angle, point up and right.
    """
    planet, vehicle = onboard.planet, onboard.vehicle
    height = height_above_ellipsoid(planet, r)
    density, sound, _ = model_atmosphere(onboard.atmosphere, height)
    through = velocity_in_air(onboard.atmosphere, r, v, height)
    air_speed, mach = max(norm(through), 1e-3), norm(v) / sound
    area, lift_to_drag = believed_aero(vehicle, mach, norm(v))
    drag = ratios[0] * 0.5 * density * air_speed * air_speed * area / vehicle.entry_mass
    lift = ratios[1] * lift_to_drag * drag
    x = scale(1.0 / air_speed, through)
    right = unit(cross(x, r))
    a = sub(scale(lift * lift_shares[0], cross(right, x)), scale(drag, x))
    a = add(add(a, scale(lift * lift_shares[1], right)), gravity_I(planet, r))
    w = planet.rotation_rate
    return add(a, (w * (2.0 * v[1] + w * r[0]), w * (w * r[1] - 2.0 * v[0]), 0.0)), drag, mach


@kernel
def step(onboard, ratios, r, v, a, lift_shares, dt):
    """Position (m) and velocity (m/s) after ``dt`` (s) with the lift held, by the classical fourth-order
    Runge-Kutta step; ``a`` is the acceleration at its beginning.
    """
    half = 0.5 * dt
    v2 = add(v, scale(half, a))
    r2 = add(r, scale(half, v))
    a2, _, _ = acceleration(onboard, ratios, r2, v2, lift_shares)
    v3 = add(v, scale(half, a2))
    r3 = add(r, scale(half, v2))
    a3, _, _ = acceleration(onboard, ratios, r3, v3, lift_shares)
    v4 = add(v, scale(dt, a3))
    a4, _, _ = acceleration(onboard, ratios, add(r, scale(dt, v3)), v4, lift_shares)
    sixth = dt / 6.0
    return (
        add(r, scale(sixth, add(add(v, v4), scale(2.0, add(v2, v3))))),
        add(v, scale(sixth, add(add(a, a4), scale(2.0, add(a2, a3))))),
    )


@kernel
def roll(bank, goal, rate, dt):
    """Bank angle (rad) after ``dt`` (s) of rolling to ``goal`` through zero at no more than ``rate`` (rad/s),
    and the mean cosine and sine of it over that time: the lift that a step of the motion sees.
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
