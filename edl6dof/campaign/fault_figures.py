"""Figures of a fault matrix: how many flights end within limits, whom the flight computer names, and how
fast.

A verdict is right when it names what has failed and the kind of the fault.  What is never used after its
fault cannot be known; such flights count as flown, and are left out of the shares of right verdicts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from edl6dof.campaign.design.fault_matrix import AND
from edl6dof.campaign.fault_response import AIR, POWERED
from edl6dof.campaign.rows import Row
from edl6dof.vehicle.plant import THRUSTER_KINDS

REGIMES = (AIR, POWERED)


@dataclass(frozen=True)
class Requirement:
    """What is asked of a figure of all flights: at least, or at most, so much."""

    figure: str
    meaning: str
    unit: str
    at_least: float | None = None
    at_most: float | None = None

    def met(self, value: float) -> bool:
        """Whether a value is as good as required."""
        least = -np.inf if self.at_least is None else self.at_least
        most = np.inf if self.at_most is None else self.at_most
        return bool(least <= value <= most)


#: What is required where single thrusters fail.
REQUIREMENTS = (
    Requirement("within_limits_pct", "within limits", "%", at_least=99.5),
    Requirement("kind_right_pct", "right name and kind, of those that fire or leak", "%", at_least=99.0),
    Requirement("wrong_verdicts_pct", "flights with a wrong verdict on anything", "%", at_most=1.0),
    Requirement("air_median_s", "median time to the verdict in the air", "s", at_most=3.0),
    Requirement("powered_median_s", "median time to the verdict in powered flight", "s", at_most=1.0),
    Requirement("worst_s", "longest time to the verdict", "s", at_most=15.0),
)


def can_be_known(row: Row) -> bool:
    """Whether all that failed was used, or leaked, after the fault and before touchdown."""
    return row.get("first_use_s") is not None


def fault_figures(rows: Sequence[Row]) -> dict[str, Any]:
    """Figures of all flights, the same for each kind of fault and regime, and what was required."""
    kinds = list(dict.fromkeys(row["kind"] for row in rows))
    groups = [
        {"kind": kind, "regime": regime, **_counts(some)}
        for kind in kinds
        for regime in REGIMES
        if (some := [row for row in rows if row["kind"] == kind and row.get("regime") == regime])
    ]
    whole = _counts(rows)
    return {"all": whole, "groups": groups, "acceptance": _acceptance(rows, whole)}


def _counts(rows: Sequence[Row]) -> dict[str, Any]:
    """Counts, and times from the fault and from the first use to right verdicts."""
    known = [row for row in rows if can_be_known(row)]
    right = [row for row in known if row["kind_right"]]
    return {
        "flights": len(rows),
        "within_limits": sum(bool(row["success"]) for row in rows),
        "over_before_the_fault": sum(row.get("fault_s") is None for row in rows),
        "never_used": sum(row.get("fault_s") is not None and not can_be_known(row) for row in rows),
        "can_be_known": len(known),
        "name_right": sum(bool(row["name_right"]) for row in known),
        "kind_right": len(right),
        "with_wrong_verdicts": sum(row.get("wrongly_named") is not None for row in rows),
        "from_fault_s": _times([row["verdict_s"] for row in right]),
        "from_use_s": _times([row["verdict_from_use_s"] for row in right]),
    }


def _times(times: Sequence[float]) -> dict[str, float] | None:
    """Median, 95 % and largest of some times, s."""
    if not times:
        return None
    median, most = np.quantile(times, [0.5, 0.95])
    return {"median": float(median), "p95": float(most), "worst": float(max(times))}


def _acceptance(rows: Sequence[Row], whole: dict[str, Any]) -> list[dict[str, Any]]:
    """The required figures that these flights have; none where other than single thrusters fail."""
    if any(row["kind"] not in THRUSTER_KINDS or AND in row["component"] for row in rows):
        return []
    regimes = {regime: _counts([row for row in rows if row.get("regime") == regime]) for regime in REGIMES}
    times = {regime: counts["from_use_s"] for regime, counts in regimes.items()}
    values = {
        "within_limits_pct": _percent(whole["within_limits"], whole["flights"]),
        "kind_right_pct": _percent(whole["kind_right"], whole["can_be_known"]),
        "wrong_verdicts_pct": _percent(whole["with_wrong_verdicts"], whole["flights"]),
        "air_median_s": times[AIR] and times[AIR]["median"],
        "powered_median_s": times[POWERED] and times[POWERED]["median"],
        "worst_s": whole["from_use_s"] and whole["from_use_s"]["worst"],
    }
    return [
        {"figure": one.figure, "value": value, "met": one.met(value)}
        for one in REQUIREMENTS
        if (value := values[one.figure]) is not None
    ]


def _percent(part: int, whole: int) -> float | None:
    return 100.0 * part / whole if whole else None
