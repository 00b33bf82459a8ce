"""What came out: fuel, miss, tilt and feasibility of each law, diverts, late releases, failing engines, and
targets kept.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import inf, isfinite, nan, sqrt

import numpy as np

from edl6dof.campaign.rows import Row
from edl6dof.config.wording import counted
from edl6dof.studies.landing.conditions import (
    DISPERSED,
    DIVERTS,
    ENGINE_FAULTS,
    LATE_RELEASES,
    divert,
    release,
)
from edl6dof.studies.quantiles import quantile_grid
from edl6dof.studies.study import Finding, Grid

#: The law that the others are compared with, and the ones that solve an optimisation problem in flight.
REFERENCE, OPTIMISERS = "polynomial", ("convex",)
#: The law that plans nothing, and by how much (m/s) another may come down faster after a late release.
UNPLANNED, FASTER_M_S = "gravity_turn", 0.5
#: A law has reached the target within these: miss (m), speed (m/s) and height (m) off where hover begins; and
#: it was out of its limits if it was saturated for longer (s).
MISS_M, SPEED_M_S, HEIGHT_M, SATURATED_S = 5.0, 5.0, 10.0, 10.0
#: Targets of this study: miss of the longest divert (m), time of a call (us), share of landings (%).
DIVERT_MISS_M, CALL_US, OPTIMISER_CALL_US, LANDED_PCT = 2.0, 5.0, 5000.0, 99.0
#: A row of a table: the law, and its figures.
Line = tuple[str | float, ...]
#: Half the width of a 95 % interval, in standard errors.
_TWO_SIDED = 1.96


def of(rows: Sequence[Row], law: str = "", condition: str = DISPERSED) -> list[Row]:
    """The rows of a law, or of all, in a condition."""
    return [row for row in rows if row["condition"] == condition and law in ("", row["law"])]


def laws(rows: Sequence[Row]) -> list[str]:
    """The laws that were flown, in their order."""
    return list(dict.fromkeys(row["law"] for row in rows))


def values(rows: Sequence[Row], name: str, missing: float = nan) -> np.ndarray:
    """A figure of each row; ``missing`` where a flight has none."""
    return np.array([row.get(name, missing) for row in rows], float)


def reached(row: Row) -> bool:
    """Whether hover began at the target."""
    return (
        row.get("target_miss_m", inf) <= MISS_M
        and row["hover_speed_m_s"] <= SPEED_M_S
        and abs(row["hover_off_m"]) <= HEIGHT_M
    )


def difference(rows: Sequence[Row], law: str, name: str) -> tuple[float, float]:
    """Mean of a figure less that of the reference in the same flights, and half of its 95 % interval; no
    numbers without a pair.
    """
    ours = {row["flight"]: row.get(name, nan) for row in of(rows, law)}
    theirs = {row["flight"]: row.get(name, nan) for row in of(rows, REFERENCE)}
    pairs = np.array([ours[flight] - theirs[flight] for flight in ours.keys() & theirs.keys()], float)
    pairs = pairs[np.isfinite(pairs)]
    if len(pairs) < 2:
        return nan, nan
    return float(np.mean(pairs)), _TWO_SIDED * float(np.std(pairs, ddof=1)) / sqrt(len(pairs))


def grids(rows: Sequence[Row], calls: Mapping[str, float]) -> Iterator[Grid]:
    """Dispersed landings, diverts, late releases, failing engines."""
    yield _fuel(rows)
    yield from _misses(rows)
    yield _feasibility(rows, calls)
    yield _diverts(rows)
    yield _late(rows)
    yield _faults(rows)


def _fuel(rows: Sequence[Row]) -> Grid:
    heads = (
        *("law", "hover: kg", "hover: less kg", "hover: 95 % +-"),
        *("ground: kg", "ground: less kg", "ground: 95 % +-"),
    )
    lines: list[Line] = [
        (
            *(law, mean(of(rows, law), "hover_fuel_kg"), *difference(rows, law, "hover_fuel_kg")),
            *(mean(of(rows, law), "ground_fuel_kg"), *difference(rows, law, "ground_fuel_kg")),
        )
        for law in laws(rows)
    ]
    title = f"{_flights(rows)} dispersed landings: propellant to hover and to the ground, less {REFERENCE}"
    return Grid(title, heads, tuple(lines))


def _misses(rows: Sequence[Row]) -> Iterator[Grid]:
    for name, words in (("target_miss_m", "of the target"), ("navigated_miss_m", "as navigated")):
        title = f"{_flights(rows)} dispersed landings: quantiles of the miss {words}, m"
        yield quantile_grid(title, "law", {law: values(of(rows, law), name, inf) for law in laws(rows)})


def _feasibility(rows: Sequence[Row], calls: Mapping[str, float]) -> Grid:
    heads = (
        "law", "tilt deg: mean", "peak", "not reached %",
        "saturated %", "landed %", "call us",
    )  # fmt: skip
    lines: list[Line] = [(law, *_kept(of(rows, law)), calls[law]) for law in laws(rows)]
    return Grid(f"{_flights(rows)} dispersed landings: target and limits", heads, tuple(lines))


def _kept(flown: Sequence[Row]) -> tuple[float, ...]:
    return (
        *(mean(flown, "peak_tilt_deg"), float(np.max(values(flown, "peak_tilt_deg", 0.0)))),
        _share(not reached(row) for row in flown),
        _share(row.get("saturated_s", inf) > SATURATED_S for row in flown),
        _share(row.get("came_down", False) for row in flown),
    )


def _flights(rows: Sequence[Row]) -> int:
    return len(of(rows, laws(rows)[0]))


def _diverts(rows: Sequence[Row]) -> Grid:
    heads = ["law"]
    for metres in DIVERTS:
        heads += [f"{metres:g} m: kg", f"{metres:g} m: miss m", f"{metres:g} m: not %"]
    lines: list[Line] = [
        (law, *(figure for metres in DIVERTS for figure in _diverted(of(rows, law, divert(metres)))))
        for law in laws(rows)
    ]
    flights = len(of(rows, laws(rows)[0], divert(DIVERTS[0])))
    each = counted(flights, "flight")
    title = f"diverts, {each} each: propellant to hover, largest miss as navigated, share not reached"
    return Grid(title, tuple(heads), tuple(lines))


def _diverted(flown: Sequence[Row]) -> tuple[float, float, float]:
    return (
        mean(flown, "hover_fuel_kg"),
        float(np.max(values(flown, "navigated_miss_m", inf))),
        _share(not reached(row) for row in flown),
    )


def _faults(rows: Sequence[Row]) -> Grid:
    lines: list[Line] = [
        (law, *(mean(of(rows, law, name), "touchdown_vertical_m_s") for name in ENGINE_FAULTS))
        for law in laws(rows)
    ]
    title = "engine fails, s after backshell release: descent rate at the ground, m/s; -: lost before"
    return Grid(title, ("law", *ENGINE_FAULTS), tuple(lines))


def _late(rows: Sequence[Row]) -> Grid:
    heads = tuple(f"{height:g} m" for height in LATE_RELEASES)
    lines: list[Line] = [
        (law, *(_ground_speed(rows, law, height) for height in LATE_RELEASES)) for law in laws(rows)
    ]
    return Grid("backshell released late: descent rate at the ground, m/s", ("law", *heads), tuple(lines))


def _ground_speed(rows: Sequence[Row], law: str, height: float) -> float:
    return mean(of(rows, law, release(height)), "touchdown_vertical_m_s")


def _faster(rows: Sequence[Row], law: str) -> float:
    """By how much a law comes down faster than the one that plans nothing, at most, after a late release."""
    return max(
        _ground_speed(rows, law, height) - _ground_speed(rows, UNPLANNED, height) for height in LATE_RELEASES
    )


def mean(rows: Sequence[Row], name: str) -> float:
    """Mean of a figure over the flights that have it."""
    found = values(rows, name)
    return float(np.nanmean(found)) if np.isfinite(found).any() else nan


def _share(kept: Iterator[bool]) -> float:
    return 100.0 * float(np.mean(list(kept)))


def findings(rows: Sequence[Row], calls: Mapping[str, float]) -> Iterator[Finding]:
    """Landings of every law, the longest divert, fuel against the reference, and the time of a call."""
    for law in laws(rows):
        share = _share(row.get("came_down", False) for row in of(rows, law))
        yield Finding(f"{law}: dispersed landings", "%", share, LANDED_PCT, ">=")
    longest = divert(DIVERTS[-1])
    worst = {
        law: float(np.max(values(of(rows, law, longest), "navigated_miss_m", inf))) for law in laws(rows)
    }
    best = min(worst, key=lambda law: worst[law])
    yield Finding(f"largest miss, {longest}, best law", "m", worst[best], DIVERT_MISS_M, "<=", best)
    for law in laws(rows):
        if law != UNPLANNED and UNPLANNED in laws(rows):
            name = f"{law}: faster than {UNPLANNED} at the ground, late releases"
            yield Finding(name, "m/s", _faster(rows, law), FASTER_M_S, "<=")
    for name in ENGINE_FAULTS:
        flown = of(rows, condition=name)
        causes = dict.fromkeys(row["cause"] for row in flown if not row.get("came_down", False))
        down = float(sum(row.get("came_down", False) for row in flown))
        yield Finding(f"{name}: laws that land, of {len(flown)}", "", down, note="; ".join(causes))
    for law in laws(rows):
        saved, half = difference(rows, law, "hover_fuel_kg")
        if law != REFERENCE and isfinite(saved):
            yield Finding(f"{law}: fuel to hover less {REFERENCE}", "kg", saved, note=f"+- {half:.2f}, 95 %")
    for law, us in calls.items():
        bound = OPTIMISER_CALL_US if law in OPTIMISERS else CALL_US
        yield Finding(f"{law}: longest guidance call", "us", us, bound, "<=")


REMARKS = (
    "The bounds are this project's own targets.",
    f"Reached: hover begins within {MISS_M:g} m of the target, {SPEED_M_S:g} m/s and {HEIGHT_M:g} m of "
    f"height; saturated: thrust at the upper end of the band or beyond, or tilt at its limit, for more than "
    f"{SATURATED_S:g} s after the start.",
    "The miss as navigated leaves out what the error of navigation changes from ignition to hover.",
    "gravity_turn has no target: its miss is where the gravity turn ends.",
)
