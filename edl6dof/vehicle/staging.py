"""What happens at each event: deployments, jettisons and ignition, with momentum conserved at every
separation.
"""

from __future__ import annotations

from edl6dof.config.base import Hardware, param
from edl6dof.config.dtype import dtype_of
from edl6dof.interface.events import (
    BACKSHELL_OFF,
    CUT_OFF,
    HEAT_SHIELD_OFF,
    IGNITION,
    LEGS_OUT,
    MORTAR,
    TRIM_WING,
)
from edl6dof.interface.parts import BACKSHELL, HEAT_SHIELD, PARACHUTE
from edl6dof.jit import kernel
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import add, cross, inertia_solve, put3, scale, sub, take3
from edl6dof.vehicle.debris import LOOSE
from edl6dof.vehicle.mass import compose_dry, with_propellant
from edl6dof.vehicle.parachute import EXTRACTING, INFLATING, RELEASED, nominal_area
from edl6dof.vehicle.plant import (
    ATTITUDE,
    CANOPY_POSITION,
    CANOPY_VELOCITY,
    POSITION,
    PROPELLANT,
    RATE,
    VELOCITY,
)
from edl6dof.vehicle.point_mass import POINT_MASS


class StagingParams(Hardware):
    """Separation springs and pyrotechnic delays."""

    pyro_delay_s: float = param(0.013, "time from command to separation", status="estimate", ge=0.0, le=1.0)
    heat_shield_speed_m_s: float = param(
        1.5, "speed at which springs push the heat shield off, forward", status="estimate", ge=0.0
    )
    heat_shield_drag_area_m2: float = param(
        9.0, "drag area of the falling heat shield", status="estimate", ge=0.0
    )
    backshell_speed_m_s: float = param(
        0.5, "speed at which springs push the backshell off, aft", status="estimate", ge=0.0
    )
    backshell_drag_area_m2: float = param(
        9.0, "drag area of the backshell without its canopy", status="estimate", ge=0.0
    )


STAGING = dtype_of(StagingParams)


@kernel
def separate(case, plant, part, index, speed, debris, drag_area):
    """Take ``part`` off the vehicle and push it along +x of B at ``speed`` relative to what stays; momentum
    is conserved.

    The centre of mass the state refers to jumps to that of the remaining body; both bodies keep the
    rigid-body velocity of their own centre, then share the spring's impulse, which acts along x of B through
    the part's centre and turns what stays behind.

    Args:
        case: true parameters.
        plant: true state.
        part: mass record of the part (mass, centre).
        index: index in ``plant.attached``.
        speed: relative separation speed along +x of B, m/s.
        debris: record that takes the part, or the canopy's; its position and velocity are written.
        drag_area: drag area of the part from now on, m2.
    """
    y = plant.y
    q = (y[ATTITUDE], y[ATTITUDE + 1], y[ATTITUDE + 2], y[ATTITUDE + 3])
    r, v, w = take3(y, POSITION), take3(y, VELOCITY), take3(y, RATE)
    load = case.vehicle.mass.propellant
    _, old, _ = with_propellant(plant.dry, load, y[PROPELLANT])
    plant.attached[index] = 0
    compose_dry(case.vehicle.mass, case.lander, plant.attached, plant.dry)
    mass, new, inertia = with_propellant(plant.dry, load, y[PROPELLANT])
    part_arm = sub(take3(part.centre, 0), old)
    remaining_arm = sub(new, old)
    push = from_frame(q, (speed, 0.0, 0.0))
    total = mass + part.mass
    v_part = add(add(v, from_frame(q, cross(w, part_arm))), scale(mass / total, push))
    v_remaining = sub(add(v, from_frame(q, cross(w, remaining_arm))), scale(part.mass / total, push))
    impulse = (speed * mass * part.mass / total, 0.0, 0.0)
    put3(y, RATE, sub(w, inertia_solve(inertia, cross(sub(part_arm, remaining_arm), impulse))))
    debris.active = LOOSE
    debris.mass = part.mass
    debris.drag_area = drag_area
    put3(debris.r_I, 0, add(r, from_frame(q, part_arm)))
    put3(debris.v_I, 0, v_part)
    put3(y, POSITION, add(r, from_frame(q, remaining_arm)))
    put3(y, VELOCITY, v_remaining)


@kernel
def fire_mortar(case, plant):
    """Eject the parachute pack aft; it becomes the canopy body."""
    chute = case.vehicle.parachute
    pack = plant.debris[1]
    separate(case, plant, case.vehicle.mass.parachute, PARACHUTE, -chute.mortar_speed, pack, 0.0)
    pack.active = 0
    put3(plant.y, CANOPY_POSITION, take3(pack.r_I, 0))
    put3(plant.y, CANOPY_VELOCITY, take3(pack.v_I, 0))
    plant.canopy = EXTRACTING


@kernel
def release_backshell(case, plant):
    """Release the backshell; an open canopy goes with it and decides its drag."""
    staging, chute = case.vehicle.staging, case.vehicle.parachute
    area = staging.backshell_drag_area
    shell = plant.debris[1]
    separate(case, plant, case.vehicle.mass.backshell, BACKSHELL, -staging.backshell_speed, shell, area)
    if plant.canopy == INFLATING:
        shell.drag_area = area + nominal_area(chute) * chute.drag_coefficient * chute.drag_factor
        # shell and canopy go on together: their common momentum
        canopy = case.vehicle.mass.parachute.mass
        share = canopy / (shell.mass + canopy)
        v_canopy, v_shell = take3(plant.y, CANOPY_VELOCITY), take3(shell.v_I, 0)
        put3(shell.v_I, 0, add(scale(share, v_canopy), scale(1.0 - share, v_shell)))
        shell.mass += canopy
    plant.canopy = RELEASED


@kernel
def carry_out(case, plant, event):
    """Change the vehicle as ``event`` demands, at ``plant.t``."""
    if event == TRIM_WING:
        plant.wing_start = plant.t
    elif event == MORTAR:
        if (
            plant.attached[PARACHUTE] != 0
            and case.vehicle.parachute.diameter > 0.0
            and case.dynamics != POINT_MASS
        ):
            fire_mortar(case, plant)
    elif event == HEAT_SHIELD_OFF:
        if plant.attached[HEAT_SHIELD] != 0:
            staging = case.vehicle.staging
            speed, area = staging.heat_shield_speed, staging.heat_shield_drag_area
            separate(case, plant, case.vehicle.mass.heat_shield, HEAT_SHIELD, speed, plant.debris[0], area)
    elif event == LEGS_OUT:
        plant.legs = 1
    elif event == BACKSHELL_OFF:
        if plant.attached[BACKSHELL] != 0:
            release_backshell(case, plant)
    elif event == IGNITION:
        plant.running = 1
    elif event == CUT_OFF:
        plant.running = 0
