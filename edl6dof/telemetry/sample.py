"""Fill one row of telemetry from plant and flight-software memory.

Errors of navigation are the estimate less the truth, in the axes north, east and down of the true place: of
position, of the velocity relative to the turning planet, and of attitude, the small rotation from the true to
the estimated body.
"""

from __future__ import annotations

from math import nan, sqrt

from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import acos, atan2
from edl6dof.spatial.frames import (
    bank_angle,
    fixed_to_ned,
    ned_to_fixed,
    rotate_z,
    to_local,
    total_angle_of_attack,
    wind_angles,
)
from edl6dof.spatial.quaternion import axes, conjugate, from_frame, multiply, rotation_vector
from edl6dof.spatial.vector import clamp, norm, scale, sub, take3
from edl6dof.vehicle.mass import CONFIG_BACKSHELL, CONFIG_CAPSULE, showing
from edl6dof.vehicle.parachutes.parachute import EXTRACTING, INFLATING
from edl6dof.vehicle.plant import CANOPY_POSITION, HEAT, POSITION, RATE, VELOCITY, take_attitude
from edl6dof.vehicle.propulsion.feed_system import propellant_left
from edl6dof.vehicle.propulsion.rcs import efficiency
from edl6dof.vehicle.surroundings import planet_rotation


@kernel
def record_errors(plant, outputs, estimate, spin, c, s, nav):
    """Write the errors of the ``estimate`` (``ESTIMATE``) into the group ``nav`` of a row of telemetry;
    ``spin``: rotation rate of the planet (rad/s), ``c``, ``s``: cosine and sine of its rotation angle.
    """
    y, out = plant.y, outputs
    sl, cl, so, co = out.sin_lat, out.cos_lat, out.sin_lon, out.cos_lon
    r = rotate_z(c, s, sub(take3(estimate.r_I, 0), take3(y, POSITION)))
    v_F = rotate_z(c, s, sub(take3(estimate.v_I, 0), take3(y, VELOCITY)))
    v = (v_F[0] + spin * r[1], v_F[1] - spin * r[0], v_F[2])
    q = take_attitude(y)
    p = (estimate.q_I2B[0], estimate.q_I2B[1], estimate.q_I2B[2], estimate.q_I2B[3])
    turned = rotate_z(c, s, from_frame(q, rotation_vector(multiply(conjugate(q), p))))
    nav.error_north, nav.error_east, nav.error_down = fixed_to_ned(sl, cl, so, co, r)
    nav.error_v_north, nav.error_v_east, nav.error_v_down = fixed_to_ned(sl, cl, so, co, v)
    nav.error_attitude_north, nav.error_attitude_east, nav.error_attitude_down = fixed_to_ned(
        sl, cl, so, co, turned
    )
    nav.error_height = estimate.height_above_ground - out.height


@kernel
def mask(flags):
    """Flags as one whole number: the sum of 2 to the power of the index of each flag that is set."""
    total = 0
    for i in range(len(flags)):
        if flags[i] != 0:
            total |= 1 << i
    return total


@kernel
def record_readings(sensed, branches, tick):
    """Write into a row of telemetry which instruments of ``sensed`` (``SENSED``) are at the end of their
    range, the range (m) of each radar beam, 0 without an echo, and the count (kg) of each flow meter.
    """
    inertial, radar = sensed.inertial, sensed.radar
    tick.sensed.gyros_saturated = mask(inertial.gyro_saturated)
    tick.sensed.accelerometers_saturated = mask(inertial.accelerometer_saturated)
    for i in range(len(radar.range)):
        tick.range[i] = radar.range[i] if radar.locked[i] != 0 else 0.0
    for k in range(branches):
        tick.metered[k] = sensed.branch_used[k]


@kernel
def farthest(values):
    """Largest magnitude of numbers."""
    largest = 0.0
    for i in range(len(values)):
        largest = max(largest, abs(values[i]))
    return largest


@kernel
def record_claims(navigation, nav):
    """Write standard deviations, innovations and instruments in use of navigation (``NAVIGATION``)."""
    solution, health = navigation.solution, navigation.health
    nav.sigma_north, nav.sigma_east, nav.sigma_down = take3(solution.sigma_r, 0)
    nav.sigma_v_north, nav.sigma_v_east, nav.sigma_v_down = take3(solution.sigma_v, 0)
    nav.sigma_attitude_north, nav.sigma_attitude_east, nav.sigma_attitude_down = take3(
        solution.sigma_attitude, 0
    )
    nav.sigma_height = solution.sigma_height
    nav.range_innovation = farthest(solution.range_innovation)
    nav.speed_innovation = farthest(solution.speed_innovation)
    nav.beams_used = solution.beams_used
    nav.gyros_in_use, nav.accelerometers_in_use = mask(health.gyro), mask(health.accelerometer)
    nav.beams_in_use = mask(health.beam_range) & mask(health.beam_speed)


@kernel
def record_brief(case, plant, outputs, fsw, tick):
    """Write the channels of a ``BRIEF`` row into it or into a ``TICK`` row; return the values that
    :func:`record` needs for the other channels.
    """
    y, out, truth, guide, control = plant.y, outputs, tick.truth, tick.guide, tick.control
    tick.t = t = plant.t
    spin = case.planet.rotation_rate
    c, s = planet_rotation(case.planet, t)
    r_I, v_I = take3(y, POSITION), take3(y, VELOCITY)
    v_rel_I = (v_I[0] + spin * r_I[1], v_I[1] - spin * r_I[0], v_I[2])
    v_N = fixed_to_ned(out.sin_lat, out.cos_lat, out.sin_lon, out.cos_lon, rotate_z(c, s, v_rel_I))

    truth.altitude, truth.height = out.altitude, out.height
    truth.height_above_areoid = out.height_above_areoid
    truth.latitude, truth.longitude = out.latitude, out.longitude
    truth.site_east, truth.site_north, truth.site_up = to_local(case.site, rotate_z(c, s, r_I))
    truth.speed = norm(v_N)
    v_air = take3(out.v_air_B, 0)
    airspeed, truth.alpha, truth.beta = wind_angles(v_air)
    truth.total_alpha = total_angle_of_attack(v_air)
    truth.mach, truth.dynamic_pressure = out.mach, out.dynamic_pressure
    truth.rate_p, truth.rate_q, truth.rate_r = take3(y, RATE)
    truth.propellant = propellant_left(case.vehicle.n_tanks, y)
    truth.disturbance_x, truth.disturbance_y, truth.disturbance_z = take3(out.disturbance_moment_B, 0)
    truth.backshell_east = truth.backshell_north = truth.backshell_up = nan
    shell = showing(case.vehicle.parts, case.vehicle.n_parts, CONFIG_BACKSHELL)
    if shell >= 0 and plant.debris[shell].active != 0:
        place = to_local(case.site, rotate_z(c, s, take3(plant.debris[shell].r_I, 0)))
        truth.backshell_east, truth.backshell_north, truth.backshell_up = place
    guide.phase, guide.bank = fsw.mission.phase, fsw.guide.bank
    control.error_roll, control.error_pitch, control.error_yaw = take3(fsw.demand.attitude_error, 0)
    record_errors(plant, outputs, fsw.navigation.estimate, spin, c, s=s, nav=tick.nav)
    estimate = tick.estimate
    estimate.torque_x, estimate.torque_y, estimate.torque_z = take3(fsw.disturbance.torque, 0)
    return c, s, v_rel_I, v_N, airspeed


@kernel
def record_choice(hazard, point, guide):
    """Write the stage of hazard detection, and the points that it has chosen; ``nan`` until then."""
    guide.coarse_east = guide.coarse_north = guide.spot_east = guide.spot_north = nan
    guide.hazard_stage = hazard.exposed
    if point.coarse_known != 0:
        guide.hazard_stage = 2
        guide.coarse_east, guide.coarse_north = point.coarse_L[0], point.coarse_L[1]
    if hazard.scanning != 0:
        guide.hazard_stage = 3
    if point.fine_known != 0:
        guide.hazard_stage = 4
        guide.spot_east, guide.spot_north = point.fine_L[0], point.fine_L[1]


@kernel
def record(case, plant, outputs, sensed, fsw, tick):
    """Write ``tick`` from the state at ``plant.t``; ``outputs``: outputs of the plant in this state."""
    c, s, v_rel_I, v_N, airspeed = record_brief(case, plant, outputs, fsw, tick)
    y, out, truth = plant.y, outputs, tick.truth
    q = take_attitude(y)
    up = rotate_z(c, -s, ned_to_fixed(out.sin_lat, out.cos_lat, out.sin_lon, out.cos_lon, (0.0, 0.0, -1.0)))
    x, y_axis, z = axes(q)

    truth.r_I_x, truth.r_I_y, truth.r_I_z = take3(y, POSITION)
    truth.v_I_x, truth.v_I_y, truth.v_I_z = take3(y, VELOCITY)
    truth.v_north, truth.v_east, truth.v_down = v_N
    truth.flight_path_angle = atan2(-v_N[2], sqrt(v_N[0] * v_N[0] + v_N[1] * v_N[1]))
    truth.azimuth = atan2(v_N[1], v_N[0])
    truth.elevation, truth.airspeed = out.elevation, airspeed
    truth.bank = bank_angle(v_rel_I, up, x, y_axis, z)
    truth.density, truth.temperature = out.density, out.temperature
    truth.wind_north, truth.wind_east, truth.wind_down = take3(out.wind_N, 0)
    truth.q_I2B_w, truth.q_I2B_x, truth.q_I2B_y, truth.q_I2B_z = q
    truth.tilt = acos(clamp(-(x[0] * up[0] + x[1] * up[1] + x[2] * up[2]), -1.0, 1.0))
    truth.mass = out.mass
    truth.centre_x, truth.centre_y, truth.centre_z = take3(out.centre, 0)
    truth.aero_force_x, truth.aero_force_y, truth.aero_force_z = take3(out.aero_force_B, 0)
    truth.aero_moment_x, truth.aero_moment_y, truth.aero_moment_z = take3(out.aero_moment_B, 0)
    truth.rcs_force_x, truth.rcs_force_y, truth.rcs_force_z = scale(
        efficiency(case.vehicle.rcs, out.dynamic_pressure), take3(plant.inputs.rcs_force, 0)
    )
    truth.load = norm(take3(out.specific_force_B, 0))
    truth.heat_flux, truth.heat_load = out.heat_flux, y[HEAT]
    truth.radiative_heat_flux = out.radiative_heat_flux
    truth.engine_thrust, truth.riser_tension, truth.footpads = out.engine_thrust, out.riser_tension, out.pads
    if plant.canopy == EXTRACTING or plant.canopy == INFLATING:
        truth.canopy_east, truth.canopy_north, truth.canopy_up = to_local(
            case.site, rotate_z(c, s, take3(y, CANOPY_POSITION))
        )
    else:
        truth.canopy_east = truth.canopy_north = truth.canopy_up = nan
    truth.heat_shield_east = truth.heat_shield_north = truth.heat_shield_up = nan
    shield = showing(case.vehicle.parts, case.vehicle.n_parts, CONFIG_CAPSULE)
    if shield >= 0 and plant.debris[shield].active != 0:
        place = to_local(case.site, rotate_z(c, s, take3(plant.debris[shield].r_I, 0)))
        truth.heat_shield_east, truth.heat_shield_north, truth.heat_shield_up = place
    truth.trim_wing = out.wing_opening

    record_readings(sensed, case.branches.count, tick)
    nav, guide, shown, control = fsw.nav, fsw.guide, tick.guide, tick.control
    tick.nav.mach, tick.nav.alpha, tick.nav.beta = nav.mach, nav.alpha, nav.beta
    tick.nav.total_alpha = nav.total_alpha
    tick.nav.wind_north, tick.nav.wind_east = nav.wind_N[0], nav.wind_N[1]
    tick.nav.bank, tick.nav.drag, tick.nav.mass = nav.bank, nav.drag, fsw.vehicle.mass
    record_claims(fsw.navigation, tick.nav)
    shown.reference_drag, shown.range_to_go = guide.reference_drag, guide.range_to_go
    shown.crossrange, shown.time_to_go, shown.thrust = guide.crossrange, guide.time_to_go, guide.thrust
    shown.surface, shown.virtual = guide.surface, guide.virtual
    shown.drag_estimate, shown.drag_rate = guide.drag_estimate, guide.drag_rate
    shown.drag_disturbance, shown.path_disturbance = guide.drag_disturbance, guide.path_disturbance
    north, east, down = take3(guide.thrust_direction_N, 0)
    shown.thrust_direction_north, shown.thrust_direction_east = north, east
    shown.thrust_direction_down = down
    record_choice(fsw.hazard, fsw.landing_point, shown)
    control.torque_x, control.torque_y, control.torque_z = take3(fsw.demand.wrench, 3)
    unallocated = take3(fsw.allocation.unallocated, 3)
    control.unallocated_x, control.unallocated_y, control.unallocated_z = unallocated
    estimate = tick.estimate
    estimate.force_x, estimate.force_y, estimate.force_z = take3(fsw.disturbance.force, 0)
    diagnosis = fsw.diagnosis
    tick.diagnosis.confidence = diagnosis.hypotheses.confidence
    tick.diagnosis.common_loss = diagnosis.flow.common
    tick.diagnosis.leaking, tick.diagnosis.isolated = diagnosis.leak.branch, diagnosis.n_isolated
    in_use = 0
    for i in range(case.vehicle.rcs.n_thrusters):
        if fsw.health.thruster[i] != 0:
            in_use |= 1 << i
        tick.duty[i] = plant.valves.mean[i]
        tick.fault[i] = plant.valves.fault[i]
        tick.valve[i] = 1 if fsw.command.valve_close_time[i] > fsw.command.valve_open_time[i] else 0
    tick.diagnosis.in_use = in_use
    for k in range(case.branches.count):
        tick.used[k], tick.expected[k] = plant.branch_used[k], diagnosis.flow.expected[k]
