"""What the flight computer concludes from its own commands: which parts are gone, and so its mass; wing and
engine.
"""

from __future__ import annotations

from edl6dof.interface.engine import ENGINE_FULL, ENGINE_OFF
from edl6dof.interface.events import CUT_OFF, DEPLOY, EXTEND, IGNITE, JETTISON, LANDING_GEAR
from edl6dof.jit import kernel


@kernel
def take_off(vehicle, part, fsw):
    """Believe that a part is gone."""
    before = fsw.configuration
    fsw.configuration = before | (1 << part) | fsw.packs
    fsw.packs = 0
    fsw.mass += vehicle.configuration[fsw.configuration].mass - vehicle.configuration[before].mass


@kernel
def any_burning(fsw):
    """Whether an engine is on."""
    count = 0
    for i in range(fsw.burning.shape[0]):
        count += fsw.burning[i]
    return count > 0


@kernel
def share_thrust(engine, fsw):
    """Command each engine that is on its share of the thrust, in proportion to what it can give."""
    total = 0.0
    for i in range(engine.count):
        if fsw.burning[i] != 0:
            total += engine.full_thrust_of[i]
    for i in range(engine.count):
        full = engine.full_thrust_of[i]
        fsw.command.thrust[i] = min(fsw.guide.thrust * (full / total), full) if fsw.burning[i] != 0 else 0.0


@kernel
def note_requests(onboard, nav, fsw):
    """Conclude from every event requested in this cycle."""
    vehicle, mission = onboard.vehicle, onboard.mission
    for i in range(mission.n_events):
        if fsw.command.request[i] == 0:
            continue
        event = mission.events[i]
        if event.action == JETTISON:
            take_off(vehicle, event.thing, fsw)
        elif event.action == DEPLOY:
            if vehicle.pack[event.thing] >= 0:
                fsw.packs |= 1 << vehicle.pack[event.thing]
        elif event.action == EXTEND and event.thing != LANDING_GEAR:
            fsw.wing_out = 1
            fsw.wing_time = nav.t
        elif event.action == IGNITE:
            fsw.ignited = fsw.burning[event.thing] = 1
            fsw.ignition_time = nav.t + event.delay
            fsw.guide.engine_mode = ENGINE_FULL
            fsw.guide.thrust = vehicle.engine.full_thrust
        elif event.action == CUT_OFF:
            fsw.burning[event.thing] = 0
            if not any_burning(fsw):
                fsw.ignited = 0
                fsw.guide.engine_mode = ENGINE_OFF
                fsw.guide.thrust = 0.0
