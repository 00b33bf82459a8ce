"""What came out: misses of each law in each condition, all figures of the dispersed entries, and the best
laws against this project's targets.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import inf, isfinite, nan

import numpy as np

from edl6dof.campaign.quantiles import percent
from edl6dof.campaign.rows import Row
from edl6dof.config.wording import counted
from edl6dof.studies.guidance.conditions import CONDITIONS, DISPERSED
from edl6dof.studies.quantiles import quantile_grid, with_quantile
from edl6dof.studies.study import Finding, Grid

#: Targets of this study: which share of the misses of the best law keeps within how much (km), time of a call
#: (us) of a law that predicts by flying ahead, and of any other.
TARGET_SHARE, TARGET_KM, PREDICTOR_CALL_US, CALL_US = 0.99, 2.5, 2000.0, 5.0
PREDICTORS = ("npc", "fnpeg")

Calls = dict[tuple[str, str], float]
#: Numbers of the dispersed entries of a vehicle that no law brings within the target.
Beyond = Mapping[str, set[int]]


def names(rows: Sequence[Row], column: str) -> list[str]:
    """What occurs in a column, in the order of the rows."""
    return list(dict.fromkeys(row[column] for row in rows))


def of(rows: Sequence[Row], **wanted: str) -> list[Row]:
    """The rows with these labels."""
    return [row for row in rows if all(row[key] == value for key, value in wanted.items())]


def misses(rows: Sequence[Row]) -> np.ndarray:
    """Miss at the mortar, km; infinite where it never fired."""
    found = np.array([row.get("parachute_miss_m", nan) for row in rows], float) / 1e3
    return np.where(np.isnan(found), inf, found)


def best_first(rows: Sequence[Row]) -> list[str]:
    """The laws of some rows, that first of which the next to last hundredth of the misses is smallest."""
    laws = names(rows, "law")
    return sorted(laws, key=lambda law: np.quantile(misses(of(rows, law=law)), 0.99, method="higher"))


def largest(rows: Sequence[Row]) -> float:
    """Largest miss, km, of what is no sample: few flights of a condition that was chosen."""
    return float(np.max(misses(rows), initial=0.0))


def mean(rows: Sequence[Row], name: str) -> float:
    """Mean of a figure over the flights that have it."""
    found = [row[name] for row in rows if isfinite(row.get(name, nan))]
    return float(np.mean(found)) if found else nan


def grids(rows: Sequence[Row], calls: Calls) -> Iterator[Grid]:
    """For each vehicle: the largest miss in each condition, quantiles of the dispersed entries, and what the
    flights cost.
    """
    for vehicle in names(rows, "vehicle"):
        flown = of(rows, vehicle=vehicle)
        yield _conditions(vehicle, flown)
        if dispersed := of(flown, condition=DISPERSED):
            title = f"{vehicle}: quantiles of the miss at the mortar, km, of dispersed entries"
            miss = {law: misses(of(dispersed, law=law)) for law in best_first(dispersed)}
            yield quantile_grid(title, "law", miss)
        yield _effort(vehicle, flown, calls)


def _conditions(vehicle: str, rows: Sequence[Row]) -> Grid:
    columns = conditions(rows)
    counts = {name: len(of(rows, condition=name)) // len(names(rows, "law")) for name in columns}
    lines: list[tuple[str | float, ...]] = [
        (law, *(largest(of(rows, law=law, condition=name)) for name in columns)) for law in best_first(rows)
    ]
    several = f"{counted(counts[columns[0]], 'flight')} in each column"
    if DISPERSED in counts:
        several += f", {counts[DISPERSED]} dispersed"
    return Grid(f"{vehicle}: largest miss at the mortar, km; {several}", ("law", *columns), tuple(lines))


def conditions(rows: Sequence[Row]) -> list[str]:
    """The conditions that were flown, in their order."""
    return [name for name in (*(c.name for c in CONDITIONS), DISPERSED) if of(rows, condition=name)]


_HEADS = (
    "law", "in box %", "load g", "alt. mean km", "Mach", "drag RMS m/s2", "bank travel deg", "in wind deg",
    "fuel kg", "lim. s", "call us", "failed",
)  # fmt: skip


def _effort(vehicle: str, rows: Sequence[Row], calls: Calls) -> Grid:
    lines = []
    for law in best_first(rows):
        flown = of(rows, law=law)
        lines.append((
            law, 100.0 * float(np.mean([row["success"] for row in flown])), mean(flown, "peak_load_g0"),
            mean(flown, "parachute_altitude_m") / 1e3, mean(flown, "parachute_mach"),
            mean(flown, "tracking_error_m_s2"), mean(of(flown, condition="nominal"), "bank_travel_deg"),
            mean(of(flown, condition="wind 60 m/s"), "bank_travel_deg"), mean(flown, "propellant_used_kg"),
            mean(flown, "saturation_s"), calls[vehicle, law], float(len(unflown(flown))),
        ))  # fmt: skip
    flights = counted(len(rows) // len(lines), "flight")
    return Grid(f"{vehicle}: mean of {flights}", _HEADS, tuple(lines))


def unflown(rows: Sequence[Row]) -> list[Row]:
    """Flights that did not come as far as the mortar; their rows have the cause."""
    return [row for row in rows if not isfinite(row.get("parachute_miss_m", nan))]


def _best_law(vehicle: str, flown: Sequence[Row], beyond: set[int]) -> Iterator[Finding]:
    """Misses of the best law, of all entries and of those in reach, and how often it keeps the deployment
    box.
    """
    best = best_first(flown)[0]
    mine = of(flown, law=best)
    share, words = 100.0 * len(beyond) / len(mine), f"{vehicle}: {percent(TARGET_SHARE)} of misses"
    in_reach = misses([row for row in mine if row["profile"] not in beyond])
    asked = Finding(f"{words}, best law", "km", nan, TARGET_KM, "<=", best)
    every = with_quantile(asked, misses(mine), TARGET_SHARE)
    within = with_quantile(replace(asked, label=f"{words} of the entries in reach"), in_reach, TARGET_SHARE)
    if within.computed <= TARGET_KM < every.computed:
        cause = f"{share:.1f} % of the entries end short with lift up all the way, flown so"
        every = replace(every, why=cause)
    yield every
    if beyond:
        yield within
        yield Finding(f"{vehicle}: entries short of the target with lift up", "%", share)
    kept = 100.0 * float(np.mean([row["success"] for row in mine]))
    yield Finding(f"{vehicle}: deployment box kept, best law", "%", kept, 100.0, ">=", best)


def findings(rows: Sequence[Row], calls: Calls, beyond: Beyond) -> Iterator[Finding]:
    """The best laws of the dispersed entries, flights that failed, and the time of a call; ``beyond`` are the
    entries of each vehicle that are out of reach.
    """
    dispersed = of(rows, condition=DISPERSED)
    for vehicle in names(dispersed, "vehicle"):
        yield from _best_law(vehicle, of(dispersed, vehicle=vehicle), beyond.get(vehicle, set()))
    failed = unflown(rows)
    why = f"{failed[0]['vehicle']}, {failed[0]['law']}: {failed[0]['cause']}" if failed else ""
    label = "flights that did not reach the mortar"
    yield Finding(label, "", float(len(failed)), 0.0, "<=", why=why)
    first = rows[0]["vehicle"]  # others may fly reversals that are found by flying ahead
    for label, bound, predicts in (
        (f"{first}: longest guidance call of laws that fly ahead", PREDICTOR_CALL_US, True),
        (f"{first}: longest guidance call of the others", CALL_US, False),
    ):
        timed = [
            (us, law)
            for (vehicle, law), us in calls.items()
            if vehicle == first and (law in PREDICTORS) == predicts
        ]
        if timed:
            us, law = max(timed)
            yield Finding(label, "us", us, bound, "<=", law)


REMARKS = (
    "The bounds are this project's own targets; the box is the scenario's limits on Mach, dynamic pressure "
    "and total angle of attack.",
    "Laws without a reference drag have no drag error; 'lim.' is the time with the bank magnitude at its "
    "least or largest value.",
    "bank_profile flies the planned bank open loop: what the conditions do without guidance.",
)
