"""Kinds of faults that a scenario may have, their usual phases, and the plan of a matrix of such
faults.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from edl6dof.campaign.design.plan import Plan, plan_of
from edl6dof.campaign.design.sections import FaultMatrixParams
from edl6dof.config.document.source import read_document, resolve_scenario
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.interface.roles import (
    HAZARD_AVOIDANCE,
    HOVER_IMAGING,
    LIFT,
    PARACHUTE,
    POWERED_DECELERATION,
    SLOW_DESCENT,
    TRIM,
)
from edl6dof.scenario.schema import Scenario
from edl6dof.vehicle.faults.component import INSTRUMENTS, Component
from edl6dof.vehicle.faults.registry import FAULT_KINDS, components_of, happens_in

#: Kinds of fault of instruments, and of all else that are about one kind of component; of the latter those of
#: a thruster.
OF_INSTRUMENTS = tuple(kind for kind in FAULT_KINDS.names if set(components_of(kind)) <= set(INSTRUMENTS))
KINDS = tuple(
    kind for kind in FAULT_KINDS.names if kind not in OF_INSTRUMENTS and len(components_of(kind)) == 1
)
OF_THRUSTERS = tuple(kind for kind in KINDS if components_of(kind) == ("thruster",))

#: Roles of the phases, the first of each, a fault begins in unless others are asked for: one of each kind of
#: attitude control; for instruments all in which the vehicle flies.
USUAL_ROLES = (TRIM, LIFT, PARACHUTE, POWERED_DECELERATION, HAZARD_AVOIDANCE)
FLYING_ROLES = (*USUAL_ROLES[:4], HOVER_IMAGING, HAZARD_AVOIDANCE, SLOW_DESCENT)


def usual_phases_of(scenario: Scenario, kind: str) -> list[str]:
    """The phases in which a kind of fault begins unless others are asked for."""
    usual = FLYING_ROLES if kind in OF_INSTRUMENTS else USUAL_ROLES
    return phases_of(scenario, happens_in(kind) or usual)


def phases_of(scenario: Scenario, wanted: Sequence[str] = USUAL_ROLES) -> list[str]:
    """The first phases of the ``wanted`` roles as far as the scenario has them, otherwise all in which
    thrusters may fire.
    """
    roles = scenario.phase_roles
    usual = [scenario.phase_names[roles.index(role)] for role in wanted if role in roles]
    return usual or [phase.name for phase in scenario.mission.phases if phase.thrusters]


def may_fail(scenario: Scenario, kind: str) -> dict[Component, list[str]]:
    """Return the kinds of component that a fault is about, such as an engine, and the names of those that
    fly.
    """
    return {component: list(scenario.components.get(component, ())) for component in components_of(kind)}


def matrix_plan(
    scenario: str, matrix: FaultMatrixParams, sets: Sequence[str], vehicles: int | None, seed: int | None
) -> Plan:
    """The plan of a matrix of faults.

    Args:
        scenario: file, or name of a shipped one.
        matrix: what fails and when.
        sets: overrides of the scenario.
        vehicles: dispersed vehicles on which each cell is flown; the nominal one if ``None``.
        seed: of the dispersions, instead of the campaign's own.

    Raises:
        ConfigError: the scenario is wrong, has faults of its own, or no dispersions where some are wanted.
    """
    document = read_document(resolve_scenario(scenario))
    data = {name: value for name, value in document.data.items() if name not in ("campaign", "sweep")}
    if vehicles is not None:
        if not isinstance(campaign := document.data.get("campaign"), dict):
            words = "has no campaign: section that would disperse it; try tianwen1_mc"
            raise ConfigError([document.problem((), words), Problem("-n", 0, 0, "", "needs dispersions")])
        data["campaign"] = {**campaign, "faults": []}  # those of the matrix alone
    elif seed is not None:
        raise ConfigError([Problem("--seed", 0, 0, "", "is that of dispersed vehicles: give -n N too")])
    data["fault_matrix"] = matrix.model_dump(mode="json", exclude_none=True)
    return plan_of(replace(document, data=data), tuple(sets), vehicles, seed)
