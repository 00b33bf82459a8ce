"""The compiled sequencer: requests events and changes phase when triggers fire.

It belongs to the flight software: it looks only at navigated quantities, at what guidance expects and at what
was commanded, and never sees the truth.
"""

from __future__ import annotations

from math import degrees

from edl6dof.fsw.mission.phases import (
    Q_ALTITUDE,
    Q_DESCENT_RATE,
    Q_DOWNRANGE_TO_GO,
    Q_DRAG,
    Q_DYNAMIC_PRESSURE,
    Q_FORCE_ANGLE,
    Q_HEIGHT,
    Q_HELD_THRUST,
    Q_MACH,
    Q_PHASE_TIME,
    Q_SPEED,
    Q_SPOT_CHOSEN,
    Q_STOP_HEIGHT,
    Q_TIME,
    Q_TIME_TO_GO,
    Q_TOTAL_ALPHA,
    Q_WING_OPEN,
    Q_WING_TIME,
)
from edl6dof.interface.capacities import MAX_EVENTS, MAX_PHASES
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, TIME_IF_EVER, record, whole

SEQUENCE = record(
    ("phase", whole(0, MAX_PHASES - 1, of="phases")),
    ("phase_start", "f8"),  # s, flight time
    ("event_done", FLAG, (MAX_EVENTS,)),  # requested
    ("entered", TIME_IF_EVER, (MAX_PHASES,)),  # s, flight time at which each phase began
)

#: Number of ``all`` among the ways to join conditions.
JOIN_ALL = 0


@kernel
def watched(quantity, nav, vehicle, guide, elapsed):
    """Present value of a trigger quantity."""
    if quantity == Q_TIME:
        return nav.t
    if quantity == Q_PHASE_TIME:
        return elapsed
    if quantity == Q_MACH:
        return nav.mach
    if quantity == Q_SPEED:
        return nav.speed
    if quantity == Q_HEIGHT:
        return nav.height
    if quantity == Q_ALTITUDE:
        return nav.altitude
    if quantity == Q_DRAG:
        return nav.drag
    if quantity == Q_DYNAMIC_PRESSURE:
        return nav.dynamic_pressure
    if quantity == Q_DESCENT_RATE:
        return nav.v_N[2]
    if quantity == Q_TIME_TO_GO:
        return guide.time_to_go
    if quantity == Q_WING_OPEN:
        return 1.0 if nav.wing_open != 0 else 0.0
    if quantity == Q_WING_TIME:
        return nav.t - vehicle.wing_time if vehicle.wing_commanded != 0 else 0.0
    if quantity == Q_TOTAL_ALPHA:
        return degrees(nav.total_alpha)
    if quantity == Q_FORCE_ANGLE:
        return degrees(vehicle.force_angle)
    if quantity == Q_DOWNRANGE_TO_GO:
        return guide.downrange_to_go
    if quantity == Q_SPOT_CHOSEN:
        return 1.0 if guide.spot_chosen != 0 else 0.0
    if quantity == Q_HELD_THRUST:
        return vehicle.held_thrust
    if quantity == Q_STOP_HEIGHT:
        return guide.stop_height
    return 1.0 if nav.footpad_contact != 0 else 0.0


@kernel
def holds(condition, nav, vehicle, guide, elapsed):
    """Return whether a condition holds."""
    value = watched(condition.quantity, nav, vehicle, guide, elapsed)
    if condition.crosses == 0:
        return value < condition.value
    return value > condition.value


@kernel
def fires(trigger, nav, vehicle, guide, elapsed):
    """Return whether a trigger fires ``elapsed`` seconds into its phase."""
    if elapsed < trigger.earliest - 1e-9:
        return False
    if elapsed >= trigger.latest:
        return True
    return holds(trigger, nav, vehicle, guide, elapsed)


@kernel
def is_open(way, nav, vehicle, guide, elapsed):
    """Return whether a transition of a phase is taken ``elapsed`` seconds into it."""
    if elapsed < way.earliest - 1e-9:
        return False
    if elapsed >= way.latest:
        return True
    count = 0
    for i in range(way.n_when):
        if holds(way.when[i], nav, vehicle, guide, elapsed):
            count += 1
    return count == way.n_when if way.join == JOIN_ALL else count > 0


@kernel
def enter(phase, t, memory):
    """Begin a phase."""
    memory.phase = phase
    memory.phase_start = t
    memory.entered[phase] = t


@kernel
def sequence(mission, nav, vehicle, guide, memory, request):
    """Advance the phase table: request events whose triggers fire, and change phase.

    Args:
        mission: ``MISSION`` record.
        nav: navigation record.
        vehicle: ``VEHICLE_STATE`` record (trim wing, thrust of a stuck throttle, force angle).
        guide: guidance record (time and downrange to go, spot chosen, height of the stop).
        memory: ``SEQUENCE`` record, updated.
        request: written, one flag for each event of the mission.
    """
    if mission.n_phases == 0:
        return
    elapsed = nav.t - memory.phase_start
    phase = mission.phases[memory.phase]
    for i in range(phase.n_events):
        number = mission.number[memory.phase, i]
        if memory.event_done[number] == 0 and fires(phase.events[i].when, nav, vehicle, guide, elapsed):
            memory.event_done[number] = request[number] = 1
    for i in range(phase.n_transitions):
        if is_open(phase.transitions[i], nav, vehicle, guide, elapsed):
            enter(mission.follows[memory.phase, i], nav.t, memory)
            return
