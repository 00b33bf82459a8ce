"""Mission phases and their triggers: parameter models and the compiled sequencer.

A phase names its guidance, its attitude controller and the thruster groups it may fire; it carries events (deployments) and ends by a
trigger.  Triggers look only at navigated quantities, and time windows bound them on both sides.  The sequencer belongs to the flight
software: it never sees the truth.
"""

from __future__ import annotations

from typing import Annotated, Literal

from edl6dof.config.base import REQUIRED, Capacity, Key, Params, param, section
from edl6dof.config.dtype import dtype_of
from edl6dof.fsw.control.registry import CONTROLLERS
from edl6dof.jit import kernel
from edl6dof.mission.roles import NO_ROLE, ROLES
from edl6dof.records import FLAG, TIME_IF_EVER, whole

MAX_PHASES = 16
MAX_EVENTS = 6
NEVER = 1e9

GUIDANCE = ("none", "hold_bank", "entry", "powered", "hover", "avoid", "descend")
G_NONE, G_HOLD_BANK, G_ENTRY, G_POWERED, G_HOVER, G_AVOID, G_DESCEND = range(7)

EVENT_NAMES = ("trim_wing", "mortar", "heat_shield", "landing_legs", "backshell", "ignition", "cut_off")

(
    Q_TIME,
    Q_PHASE_TIME,
    Q_MACH,
    Q_SPEED,
    Q_HEIGHT,
    Q_ALTITUDE,
    Q_DRAG,
    Q_DYNAMIC_PRESSURE,
    Q_DESCENT_RATE,
    Q_TIME_TO_GO,
    Q_CONTACT,
) = range(11)


class Trigger(Params):
    """A condition on one navigated quantity, in SI units, inside a time window of the phase."""

    quantity: Literal[
        "time_s",
        "phase_time_s",
        "mach",
        "speed_m_s",
        "height_m",
        "altitude_m",
        "drag_m_s2",
        "dynamic_pressure_pa",
        "descent_rate_m_s",
        "time_to_go_s",
        "footpad_contact",
    ] = param(REQUIRED, "navigated quantity that is watched")
    goes: Literal["below", "above"] = param(REQUIRED, "which side of the value fires the trigger")
    value: float = param(REQUIRED, "threshold, in the quantity's own unit")
    earliest_s: float = param(0.0, "phase time before which the trigger cannot fire", ge=0.0)
    latest_s: float = param(NEVER, "phase time at which it fires whatever the quantity", gt=0.0)


class Event(Params):
    """Something that is done once inside a phase."""

    do: Literal["trim_wing", "mortar", "heat_shield", "landing_legs", "backshell", "ignition", "cut_off"] = param(
        REQUIRED, "what is commanded"
    )
    when: Trigger = section("condition")


class Phase(Params):
    """One mission phase."""

    name: Key = param(REQUIRED, "name shown in events and telemetry", record=False)
    role: Literal[ROLES] = param(NO_ROLE, "what the phase is for: figures, reports and studies look for it", record=False)
    guidance: Literal["none", "hold_bank", "entry", "powered", "hover", "avoid", "descend"] = param("none", "guidance of the phase")
    control: Literal[CONTROLLERS.names] = param("off", "attitude controller of the phase")
    thrusters: Annotated[list[Literal["horizontal", "axial", "attitude", "fine"]], Capacity(4)] = param(
        None, "thruster groups that may fire for attitude", factory=list, max_length=4
    )
    bandwidth: float = param(1.0, "bandwidth of the attitude loop in this phase over that of the controller's gains", gt=0.0, le=3.0)
    events: Annotated[list[Event], Capacity(MAX_EVENTS)] = param(None, "events inside the phase", factory=list, max_length=MAX_EVENTS)
    until: Trigger | None = param(None, "trigger that ends the phase; none for the last")


class MissionParams(Params):
    """The phase table; an empty one flies without flight software."""

    goal: Literal["landing", "deployment", "time"] = param(
        "landing",
        "what counts as success: a landing within limits, the mortar fired within limits, or a flight up to simulation.time_limit_s",
        record=False,
    )
    phases: Annotated[list[Phase], Capacity(MAX_PHASES)] = param(None, "phases in order", factory=list, max_length=MAX_PHASES)


MISSION = dtype_of(MissionParams)


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
def sequence(mission, nav, guide, fsw, request):
    """Advance the phase table: request events whose triggers fire, and change phase.

    Args:
        mission: ``MISSION`` record.
        nav: navigation record.
        guide: guidance record (time to go).
        fsw: flight-software memory: ``phase``, ``phase_start``, ``event_done`` are updated.
        request: written, one flag for each event name.
    """
    if mission.n_phases == 0:
        return
    elapsed = nav.t - fsw.phase_start
    phase = mission.phases[fsw.phase]
    for i in range(phase.n_events):
        if fsw.event_done[i] == 0 and fires(phase.events[i].when, nav, guide, elapsed):
            fsw.event_done[i] = 1
            request[phase.events[i].do] = 1
    if fsw.phase + 1 < mission.n_phases and fires(phase.until, nav, guide, elapsed):
        fsw.phase += 1
        fsw.phase_start = nav.t
        fsw.entered[fsw.phase] = nav.t
        for i in range(MAX_EVENTS):
            fsw.event_done[i] = 0


#: Fields of the flight-software memory that the sequencer owns.
PHASE_MEMORY = [
    ("phase", whole(0, MAX_PHASES - 1, of="phases")),
    ("phase_start", "f8"),
    ("event_done", FLAG, (MAX_EVENTS,)),
    ("entered", TIME_IF_EVER, (MAX_PHASES,)),
]
