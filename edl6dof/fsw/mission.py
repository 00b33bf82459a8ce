"""The mission as a table of phases and triggers, and the sequencer, which requests events and changes phases.

A phase names its guidance, its attitude controller and the thruster groups that may fire; it contains events
(such as deployments) and ends by a transition. The sequencer uses only navigated quantities, predictions of
guidance and past commands, never the truth; time windows bound the triggers on both sides.
"""

from __future__ import annotations

from math import degrees
from typing import Annotated, Any, Literal, get_args

from pydantic import field_validator

from edl6dof.config.base import REQUIRED, Capacity, Key, Params, param, section, stated
from edl6dof.config.dtype import dtype_of
from edl6dof.fsw.control.registry import ControllerName
from edl6dof.interface.capacities import (
    MAX_CONDITIONS,
    MAX_EVENTS,
    MAX_PHASE_EVENTS,
    MAX_PHASES,
    MAX_TRANSITIONS,
)
from edl6dof.interface.effectors import EVENT_TABLE, THRUSTER_GROUPS, Action, ThrusterGroup
from edl6dof.interface.roles import NO_ROLE, Role
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, TIME_IF_EVER, record, whole

NEVER = 1e9

Guidance = Literal["none", "hold_bank", "entry", "powered", "hover", "avoid", "descend", "held_thrust"]
GUIDANCE: tuple[Guidance, ...] = get_args(Guidance)
G_NONE, G_HOLD_BANK, G_ENTRY, G_POWERED, G_HOVER, G_AVOID, G_DESCEND, G_HELD_THRUST = range(len(GUIDANCE))

#: Quantities of triggers; :func:`watched` returns their values.
Quantity = Literal[
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
    "wing_open",
    "wing_time_s",  # time since the trim wing was commanded; 0 before
    "total_alpha_deg",  # angle between the body axis and the flow in the expected wind
    "force_angle_deg",  # angle between the body axis and the unexplained force, smoothed
    "downrange_to_go_m",  # along the course until the aim point of entry guidance lies abeam; negative beyond
    "spot_chosen",  # hazard detection has chosen the spot to land on
    "held_thrust_n",  # thrust of a throttle that is believed stuck; 0: none
    "stop_height_m",  # height of rest with a stuck throttle, if it burns from now on
]


class Condition(Params):
    """A condition on one navigated quantity."""

    quantity: Quantity = param(REQUIRED, "navigated quantity that is watched")
    crosses: Literal["below", "above"] = param(
        REQUIRED, "side of the value on which the condition is true; no crossing is needed"
    )
    value: float = param(REQUIRED, "threshold, in the quantity's own unit")


class Trigger(Condition):
    """A condition inside a time window of the phase."""

    earliest_s: float = param(0.0, "phase time before which the trigger cannot fire", ge=0.0)
    latest_s: float = param(
        NEVER,
        "phase time at which it fires for any value of the quantity",
        gt=0.0,
        usual=(0, 1e9, "a time after the start of a phase"),
    )


#: Common words for events that are no action, and the equivalent to write.
SAID_OTHERWISE = {
    "eject": "jettison, which throws a part off at its separation_velocity_m_s, or deploy, which fires a "
    "parachute's pack at its mortar_speed_m_s",
    "arm": "the 'thrusters' of a phase, the groups that may fire for attitude in it, the ignite of an "
    "engine, or the 'when' with earliest_s of the event that is to wait",
}


class Event(Params):
    """An action that is done once inside a phase; two phases may contain the same event, as on alternative
    branches.
    """

    name: Key = param(REQUIRED, "name in timeline, figures and telemetry", record=False)
    action: Action = param(REQUIRED, "action of the event", record=False)
    component: Key = param(
        REQUIRED,
        "part, parachute, engine or surface of the vehicle that the event acts on, or landing_gear",
        record=False,
    )
    delay_s: float = param(
        0.0, "time from command to action", status="estimate", record=False, ge=0.0, le=60.0
    )
    when: Trigger = section("condition")

    @field_validator("action", mode="before")
    @classmethod
    def _said_otherwise(cls, value: Any) -> Any:
        if isinstance(value, str) and value in SAID_OTHERWISE:
            raise ValueError(f"{value!r} is no action of its own: write {SAID_OTHERWISE[value]}")
        return value


class Transition(Params):
    """One way in which a phase ends: conditions inside a time window of the phase, and the phase that
    follows.
    """

    when: Annotated[list[Condition], Capacity(MAX_CONDITIONS)] = param(
        REQUIRED, "conditions", min_length=1, max_length=MAX_CONDITIONS
    )
    join: Literal["all", "any"] = param("all", "whether all conditions must hold, or any")
    earliest_s: float = param(0.0, "phase time before which it is not taken", ge=0.0)
    latest_s: float = param(NEVER, "phase time at which it is taken in any case", gt=0.0)
    next: Key | None = param(None, "phase that follows; none: the next in the list", record=False)


class Phase(Params):
    """One mission phase.  Its transitions are tried in their order, then ``until``."""

    name: Key = param(REQUIRED, "name shown in events and telemetry", record=False)
    role: Role = param(
        NO_ROLE, "purpose of the phase, by which figures, reports and studies find it", record=False
    )
    guidance: Guidance = param("none", "guidance of the phase")
    control: ControllerName = param("off", "attitude controller of the phase")
    thrusters: Annotated[list[ThrusterGroup], Capacity(len(THRUSTER_GROUPS))] = param(
        None, "thruster groups that may fire for attitude", factory=list, max_length=len(THRUSTER_GROUPS)
    )
    hold_alpha: bool = param(
        False, "whether bank_to_steer holds the angle of attack by thrusters instead of the aerodynamic trim"
    )
    bandwidth: float = param(
        1.0, "bandwidth of thrust_vector in this phase, over that of its gains", gt=0.0, le=3.0
    )
    events: Annotated[list[Event], Capacity(MAX_PHASE_EVENTS)] = param(
        None, "events inside the phase", factory=list, max_length=MAX_PHASE_EVENTS
    )
    transitions: Annotated[list[Transition], Capacity(MAX_TRANSITIONS)] = param(
        None, "ways in which the phase may end, and the phase that follows each", factory=list
    )
    until: Trigger | None = param(
        None, "short form of a last transition with one condition, to the next phase", record=False
    )

    @property
    def exits(self) -> list[Transition]:
        """All transitions in the order in which they are tried."""
        if self.until is None:
            return self.transitions
        until = self.until
        when = Condition.model_construct(**{name: getattr(until, name) for name in Condition.model_fields})
        way = Transition.model_construct(when=[when], earliest_s=until.earliest_s, latest_s=until.latest_s)
        return [*self.transitions, way]


class MissionParams(Params):
    """The phase table; with an empty table only navigation runs."""

    goal: Literal["landing", "deployment", "event", "time"] = param(
        "landing",
        (
            "criterion of success: a landing within limits, the mortar fired within limits, the event of "
            "goal_event within limits, or a flight up to simulation.time_limit_s"
        ),
        record=False,
    )
    goal_event: Key | None = param(None, "event with which a flight of goal event ends", record=False)
    phases: Annotated[list[Phase], Capacity(MAX_PHASES)] = param(
        None, "phases in order", factory=list, max_length=MAX_PHASES
    )

    @property
    def exits(self) -> list[list[Transition]]:
        """Transitions of each phase; of the last phase without ``until``."""
        return [
            *(phase.exits for phase in self.phases[:-1]),
            *(phase.transitions for phase in self.phases[-1:]),
        ]

    @property
    def last_events(self) -> set[str]:
        """Names of the events that end the flight."""
        if self.goal == "event":
            return {stated(self.goal_event)}
        deploying = self.goal == "deployment"
        return {name for name, event in self.events.items() if deploying and event.action == "deploy"}

    @property
    def events(self) -> dict[str, Event]:
        """Events by name, in the order of their numbers: that of their first occurrence in the phases."""
        found: dict[str, Event] = {}
        for phase in self.phases:
            for event in phase.events:
                found.setdefault(event.name, event)
        return found


_TABLE = dtype_of(MissionParams)
MISSION = record(
    *[(name, _TABLE[name]) for name in stated(_TABLE.names)],
    ("number", "i8", (MAX_PHASES, MAX_PHASE_EVENTS)),  # of each event of a phase, in the event table
    ("follows", "i8", (MAX_PHASES, MAX_TRANSITIONS)),  # index of the phase after each transition
    *[(name, EVENT_TABLE[name]) for name in stated(EVENT_TABLE.names)],
)


SEQUENCE = record(
    ("phase", whole(0, MAX_PHASES - 1, of="phases")),
    ("phase_start", "f8"),  # s, flight time
    ("event_done", FLAG, (MAX_EVENTS,)),  # the event has been requested
    ("entered", TIME_IF_EVER, (MAX_PHASES,)),  # s, flight time at which each phase began
)

#: Index of ``all`` among the choices of ``join``.
JOIN_ALL = 0


@kernel
def watched(quantity, nav, vehicle, guide, elapsed):
    """Present value of the trigger quantity with this index in ``Quantity``; ``elapsed``: phase time, s."""
    values = (
        nav.t,
        elapsed,
        nav.mach,
        nav.speed,
        nav.height,
        nav.altitude,
        nav.drag,
        nav.dynamic_pressure,
        nav.v_N[2],
        guide.time_to_go,
        float(nav.footpad_contact),
        float(nav.wing_open),
        nav.t - vehicle.wing_time if vehicle.wing_commanded != 0 else 0.0,
        degrees(nav.total_alpha),
        degrees(vehicle.force_angle),
        guide.downrange_to_go,
        float(guide.spot_chosen),
        vehicle.held_thrust,
        guide.stop_height,
    )
    return values[quantity]


@kernel
def holds(condition, nav, vehicle, guide, elapsed):
    """Return whether a condition is true; ``elapsed``: phase time, s."""
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
    """Begin a phase at flight time ``t`` (s)."""
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
