"""What came out: the chain beside the published one, the cliff, and what each guard does."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite, nan

import numpy as np

from edl6dof.campaign.rows import Row
from edl6dof.metrics.published import published_figures
from edl6dof.sim.flight import Flight
from edl6dof.studies.schiaparelli.conditions import GUARDS, PERSISTENCES
from edl6dof.studies.study import Finding, Grid

#: Height (m) of a release that is too early: twice the planned one.
EARLY_M = 2400.0
#: The figures that the chain is held to.
HELD = ("backshell_height_m", "engine_burn_s", "touchdown_vertical_m_s")

REMARKS = (
    "Nothing is made to fail: gyros meet the end of their range as the canopy swings the capsule faster.",
    "The phase of the nutation at entry, which decides how hard it swings, is drawn; 3 deg are an estimate.",
    "parity: two gyros more, between pitch and yaw, each with the same range.",
    "A failed check is noted whether or not its guard is switched on.",
)


def findings(flight: Flight) -> tuple[Finding, ...]:
    """The scenario as it is, one flight, beside what is published."""
    found = []
    for figure, entry in published_figures(flight.scenario.published):
        own = flight.metrics.get(figure.name, nan)
        within = entry.sigma / abs(entry.number) if figure.name in HELD and entry.sigma else None
        found.append(
            Finding(figure.meaning, figure.unit.label, own, entry.number, entry.bound, within=within)
        )
    return tuple(found)


def saturated(rows: Sequence[Row]) -> list[Row]:
    """Flights in which a gyro met the end of its range."""
    return [row for row in rows if row["flagged_s"] > 0.0]


def landed(rows: Sequence[Row]) -> int:
    """How many landed within limits."""
    return sum(bool(row["success"]) for row in rows)


def crashed(rows: Sequence[Row]) -> int:
    """How many ended in a crash, and neither landed nor only tipped over."""
    return sum(bool(row["crashed"]) for row in rows)


def early(rows: Sequence[Row]) -> int:
    """How many released the parachute far too high."""
    return sum((row.get("backshell_height_m") or 0.0) > EARLY_M for row in rows)


def mean(rows: Sequence[Row], name: str) -> float:
    """Mean of a figure over the flights that have it."""
    values = [row[name] for row in rows if row.get(name) is not None and isfinite(row[name])]
    return float(np.mean(values)) if values else nan


def grids(rows: Sequence[Row]) -> tuple[Grid, ...]:
    """The cliff and the guards."""
    return cliff(rows), guards(rows)


def cliff(rows: Sequence[Row]) -> Grid:
    """A row for each persistence of the flag."""
    found: list[tuple[str | float, ...]] = []
    for persistence in PERSISTENCES:
        own = [row for row in rows if row["sweep"] == "persistence" and row["persistence_s"] == persistence]
        hit = saturated(own)
        found.append(
            (f"{persistence:g} s", len(own), len(hit), landed(hit), early(hit), mean(hit, "vertical_deg"))
        )
    heads = (
        "flag stays on",
        "flights",
        "beyond the range",
        "of these landed",
        "released early",
        "vertical off deg",
    )
    return Grid("How long the flag stays on", heads, tuple(found))


def guards(rows: Sequence[Row]) -> Grid:
    """A row for each guard."""
    found: list[tuple[str | float, ...]] = []
    for guard in GUARDS:
        own = [row for row in rows if row["sweep"] == "guard" and row["guard"] == guard.name]
        hit = saturated(own)
        good = [row for row in own if row["success"]]
        found.append(
            (
                guard.name, len(own), landed(own), len(hit), landed(hit), crashed(hit), early(own),
                mean(good, "propellant_used_kg"),
            )
        )  # fmt: skip
    heads = (
        *("", "flights", "landings", "beyond the range", "of these landed", "crashed"),
        *("released early", "propellant kg"),
    )
    return Grid("One guard at a time", heads, tuple(found))
