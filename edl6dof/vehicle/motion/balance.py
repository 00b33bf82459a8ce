"""Balance of a flight: momentum, energy and mass that its vehicle was given, summed up along the way.

The sums do not use what the integrator makes of its stages.  Over a step forces, power and flow are taken by
the trapezoidal rule from the states at both ends, thrusters with the mean of the step; at an event the
vehicle loses the mass and the momentum that canopy and parts that have left gain.  What the state has become
since the start is compared with them after the flight (:mod:`edl6dof.metrics.balance`).

The vehicle is the body that is balanced: the pull of a riser and the push of the ground are forces on it.
All is per kilogramme of the vehicle but its mass, so that propellant that leaves takes nothing else along.
At a separation the work of the springs follows from momentum (theorem of Koenig).  Left out: rotation, and
the canopy between its own events.
"""

from __future__ import annotations

from edl6dof.interface.capacities import MAX_TANKS
from edl6dof.jit import kernel
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import add, dot, norm, put3, scale, sub, take3
from edl6dof.vehicle.motion.point_mass import POINT_MASS
from edl6dof.vehicle.parachutes.parachute import EXTRACTING, INFLATING
from edl6dof.vehicle.plant import CANOPY_VELOCITY, POSITION, PROPELLANT, THRUST, VELOCITY
from edl6dof.vehicle.propulsion.engine import propellant_flow
from edl6dof.vehicle.propulsion.rcs import efficiency
from edl6dof.vehicle.propulsion.tanks import load_within_reach, with_propellant


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
    """At the present state: acceleration (I, m/s2), power of all forces but gravitation (W/kg), and flow of
    propellant to the engines (kg/s); thrusters with the mean of the step.

    Gravitation adds to the power what the turning of a field does that is not symmetric about its axis.
    """
    out, inputs = outputs, plant.inputs
    specific = take3(out.specific_force_B, 0)
    if case.dynamics != POINT_MASS:
        share = efficiency(case.vehicle.rcs, out.dynamic_pressure) / out.mass
        beyond_mean = scale(share * (plant.t - inputs.middle), take3(inputs.rcs_force_slope, 0))
        specific = sub(specific, beyond_mean)
    q = (out.q_I2B[0], out.q_I2B[1], out.q_I2B[2], out.q_I2B[3])
    felt, g = from_frame(q, specific), take3(out.gravity_I, 0)
    r, v = take3(plant.y, POSITION), take3(plant.y, VELOCITY)
    power = dot(felt, v) + case.planet.rotation_rate * (r[0] * g[1] - r[1] * g[0])
    return add(felt, g), power, engine_flow(case, plant)


@kernel
def engine_flow(case, plant):
    """Flow of propellant to the engines, kg/s."""
    flow = 0.0
    for i in range(case.vehicle.n_engines):
        thrust = plant.y[THRUST + i] * (1.0 - plant.thrust_lost[i])
        if thrust != 0.0 and load_within_reach(case.feeds.engines, i, plant.inputs.filled) > 0.0:
            flow += propellant_flow(case.vehicle.engines[i], thrust)
    return flow


@kernel
def weigh(case, plant, work, h, begun, ended):
    """What a step of ``h`` s gives the vehicle, into ``work``; ``begun``, ``ended``: :func:`rates` at its
    ends.
    """
    put3(work.velocity, 0, scale(0.5 * h, add(begun[0], ended[0])))
    work.work = 0.5 * h * (begun[1] + ended[1])
    flow = 0.5 * (begun[2] + ended[2])
    if case.dynamics != POINT_MASS:
        for k in range(MAX_TANKS):
            flow += plant.inputs.rcs_flow[k]
            if work.y0[PROPELLANT + k] > 0.0:
                flow += plant.leak[k]
    work.lost = h * flow


@kernel
def book(plant, work):
    """Book the step that ``work`` holds: one that stands, and is not repeated to find an event."""
    kept = plant.balance
    put3(kept.velocity, 0, add(take3(kept.velocity, 0), take3(work.velocity, 0)))
    kept.work += work.work
    kept.lost += work.lost


@kernel
def bodies(case, plant):
    """Mass (kg), position and velocity (I) of the vehicle; mass and momentum (I, N s) of canopy and parts
    that have left it.
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
    """Book an event: the vehicle loses what the other :func:`bodies` have gained since ``before``."""
    m, r, v, others, momentum = before
    m_now, r_now, v_now, others_now, momentum_now = bodies(case, plant)
    due = scale(1.0 / m_now, sub(scale(m, v), sub(momentum_now, momentum)))
    kept = plant.balance
    put3(kept.velocity, 0, add(take3(kept.velocity, 0), sub(due, v)))
    kept.separations += norm(sub(v_now, due))
    fell = dot(take3(outputs.gravity_I, 0), sub(r_now, r))
    kept.work += 0.5 * (dot(due, due) - dot(v, v)) - fell
    kept.lost += others_now - others
