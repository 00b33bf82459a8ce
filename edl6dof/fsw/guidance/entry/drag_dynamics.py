"""Drag acceleration and its first and second derivative along the flight, which every drag-tracking law
inverts.

Derived here from D = k rho V^2 with an exponential density and the equations of motion over a non-rotating
sphere, and checked in the tests against finite differences of independently integrated and of flown
trajectories.  Same quantity: Zheng & Cui 2015, eqs. 13-14; Wu, Cui & Cui 2013, eq. 12; Yan, Sun & Guo 2016,
eqs. 13-14.

Differences from the prints, each shown in the tests: Zheng & Cui have a D-dot in eq. 14 where D belongs (-D V
sin(gamma)/h_s), and in eq. 13 +2 D'(D + g sin(gamma))/V^2 where -2 D'(D + g sin(gamma))/V belongs; Yan, Sun &
Guo leave out of eq. 14 the loss of g with height, 4 D g sin^2(gamma)/r.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.fsw.guidance.entry.airframe import area_rate, believed_aero
from edl6dof.fsw.navigation.derived import expected_wind, model_atmosphere
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import acos, asin, sincos
from edl6dof.spatial.vector import clamp


@kernel
def drag_dynamics(drag, speed, gamma, radius, gravity, lift, scale_height, area_rate=0.0):
    """Drag rate and the two parts of its derivative: D'' = b + a cos(bank). Returns (D' in m/s3, a and b in
    m/s4).

    D' = D (-V sin(gamma)/h_s + 2 V'/V + A'/A) with V' = -D - g sin(gamma); the rest follows by
    differentiation with gamma' = L cos(bank)/V + (V/r - g/V) cos(gamma), g' = -2 g V sin(gamma)/r, constant
    h_s and constant ``area_rate``, the relative rate A'/A of the drag area (1/s), which the papers leave out.
    """
    s, c = sincos(gamma)
    v_rate = -drag - gravity * s
    relative = -speed * s / scale_height + 2.0 * v_rate / speed + area_rate
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
def measured_drag_dynamics(onboard, nav, lift):
    """Result of :func:`drag_dynamics` at the navigated state and measured drag, with the believed drag area;
    ``lift`` in m/s2.
    """
    _, _, scale_height = model_atmosphere(onboard.atmosphere, nav.altitude)
    return drag_dynamics(
        nav.drag,
        nav.speed,
        gamma=nav.flight_path_angle,
        radius=nav.radius,
        gravity=nav.gravity,
        lift=lift,
        scale_height=scale_height,
        area_rate=area_rate(onboard.vehicle, nav.mach, nav.speed, -nav.drag),
    )


#: Least lift-to-drag ratio of the inversion, which keeps it finite where the trim wing has removed the lift.
LEAST_LIFT = 0.01
#: Half the height (m) over which changes of scale height and wind are measured.
REACH = 2000.0


@kernel
def believed_lift(vehicle, nav):
    """Lift-to-drag ratio that the flight computer expects at the present Mach number, at least
    ``LEAST_LIFT``.
    """
    _, lift_to_drag = believed_aero(vehicle, nav.mach, nav.speed)
    return max(lift_to_drag, LEAST_LIFT)


@kernel
def drag_dynamics_in_air(onboard, nav):
    """Result of :func:`drag_dynamics` at the navigated state and measured drag, with the believed drag area
    and lift, in the expected wind, and with a scale height that changes with altitude.

    The speed is that through the air, which gains -w' where the wind w changes with height h; D'' gains D
    (h'/h_s)^2 dh_s/dh.
    """
    air, h = onboard.atmosphere, nav.altitude
    _, _, scale_height = model_atmosphere(air, h)
    _, _, below = model_atmosphere(air, h - REACH)
    _, _, above = model_atmosphere(air, h + REACH)
    wind, wind_below, wind_above = (
        expected_wind(air, h),
        expected_wind(air, h - REACH),
        expected_wind(air, h + REACH),
    )
    north, east, climb = nav.v_N[0] - wind[0], nav.v_N[1] - wind[1], -nav.v_N[2]
    speed = sqrt(north * north + east * east + climb * climb)
    rate, a, b = drag_dynamics(
        nav.drag,
        speed,
        gamma=asin(climb / speed),
        radius=nav.radius,
        gravity=nav.gravity,
        lift=nav.drag * believed_lift(onboard.vehicle, nav),
        scale_height=scale_height,
        area_rate=area_rate(onboard.vehicle, nav.mach, nav.speed, -nav.drag),
    )
    growth = north * (wind_above[0] - wind_below[0]) + east * (wind_above[1] - wind_below[1])
    slower = growth / (2.0 * REACH * speed) * climb
    bend = nav.drag * (climb / scale_height) ** 2 * (above - below) / (2.0 * REACH)
    return rate - 2.0 * nav.drag * slower / speed, a, b + bend


@kernel
def bank_for(wanted, free, authority):
    """Bank angle (rad, 0..pi) with D'' = free + authority cos(bank) nearest to ``wanted``; authority <= 0."""
    return acos(clamp((wanted - free) / min(authority, -1e-12), -1.0, 1.0))


@kernel
def uncertain_drag(drag, rate, speed, gravity, radius, scale_height):
    """Return the drag dynamics in drag, drag rate and speed alone, with five unknown parameters theta: (g0,
    g1 without u, g2).

    D'' + g0(D, D', V) + g1(D, D', V, u) theta = w + g2(D, V) u with u = (L/D) cos(bank) and theta = (C, C', 1
    - (R/r) cos^2(gamma), 1 - cos(gamma), sin^2(gamma)), C = (dC_D/dt)/C_D, R a reference radius with g =
    mu/R^2. The fourth component of g1 is ``g2 u`` and is returned as zero; ``gravity`` and ``radius`` are
    those of the reference sphere. Derived here from D = k rho V^2 C_D and eqs. 2-4; checked in the tests
    against finite differences of integrated entries. Source: Lu & Bayard, sections 2.1 and 2.3, eqs. 8-13.

    Differences from the print: g = mu/R^2 where section 2.3 has mu/R; 2 D/V where eq. 10 has 2 V'/V; R/r
    where eqs. 9 and 13 have r/R; w is D delta' + (D^2/V) ((V^2 - 4 g H)/(V^2 + 2 g H)) delta, where the print
    leaves out the V^2.
    """
    potential = gravity * scale_height / (speed * speed)
    k = 1.0 + 2.0 * potential
    path = drag * drag / speed * (1.0 - 4.0 * potential) / k
    climb = drag / scale_height * k
    centrifugal = speed * speed / radius
    free = (
        -rate * rate / drag
        + 2.0 * drag * rate / speed
        + 2.0 * drag * drag * drag / (speed * speed)
        + climb * (centrifugal - gravity)
        + path * (rate / drag + 2.0 * drag / speed)
    )
    unknown = (-path, -drag, -climb * centrifugal, 0.0, 4.0 * gravity * gravity * drag / (speed * speed))
    return free, unknown, -climb * drag
