"""Figures of the fault matrix, by kind of fault and phase."""

from __future__ import annotations

import statistics
from collections.abc import Mapping, Sequence
from typing import Any

from edl6dof.campaign.faults import OF_INSTRUMENTS
from edl6dof.campaign.rows import Row


def found_s(row: Row) -> float | None:
    """Time from the fault to the isolation of the thruster, or the exclusion of the instrument, that failed;
    ``None`` where it was not named.
    """
    if row.get("named") != row["component"]:
        return None
    return row.get("time_to_exclude_s" if row["kind"] in OF_INSTRUMENTS else "time_to_detect_s")


def never_used(row: Row) -> bool:
    """Whether nobody could tell, for want of any use, that the component has failed."""
    return row["kind"] != "stuck_on" and row.get("unused_s") is None


def summary_of(rows: Sequence[Row], phases: Mapping[str, Sequence[str]]) -> dict[str, Any]:
    """Counts of all flights, figures of each group, and the rows themselves; ``phases``: by kind of fault."""
    return {
        "flights": len(rows),
        "survived": sum(row["success"] for row in rows),
        "groups": [group for kind in phases for group in groups_of(rows, kind, phases[kind])],
        "rows": list(rows),
    }


def groups_of(rows: Sequence[Row], kind: str, phases: Sequence[str]) -> list[dict[str, Any]]:
    """Figures of a kind of fault in each phase."""
    return [
        _group([row for row in rows if row["kind"] == kind and row["phase"] == phase]) for phase in phases
    ]


def _group(rows: Sequence[Row]) -> dict[str, Any]:
    """Figures of one kind of fault in one phase."""
    named = [row for row in rows if row.get("named") == row["component"]]
    times = [t for row in named if (t := found_s(row)) is not None]
    in_use = [
        max(t - (row["unused_s"] or 0.0), 0.0)
        for row in named
        if row["kind"] != "stuck_on" and (t := found_s(row)) is not None
    ]
    return {
        "kind": rows[0]["kind"],
        "phase": rows[0]["phase"],
        "flights": len(rows),
        "survived": sum(row["success"] for row in rows),
        "named_right": len(named),
        "named_wrong": sum(row.get("named") not in (None, row["component"]) for row in rows),
        "never_used": sum(never_used(row) for row in rows),
        "median_time_to_detect_s": statistics.median(times) if times else None,
        "median_from_first_use_s": statistics.median(in_use) if in_use else None,
        "worst_landing_distance_m": _worst(rows, "landing_distance_m"),
        "worst_attitude_error_deg": max(
            (row["peak_attitude_error_deg"] or 0.0 for row in rows if row["success"]), default=None
        ),
        "worst_nav_height_m": _worst(rows, "touchdown_nav_height_m"),
        "worst_nav_velocity_m_s": _worst(rows, "touchdown_nav_velocity_m_s"),
        "worst_nav_vertical_deg": _worst(rows, "touchdown_nav_vertical_deg"),
    }


def _worst(rows: Sequence[Row], name: str) -> float | None:
    """Largest magnitude of a figure among the flights that have it."""
    return max((abs(row[name]) for row in rows if name in row), default=None)
