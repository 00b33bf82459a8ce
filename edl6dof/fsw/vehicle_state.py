"""What the flight computer believes of its own vehicle: configuration, mass, trim wing and engine, concluded
from the commands it gives itself.
"""

from __future__ import annotations

import numpy as np

from edl6dof.interface.capacities import MAX_ENGINES, MAX_PARTS
from edl6dof.interface.events import CUT_OFF, DEPLOY, EXTEND, IGNITE, JETTISON, LANDING_GEAR
from edl6dof.jit import kernel
from edl6dof.records import FLAG, whole

G0 = 9.80665

VEHICLE_STATE = np.dtype(
    [
        ("configuration", whole(0, 2**MAX_PARTS - 1)),  # parts that are gone, a bit for each
        ("mass", "f8"),  # kg
        ("wing_commanded", FLAG),  # the trim wing was commanded open
        ("wing_time", "f8"),  # s, flight time: when
        ("burning", FLAG, (MAX_ENGINES,)),  # engines that were commanded to start, and not to stop
        ("ignited", FLAG),  # one of them at least
        ("ignition_time", "f8"),  # s, flight time: when its thrust begins
    ],
    align=True,
)


@kernel
def take_off(vehicle, part, state):
    """Believe that a part is gone."""
    before = state.configuration
    state.configuration = before | (1 << part)
    state.mass += vehicle.configuration[state.configuration].mass - vehicle.configuration[before].mass


@kernel
def follow_events(vehicle, mission, t, request, state):
    """What the events requested in this cycle do to the vehicle.

    Args:
        vehicle: believed vehicle.
        mission: ``MISSION`` record: what each event does.
        t: flight time, s.
        request: one flag for each event.
        state: ``VEHICLE_STATE`` record, updated.
    """
    for i in range(mission.n_events):
        if request[i] == 0:
            continue
        event = mission.events[i]
        if event.action == JETTISON:
            take_off(vehicle, event.thing, state)
        elif event.action == DEPLOY:
            if (
                vehicle.pack[event.thing] >= 0
            ):  # the mortar throws the pack off: what it opens to is a body of its own
                take_off(vehicle, vehicle.pack[event.thing], state)
        elif event.action == EXTEND and event.thing != LANDING_GEAR:
            state.wing_commanded = 1
            state.wing_time = t
        elif event.action == IGNITE:
            state.burning[event.thing] = 1
            state.ignition_time = t + event.delay
        elif event.action == CUT_OFF:
            state.burning[event.thing] = 0
    count = 0
    for i in range(vehicle.engine.count):
        count += state.burning[i]
    state.ignited = 1 if count > 0 else 0


@kernel
def share_thrust(engine, thrust, burning, command):
    """Command each engine that burns its share of the thrust (N), in proportion to what it can give.

    Args:
        engine: believed engines.
        thrust: of all together, N.
        burning: one flag for each engine.
        command: thrust of each engine, N, written.
    """
    total = 0.0
    for i in range(engine.count):
        if burning[i] != 0:
            total += engine.full_thrust_of[i]
    for i in range(engine.count):
        full = engine.full_thrust_of[i]
        command[i] = min(thrust * (full / total), full) if burning[i] != 0 else 0.0


@kernel
def count_propellant(vehicle, thrust, command, dt, control_dt, state):
    """Take the propellant of the commanded engine and thruster impulse off the mass.

    Args:
        vehicle: believed vehicle.
        thrust: of the engine while it runs, N.
        command: ``COMMAND`` record: the valve intervals of the present control cycle.
        dt: base cycle, s.
        control_dt: control cycle, s.
        state: ``VEHICLE_STATE`` record, updated.
    """
    used = 0.0
    if state.ignited != 0:
        used = thrust / vehicle.engine.specific_impulse
    for i in range(vehicle.n_thrusters):
        on = command.closes[i] - command.opens[i]
        if on > 0.0:
            jet = vehicle.thrusters[i]
            used += jet.thrust * on / control_dt / jet.specific_impulse
    state.mass -= used * dt / G0
