"""Carry out the action of each event on its component, with momentum conserved at every separation, and let
the parts that have left fall: point masses with drag, until they reach the ground.
"""

from __future__ import annotations

from edl6dof.environment.gravity import central
from edl6dof.interface.effectors import (
    CUT_OFF,
    DEPLOY,
    EXTEND,
    IGNITE,
    JETTISON,
    LANDING_GEAR,
    RELEASE,
    is_done_to,
)
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import sincos
from edl6dof.spatial.frames import rotate_z
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import add, cross, inertia_solve, norm, put3, scale, sub, take3
from edl6dof.vehicle.mass import compose
from edl6dof.vehicle.motion.point_mass import POINT_MASS
from edl6dof.vehicle.parachutes.parachute import EXTRACTING, INFLATING, RELEASED, nominal_area
from edl6dof.vehicle.plant import (
    CANOPY_POSITION,
    CANOPY_VELOCITY,
    FALLING,
    LOOSE,
    POSITION,
    RATE,
    RESTING,
    VELOCITY,
    take_attitude,
)
from edl6dof.vehicle.propulsion.feed_system import with_propellant
from edl6dof.vehicle.surroundings import noncentral_I, planet_rotation, surroundings


@kernel
def separate(case, plant, index, velocity):
    """Take part ``index`` off the vehicle and push it at ``velocity`` (m/s, in B) relative to the remaining
    body; momentum is conserved.

    The centre of mass the state refers to jumps to that of the remaining body; both bodies keep the
    rigid-body velocity of their own centre, then share the spring's impulse, which acts through the part's
    centre and turns the remaining body.  The part goes to ``plant.debris[index]``.
    """
    y, vehicle = plant.y, case.vehicle
    part, debris = vehicle.parts[index], plant.debris[index]
    q = take_attitude(y)
    r, v, w = take3(y, POSITION), take3(y, VELOCITY), take3(y, RATE)
    _, old, _ = with_propellant(plant.dry, vehicle.tanks, vehicle.n_tanks, y)
    plant.attached[index] = 0
    compose(case, plant)
    mass, new, inertia = with_propellant(plant.dry, vehicle.tanks, vehicle.n_tanks, y)
    part_arm = sub(take3(part.centre, 0), old)
    remaining_arm = sub(new, old)
    push = from_frame(q, velocity)
    total = mass + part.mass
    v_part = add(add(v, from_frame(q, cross(w, part_arm))), scale(mass / total, push))
    v_remaining = sub(add(v, from_frame(q, cross(w, remaining_arm))), scale(part.mass / total, push))
    impulse = (
        velocity[0] * mass * part.mass / total,
        velocity[1] * mass * part.mass / total,
        velocity[2] * mass * part.mass / total,
    )
    put3(y, RATE, sub(w, inertia_solve(inertia, cross(sub(part_arm, remaining_arm), impulse))))
    debris.active = LOOSE
    debris.mass = part.mass
    debris.drag_area = part.drag_area
    put3(debris.r_I, 0, add(r, from_frame(q, part_arm)))
    put3(debris.v_I, 0, v_part)
    put3(y, POSITION, add(r, from_frame(q, remaining_arm)))
    put3(y, VELOCITY, v_remaining)
    recoil = scale(-part.mass / total, velocity)
    put3(plant.separation_gain, 0, add(take3(plant.separation_gain, 0), recoil))


@kernel
def deploy(case, plant, index):
    """Eject the pack of parachute ``index`` aft as the canopy body; a canopy still attached is released
    first.
    """
    chute, pack = case.vehicle.parachutes[index], case.suspension[index].pack
    if case.dynamics == POINT_MASS or pack < 0 or plant.attached[pack] == 0:
        return
    if plant.canopy == EXTRACTING or plant.canopy == INFLATING:
        release(case, plant, plant.parachute)
    separate(case, plant, pack, (-chute.mortar_speed, 0.0, 0.0))
    thrown = plant.debris[pack]
    thrown.active = 0
    put3(plant.y, CANOPY_POSITION, take3(thrown.r_I, 0))
    put3(plant.y, CANOPY_VELOCITY, take3(thrown.v_I, 0))
    plant.parachute = index
    plant.canopy = EXTRACTING


@kernel
def canopy_area(case, plant):
    """Drag area (m2) of the deployed canopy when it flies without the vehicle."""
    chute, left = case.vehicle.parachutes[plant.parachute], 1.0 - plant.canopy_lost[plant.parachute]
    return nominal_area(chute) * chute.drag_coefficient * chute.drag_factor * left


@kernel
def release(case, plant, index):
    """Release parachute ``index`` if it is the deployed one: its canopy flies on alone."""
    if plant.parachute != index or not (plant.canopy == EXTRACTING or plant.canopy == INFLATING):
        return
    chute, canopy = case.vehicle.parachutes[index], plant.debris[case.suspension[index].pack]
    canopy.active = LOOSE
    canopy.drag_area = canopy_area(case, plant) if plant.canopy == INFLATING else chute.pack_drag_area
    put3(canopy.r_I, 0, take3(plant.y, CANOPY_POSITION))
    put3(canopy.v_I, 0, take3(plant.y, CANOPY_VELOCITY))
    plant.canopy = RELEASED


@kernel
def jettison(case, plant, index):
    """Push a part off; a canopy attached to it leaves with it, or alone if its lines are not yet taut."""
    if plant.attached[index] == 0:
        return
    v, part = case.vehicle.parts[index].separation_velocity, plant.debris[index]
    separate(case, plant, index, (v[0], v[1], v[2]))
    if case.suspension[plant.parachute].carrier != index:
        return
    if plant.canopy == EXTRACTING:
        release(case, plant, plant.parachute)
    elif plant.canopy == INFLATING:
        part.drag_area += canopy_area(case, plant)
        # part and canopy fly on together, with their common momentum
        canopy = case.vehicle.parts[case.suspension[plant.parachute].pack].mass
        share = canopy / (part.mass + canopy)
        v_canopy, v_part = take3(plant.y, CANOPY_VELOCITY), take3(part.v_I, 0)
        put3(part.v_I, 0, add(scale(share, v_canopy), scale(1.0 - share, v_part)))
        part.mass += canopy
    plant.canopy = RELEASED


@kernel
def carry_out(case, plant, number):
    """Change the vehicle as event ``number`` demands, at ``plant.t``."""
    event = case.events.events[number]
    action, component = event.action, event.component
    if action == JETTISON:
        jettison(case, plant, component)
    elif action == DEPLOY:
        deploy(case, plant, component)
    elif action == RELEASE:
        release(case, plant, component)
    elif action == EXTEND:
        if component == LANDING_GEAR:
            plant.legs = 1
        else:
            plant.wing_start[component] = plant.t
    elif action == IGNITE or action == CUT_OFF:
        for i in range(case.vehicle.n_engines):
            if is_done_to(event, i):
                plant.running[i] = 1 if action == IGNITE else 0


@kernel
def fall(case, tables, areoid, part, t, r_I, v_I):
    """Acceleration (I) of a falling part, and its altitude; ``areoid``: as in :func:`surroundings`."""
    rotation = planet_rotation(case.planet, t)
    place, gas, _, air_I = surroundings(case, tables, areoid, rotation, r_I)
    g_I = add(central(case.planet.gravity, r_I), noncentral_I(case.planet, rotation, r_I))
    v = sub(v_I, air_I)
    return add(g_I, scale(-0.5 * gas[0] * norm(v) * part.drag_area / part.mass, v)), place[4]


@kernel
def step_part(case, tables, inputs, part, t, h):
    """Advance one part by ``h`` s over the areoid and the ground of ``inputs``; on the ground it rests and
    turns with the planet.

    Beeman's position and the second-order Adams-Bashforth velocity need one evaluation a step: debris does
    not affect the flight, and the error over its whole fall stays below a centimetre.
    """
    r, v = take3(part.r_I, 0), take3(part.v_I, 0)
    spin = case.planet.rotation_rate
    if part.active == RESTING:
        s, c = sincos(spin * h)
        put3(part.r_I, 0, rotate_z(c, -s, r))
        return
    a, altitude = fall(case, tables, inputs.areoid, part, t, r_I=r, v_I=v)
    if altitude <= inputs.ground_altitude:
        part.active = RESTING
        put3(part.v_I, 0, (-spin * r[1], spin * r[0], 0.0))
        return
    growth = sub(a, take3(part.a_I, 0)) if part.active == FALLING else (0.0, 0.0, 0.0)
    part.active = FALLING
    put3(part.a_I, 0, a)
    put3(part.r_I, 0, add(r, scale(h, add(v, scale(h, add(scale(0.5, a), scale(1.0 / 6.0, growth)))))))
    put3(part.v_I, 0, add(v, scale(h, add(a, scale(0.5, growth)))))


@kernel
def step_debris(case, tables, plant, t, h):
    """Advance every part that has left the vehicle."""
    for i in range(plant.debris.shape[0]):
        if plant.debris[i].active != 0:
            step_part(case, tables, plant.inputs, part=plant.debris[i], t=t, h=h)
