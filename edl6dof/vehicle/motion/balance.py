"""Balance of a flight: momentum, energy and mass that the vehicle gained and lost, summed up along it.

The sums do not use the derivatives of the integrator.  Over a step forces and power are integrated by the
trapezoidal rule from the states at both ends; thrusters and engines count with their mean thrust, since
pulses change within a step.  At an event the vehicle loses the mass and momentum that the canopy and departed
parts gain.  After the flight the sums are compared with the change of the state
(:mod:`edl6dof.metrics.record_figures`).

The balance is of the vehicle alone: the pull of a riser and the push of the ground are external forces.
Momentum and energy are per kilogramme of the vehicle, so that the flow of propellant changes the mass only.
At a separation the work of the springs follows from momentum (theorem of Koenig).  Left out: rotation, and
the canopy between its own events.

The largest loads are recorded at the same places (:func:`update_peaks`).
"""

from __future__ import annotations

from edl6dof.interface.capacities import MAX_TANKS
from edl6dof.kernels import kernel
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import add, dot, norm, put3, scale, sub, take3
from edl6dof.vehicle.motion.point_mass import POINT_MASS
from edl6dof.vehicle.parachutes.parachute import EXTRACTING, INFLATING, PACKED, RELEASED
from edl6dof.vehicle.plant import CANOPY_VELOCITY, POSITION, PROPELLANT, THRUST, VELOCITY
from edl6dof.vehicle.propulsion.engine import propellant_flow, thrust_wrench
from edl6dof.vehicle.propulsion.feed_system import load_within_reach, with_propellant
from edl6dof.vehicle.propulsion.rcs import efficiency


@kernel
def vehicle_mass(case, plant):
    """Mass of the vehicle with its propellant, kg."""
    return with_propellant(plant.dry, case.vehicle.tanks, case.vehicle.n_tanks, plant.y)[0]


@kernel
def open_balance(case, plant):
    """Begin the balance with the present state."""
    kept = plant.balance
    kept.mass = vehicle_mass(case, plant)
    put3(kept.r_I, 0, take3(plant.y, POSITION))
    put3(kept.v_I, 0, take3(plant.y, VELOCITY))
    put3(kept.velocity, 0, (0.0, 0.0, 0.0))
    kept.separations = kept.work = kept.lost = 0.0


@kernel
def rates(case, plant, outputs):
    """Rates at the present state: acceleration (I, m/s2) with gravitation, power of all other forces (W/kg),
    attitude, velocity (I, m/s) and inverse of the mass (1/kg).  Acceleration and power are without engines
    and with the mean thruster force of the step.

    The power includes that of a rotating gravity field which is not symmetric about its axis.
    """
    out, inputs = outputs, plant.inputs
    force, _ = engines(case, plant, plant.y, THRUST)
    if case.dynamics != POINT_MASS:
        share = efficiency(case.vehicle.rcs, out.dynamic_pressure)
        force = add(force, scale(share * (plant.t - inputs.middle), take3(inputs.rcs_force_slope, 0)))
    q, inverse = (out.q_I2B[0], out.q_I2B[1], out.q_I2B[2], out.q_I2B[3]), 1.0 / out.mass
    felt = from_frame(q, sub(take3(out.specific_force_B, 0), scale(inverse, force)))
    r, v, g = take3(plant.y, POSITION), take3(plant.y, VELOCITY), take3(out.gravity_I, 0)
    power = dot(felt, v) + case.planet.rotation_rate * (r[0] * g[1] - r[1] * g[0])
    return add(felt, g), power, q, v, inverse


@kernel
def engines(case, plant, thrusts, first):
    """Force of the engines (N, B) and flow of propellant to them (kg/s) at ``thrusts[first:]`` (N)."""
    force, flow = (0.0, 0.0, 0.0), 0.0
    for i in range(case.vehicle.n_engines):
        thrust = thrusts[first + i] * (1.0 - plant.thrust_lost[i])
        if thrust == 0.0:
            continue
        engine = case.vehicle.engines[i]
        pushed, _ = thrust_wrench(engine, thrust, plant.thrust_turned[i, 0], plant.thrust_turned[i, 1])
        force = add(force, pushed)
        if load_within_reach(case.feeds.engines, i, plant.inputs.filled) > 0.0:
            flow += propellant_flow(engine, thrust)
    return force, flow


@kernel
def weigh(case, plant, work, h, begun, ended):
    """Write velocity gained, work and mass lost in a step of ``h`` s into ``work``; ``begun``, ``ended``:
    :func:`rates` at its start and end.
    """
    for i in range(THRUST, THRUST + case.vehicle.n_engines):
        work.thrust[i - THRUST] = plant.y[i] - h / 6.0 * (work.k[1, i] + work.k[2, i] + work.k[3, i])
    force, flow = engines(case, plant, work.thrust, 0)
    gained, power = (0.0, 0.0, 0.0), 0.0
    for end in (begun, ended):
        pushed = from_frame(end[2], scale(end[4], force))
        gained = add(gained, add(end[0], pushed))
        power += end[1] + dot(pushed, end[3])
    put3(work.velocity, 0, scale(0.5 * h, gained))
    work.work = 0.5 * h * power
    if case.dynamics != POINT_MASS:
        for k in range(MAX_TANKS):
            flow += plant.inputs.rcs_flow[k]
            if work.y0[PROPELLANT + k] > 0.0:
                flow += plant.leak[k]
    work.lost = h * flow


@kernel
def book(plant, work):
    """Add the step in ``work`` to the balance, once it need not be repeated to find an event."""
    kept = plant.balance
    put3(kept.velocity, 0, add(take3(kept.velocity, 0), take3(work.velocity, 0)))
    kept.work += work.work
    kept.lost += work.lost


@kernel
def bodies(case, plant):
    """Mass (kg), position and velocity (I) of the vehicle; mass and momentum (I, N s) of the parts that have
    left it.
    """
    mass, momentum = 0.0, (0.0, 0.0, 0.0)
    for i in range(case.vehicle.n_parts):
        part = plant.debris[i]
        if part.active != 0:
            mass, momentum = mass + part.mass, add(momentum, scale(part.mass, take3(part.v_I, 0)))
    if plant.canopy == EXTRACTING or plant.canopy == INFLATING:
        canopy = case.vehicle.parts[case.suspension[plant.parachute].pack].mass
        mass += canopy
        momentum = add(momentum, scale(canopy, take3(plant.y, CANOPY_VELOCITY)))
    r, v = take3(plant.y, POSITION), take3(plant.y, VELOCITY)
    return vehicle_mass(case, plant), r, v, mass, momentum


@kernel
def settle(case, plant, outputs, before):
    """Add an event to the balance: the vehicle loses what the other bodies have gained; ``before``: result of
    :func:`bodies` before the event.
    """
    m, r, v, others, momentum = before
    m_now, r_now, v_now, others_now, momentum_now = bodies(case, plant)
    due = scale(1.0 / m_now, sub(scale(m, v), sub(momentum_now, momentum)))
    kept = plant.balance
    put3(kept.velocity, 0, add(take3(kept.velocity, 0), sub(due, v)))
    kept.separations += norm(sub(v_now, due))
    fell = dot(take3(outputs.gravity_I, 0), sub(r_now, r))
    kept.work += 0.5 * (dot(due, due) - dot(v, v)) - fell
    kept.lost += others_now - others


@kernel
def update_peaks(plant, outputs, peaks):
    """Update ``peaks`` with ``outputs``: the load of the entry until the first deployment of a parachute, the
    load under a parachute separately, neither in contact with the ground.
    """
    if outputs.pads == 0:
        load = norm(take3(outputs.specific_force_B, 0))
        if plant.canopy == PACKED:
            if load > peaks.entry_load:
                peaks.entry_load, peaks.entry_load_time = load, plant.t
        elif plant.canopy != RELEASED:
            peaks.parachute_load = max(peaks.parachute_load, load)
    if outputs.dynamic_pressure > peaks.dynamic_pressure:
        peaks.dynamic_pressure, peaks.dynamic_pressure_time = outputs.dynamic_pressure, plant.t
    if outputs.heat_flux > peaks.heat_flux:
        peaks.heat_flux, peaks.heat_flux_time = outputs.heat_flux, plant.t
    peaks.radiative_heat_flux = max(peaks.radiative_heat_flux, outputs.radiative_heat_flux)
    peaks.riser_tension = max(peaks.riser_tension, outputs.riser_tension)
