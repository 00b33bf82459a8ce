"""Events of the mission by number: the names of things turned into indices, for both sides alike."""

from __future__ import annotations

import numpy as np

from edl6dof.config.dtype import fill
from edl6dof.fsw.mission.phases import Event, MissionParams
from edl6dof.interface.capacities import MAX_EVENTS
from edl6dof.interface.events import ACTIONS, LANDING_GEAR
from edl6dof.vehicle.vehicle import VehicleParams


def things(vehicle: VehicleParams, action: str) -> dict[str, int]:
    """Index by name of what an action can be done to."""
    if action == "jettison":
        return {part.name: index for index, part in enumerate(vehicle.parts)}
    if action in ("deploy", "release"):
        return {chute.name: index for index, chute in enumerate(vehicle.parachutes)}
    if action == "extend":
        surfaces = {surface.name: index for index, surface in enumerate(vehicle.surfaces)}
        return surfaces | {"landing_gear": LANDING_GEAR}
    return {engine.name: index for index, engine in enumerate(vehicle.engines)}


def event_problems(mission: MissionParams, vehicle: VehicleParams) -> dict[str, str]:
    """Things that do not exist, names with two meanings and events too many, by dotted key."""
    problems: dict[str, str] = {}
    numbered = mission.events
    for i, phase in enumerate(mission.phases):
        for k, event in enumerate(phase.events):
            here = f"mission.phases.{i}.events.{k}"
            known = things(vehicle, event.action)
            if event.thing not in known:
                words = ", ".join(known) or "none"
                problems[f"{here}.thing"] = (
                    f"nothing to {event.action.replace('_', ' ')} named {event.thing!r}; names: {words}"
                )
            if _meaning(event) != _meaning(numbered[event.name]):
                problems[f"{here}.name"] = f"another event is named {event.name!r} and does something else"
    if len(numbered) > MAX_EVENTS:
        problems["mission.phases"] = f"at most {MAX_EVENTS} events in all (got {len(numbered)})"
    return problems


def fill_events(record: np.void, mission: MissionParams, vehicle: VehicleParams) -> None:
    """Fill the fields of an ``EVENT_TABLE`` record with checked events."""
    numbered = mission.events
    record["n_events"] = len(numbered)
    for slot, event in zip(record["events"], numbered.values(), strict=False):
        slot["action"] = ACTIONS.index(event.action)
        slot["thing"] = things(vehicle, event.action)[event.thing]
        slot["delay"] = event.delay_s


def fill_mission(record: np.void, mission: MissionParams, vehicle: VehicleParams) -> None:
    """Fill a ``MISSION`` record with a checked mission: the phases, and the numbers of their events."""
    fill(record, mission)
    fill_events(record, mission, vehicle)
    numbers = {name: number for number, name in enumerate(mission.events)}
    for row, phase in zip(record["number"], mission.phases, strict=False):
        row[: len(phase.events)] = [numbers[event.name] for event in phase.events]


def _meaning(event: Event) -> tuple[str, str, float]:
    return event.action, event.thing, event.delay_s
