"""Dispersed entries that no bank angle brings to the aim point: with lift up all the way they end short.

A flight at zero bank from entry interface to the parachute flies about as far as that entry can.  What still
ends further short than the target is out of reach of every law.  Flown only for entries that no law brought
within the target: the others are in reach by what was flown.
"""

from __future__ import annotations

from collections.abc import Sequence

from edl6dof.campaign.design.case import Case
from edl6dof.campaign.executor import fly_rows
from edl6dof.campaign.rows import Row
from edl6dof.studies.guidance.conditions import DISPERSED, WAVES_AND_GUSTS
from edl6dof.studies.guidance.tables import TARGET_KM, misses, of
from edl6dof.studies.guidance.vehicles import ENTRY, Vehicle, entries

#: Label of the flights with lift up, in the place of a condition.
LIFT_UP = "lift up"
_LIFT_UP = (
    f"{ENTRY}.law=constant_bank",
    f"{ENTRY}.constant_bank.bank_deg=0",
    f"{ENTRY}.bank_min_deg=0",
    f"{ENTRY}.preset_bank_deg=0",
    f"{ENTRY}.heading.speed_m_s=0",
    f"{ENTRY}.reversal.logic=own_sign",
)


def missed_by_all(rows: Sequence[Row]) -> list[int]:
    """Numbers of the dispersed entries of one vehicle that every law ends further from than the target."""
    best: dict[int, float] = {}
    for row, miss in zip(rows, misses(rows), strict=True):
        best[row["profile"]] = min(best.get(row["profile"], miss), miss)
    return sorted(number for number, miss in best.items() if miss > TARGET_KM)


def lift_up(vehicle: Vehicle, rows: Sequence[Row], flights: int) -> list[Row]:
    """Rows of the entries of a vehicle that all laws missed, of ``flights`` drawn ones, with lift up."""
    missed = missed_by_all(of(rows, vehicle=vehicle.name, condition=DISPERSED))
    if not missed:
        return []
    loaded = vehicle.load("simulation.log_every=5", *_LIFT_UP)
    truths, label = entries(vehicle.dispersions, flights), {"vehicle": vehicle.name, "condition": LIFT_UP}
    about = {**label, "law": "constant_bank"}
    cases = (Case(i, {**truths[n], **WAVES_AND_GUSTS}, profile=n, label=about) for i, n in enumerate(missed))
    return list(fly_rows(loaded, cases))


def out_of_reach(rows: Sequence[Row]) -> set[int]:
    """Numbers of the entries that lift up all the way leaves further short than the target."""
    return {row["profile"] for row in rows if row.get("parachute_downrange_m", 0.0) < -1e3 * TARGET_KM}
