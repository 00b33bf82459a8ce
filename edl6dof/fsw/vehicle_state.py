"""What the flight computer believes of its own vehicle: configuration, mass, trim wing and engine, concluded
from the commands it gives itself.
"""

from __future__ import annotations

import numpy as np

from edl6dof.interface.events import BACKSHELL_OFF, CUT_OFF, HEAT_SHIELD_OFF, IGNITION, TRIM_WING
from edl6dof.interface.parts import ENTRY, LANDER, UNDER_CHUTE
from edl6dof.jit import kernel
from edl6dof.records import FLAG, whole

G0 = 9.80665

VEHICLE_STATE = np.dtype(
    [
        ("configuration", whole(ENTRY, LANDER)),
        ("mass", "f8"),  # kg
        ("wing_commanded", FLAG),  # the trim wing was commanded open
        ("wing_time", "f8"),  # s, flight time: when
        ("ignited", FLAG),  # the engine was commanded to start, and not to stop
        ("ignition_time", "f8"),  # s, flight time: when its thrust begins
    ],
    align=True,
)


@kernel
def follow_events(vehicle, t, request, state):
    """What the events requested in this cycle do to the vehicle.

    Args:
        vehicle: believed vehicle.
        t: flight time, s.
        request: one flag for each event.
        state: ``VEHICLE_STATE`` record, updated.
    """
    if request[TRIM_WING] != 0:
        state.wing_commanded = 1
        state.wing_time = t
    if request[HEAT_SHIELD_OFF] != 0:
        state.configuration = UNDER_CHUTE
        state.mass += vehicle.configuration[UNDER_CHUTE].mass - vehicle.configuration[ENTRY].mass
    if request[BACKSHELL_OFF] != 0:
        state.mass += vehicle.configuration[LANDER].mass - vehicle.configuration[state.configuration].mass
        state.configuration = LANDER
    if request[IGNITION] != 0:
        state.ignited = 1
        state.ignition_time = t + vehicle.engine.ignition_delay
    if request[CUT_OFF] != 0:
        state.ignited = 0


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
