"""Events and transitions of the mission by number: names of components and phases as indices."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from edl6dof.config.dtype import fill
from edl6dof.fsw.mission import Condition, Event, MissionParams, Phase, Transition, Trigger
from edl6dof.interface.capacities import MAX_EVENTS, MAX_TRANSITIONS
from edl6dof.interface.effectors import ACTIONS, LANDING_GEAR, group_of
from edl6dof.vehicle.vehicle import VehicleParams

#: Quantities that guidance computes, and the guidance of each; navigation always gives the others.
WORKED_OUT_BY = {
    "downrange_to_go_m": ("hold_bank", "entry"),
    "time_to_go_s": ("powered", "held_thrust"),
    "spot_chosen": ("hover", "avoid", "descend"),
    "stop_height_m": ("held_thrust",),
}


def components(vehicle: VehicleParams, action: str) -> dict[str, int]:
    """Return the components of a vehicle on which an ``action`` of an event can act: index by name."""
    if action == "jettison":
        return {part.name: index for index, part in enumerate(vehicle.parts)}
    if action in ("deploy", "release"):
        return {chute.name: index for index, chute in enumerate(vehicle.parachutes)}
    if action == "extend":
        surfaces = {surface.name: index for index, surface in enumerate(vehicle.surfaces)}
        return surfaces | {"landing_gear": LANDING_GEAR}
    found = {engine.name: index for index, engine in enumerate(vehicle.engines)}
    for group, members in vehicle.engine_groups.items():
        found[group] = group_of(found[name] for name in members)
    return found


def event_number(mission: MissionParams, name: str | None) -> int:
    """Number of an event, counted from one; zero where none is named."""
    return 0 if name is None else 1 + list(mission.events).index(name)


def event_problems(mission: MissionParams, vehicle: VehicleParams) -> Iterator[tuple[str, str]]:
    """Yield key and message for unknown components, names with two meanings and too many events."""
    numbered = mission.events
    for i, phase in enumerate(mission.phases):
        for k, event in enumerate(phase.events):
            here, known = f"mission.phases.{i}.events.{k}", components(vehicle, event.action)
            if event.component not in known:
                what = f"nothing to {event.action.replace('_', ' ')} named {event.component!r}"
                yield f"{here}.component", f"{what}; names: {', '.join(known) or 'none'}"
            if _meaning(event) != _meaning(numbered[event.name]):
                yield f"{here}.name", f"another event is named {event.name!r} and does something else"
    if len(numbered) > MAX_EVENTS:
        yield "mission.phases", f"at most {MAX_EVENTS} events in all (got {len(numbered)})"


def way_problems(mission: MissionParams) -> Iterator[tuple[str, str]]:
    """Yield key and message for missing or dead-end phases, and time windows that end before they begin."""
    names = [phase.name for phase in mission.phases]
    branches = {way.next for phase in mission.phases for way in phase.transitions}
    for i, phase in enumerate(mission.phases):
        here, last = f"mission.phases.{i}", i == len(names) - 1
        if not phase.exits and not last and names[i + 1] not in branches:
            yield here, f"phase {phase.name!r} has no 'until'; only the last may go on for ever"
        if len(phase.exits) > MAX_TRANSITIONS:
            yield f"{here}.transitions", f"at most {MAX_TRANSITIONS} with 'until' (got {len(phase.exits)})"
        for k, way in enumerate(phase.transitions):
            if way.next is None and last:
                message = "the last phase has no next one: name the phase that follows"
                yield f"{here}.transitions.{k}", message
            elif way.next is not None and way.next not in names:
                message = f"no phase named {way.next!r}; names: {', '.join(names)}"
                yield f"{here}.transitions.{k}.next", message
        windows: dict[str, Trigger | Transition] = {
            **{f"events.{k}.when": event.when for k, event in enumerate(phase.events)},
            **{f"transitions.{k}": way for k, way in enumerate(phase.transitions)},
            **({"until": phase.until} if phase.until is not None else {}),
        }
        for below, window in windows.items():
            if window.latest_s < window.earliest_s:
                message = f"must not lie before earliest_s {window.earliest_s:g} (got {window.latest_s:g})"
                yield f"{here}.{below}.latest_s", message


def quantity_problems(mission: MissionParams) -> Iterator[tuple[str, str]]:
    """Yield key and message for quantities that the guidance of a phase does not compute, or not in time."""
    for i, phase in enumerate(mission.phases):
        for below, condition, earliest_s in _conditions(phase):
            here, name = f"mission.phases.{i}.{below}.quantity", condition.quantity
            guidance = WORKED_OUT_BY.get(name, (phase.guidance,))
            if phase.guidance not in guidance:
                by = f"{name} is worked out by guidance {' or '.join(guidance)}"
                yield here, f"{by}, and the phase has {phase.guidance}"
            elif name in WORKED_OUT_BY and i == 0 and earliest_s == 0.0:
                known = f"{name} is not known in the first cycle of the flight"
                yield here, f"{known}: give an earliest_s above 0"


def _conditions(phase: Phase) -> Iterator[tuple[str, Condition, float]]:
    """Every condition of a phase with its dotted key and its earliest time, s."""
    for k, event in enumerate(phase.events):
        yield f"events.{k}.when", event.when, event.when.earliest_s
    for k, way in enumerate(phase.transitions):
        yield from ((f"transitions.{k}.when.{m}", one, way.earliest_s) for m, one in enumerate(way.when))
    if phase.until is not None:
        yield "until", phase.until, phase.until.earliest_s


def fill_events(record: np.void, mission: MissionParams, vehicle: VehicleParams) -> None:
    """Fill the fields of an ``EVENT_TABLE`` record with checked events."""
    numbered = mission.events
    record["n_events"] = len(numbered)
    for slot, event in zip(record["events"], numbered.values(), strict=False):
        slot["action"] = ACTIONS.index(event.action)
        slot["component"] = components(vehicle, event.action)[event.component]
        slot["delay"] = event.delay_s


def fill_mission(record: np.void, mission: MissionParams, vehicle: VehicleParams) -> None:
    """Fill a ``MISSION`` record with a checked mission: the phases, and the numbers of their events."""
    ways = mission.exits
    phases = [
        phase.model_copy(update={"transitions": out}) for phase, out in zip(mission.phases, ways, strict=True)
    ]
    fill(record, mission.model_copy(update={"phases": phases}))
    fill_events(record, mission, vehicle)
    numbers = {name: number for number, name in enumerate(mission.events)}
    for row, phase in zip(record["number"], mission.phases, strict=False):
        row[: len(phase.events)] = [numbers[event.name] for event in phase.events]
    names = [phase.name for phase in mission.phases]
    for index, (row, out) in enumerate(zip(record["follows"], ways, strict=False)):
        follow = [way.next for way in out]
        row[: len(follow)] = [index + 1 if name is None else names.index(name) for name in follow]


def _meaning(event: Event) -> tuple[str, str, float]:
    return event.action, event.component, event.delay_s
