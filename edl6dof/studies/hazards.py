"""Landings among rocks, with and without hazard avoidance.

This is an experiment of this simulator and of no paper.  The flights are those of ``tianwen1_mc`` over the
ground of ``tianwen1_hazards``, which differs in each flight, at three abundances of rocks.  Blind landings
fly to a fixed offset: how many of them come down on a rock is known in closed form (Golombek & Rapp 1997).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import exp, inf, isfinite, nan, pi, sqrt

import numpy as np
from scipy.integrate import quad

import edl6dof
from edl6dof import Case, LoadedScenario
from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.executor import Row
from edl6dof.config.wording import counted
from edl6dof.fsw.hazard.registry import HAZARD_DETECTION
from edl6dof.metrics.record_figures import COUNTED, FOOTPRINT
from edl6dof.studies.frame import Curve, Finding, Grid, Panel, Report, Session, Study
from edl6dof.studies.samples import column, kinds, mean, percentage, pick, quantile_grid, with_quantile

SCENARIO, DISPERSIONS = "tianwen1_hazards", "tianwen1_mc"
#: Share of the ground that rocks cover.
ABUNDANCES = (0.04, 0.1, 0.2)
#: Ways of hazard detection; the first detects nothing: blind landings.
WAYS = HAZARD_DETECTION.names
BLIND = WAYS[0]
#: Targets, at the abundance that they hold for: flights on a rock (%), spots wrongly thought safe (%), 95 %
#: of touchdowns from the spot (m), least distance from backshell and canopy (m).
AT, ON_A_ROCK_PCT, FALSE_SAFE_PCT, SPOT_M, CLEAR_M = 0.1, 0.5, 0.1, 1.5, 50.0
#: Standard errors by which a counted share may differ from the expected one: 99 % of shares differ by less.
_ERRORS = 2.58
REMARKS = (
    "On a rock: the middle of a rock of half a metre or more lies within the 12.6 m2 under the lander; a "
    "flight that does not come down counts as one.",
    "The bounds are this project's own targets; the share of blind landings is Golombek & Rapp's (1997).",
)


def run(session: Session) -> Report:
    """Fly dispersed landings with each way of hazard detection over each ground."""
    session.total = len(session.parts) * len(ABUNDANCES) * session.flights
    rows: list[Row] = []
    for abundance in ABUNDANCES:
        for way in session.parts:
            rows += session.fly(over(abundance, way), cases(abundance, way, session.flights))
    return Report(list(findings(rows)), rows, session.total, list(_grids(rows)), REMARKS, _pictures(rows))


def over(abundance: float, way: str) -> LoadedScenario:
    """The landing with one way of hazard detection over ground with this rock abundance."""
    air = ["atmosphere.perturbation.enabled=true", "wind.gust.enabled=true"]
    ground = f"terrain.landing_area.rock_abundance={abundance:g}"
    detection = f"flight_software.hazard.detection={way}"
    return edl6dof.load(SCENARIO, ["simulation.log_every=5", *air, ground, detection])


def cases(abundance: float, way: str, flights: int) -> list[Case]:
    """The first cases of the campaign; a case and its ground have the same number."""
    label = {"abundance": abundance, "way": way}
    return [replace(one, label=label) for one in load_plan(DISPERSIONS).cases(0, flights)]


def blind_share(abundance: float) -> float:
    """Share of footprints with a rock that counts, of rocks at random places: 1 - exp(-N A).

    Golombek & Rapp, J. Geophys. Res. 102 (1997) 4117-4129: rocks of diameter D and more cover k exp(-q D) of
    the ground, q = 1.79 + 0.152 / k.
    """
    q = 1.79 + 0.152 / abundance

    def each(diameter: float) -> float:
        return 4.0 * q * abundance * exp(-q * diameter) / (pi * diameter**2)

    return 1.0 - exp(-quad(each, COUNTED, inf)[0] * pi * FOOTPRINT**2)


def on_a_rock(rows: list[Row]) -> float:
    """Share (%) of flights that landed on a rock large enough to count, or did not land."""
    return percentage(column(rows, "rocks_under_lander", inf) > 0.0)


def findings(rows: list[Row]) -> Iterator[Finding]:
    """Compare blind landings with the closed form, and the others with their targets."""
    ways = kinds(rows, "way")
    if BLIND in ways:
        yield from _blind(rows)
    for way in ways:
        if way != BLIND:
            yield from _avoiding(way, pick(rows, abundance=AT, way=way))
    failed = [row for row in rows if not isfinite(row.get("touchdown_s", nan))]
    note = f"{failed[0]['way']}, {failed[0]['abundance']:g}: {failed[0]['cause']}" if failed else ""
    yield Finding("flights that did not come down", "", float(len(failed)), 0.0, "<=", note)


def _blind(rows: list[Row]) -> Iterator[Finding]:
    for abundance in ABUNDANCES:
        flown, expected = pick(rows, abundance=abundance, way=BLIND), blind_share(abundance)
        off = _ERRORS * sqrt(expected * (1.0 - expected) / len(flown))
        label = f"{100.0 * abundance:g} %: blind landings on a rock"
        note = f"1 - exp(-N A); {len(flown)} flights count it to {100.0 * off:.1f} %"
        yield Finding(label, "%", on_a_rock(flown), 100.0 * expected, "", note, within=off / expected)


def _avoiding(way: str, rows: list[Row]) -> Iterator[Finding]:
    label = f"{100.0 * AT:g} %, {way}"
    false, least = 100.0 * mean(rows, "spot_false_safe"), np.min(column(rows, "min_drift_distance_m", inf))
    yield Finding(f"{label}: landings on a rock", "%", on_a_rock(rows), ON_A_ROCK_PCT, "<=")
    yield Finding(f"{label}: chosen as safe with a rock under it", "%", false, FALSE_SAFE_PCT, "<=")
    spot = Finding(f"{label}: 95 % of touchdowns from the spot", "m", nan, SPOT_M, "<=")
    yield with_quantile(spot, column(rows, "spot_miss_m", inf), 0.95)
    yield Finding(f"{label}: least distance from backshell and canopy", "m", float(least), CLEAR_M, ">=")


_HEADS = (
    "way", "on a rock %", "within limits %", "spot found %", "false safe %",
    "clear of drift m, least", "fuel kg", "map safe %",
)  # fmt: skip


def _grids(rows: list[Row]) -> Iterator[Grid]:
    """Figures of each way of hazard detection, a table for each ground."""
    ways = kinds(rows, "way")
    for abundance in ABUNDANCES:
        flown = {way: pick(rows, abundance=abundance, way=way) for way in ways}
        each = counted(len(flown[ways[0]]), "flight")
        title = f"rocks cover {100.0 * abundance:g} % of the ground, {each} each way"
        yield Grid(title, _HEADS, [(way, *_figures(some)) for way, some in flown.items()])
    for abundance in ABUNDANCES:
        flown = {way: pick(rows, abundance=abundance, way=way) for way in ways if way != BLIND}
        misses = {way: column(some, "spot_miss_m") for way, some in flown.items()}
        if misses:
            title = f"rocks cover {100.0 * abundance:g} %: quantiles of touchdowns from the chosen spot, m"
            yield quantile_grid(title, "way", misses)


def _figures(rows: list[Row]) -> tuple[float, ...]:
    past = column(rows, "min_drift_distance_m")
    return (
        on_a_rock(rows),
        percentage(row["success"] for row in rows),
        100.0 * mean(rows, "spot_found"),
        100.0 * mean(rows, "spot_false_safe"),
        float(np.nanmin(past)) if np.isfinite(past).any() else nan,
        mean(rows, "propellant_used_kg"),
        100.0 * mean(rows, "map_safe_share"),
    )


def _pictures(rows: list[Row]) -> dict[str, list[Panel]]:
    """Landings on a rock by abundance, and touchdowns from their spots."""
    ways, percent = kinds(rows, "way"), [100.0 * share for share in ABUNDANCES]
    known = Curve(percent, [100.0 * blind_share(k) for k in ABUNDANCES], f"{BLIND}: expected", "reference")
    flown, spots = [known], []
    for way in ways:
        flown.append(Curve(percent, [on_a_rock(pick(rows, abundance=k, way=way)) for k in ABUNDANCES], way))
        if way != BLIND:
            spots.append(Curve.distribution(column(pick(rows, abundance=AT, way=way), "spot_miss_m"), way))
    panels = [Panel("landings on a rock >= 0.5 m", "rocks, % of the ground", "%", flown)]
    panels.append(Panel("touchdown from the chosen spot", "distance (m)", "flights within (%)", spots))
    return {"comparison": panels}


TITLE = "Landings among rocks with and without hazard avoidance, at rock abundances of 4, 10 and 20 %"
STUDY = Study("hazards", TITLE, "this simulator, 2026", run, runs=200, quick_runs=10, parts=WAYS)
