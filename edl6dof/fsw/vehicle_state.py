"""State of the vehicle as the flight computer believes it: configuration, mass, trim wing and engine, derived
from its own commands; and the thrusters that may be used.
"""

from __future__ import annotations

from edl6dof.config.units import G0
from edl6dof.interface.capacities import MAX_ENGINES, MAX_EVENTS, MAX_PARTS, MAX_THRUSTERS
from edl6dof.interface.effectors import CUT_OFF, DEPLOY, EXTEND, IGNITE, JETTISON, LANDING_GEAR, is_done_to
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record, whole

#: Health of the thrusters as far as the flight computer knows.
HEALTH = record(
    ("thruster", FLAG, (MAX_THRUSTERS,)),  # whether each may be used: 0 once it is found to have failed
    ("loss", "f8", (MAX_THRUSTERS,)),  # share of its thrust that each in use has lost
)

#: Ability of one engine, or of all burning engines together.
ENGINE_ABILITY = record(
    ("full_thrust", "f8"),  # N: at the full level
    ("throttle_min", "f8"),  # N: lower end of the throttle band
    ("throttle_max", "f8"),  # N: upper end of the throttle band
    ("specific_impulse", "f8"),  # s: at full thrust
    ("by_thrusters", "f8"),  # share of the thrust that the axial thrusters give
    ("axial", "f8"),  # share of the thrust along -x of B, to which all other fields refer; 1 of all together
)

VEHICLE_STATE = record(
    ("requested", FLAG, (MAX_EVENTS,)),  # events that have been requested
    ("configuration", whole(0, 2**MAX_PARTS - 1)),  # separated parts, a bit for each
    ("mass", "f8"),  # kg: believed
    ("wing_commanded", FLAG),  # the trim wing was commanded open
    ("wing_time", "f8"),  # s: flight time of that command
    ("burning", FLAG, (MAX_ENGINES,)),  # engines that were commanded to start, and not to stop
    ("ignited", FLAG),  # at least one engine burns
    ("thrust_lost", "f8"),  # share of the commanded thrust that is lost, as estimated
    ("held_thrust", "f8"),  # N: thrust of a throttle that is believed stuck; 0: none
    ("force_angle", "f8"),  # rad: angle between the unexplained force and -x of B, smoothed
    ("engine", ENGINE_ABILITY),  # ability of all burning engines, less the believed loss
    ("ignition_time", "f8"),  # s: flight time at which the thrust of the engine begins
)


@kernel
def take_off(vehicle, part, state):
    """Remove a part from the believed vehicle."""
    before = state.configuration
    state.configuration = before | (1 << part)
    state.mass += vehicle.configuration[state.configuration].mass - vehicle.configuration[before].mass


@kernel
def follow_events(vehicle, mission, t, request, state):
    """Apply the events requested in this cycle (``request``: a flag for each) to the believed vehicle."""
    for i in range(mission.n_events):
        if request[i] == 0:
            continue
        state.requested[i] = 1
        event = mission.events[i]
        if event.action == JETTISON:
            take_off(vehicle, event.component, state)
        elif event.action == DEPLOY:
            if (
                vehicle.pack[event.component] >= 0
            ):  # the mortar ejects the pack; the open canopy is a separate body
                take_off(vehicle, vehicle.pack[event.component], state)
        elif event.action == EXTEND and event.component != LANDING_GEAR:
            state.wing_commanded = 1
            state.wing_time = t
        elif event.action == IGNITE or event.action == CUT_OFF:
            for k in range(vehicle.n_engines):
                if is_done_to(event, k):
                    state.burning[k] = 1 if event.action == IGNITE else 0
            if event.action == IGNITE:
                state.ignition_time = t + event.delay
    take_together(vehicle.engines, vehicle.n_engines, state)


@kernel
def take_together(engines, count, state):
    """Sum up thrust and throttle band of the burning engines, of ``count``, less the believed loss of thrust;
    the specific impulse is that of their total propellant flow.
    """
    full = low = high = flow = by_thrusters = 0.0
    left = 1.0 - state.thrust_lost
    for i in range(count):
        if state.burning[i] != 0:
            one = engines[i]
            full += one.full_thrust
            low += one.throttle_min
            high += one.throttle_max
            flow += one.full_thrust / one.specific_impulse
            by_thrusters += one.by_thrusters * one.full_thrust
    state.ignited = 1 if full > 0.0 else 0
    state.engine.full_thrust = left * full
    state.engine.throttle_min, state.engine.throttle_max = left * low, left * high
    state.engine.specific_impulse = full / flow if full > 0.0 else 0.0
    state.engine.by_thrusters = by_thrusters / full if full > 0.0 else 0.0
    state.engine.axial = 1.0


@kernel
def share_thrust(vehicle, thrust, state, command):
    """Distribute the ``thrust`` (N, total along the axis) over the burning engines in proportion to their
    full thrust, into ``command`` (N); an oblique engine gets more by the inverse of its axial share.
    """
    for i in range(vehicle.n_engines):
        full = vehicle.engines[i].full_thrust
        command[i] = 0.0
        if state.burning[i] != 0:
            command[i] = min(thrust * (full / state.engine.full_thrust), full) / vehicle.engines[i].axial


@kernel
def count_propellant(vehicle, thrust, valves, dt, control_dt, state):
    """Subtract the propellant of the commanded engine and thruster impulse from the mass.

    Args:
        vehicle: believed vehicle.
        thrust: commanded engine thrust, N.
        valves: ``MODULATION`` record: the valve intervals of the present control cycle.
        dt, control_dt: base cycle and control cycle, s.
        state: ``VEHICLE_STATE`` record, updated.
    """
    used = 0.0
    if state.ignited != 0:
        used = thrust * (1.0 - state.engine.by_thrusters) / state.engine.specific_impulse
    for i in range(vehicle.n_thrusters):
        on = valves.close_time[i] - valves.open_time[i]
        if on > 0.0:
            jet = vehicle.thrusters[i]
            used += jet.thrust * on / control_dt / jet.specific_impulse
    state.mass -= used * dt / G0
