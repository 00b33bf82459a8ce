"""One flight for each way in which one component can fail: cases of the fault matrix, and what a row says
about each.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from edl6dof.campaign.design.case import Case
from edl6dof.fsw.mission.roles import HAZARD_AVOIDANCE, LIFT, PARACHUTE, POWERED_DECELERATION, TRIM
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.flight import Flight
from edl6dof.vehicle.faults.registry import FAULT_KINDS, components_of
from edl6dof.vehicle.plant import THRUSTER_KINDS

#: Kinds of fault that are about one kind of component, and those of them that are of a thruster.
KINDS = tuple(kind for kind in FAULT_KINDS.names if len(components_of(kind)) == 1)
OF_THRUSTERS = THRUSTER_KINDS

#: Roles of the phases, the first of each, a fault begins in unless others are asked for: one of each kind of
#: attitude control.
USUAL_ROLES = (TRIM, LIFT, PARACHUTE, POWERED_DECELERATION, HAZARD_AVOIDANCE)


def phases_of(scenario: Scenario) -> list[str]:
    """The usual phases as far as the scenario has them, otherwise all in which thrusters may fire."""
    roles = scenario.phase_roles
    usual = [scenario.phase_names[roles.index(role)] for role in USUAL_ROLES if role in roles]
    return usual or [phase.name for phase in scenario.mission.phases if phase.thrusters]


def may_fail(scenario: Scenario, kind: str) -> tuple[str, list[str]]:
    """What a kind of fault is about, such as an engine, and the names of those that the vehicle has."""
    (component,) = components_of(kind)
    return component, list(scenario.components.get(component, ()))


def fault_cases(components: Mapping[str, Sequence[str]], phases: Sequence[str], after_s: float) -> list[Case]:
    """A case for each kind, phase and component; the fault begins ``after_s`` s into the phase.

    ``components``: names of what is to fail, by kind of fault.
    """
    at = {"plus_s": after_s}
    grid = [(kind, phase, name) for kind, names in components.items() for phase in phases for name in names]
    return [
        Case(index, truth={"faults": [fault]}, label={"component": name, "kind": kind, "phase": phase})
        for index, (kind, phase, name) in enumerate(grid)
        for fault in ({components_of(kind)[0]: name, "kind": kind, "at": at | {"phase": phase}},)
    ]


def fault_response(flight: Flight) -> Mapping[str, Any]:
    """What the fault did to a flight, and what was made of it.

    ``unused_s`` is the time from the fault to a thruster's first use after it, null if there was none: before
    that nobody can tell that it is dead; 0 for other components.  ``peak_attitude_error_deg`` is the largest
    error of pitch and yaw control between fault and touchdown.
    """
    fault = flight.loaded.truth.faults[0]
    since = float(flight.plant["fault_since"][0][0])
    table = flight.telemetry
    t, end = table["t_s"], flight.metrics.get("touchdown_s", flight.time_s)
    after = (t >= since) & (t < end)
    error = np.hypot(table["control.error_pitch_deg"], table["control.error_yaw_deg"])
    used = after & (table[f"valve.{fault.thruster}"] != 0) if fault.component == "thruster" else after
    named = flight.isolated_faults[0] if flight.isolated_faults else None
    return {
        "fault_s": since if since <= end else None,
        "unused_s": float(t[used][0]) - since if used.any() else None,
        "named": named.thruster if named else None,
        "named_kind": named.kind if named else None,
        "confidence": named.confidence if named else None,
        "peak_attitude_error_deg": float(error[after].max()) if after.any() else None,
    }
