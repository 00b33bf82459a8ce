"""The timeline of a flight: phases, deployments, faults, bank reversals, touchdown, outcome."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import isfinite
from typing import Any

import numpy as np

from edl6dof.fsw.guidance import guidance_command
from edl6dof.fsw.mission import Event, MissionParams
from edl6dof.fsw.navigation.integrity import CHECKS
from edl6dof.interface.roles import NO_ROLE, begun
from edl6dof.telemetry.reversals import reversal_rows
from edl6dof.vehicle.mass import Tank
from edl6dof.vehicle.vehicle import VehicleParams

#: Effect of an action on its component in words; of an extension, the command.
DONE = {
    "jettison": "{} jettisoned",
    "deploy": "{} parachute deployed",
    "release": "{} parachute released",
    "extend": "{} commanded",
    "ignite": "{} engine ignition",
    "cut_off": "{} engine cut-off",
}

#: Milestones by action, and of a jettison by the shape of the part; see :func:`milestone`.
MILESTONES = {"deploy": "mortar", "ignite": "ignition", "cut_off": "cut_off"}
UNCOVERED = {"capsule": "heat_shield", "backshell": "backshell"}
#: Milestone of an event that has no name of its own, such as the jettison of ballast or a drogue's release.
NO_MILESTONE = ""

#: An event: ``t_s``, ``key``, ``name`` in words, and more, such as ``phase`` and ``role``, ``milestone`` or
#: ``thruster``.
Moment = dict[str, Any]


def timeline(
    telemetry: Mapping[str, np.ndarray],
    plant: np.void,
    fsw: np.void,
    mission: MissionParams,
    vehicle: VehicleParams,
    outcome: str,
    others: Sequence[Moment] = (),
) -> list[dict[str, Any]]:
    """Events in order of time, each with the state of the vehicle then.

    ``others``: more events, such as the trim wing open, faults and isolations.
    """
    reversals = [
        moment(t, "bank_reversal", f"bank reversal to {side}") for t, side in bank_reversals(telemetry)
    ]
    found = [*others, *moments(plant, fsw, mission, vehicle), *reversals, moment(plant["t"], "end", outcome)]
    return [_with_state(telemetry, one) for one in sorted(found, key=lambda one: one["t_s"])]


def moment(t: float, key: str, name: str, **about: Any) -> Moment:
    """An event at time ``t`` (s)."""
    return {"t_s": float(t), "key": key, "name": name, **about}


def moments(plant: np.void, fsw: np.void, mission: MissionParams, vehicle: VehicleParams) -> list[Moment]:
    """Events that plant and flight computer record, each at most once; no telemetry is needed."""
    found = [
        moment(t, f"phase.{phase.name}", f"phase {phase.name}", phase=phase.name, role=phase.role)
        for phase, t in zip(mission.phases, fsw["mission"]["entered"], strict=False)
    ]
    found += [
        moment(t, event.name, in_words(event), milestone=milestone(event, vehicle))
        for event, t in zip(mission.events.values(), plant["done"], strict=False)
    ]
    found += [moment(t, "line_stretch", "line stretch, inflation begins") for t in plant["line_stretch_time"]]
    found += [
        moment(t, "propellant_exhausted", ran_empty(tank, vehicle))
        for tank, t in zip(vehicle.tanks, plant["exhausted_time"], strict=False)
    ]
    found += guard_moments(fsw["navigation"])
    found += hazard_moments(fsw["hazard"])
    found += [
        moment(t, "relaxed", f"powered guidance: {guidance_command.in_words(relaxed)}")
        for relaxed, t in enumerate(fsw["guidance"]["relaxed"]["t"], start=1)
        if t > 0.0
    ]
    found.append(moment(plant["touchdown_time"], "touchdown", "touchdown, first contact"))
    return [one for one in found if isfinite(one["t_s"])]


def guard_moments(navigation: np.void) -> list[Moment]:
    """First time of each finding of the guards of navigation, and the recovery of the vertical."""
    given = zip(CHECKS, navigation["integrity"]["first_t"], strict=True)
    found = [moment(t, "guard", f"guard: {words}") for words, t in given if t > 0.0]
    if (t := navigation["recovery"]["found_t"]) > 0.0:
        found.append(moment(t, "vertical_found", "vertical found again"))
    return found


def hazard_moments(hazard: np.void) -> list[Moment]:
    """Steps of hazard detection: the coarse choice on an image, the scan, and the choice of the spot."""
    spot = "safe spot chosen" if hazard["choice"]["found"] else "no spot safe: the best of them chosen"
    return [
        moment(hazard["site_t"], "site", "site of the map chosen"),
        moment(hazard["image_t"], "image", "image taken, coarse point chosen"),
        moment(hazard["scan_t"], "scan", "scan begins"),
        moment(hazard["spot_t"], "spot", spot),
    ]


def ran_empty(tank: Tank, vehicle: VehicleParams) -> str:
    """Name of the event that a tank is empty: ``propellant exhausted`` if it is the only one."""
    return "propellant exhausted" if len(vehicle.tanks) == 1 else f"tank {tank.name} empty"


def in_words(event: Event) -> str:
    """Describe an event: ``heat shield jettisoned``; landing gear by the event's own name."""
    component = event.name if event.component == "landing_gear" else event.component
    return DONE[event.action].format(component.replace("_", " "))


def milestone(event: Event, vehicle: VehicleParams) -> str:
    """Name of an event in figures, reports and pictures, from its action and its component."""
    if event.action == "jettison":
        shapes = {part.name: part.shape for part in vehicle.parts}
        return UNCOVERED.get(shapes[event.component], NO_MILESTONE)
    if event.action == "extend":
        return "landing_legs" if event.component == "landing_gear" else "trim_wing"
    return MILESTONES.get(event.action, NO_MILESTONE)


def first_times(events: Iterable[Mapping[str, Any]]) -> dict[str, float]:
    """Time (s) of the first event of each key or milestone, and of each phase role as ``begun(role)``."""
    when: dict[str, float] = {}
    for event in events:
        when.setdefault(event.get("milestone", event["key"]), event["t_s"])
        if (role := event.get("role", NO_ROLE)) != NO_ROLE:
            when.setdefault(begun(role), event["t_s"])
    when.pop(NO_MILESTONE, None)
    return when


def bank_reversals(telemetry: Mapping[str, np.ndarray]) -> list[tuple[float, str]]:
    """Times (s) of the reversals of the commanded bank angle, and the new side."""
    t, bank = telemetry["t_s"], telemetry["guide.bank_deg"]
    return [(float(t[i]), "right" if bank[i] > 0.0 else "left") for i in reversal_rows(bank)]


def _with_state(telemetry: Mapping[str, np.ndarray], one: Moment) -> dict[str, Any]:
    t = one["t_s"]
    i = min(int(np.searchsorted(telemetry["t_s"], t - 1e-9)), len(telemetry["t_s"]) - 1)
    row = {name: telemetry[f"truth.{name}"][i] for name in ("altitude_m", "height_m", "speed_m_s", "mach")}
    # a flight continued from a saved state has no telemetry of the time before
    known = t >= telemetry["t_s"][0] - 1e-9
    values = {column: float(value) if known and abs(value) < 1e9 else None for column, value in row.items()}
    return {**one, "detail": _in_words(values), **values}


def _in_words(values: Mapping[str, float | None]) -> str:
    """Height, speed and Mach number, as far as they are known."""
    forms = {"height_m": "{:z,.0f} m above the ground", "speed_m_s": "{:.0f} m/s", "mach": "Mach {:.2f}"}
    return ", ".join(form.format(values[name]) for name, form in forms.items() if values[name] is not None)
