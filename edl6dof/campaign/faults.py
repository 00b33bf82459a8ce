"""A matrix of faults: kinds and phases to choose from, its plan, and the figures of its flights.

Figures: how many flights end within limits, which components the flight computer isolates, and how fast.  An
isolation is right if it names the failed component and the kind of the fault.  A component that is not used
after its fault cannot be isolated; such flights count as flown, but not in the shares of right isolations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal, NamedTuple

import numpy as np

from edl6dof.campaign.design.dispersions import AND
from edl6dof.campaign.design.plan import Plan, plan_of
from edl6dof.campaign.design.sections import FaultMatrixParams
from edl6dof.campaign.executor import Row
from edl6dof.campaign.fault_response import AIR, NOT_BEGUN_YET, POWERED
from edl6dof.config.document.source import read_document, resolve_scenario
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.interface.effectors import THRUSTER_FAILURES
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
from edl6dof.vehicle.faults.fault import FAULT_KINDS, about

#: Kinds of fault of instruments; other kinds of fault of one kind of component; of these, the three of a
#: thruster that fault isolation distinguishes.
OF_INSTRUMENTS = tuple(kind for kind in FAULT_KINDS.names if set(about(kind).components) <= set(INSTRUMENTS))
KINDS = tuple(
    kind for kind in FAULT_KINDS.names if kind not in OF_INSTRUMENTS and len(about(kind).components) == 1
)
OF_THRUSTERS = THRUSTER_FAILURES

#: Roles of the phases (the first of each) in which a fault begins by default: one of each kind of attitude
#: control; for instruments, all phases of flight.
USUAL_ROLES = (TRIM, LIFT, PARACHUTE, POWERED_DECELERATION, HAZARD_AVOIDANCE)
FLYING_ROLES = (*USUAL_ROLES[:4], HOVER_IMAGING, HAZARD_AVOIDANCE, SLOW_DESCENT)


def usual_phases_of(scenario: Scenario, kind: str) -> list[str]:
    """The phases in which a kind of fault begins by default."""
    usual = FLYING_ROLES if kind in OF_INSTRUMENTS else USUAL_ROLES
    return phases_of(scenario, about(kind).happens_in or usual)


def phases_of(scenario: Scenario, wanted: Sequence[str] = USUAL_ROLES) -> list[str]:
    """The first phase of each of the ``wanted`` roles; all phases in which thrusters may fire if the scenario
    has none of these roles.
    """
    roles = scenario.phase_roles
    usual = [scenario.phase_names[roles.index(role)] for role in wanted if role in roles]
    return usual or [phase.name for phase in scenario.mission.phases if phase.thrusters]


def may_fail(scenario: Scenario, kind: str) -> dict[Component, list[str]]:
    """Names of the components on this vehicle that a kind of fault can affect, by kind of component."""
    return {component: list(scenario.components.get(component, ())) for component in about(kind).components}


def matrix_plan(
    scenario: str, matrix: FaultMatrixParams, sets: Sequence[str], vehicles: int | None, seed: int | None
) -> Plan:
    """Return the plan of a matrix of faults.

    Args:
        scenario: file, or name of a shipped scenario.
        matrix: faults and the moments at which they occur.
        sets: overrides of the scenario.
        vehicles: dispersed vehicles on which each cell is flown; the nominal one if ``None``.
        seed: seed of the dispersions; replaces that of the campaign.

    Raises:
        ConfigError: the scenario is wrong, has faults of its own, or no dispersions for ``vehicles``.
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


REGIMES = (AIR, POWERED, NOT_BEGUN_YET)


class Requirement(NamedTuple):
    """Requirement on a figure of all flights: ``at least`` or ``at most`` a number."""

    figure: str
    meaning: str
    bound: Literal["at least", "at most"]
    number: float
    unit: str

    def met(self, value: float) -> bool:
        """Return whether a value is as good as required."""
        return bool(value >= self.number if self.bound == "at least" else value <= self.number)


#: Requirements if single thrusters fail, and if two fail together.
REQUIRED = (
    Requirement("within_limits_pct", "within limits", "at least", 99.5, "%"),
    Requirement("kind_right_pct", "right name and kind, if it fires or leaks", "at least", 99.0, "%"),
    Requirement("wrong_isolations_pct", "flights with a wrong isolation", "at most", 1.0, "%"),
    Requirement("air_median_s", "median time to isolation in the air", "at most", 3.0, "s"),
    Requirement("powered_median_s", "median time to isolation in powered flight", "at most", 1.0, "s"),
    Requirement("worst_s", "longest time to isolation", "at most", 15.0, "s"),
)
REQUIRED_OF_PAIRS = (Requirement("within_limits_pct", "within limits", "at least", 100.0, "%"),)


def can_be_known(row: Row) -> bool:
    """Return whether all failed components were used, or leaked, between fault and touchdown."""
    return row.get("first_use_s") is not None


def is_right(row: Row) -> bool:
    """Return whether all failed components could be known and were named with the right kind."""
    return can_be_known(row) and bool(row["kind_right"])


def fault_figures(rows: Sequence[Row]) -> dict[str, Any]:
    """Figures of all flights, of each kind of fault in each regime, and the requirements."""
    kinds = list(dict.fromkeys(row["kind"] for row in rows))
    groups = [
        {"kind": kind, "regime": regime, **_counts(some)}
        for kind in kinds
        for regime in REGIMES
        if (some := [row for row in rows if row["kind"] == kind and _regime(row) == regime])
    ]
    whole = _counts(rows)
    undetected = _undetected(rows)
    return {"all": whole, "groups": groups, "undetected": undetected, "acceptance": _acceptance(rows, whole)}


#: Figures of a flight whose largest value is the effect of the faults that were not detected.
EFFECTS = ("touchdown_nav_velocity_m_s", "touchdown_nav_height_m", "touchdown_nav_vertical_deg")


def _undetected(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Of each kind of fault and swept parameter: number of flights in which the fault could be known, and in
    which no failed component was named; the largest size of these, how many of them are not within limits,
    and the largest magnitudes of ``EFFECTS`` in them.
    """
    swept: dict[tuple[str, str], list[tuple[float, Row]]] = {}
    for row in filter(can_be_known, rows):
        parameter, _, size = (row.get("size") or "").partition("=")
        if parameter:
            swept.setdefault((row["kind"], parameter), []).append((float(size), row))
    found = []
    for (kind, parameter), flown in swept.items():
        missed = [(size, row) for size, row in flown if not row["name_right"]]
        effects = {
            name: max((abs(row[name]) for _, row in missed if row.get(name) is not None), default=None)
            for name in EFFECTS
        }
        found.append({
            "kind": kind, "parameter": parameter, "flights": len(flown), "undetected": len(missed),
            "largest": max((size for size, _ in missed), default=None),
            "not_within_limits": sum(not row["success"] for _, row in missed), **effects,
        })  # fmt: skip
    return found


def _regime(row: Row) -> str:
    """Return the regime of the first use, or the value for a case that could not fly."""
    return row.get("regime") or NOT_BEGUN_YET


def _counts(rows: Sequence[Row]) -> dict[str, Any]:
    """Counts, and times (s) from the fault and from the first use to right isolations."""
    known = [row for row in rows if can_be_known(row)]
    right = [row for row in known if is_right(row)]
    return {
        "flights": len(rows),
        "within_limits": sum(bool(row["success"]) for row in rows),
        "not_begun": sum(_regime(row) == NOT_BEGUN_YET for row in rows),
        "never_used": sum(_regime(row) != NOT_BEGUN_YET and not can_be_known(row) for row in rows),
        "can_be_known": len(known),
        "name_right": sum(bool(row["name_right"]) for row in known),
        "kind_right": len(right),
        "with_wrong_isolations": sum(row.get("wrongly_named") is not None for row in rows),
        "from_fault_s": _times([row["isolation_s"] for row in right]),
        "from_use_s": _times([row["isolation_from_use_s"] for row in right]),
    }


def _times(times: Sequence[float]) -> dict[str, float] | None:
    """Median, 95 % quantile and largest of some times, s."""
    if not times:
        return None
    median, most = np.quantile(times, [0.5, 0.95])
    return {"median": float(median), "p95": float(most), "worst": float(max(times))}


def required_of(rows: Sequence[Row]) -> tuple[Requirement, ...]:
    """Return the requirements on faults of one or two single thrusters; none on other components."""
    if any(row["kind"] not in OF_THRUSTERS for row in rows):
        return ()
    together = {AND in row["component"] for row in rows}
    return REQUIRED_OF_PAIRS if together == {True} else REQUIRED if together == {False} else ()


def _acceptance(rows: Sequence[Row], whole: dict[str, Any]) -> list[dict[str, Any]]:
    """Compare the required figures that these flights have with their requirements."""
    of_regime = {regime: [row for row in rows if _regime(row) == regime] for regime in REGIMES}
    times = {regime: _counts(some)["from_use_s"] for regime, some in of_regime.items()}
    values = {
        "within_limits_pct": _percent(whole["within_limits"], whole["flights"]),
        "kind_right_pct": _percent(whole["kind_right"], whole["can_be_known"]),
        "wrong_isolations_pct": _percent(whole["with_wrong_isolations"], whole["flights"]),
        "air_median_s": times[AIR] and times[AIR]["median"],
        "powered_median_s": times[POWERED] and times[POWERED]["median"],
        "worst_s": whole["from_use_s"] and whole["from_use_s"]["worst"],
    }
    return [
        {
            **{"meaning": one.meaning, "value": value, "unit": one.unit},
            **{"limit": f"{one.bound} {one.number:g} {one.unit}", "met": one.met(value)},
        }
        for one in required_of(rows)
        if (value := values[one.figure]) is not None
    ]


def _percent(part: int, whole: int) -> float | None:
    return 100.0 * part / whole if whole else None
