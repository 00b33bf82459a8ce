"""Parts that have left the vehicle: point masses falling with drag, until they reach the ground."""

from __future__ import annotations

from edl6dof.environment.gravity import central
from edl6dof.jit import kernel
from edl6dof.spatial.elementary import sincos
from edl6dof.spatial.frames import rotate_z
from edl6dof.spatial.vector import add, norm, put3, scale, sub, take3
from edl6dof.vehicle.surroundings import noncentral_I, planet_rotation, surroundings

LOOSE, RESTING, FALLING = 1, 2, 3


@kernel
def fall(case, tables, areoid, part, t, r_I, v_I):
    """Acceleration (I) of a falling part, and its altitude; ``areoid``: as :func:`surroundings` takes it."""
    rotation = planet_rotation(case.planet, t)
    place, gas, _, air_I = surroundings(case, tables, areoid, rotation, r_I)
    g_I = add(central(case.planet.gravity, r_I), noncentral_I(case.planet, rotation, r_I))
    v = sub(v_I, air_I)
    return add(g_I, scale(-0.5 * gas[0] * norm(v) * part.drag_area / part.mass, v)), place[4]


@kernel
def step_part(case, tables, inputs, part, t, h):
    """Advance one part by ``h`` s over the areoid and the ground of ``inputs``; on the ground it rests and
    turns with the planet.

    Beeman's position and the second-order Adams-Bashforth velocity need one evaluation a step: nothing flies
    on what debris does, and over its whole fall the error stays below a centimetre.
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
