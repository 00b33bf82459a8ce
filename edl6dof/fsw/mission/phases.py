"""Mission phases and their triggers: parameter models.

A phase names its guidance, its attitude controller and the thruster groups it may fire; it carries events
(deployments) and ends by a trigger.  Triggers look only at navigated quantities, and time windows bound them
on both sides.
"""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from edl6dof.config.base import REQUIRED, Capacity, Key, Params, param, section
from edl6dof.config.dtype import dtype_of
from edl6dof.fsw.control.registry import ControllerName
from edl6dof.fsw.mission.roles import NO_ROLE, Role
from edl6dof.interface.capacities import MAX_PHASES
from edl6dof.interface.events import EventName
from edl6dof.interface.thrusters import THRUSTER_GROUPS, ThrusterGroup

#: Events of a phase.
MAX_EVENTS = 6
NEVER = 1e9

Guidance = Literal["none", "hold_bank", "entry", "powered", "hover", "avoid", "descend"]
GUIDANCE: tuple[Guidance, ...] = get_args(Guidance)
G_NONE, G_HOLD_BANK, G_ENTRY, G_POWERED, G_HOVER, G_AVOID, G_DESCEND = range(len(GUIDANCE))

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
]
QUANTITIES: tuple[Quantity, ...] = get_args(Quantity)
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
) = range(len(QUANTITIES))


class Trigger(Params):
    """A condition on one navigated quantity, in SI units, inside a time window of the phase."""

    quantity: Quantity = param(REQUIRED, "navigated quantity that is watched")
    goes: Literal["below", "above"] = param(REQUIRED, "which side of the value fires the trigger")
    value: float = param(REQUIRED, "threshold, in the quantity's own unit")
    earliest_s: float = param(0.0, "phase time before which the trigger cannot fire", ge=0.0)
    latest_s: float = param(NEVER, "phase time at which it fires whatever the quantity", gt=0.0)


class Event(Params):
    """Something that is done once inside a phase."""

    do: EventName = param(REQUIRED, "what is commanded")
    when: Trigger = section("condition")


class Phase(Params):
    """One mission phase."""

    name: Key = param(REQUIRED, "name shown in events and telemetry", record=False)
    role: Role = param(
        NO_ROLE, "what the phase is for: figures, reports and studies look for it", record=False
    )
    guidance: Guidance = param("none", "guidance of the phase")
    control: ControllerName = param("off", "attitude controller of the phase")
    thrusters: Annotated[list[ThrusterGroup], Capacity(len(THRUSTER_GROUPS))] = param(
        None, "thruster groups that may fire for attitude", factory=list, max_length=len(THRUSTER_GROUPS)
    )
    bandwidth: float = param(
        1.0,
        ("bandwidth of the attitude loop in this phase over that of the controller's gains"),
        gt=0.0,
        le=3.0,
    )
    events: Annotated[list[Event], Capacity(MAX_EVENTS)] = param(
        None, "events inside the phase", factory=list, max_length=MAX_EVENTS
    )
    until: Trigger | None = param(None, "trigger that ends the phase; none for the last")


class MissionParams(Params):
    """The phase table; an empty one flies without flight software."""

    goal: Literal["landing", "deployment", "time"] = param(
        "landing",
        (
            "what counts as success: a landing within limits, the mortar fired within limits, or a flight "
            "up to simulation.time_limit_s"
        ),
        record=False,
    )
    phases: Annotated[list[Phase], Capacity(MAX_PHASES)] = param(
        None, "phases in order", factory=list, max_length=MAX_PHASES
    )


MISSION = dtype_of(MissionParams)
