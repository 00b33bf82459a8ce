"""Equations of motion: the derivative of the integrated state of vehicle, propellant, engine and canopy.

State in I: position and velocity of the centre of mass, quaternion ``q_I2B``, body rate.  Forces:
gravitation, aerodynamics, trim wing, thrusters, engine, riser, ground.  Left out: the momentum of propellant
moving inside the vehicle (jet damping) and the slow shift of the centre of mass inside the body while
propellant is used, both below 1e-4 of the control torque.
"""

from __future__ import annotations

from edl6dof.environment.heating import convective_heat_flux, radiative_heat_flux
from edl6dof.interface.capacities import MAX_ENGINES, MAX_TANKS
from edl6dof.kernels import inlined_kernel, kernel
from edl6dof.spatial.elementary import acos, sincos
from edl6dof.spatial.frames import ned_to_fixed, rotate_z
from edl6dof.spatial.quaternion import from_frame, rate, to_frame
from edl6dof.spatial.vector import (
    add,
    clamp,
    cross,
    dot,
    inertia_solve,
    inertia_times,
    norm,
    put3,
    scale,
    sub,
    take3,
)
from edl6dof.vehicle.aerodynamics.surfaces import extension, wing_force
from edl6dof.vehicle.aerodynamics.wrench import aerodynamic_wrench
from edl6dof.vehicle.landing_gear import ground_loads
from edl6dof.vehicle.motion.point_mass import POINT_MASS, point_attitude, point_motion
from edl6dof.vehicle.parachutes.parachute import (
    EXTRACTING,
    INFLATING,
    apparent_mass,
    canopy_force,
    confluence,
    inflation,
    riser_tension,
)
from edl6dof.vehicle.plant import (
    ATTITUDE,
    CANOPY_POSITION,
    CANOPY_VELOCITY,
    HEAT,
    POSITION,
    PROPELLANT,
    RATE,
    THRUST,
    VELOCITY,
    take_attitude,
)
from edl6dof.vehicle.propulsion.engine import propellant_flow, thrust_rate, thrust_wrench
from edl6dof.vehicle.propulsion.engine_models import BY_THRUSTERS
from edl6dof.vehicle.propulsion.feed_system import draw, load_within_reach, with_propellant
from edl6dof.vehicle.propulsion.rcs import efficiency
from edl6dof.vehicle.surroundings import gravity, surroundings


@kernel
def derivatives(case, tables, plant, t, rotation, y, outputs, dy):
    """Time derivative ``dy`` of the state ``y`` at time ``t`` (s), with the planet turned by ``rotation``;
    the quantities computed on the way go to ``outputs``.

    The result depends only on the arguments and on parts, commands and ``inputs`` in ``plant``, never on an
    earlier evaluation.
    """
    loads(case, tables, plant, t, rotation, y=y, outputs=outputs)
    if case.dynamics == POINT_MASS:
        point_motion(case, plant, t, y, outputs, dy=dy)
    else:
        motion(case, plant, t, y, outputs, dy=dy)


@inlined_kernel
def aero_loads(case, tables, plant, t, gas, v_air, w, centre):
    """Aerodynamic force and moment about the centre of mass (B); Mach number, dynamic pressure (Pa), and
    smallest opening (0..1) of the surfaces commanded to open.
    """
    vehicle = case.vehicle
    density, sound = gas[0], gas[3]
    speed = norm(v_air)
    mach = speed / sound if sound > 0.0 else 0.0
    qbar = 0.5 * density * speed * speed
    air = (case.planet.gas, qbar, mach, density)
    wrench = aerodynamic_wrench(vehicle.aero, (tables.aero, tables.body), air, plant.shape, v_air, rate=w)
    force = (wrench[0], wrench[1], wrench[2])
    arm = (wrench[6] - centre[0], -centre[1], -centre[2])
    moment = add((wrench[3], wrench[4], wrench[5]), cross(arm, force))
    least = 2.0  # above any opening: no surface was commanded to open
    for i in range(vehicle.n_surfaces):
        if plant.wing_start[i] > t:
            continue
        opening, carrier = extension(case, plant, i, t), case.carrier[i]
        least = min(least, opening)
        if opening > 0.0 and (carrier < 0 or plant.attached[carrier] != 0):
            wing = wing_force(vehicle.surfaces[i], opening, qbar, v_air)
            wing_f = (wing[0], wing[1], wing[2])
            force = add(force, wing_f)
            moment = add(moment, sub((wing[3], wing[4], wing[5]), cross(centre, wing_f)))
    return force, moment, mach, qbar, least if least <= 1.0 else 0.0


@kernel
def riser_loads(case, tables, plant, t, rotation, y, q, w, centre):
    """Loads of the riser on the vehicle: force and moment about the centre of mass (B), tension (N) and its
    margin (m).  Motion of the canopy, in the air at its own height: acceleration without gravitation (I,
    m/s2), and the factor on gravitation (below 1) due to its apparent mass.
    """
    chute = case.vehicle.parachutes[plant.parachute]
    r_I = take3(y, POSITION)
    canopy_B = add(centre, to_frame(q, sub(take3(y, CANOPY_POSITION), r_I)))
    arm = sub(confluence(chute, canopy_B), centre)
    confluence_r = add(r_I, from_frame(q, arm))
    confluence_v = add(take3(y, VELOCITY), from_frame(q, cross(w, arm)))
    line = sub(take3(y, CANOPY_POSITION), confluence_r)
    distance = max(norm(line), 1e-6)
    line = scale(1.0 / distance, line)
    v_canopy = take3(y, CANOPY_VELOCITY)
    packed = case.vehicle.parts[case.suspension[plant.parachute].pack].mass
    rate = dot(sub(v_canopy, confluence_v), line)
    tension, margin = riser_tension(chute, packed, distance, rate, held=plant.inputs.riser)
    fraction = 0.0
    if plant.canopy == INFLATING:
        filled = inflation(chute, t - plant.line_stretch_time[plant.parachute])
        fraction = filled * (1.0 - plant.canopy_lost[plant.parachute])
    _, gas, _, air_I = surroundings(case, tables, plant.inputs.areoid, rotation, take3(y, CANOPY_POSITION))
    v_air = sub(v_canopy, air_I)
    density, sound = gas[0], gas[3]
    drag = canopy_force(
        chute, fraction, density, mach=norm(v_air) / sound, t=t, v_air=v_air, axis=scale(-1.0, line)
    )
    inverse = 1.0 / (packed + apparent_mass(chute, density, fraction))
    acceleration = scale(inverse, sub(drag, scale(tension, line)))
    pull = to_frame(q, scale(tension, line))
    return pull, cross(arm, pull), tension, margin, acceleration, packed * inverse


@inlined_kernel
def loads(case, tables, plant, t, rotation, y, outputs):
    """Write surroundings, mass properties and all loads except propulsion at time ``t`` (s) into ``outputs``;
    these do not depend on the commands to engine and thrusters.
    """
    r_I, w = take3(y, POSITION), take3(y, RATE)
    place, gas, wind_N, air_I = surroundings(case, tables, plant.inputs.areoid, rotation, r_I)
    v_air_I = sub(take3(y, VELOCITY), air_I)
    if case.dynamics == POINT_MASS:
        spin, v_I = case.planet.rotation_rate, take3(y, VELOCITY)
        v_rel_I = (v_I[0] + spin * r_I[1], v_I[1] - spin * r_I[0], v_I[2])
        q = point_attitude(case, plant, t, rotation, place, v_rel_I=v_rel_I, v_air_I=v_air_I)
    else:
        q = take_attitude(y)
    v_air = to_frame(q, v_air_I)
    mass, centre, inertia = with_propellant(plant.dry, case.vehicle.tanks, case.vehicle.n_tanks, y)

    aero_force, aero_moment, mach, qbar, opening = aero_loads(
        case, tables, plant, t, gas, v_air=v_air, w=w, centre=centre
    )
    force, moment = aero_force, aero_moment
    tension = margin = canopy_weight = 0.0
    canopy_acceleration = (0.0, 0.0, 0.0)
    if plant.canopy == EXTRACTING or plant.canopy == INFLATING:
        pull, turning, tension, margin, canopy_acceleration, canopy_weight = riser_loads(
            case, tables, plant, t, rotation, y=y, q=q, w=w, centre=centre
        )
        force, moment = add(force, pull), add(moment, turning)
    pads = 0
    if plant.legs != 0 and plant.touched != 0:
        push, turning, pads = ground_loads(
            case, plant.inputs, y, q, w, centre=centre, rotation=rotation, place=place
        )
        force, moment = add(force, push), add(moment, turning)

    out = outputs
    out.sin_lat, out.cos_lat, out.sin_lon, out.cos_lon, out.altitude, out.height_above_areoid = place
    out.density, out.pressure, out.temperature, out.speed_of_sound = gas
    out.mach, out.dynamic_pressure = mach, qbar
    speed, nose_radius = norm(v_air), case.vehicle.nose_radius
    out.radiative_heat_flux = radiative_heat_flux(case.planet.gas.radiation, out.density, nose_radius, speed)
    convective = convective_heat_flux(case.planet.gas, out.density, nose_radius, speed)
    out.heat_flux = convective + out.radiative_heat_flux
    for i in range(4):
        out.q_I2B[i] = q[i]
    put3(out.v_air_B, 0, v_air)
    put3(out.v_air_I, 0, v_air_I)
    put3(out.wind_N, 0, wind_N)
    put3(out.aero_force_B, 0, aero_force)
    put3(out.aero_moment_B, 0, aero_moment)
    put3(out.load_force_B, 0, force)
    put3(out.load_moment_B, 0, moment)
    out.riser_tension, out.riser_margin = tension, margin
    out.mass, out.pads, out.wing_opening = mass, pads, opening
    put3(out.canopy_acceleration_I, 0, canopy_acceleration)
    out.canopy_weight = canopy_weight
    put3(out.centre, 0, centre)
    for i in range(6):
        out.inertia[i] = inertia[i]


@inlined_kernel
def propulsion(case, plant, t, y, centre, dy):
    """Force and moment about the centre of mass (B) of the engines, and the thrust delivered (N); rates of
    thrusts and propellant go to ``dy``.
    """
    force = moment = (0.0, 0.0, 0.0)
    delivered = 0.0
    for k in range(MAX_TANKS):
        dy[PROPELLANT + k] = 0.0
    for i in range(MAX_ENGINES):
        dy[THRUST + i] = 0.0
    for i in range(case.vehicle.n_engines):
        inputs, level = plant.inputs, y[THRUST + i]
        if inputs.thrust_goal[i] == 0.0 and level == 0.0:
            continue
        loads, filled = case.feeds.engines, inputs.filled
        within = load_within_reach(loads, i, filled)
        engine, thrust = case.vehicle.engines[i], level * (1.0 - plant.thrust_lost[i])
        own_force, own_moment = thrust_wrench(
            engine, thrust, plant.thrust_turned[i, 0], plant.thrust_turned[i, 1]
        )
        force = add(force, own_force)
        moment = add(moment, sub(own_moment, cross(centre, own_force)))
        delivered += thrust * engine.thrust_factor
        if within > 0.0:
            draw((loads, i, filled, within), -propellant_flow(engine, thrust), dy, PROPELLANT)
        goal = inputs.thrust_goal[i] + (t - inputs.middle) * inputs.thrust_goal_slope[i]
        # a starving engine goes out as fast as one that is cut off
        fast = plant.starting != 0 or plant.running[i] == 0 or within == 0.0
        dy[THRUST + i] = thrust_rate(engine, goal, level, fast)
    return force, moment, delivered


@inlined_kernel
def thrust_by_thrusters(case, plant, rcs_force):
    """Thrust (N) of a running engine that consists of thrusters, from their force (N, B); 0 without one."""
    for i in range(case.vehicle.n_engines):
        if case.vehicle.engines[i].model == BY_THRUSTERS and plant.running[i] != 0:
            return max(-rcs_force[0], 0.0)
    return 0.0


@inlined_kernel
def motion(case, plant, t, y, outputs, dy):
    """Derivative ``dy`` of the state ``y`` at time ``t`` (s) under the loads in ``outputs``, the engines and
    the thrusters.

    Thruster forces and flows are linear in time over the current step, and constant at their mean after it;
    the air flow reduces the forces (:mod:`edl6dof.vehicle.propulsion.rcs`).
    """
    out, inputs = outputs, plant.inputs
    q, w = take_attitude(y), take3(y, RATE)
    centre = take3(out.centre, 0)
    i = out.inertia
    inertia = (i[0], i[1], i[2], i[3], i[4], i[5])
    engine_force, engine_moment, delivered = propulsion(case, plant, t, y, centre, dy=dy)
    share = efficiency(case.vehicle.rcs, out.dynamic_pressure)
    since = t - inputs.middle
    rcs_force = add(take3(inputs.rcs_force, 0), scale(since, take3(inputs.rcs_force_slope, 0)))
    rcs_moment = add(take3(inputs.rcs_moment, 0), scale(since, take3(inputs.rcs_moment_slope, 0)))
    rcs_force, rcs_moment = scale(share, rcs_force), scale(share, rcs_moment)
    # everything that turns the vehicle except the thrusters
    disturbance = add(take3(out.load_moment_B, 0), engine_moment)
    moment = add(disturbance, sub(rcs_moment, cross(centre, rcs_force)))
    specific = scale(1.0 / out.mass, add(take3(out.load_force_B, 0), add(engine_force, rcs_force)))
    put3(out.specific_force_B, 0, specific)
    put3(out.disturbance_moment_B, 0, disturbance)
    out.engine_thrust = delivered + thrust_by_thrusters(case, plant, rcs_force)

    put3(dy, POSITION, take3(y, VELOCITY))
    g = gravity(case.planet.gravity, inputs, take3(y, POSITION))
    put3(out.gravity_I, 0, g)
    put3(dy, VELOCITY, add(from_frame(q, specific), g))
    q_dot = rate(q, w)
    for k in range(4):
        dy[ATTITUDE + k] = q_dot[k]
    put3(dy, RATE, inertia_solve(inertia, sub(moment, cross(w, inertia_times(inertia, w)))))
    for k in range(MAX_TANKS):
        dy[PROPELLANT + k] -= inputs.rcs_flow[k] + since * inputs.rcs_flow_slope[k]
        if plant.leak[k] > 0.0 and plant.y[PROPELLANT + k] > 0.0:
            dy[PROPELLANT + k] -= plant.leak[k]
    dy[HEAT] = out.heat_flux
    put3(dy, CANOPY_POSITION, take3(y, CANOPY_VELOCITY))
    put3(dy, CANOPY_VELOCITY, add(take3(out.canopy_acceleration_I, 0), scale(out.canopy_weight, g)))


@kernel
def tilt(case, t, q, out):
    """Angle between -x of B (up when landed) and the local vertical, rad."""
    down_F = ned_to_fixed(out.sin_lat, out.cos_lat, out.sin_lon, out.cos_lon, (0.0, 0.0, 1.0))
    spin = case.planet.rotation_rate
    s, c = sincos(spin * t)
    down_I = rotate_z(c, -s, down_F)
    x = from_frame(q, (1.0, 0.0, 0.0))
    return acos(clamp(x[0] * down_I[0] + x[1] * down_I[1] + x[2] * down_I[2], -1.0, 1.0))
