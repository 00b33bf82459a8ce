"""The compiled sequencer: requests events and changes phase when triggers fire.

It belongs to the flight software: it looks only at navigated quantities and never sees the truth.
"""

from __future__ import annotations

import numpy as np

from edl6dof.fsw.mission.phases import (
    MAX_EVENTS,
    Q_ALTITUDE,
    Q_DESCENT_RATE,
    Q_DRAG,
    Q_DYNAMIC_PRESSURE,
    Q_HEIGHT,
    Q_MACH,
    Q_PHASE_TIME,
    Q_SPEED,
    Q_TIME,
    Q_TIME_TO_GO,
)
from edl6dof.interface.capacities import MAX_PHASES
from edl6dof.jit import kernel
from edl6dof.records import FLAG, TIME_IF_EVER, whole

SEQUENCE = np.dtype(
    [
        ("phase", whole(0, MAX_PHASES - 1, of="phases")),
        ("phase_start", "f8"),  # s, flight time
        ("event_done", FLAG, (MAX_EVENTS,)),
        ("entered", TIME_IF_EVER, (MAX_PHASES,)),  # s, flight time at which each phase began
    ],
    align=True,
)


@kernel
def watched(quantity, nav, guide, elapsed):
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
    return 1.0 if nav.footpad_contact != 0 else 0.0


@kernel
def fires(trigger, nav, guide, elapsed):
    """Whether a trigger fires ``elapsed`` seconds into its phase."""
    if elapsed < trigger.earliest - 1e-9:
        return False
    if elapsed >= trigger.latest:
        return True
    value = watched(trigger.quantity, nav, guide, elapsed)
    if trigger.goes == 0:
        return value < trigger.value
    return value > trigger.value


@kernel
def sequence(mission, nav, guide, memory, request):
    """Advance the phase table: request events whose triggers fire, and change phase.

    Args:
        mission: ``MISSION`` record.
        nav: navigation record.
        guide: guidance record (time to go).
        memory: ``SEQUENCE`` record, updated.
        request: written, one flag for each event name.
    """
    if mission.n_phases == 0:
        return
    elapsed = nav.t - memory.phase_start
    phase = mission.phases[memory.phase]
    for i in range(phase.n_events):
        if memory.event_done[i] == 0 and fires(phase.events[i].when, nav, guide, elapsed):
            memory.event_done[i] = 1
            request[phase.events[i].do] = 1
    if memory.phase + 1 < mission.n_phases and fires(phase.until, nav, guide, elapsed):
        memory.phase += 1
        memory.phase_start = nav.t
        memory.entered[memory.phase] = nav.t
        for i in range(MAX_EVENTS):
            memory.event_done[i] = 0
