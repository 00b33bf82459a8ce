"""One flight for each way in which one component can fail: cases of the fault matrix, and what a row says
about each.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from edl6dof.campaign.design.case import Case
from edl6dof.fsw.mission.roles import (
    HAZARD_AVOIDANCE,
    HOVER_IMAGING,
    LIFT,
    PARACHUTE,
    POWERED_DECELERATION,
    SLOW_DESCENT,
    TRIM,
)
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.flight import Flight
from edl6dof.vehicle.faults.component import INSTRUMENTS, Component
from edl6dof.vehicle.faults.fault import FaultParams
from edl6dof.vehicle.faults.registry import FAULT_KINDS, components_of
from edl6dof.vehicle.plant import THRUSTER_KINDS

#: Kinds of fault of instruments, and of all else that are about one kind of component; of the latter those of
#: a thruster.
OF_INSTRUMENTS = tuple(kind for kind in FAULT_KINDS.names if set(components_of(kind)) <= set(INSTRUMENTS))
KINDS = tuple(
    kind for kind in FAULT_KINDS.names if kind not in OF_INSTRUMENTS and len(components_of(kind)) == 1
)
OF_THRUSTERS = THRUSTER_KINDS

#: Roles of the phases, the first of each, a fault begins in unless others are asked for: one of each kind of
#: attitude control; for instruments all in which the vehicle flies.
USUAL_ROLES = (TRIM, LIFT, PARACHUTE, POWERED_DECELERATION, HAZARD_AVOIDANCE)
FLYING_ROLES = (*USUAL_ROLES[:4], HOVER_IMAGING, HAZARD_AVOIDANCE, SLOW_DESCENT)
#: Those of kinds that happen in one phase only: what saturates all gyros is a parachute that opens.
OWN_ROLES = {"gyros_saturated": (PARACHUTE,)}


def sensor_phases_of(scenario: Scenario, kind: str) -> list[str]:
    """The usual phases of a kind of fault of instruments."""
    return phases_of(scenario, OWN_ROLES.get(kind, FLYING_ROLES))


def phases_of(scenario: Scenario, wanted: Sequence[str] = USUAL_ROLES) -> list[str]:
    """The first phases of the ``wanted`` roles as far as the scenario has them, otherwise all in which
    thrusters may fire.
    """
    roles = scenario.phase_roles
    usual = [scenario.phase_names[roles.index(role)] for role in wanted if role in roles]
    return usual or [phase.name for phase in scenario.mission.phases if phase.thrusters]


def may_fail(scenario: Scenario, kind: str) -> dict[Component, list[str]]:
    """What a kind of fault is about, such as an engine, and the names of those that fly."""
    return {component: list(scenario.components.get(component, ())) for component in components_of(kind)}


def fault_cases(
    kinds: Mapping[str, Mapping[Component, Sequence[str]]],
    phases: Mapping[str, Sequence[str]],
    after_s: float,
) -> list[Case]:
    """A case for each kind, phase and component; the fault begins ``after_s`` s into the phase.

    Args:
        kinds: names of what is to fail, by kind of fault and kind of component.
        phases: those in which it fails, by kind of fault.
        after_s: s.
    """
    grid = [
        (kind, phase, component, name)
        for kind, components in kinds.items()
        for phase in phases[kind]
        for component, names in components.items()
        for name in names
    ]
    return [
        Case(
            index,
            truth={"faults": [{component: name, "kind": kind, "at": {"plus_s": after_s, "phase": phase}}]},
            label={"component": name, "kind": kind, "phase": phase},
        )
        for index, (kind, phase, component, name) in enumerate(grid)
    ]


def fault_response(flight: Flight) -> Mapping[str, Any]:
    """What the fault did to a flight, and what was made of it.

    ``unused_s`` is the time from the fault to a component's first use after it, null if there was none:
    before that nobody can tell that it is dead.  ``peak_attitude_error_deg`` is the largest error of pitch
    and yaw control between fault and touchdown.  ``named`` is the thruster isolated, or the instrument
    excluded, first; ``excluded`` all instruments excluded.
    """
    fault = flight.loaded.truth.faults[0]
    since = float(flight.plant["fault_since"][0][0])
    table = flight.telemetry
    t, end = table["t_s"], flight.metrics.get("touchdown_s", flight.time_s)
    after = (t >= since) & (t < end)
    error = np.hypot(table["control.error_pitch_deg"], table["control.error_yaw_deg"])
    used = after & _in_use(flight, fault)
    row = {
        "fault_s": since if since <= end else None,
        "unused_s": float(t[used][0]) - since if used.any() else None,
        "peak_attitude_error_deg": float(error[after].max()) if after.any() else None,
    }
    return row | (_excluded(flight) if fault.component in INSTRUMENTS else _isolated(flight))


def _isolated(flight: Flight) -> dict[str, Any]:
    """The thruster isolated first."""
    named = flight.isolated_faults[0] if flight.isolated_faults else None
    return {
        "named": named.thruster if named else None,
        "named_kind": named.kind if named else None,
        "confidence": named.confidence if named else None,
    }


def _excluded(flight: Flight) -> dict[str, Any]:
    """The instruments excluded, in the order of time."""
    names = [one.instrument for one in flight.exclusions if not one.back]
    return {"named": names[0] if names else None, "excluded": ", ".join(dict.fromkeys(names))}


def _in_use(flight: Flight, fault: FaultParams) -> np.ndarray:
    """Rows of telemetry in which what fails is used, shape (rows,), bool."""
    table = flight.telemetry
    if fault.component == "thruster":
        return table[f"valve.{fault.thruster}"] != 0
    if fault.component == "beam":
        return table["nav.beams_used"] != 0
    if fault.component == "star_tracker":
        return table["truth.altitude_m"] >= flight.scenario.sensors.star_tracker.lowest_m
    return np.ones(len(table["t_s"]), bool)
