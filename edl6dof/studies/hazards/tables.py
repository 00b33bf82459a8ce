"""What came out: rocks under the lander, spots that were chosen, backshell and canopy, and targets kept."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import inf, isfinite, nan

import numpy as np

from edl6dof.campaign.rows import Row
from edl6dof.config.wording import counted
from edl6dof.studies.hazards.conditions import ABUNDANCES, BLIND, blind_share, standard_error
from edl6dof.studies.quantiles import quantile_grid, with_quantile
from edl6dof.studies.study import Finding, Grid

#: Targets, at the abundance that they hold for: flights on a rock (%), spots wrongly thought safe (%), 95 %
#: of touchdowns from the spot (m), least distance from backshell and canopy (m).
AT, ON_A_ROCK_PCT, FALSE_SAFE_PCT, SPOT_M, CLEAR_M = 0.1, 0.5, 0.1, 1.5, 50.0
#: Standard errors that a counted share may lie off the expected one: 99 % of them do less.
_ERRORS = 2.58


def of(rows: Sequence[Row], abundance: float, way: str) -> list[Row]:
    """The rows of a way over a ground."""
    return [row for row in rows if (row["abundance"], row["way"]) == (abundance, way)]


def ways(rows: Sequence[Row]) -> list[str]:
    """The ways that were flown, in their order."""
    return list(dict.fromkeys(row["way"] for row in rows))


def values(rows: Sequence[Row], name: str, missing: float = nan) -> np.ndarray:
    """A figure of each row; ``missing`` where a flight has none."""
    return np.array([row.get(name, missing) for row in rows], float)


def on_a_rock(rows: Sequence[Row]) -> float:
    """Share (%) of flights that came down on a rock that counts; one that did not come down to stand counts
    as one that did.
    """
    return 100.0 * float(np.mean(values(rows, "rocks_under_lander", inf) > 0.0))


def grids(rows: Sequence[Row]) -> Iterator[Grid]:
    """For each ground what the ways make of it."""
    for abundance in ABUNDANCES:
        flown = [(way, of(rows, abundance, way)) for way in ways(rows)]
        each = counted(len(flown[0][1]), "flight")
        title = f"rocks cover {100.0 * abundance:g} % of the ground, {each} each way"
        yield Grid(title, _HEADS, tuple((way, *_figures(some)) for way, some in flown))
    for abundance in ABUNDANCES:
        miss = {way: values(of(rows, abundance, way), "spot_miss_m") for way in ways(rows) if way != BLIND}
        if miss:
            title = f"rocks cover {100.0 * abundance:g} %: quantiles of touchdowns from the chosen spot, m"
            yield quantile_grid(title, "way", miss)


_HEADS = (
    "way", "on a rock %", "within limits %", "spot found %", "false safe %",
    "clear of drift m, least", "fuel kg", "map safe %",
)  # fmt: skip


def _figures(rows: Sequence[Row]) -> tuple[float, ...]:
    past = values(rows, "min_drift_distance_m")
    return (
        on_a_rock(rows),
        100.0 * float(np.mean([row["success"] for row in rows])),
        100.0 * _mean(values(rows, "spot_found")),
        100.0 * _mean(values(rows, "spot_false_safe")),
        float(np.nanmin(past)) if np.isfinite(past).any() else nan,
        _mean(values(rows, "propellant_used_kg")),
        100.0 * _mean(values(rows, "map_safe_share")),
    )


def _mean(sample: np.ndarray) -> float:
    known = sample[np.isfinite(sample)]
    return float(np.mean(known)) if len(known) else nan


def findings(rows: Sequence[Row]) -> Iterator[Finding]:
    """Blind landings beside the closed form, and the targets of those that look."""
    if BLIND in ways(rows):
        yield from _blind(rows)
    for way in ways(rows):
        if way != BLIND:
            yield from _avoiding(way, of(rows, AT, way))
    failed = [row for row in rows if not isfinite(row.get("touchdown_s", nan))]
    note = f"{failed[0]['way']}, {failed[0]['abundance']:g}: {failed[0]['cause']}" if failed else ""
    yield Finding("flights that did not come down", "", float(len(failed)), 0.0, "<=", note)


def _blind(rows: Sequence[Row]) -> Iterator[Finding]:
    for abundance in ABUNDANCES:
        flown, expected = of(rows, abundance, BLIND), blind_share(abundance)
        off = _ERRORS * standard_error(expected, len(flown))
        label = f"{100.0 * abundance:g} %: blind landings on a rock"
        note = f"1 - exp(-N A); {len(flown)} flights count it to {100.0 * off:.1f} %"
        yield Finding(label, "%", on_a_rock(flown), 100.0 * expected, "", note, within=off / expected)


def _avoiding(way: str, rows: Sequence[Row]) -> Iterator[Finding]:
    label = f"{100.0 * AT:g} %, {way}"
    false = 100.0 * _mean(values(rows, "spot_false_safe"))
    miss = values(rows, "spot_miss_m", inf)
    least = float(np.min(values(rows, "min_drift_distance_m", inf)))
    yield Finding(f"{label}: landings on a rock", "%", on_a_rock(rows), ON_A_ROCK_PCT, "<=")
    yield Finding(f"{label}: chosen as safe with a rock under it", "%", false, FALSE_SAFE_PCT, "<=")
    spot = Finding(f"{label}: 95 % of touchdowns from the spot", "m", nan, SPOT_M, "<=")
    yield with_quantile(spot, miss, 0.95)
    yield Finding(f"{label}: least distance from backshell and canopy", "m", least, CLEAR_M, ">=")


REMARKS = (
    "On a rock: the middle of a rock of half a metre or more lies within the 12.6 m2 under the lander; a "
    "flight that does not come down counts as one.",
    "The bounds are this project's own targets; the share of blind landings is Golombek & Rapp's (1997).",
)
