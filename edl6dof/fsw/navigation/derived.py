"""Quantities that mission logic, guidance and control use, computed from the estimated state and the on-board
models alone.

Velocity is relative to the planet. The true wind is not known on board, so angle of attack, sideslip, bank
angle and Mach number differ from the true ones. A second angle of attack and sideslip include the estimated
wind, which starts as the mean wind that was expected before the flight (:mod:`.wind_estimate`). They are used
where the vehicle has to be aligned with the air flow.

Drag is the component of the specific force along the air flow at the expected trim angle. The vehicle trims
relative to the true air flow, whereas the direction of the planet-relative velocity has an error of wind
divided by speed. A projection on this velocity would count part of the lift as drag, with a sign that changes
with the bank angle. An error of the trim angle has a small effect on drag, lift times the error. Lift is the
component normal to the flow in the expected wind. With the trim angle it would have an error of drag times
the error of the trim angle, as large as the changes of lift that have to be measured. The users of lift
filter the effect of the unexpected wind; the estimated wind comes from the force across the axis itself, and
with it the lift would always be the believed one.

The ratio of measured drag to the drag of the on-board models, and the speed, pass fading-memory filters.
Changes due to the motion of the vehicle (descent, deceleration, drag coefficient) are in the modelled drag
without lag; only the ratio (gusts, density waves, thrusters, noise) is filtered. If the air is as modelled,
or differs by a constant factor, the filtered drag is the measured drag without lag. In wind, lift changes the
planet-relative speed but not the air-relative speed. The speed in modelled drag and energy is therefore
integrated from drag and gravity alone, and approaches the navigated speed slowly. Otherwise the reference
drag, a function of energy, would change with every change of the bank angle.

Source: the fading-memory filters of density and lift-to-drag ratio of numerical entry guidance (Brunner & Lu
2008, eqs. 33-34; Lu 2014, section V.C); the filter of the speed: this project.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.airframe import believed_aero, trim_alpha
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.spatial.elementary import acos, atan2, exp, sin, sincos
from edl6dof.spatial.frames import (
    bank_angle,
    fixed_to_ned,
    geodetic,
    ned_to_fixed,
    rotate_z,
    to_local,
    total_angle_of_attack,
    wind_angles,
)
from edl6dof.spatial.quaternion import axes, to_frame
from edl6dof.spatial.table_index import between, held_cell
from edl6dof.spatial.vector import add, clamp, dot, norm, put3, put4, scale, sub, take3, take4

NAV = record(
    ("t", "f8"),  # s: flight time
    ("q_I2B", "f8", (4,)),  # attitude of B in I, unit quaternion, scalar first
    ("w_B", "f8", (3,)),  # rad/s, B: rate of B relative to I
    ("specific_force_B", "f8", (3,)),  # m/s2, B: acceleration of the centre of mass without gravity
    # rad/s, B: rate of B relative to I as the inertial unit read it, some cycles ago
    ("imu_rate_B", "f8", (3,)),
    ("imu_gain_B", "f8", (3,)),  # m/s, B: integral of the specific force since the start, of the same age
    ("v_rel_I", "f8", (3,)),  # m/s, I: planet-relative velocity
    ("up_I", "f8", (3,)),  # 1, I: unit vector up, along the geodetic vertical
    ("north_I", "f8", (3,)),  # 1, I: unit vector north
    ("east_I", "f8", (3,)),  # 1, I: unit vector east
    ("radius", "f8"),  # m: distance from the centre of the planet
    ("latitude", "f8"),  # rad: geodetic, positive north
    ("longitude", "f8"),  # rad: positive east, -pi to pi
    ("altitude", "f8"),  # m: height above the reference ellipsoid
    ("height", "f8"),  # m: height of the centre of mass above the ground below
    ("speed", "f8"),  # m/s: magnitude of the planet-relative velocity
    # rad: of the planet-relative velocity above the horizontal, positive climbing
    ("flight_path_angle", "f8"),
    ("azimuth", "f8"),  # rad: of the planet-relative velocity, from north, positive to the east
    ("v_N", "f8", (3,)),  # m/s, N: planet-relative velocity north, east, down
    ("site_L", "f8", (3,)),  # m, L: position relative to the landing site: east, north, up
    ("alpha", "f8"),  # rad: angle of attack atan2(w, u) of the planet-relative velocity; positive nose up
    # rad: sideslip asin(v/V) of the planet-relative velocity; positive with the nose left of it
    ("beta", "f8"),
    ("bank", "f8"),  # rad: about the planet-relative velocity, 0 with lift up, positive right wing down
    ("wind_N", "f8", (2,)),  # m/s, N: estimated wind towards north and east
    ("alpha_in_air", "f8"),  # rad: angle of attack in the estimated wind, sign as alpha
    ("beta_in_air", "f8"),  # rad: sideslip in the estimated wind, sign as beta
    ("total_alpha", "f8"),  # rad: angle between x of B and the velocity in the estimated wind, 0 to pi
    ("mach", "f8"),  # Mach number of the planet-relative speed in the believed atmosphere
    # m/s2: measured, along the air flow at the believed trim; positive against the motion
    ("drag", "f8"),
    ("lift", "f8"),  # m/s2: measured, across the flow in the expected wind, up at zero bank
    ("dynamic_pressure", "f8"),  # Pa: from the believed density and the planet-relative speed
    ("energy", "f8"),  # m2/s2: kinetic and potential energy per mass, zero at rest on the equatorial radius
    ("gravity", "f8"),  # m/s2: magnitude of mu / radius^2
    ("tilt", "f8"),  # rad: angle between the thrust axis (-x of B) and up, 0 to pi
    # rad: roll error about +x of B, goal minus actual; the goal has y of B to the south
    ("roll_to_south", "f8"),
    ("footpad_contact", FLAG),  # a footpad touches the ground
    ("wing_open", FLAG),  # end switch of the trim wing
)


@kernel
def model_atmosphere(table, altitude):
    """Believed density (kg/m3), speed of sound (m/s) and density scale height (m) at ``altitude`` (m)."""
    i, f = held_cell((altitude - table.bottom) / table.spacing, table.ln_density.shape[0] - 1)
    slope = table.ln_density[i + 1] - table.ln_density[i]
    density = exp(table.ln_density[i] + f * slope)
    sound = between(table.speed_of_sound, i, f)
    return density, sound, -table.spacing / slope


@kernel
def expected_wind(table, altitude):
    """Mean wind (m/s) towards north and east that is expected at ``altitude`` (m)."""
    i, f = held_cell((altitude - table.bottom) / table.spacing, table.wind_north.shape[0] - 1)
    return between(table.wind_north, i, f), between(table.wind_east, i, f)


@kernel
def drag_and_lift(force_B, alpha):
    """Return drag and lift (m/s2; lift is positive up at zero bank) of the specific force ``force_B`` (m/s2)
    at the angle of attack ``alpha`` (rad).
    """
    s, c = sincos(alpha)
    return -(force_B[0] * c + force_B[2] * s), force_B[0] * s - force_B[2] * c


@kernel
def derive(planet, atmosphere, vehicle, site_frame, estimate, wind, nav):
    """Fill ``nav`` (``NAV``) from ``estimate`` (``ESTIMATE``) by believed planet, air and vehicle, the frame
    L of the site, and the estimated ``wind`` (``WIND_ESTIMATE``).
    """
    t = estimate.t
    nav.t = t
    q = take4(estimate.q_I2B)
    put4(nav.q_I2B, q)
    for i in range(3):
        nav.w_B[i] = estimate.w_B[i]
        nav.specific_force_B[i] = estimate.specific_force_B[i]
        nav.imu_rate_B[i] = estimate.imu_rate_B[i]
        nav.imu_gain_B[i] = estimate.imu_gain_B[i]
    spin = planet.rotation_rate
    s, c = sincos(spin * t)
    r_I = take3(estimate.r_I, 0)
    v_rel_I = (estimate.v_I[0] + spin * r_I[1], estimate.v_I[1] - spin * r_I[0], estimate.v_I[2])
    r_F, v_F = rotate_z(c, s, r_I), rotate_z(c, s, v_rel_I)
    sin_lat, cos_lat, sin_lon, cos_lon, altitude = geodetic(planet.equatorial_radius, planet.flattening, r_F)
    up = rotate_z(c, -s, ned_to_fixed(sin_lat, cos_lat, sin_lon, cos_lon, (0.0, 0.0, -1.0)))
    north = rotate_z(c, -s, ned_to_fixed(sin_lat, cos_lat, sin_lon, cos_lon, (1.0, 0.0, 0.0)))
    east = rotate_z(c, -s, ned_to_fixed(sin_lat, cos_lat, sin_lon, cos_lon, (0.0, 1.0, 0.0)))
    put3(nav.v_rel_I, 0, v_rel_I)
    put3(nav.up_I, 0, up)
    put3(nav.north_I, 0, north)
    put3(nav.east_I, 0, east)
    nav.radius = norm(r_I)
    nav.latitude, nav.longitude, nav.altitude = atan2(sin_lat, cos_lat), atan2(sin_lon, cos_lon), altitude
    nav.height = estimate.height_above_ground
    v_N = fixed_to_ned(sin_lat, cos_lat, sin_lon, cos_lon, v_F)
    put3(nav.v_N, 0, v_N)
    speed = norm(v_rel_I)
    nav.speed = speed
    nav.flight_path_angle = atan2(-v_N[2], sqrt(v_N[0] * v_N[0] + v_N[1] * v_N[1]))
    nav.azimuth = atan2(v_N[1], v_N[0])

    put3(nav.site_L, 0, to_local(site_frame, r_F))

    v_B = to_frame(q, v_rel_I)
    _, nav.alpha, nav.beta = wind_angles(v_B)
    x, y, z = axes(q)
    nav.bank = bank_angle(v_rel_I, up, x, y, z)
    wind_north, wind_east = expected_wind(atmosphere, altitude)
    v_air_B = to_frame(q, sub(v_rel_I, add(scale(wind_north, north), scale(wind_east, east))))
    _, alpha_expected, _ = wind_angles(v_air_B)
    nav.wind_N[0], nav.wind_N[1] = wind_north + wind.shift_N[0], wind_east + wind.shift_N[1]
    v_air_B = to_frame(q, sub(v_rel_I, add(scale(nav.wind_N[0], north), scale(nav.wind_N[1], east))))
    _, nav.alpha_in_air, nav.beta_in_air = wind_angles(v_air_B)
    nav.total_alpha = total_angle_of_attack(v_air_B)
    density, sound, _ = model_atmosphere(atmosphere, altitude)
    nav.mach = speed / sound
    nav.dynamic_pressure = 0.5 * density * speed * speed
    force_B = take3(estimate.specific_force_B, 0)
    nav.drag, _ = drag_and_lift(force_B, 0.0 if estimate.wing_open != 0 else trim_alpha(vehicle, nav.mach))
    _, nav.lift = drag_and_lift(force_B, alpha_expected)
    radius = planet.equatorial_radius
    nav.energy = 0.5 * speed * speed + planet.mu * (1.0 / radius - 1.0 / (radius + altitude))
    nav.gravity = planet.mu / (nav.radius * nav.radius)
    nav.tilt = acos(clamp(-dot(x, up), -1.0, 1.0))
    # roll of y_B about the upward x_C away from south, seen with the thrust axis brought to the vertical
    nav.roll_to_south = atan2(dot(y, east), -dot(y, north))
    nav.footpad_contact, nav.wing_open = estimate.footpad_contact, estimate.wing_open


class DragFilterParams(Params):
    """Fading memories of measured drag and speed."""

    time_constant_s: float = param(
        1.0,
        "time constant of the drag ratio; 0: drag and energy as measured",
        status="estimate",
        ge=0.0,
        le=100.0,
    )
    speed_time_constant_s: float = param(
        10.0,
        "time constant with which the filtered speed follows changes that drag and gravity do not explain",
        status="estimate",
        gt=0.0,
        le=100.0,
    )
    least_drag_m_s2: float = param(
        0.5, "drag below which drag and energy are as measured", status="estimate", gt=0.0
    )


#: Time (s), filtered speed (m/s), rate of the speed (m/s2), filtered ratio of drag; ratio 0: not started.
DRAG_FILTER = record(("t", "f8"), ("speed", "f8"), ("rate", "f8"), ("ratio", "f8"))


@kernel
def filter_drag(params, atmosphere, vehicle, nav, memory):
    """Replace drag and energy of ``nav`` by the filtered drag and the energy at the filtered speed."""
    p = params
    density, _, _ = model_atmosphere(atmosphere, nav.altitude)
    area, _ = believed_aero(vehicle, nav.mach, nav.speed)
    per_square = 0.5 * density * area / vehicle.entry_mass
    if p.time_constant == 0.0 or min(nav.drag, per_square * nav.speed * nav.speed) < p.least_drag:
        memory.ratio = 0.0
        return
    rate = -nav.drag - nav.gravity * sin(nav.flight_path_angle)
    if memory.ratio == 0.0:
        memory.speed, memory.ratio = nav.speed, nav.drag / (per_square * nav.speed * nav.speed)
    else:
        dt = nav.t - memory.t
        memory.speed += 0.5 * dt * (memory.rate + rate)
        memory.speed += (1.0 - exp(-dt / p.speed_time_constant)) * (nav.speed - memory.speed)
        ratio = nav.drag / (per_square * memory.speed * memory.speed)
        memory.ratio += (1.0 - exp(-dt / p.time_constant)) * (ratio - memory.ratio)
    memory.t, memory.rate = nav.t, rate
    nav.drag = memory.ratio * per_square * memory.speed * memory.speed
    nav.energy += 0.5 * (memory.speed * memory.speed - nav.speed * nav.speed)
