"""Hazard avoidance: the map from hover with the chosen and the rejected spots, and the choice on the landing
image before it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import numpy as np

from edl6dof.report.catalogue import CELLS
from edl6dof.report.figure import Figure, Heat, Trace, legend_entry
from edl6dof.report.flight.common import circle, flown, site_panel
from edl6dof.report.palette import BLACK, BLUE, GREY, ORANGE, PURPLE, SEQUENTIAL, VERMILION
from edl6dof.runs.run import Run
from edl6dof.telemetry.landing_map import CELL_CLASSES, LandingMap

#: Cells that a page needs side by side; more would weigh it down and nobody sees them.
MOST_CELLS = 128
_WAYS = ("east", "north")


def figures(run: Run) -> Iterator[Figure]:
    """Draw the figures of the section; none for a flight that chose no spot from a scan."""
    found = run.landing_map
    if found is None:
        return
    if len(found.coarse_m):
        yield _coarse(run, found)
    yield _fine(run, found)


def _fine(run: Run, found: LandingMap) -> Figure:
    """The map of the scan, by class of cell and as heights."""
    east, north = middles(found)
    every = -(-len(east) // MOST_CELLS)
    e, n = east[::every], north[::every]
    names = [CELL_CLASSES.index(name) for name in CELLS]
    cell_class = np.argsort(names)[found.cell_class[::every, ::every]].astype(float)
    kinds = Heat(e, n, cell_class, "", 0, len(CELLS) - 1, [colour for _, colour in CELLS.values()])
    height = found.elevation_m[::every, ::every]
    low, high = (float(value) for value in np.nanpercentile(height, (0.5, 99.5)))
    heights = Heat(e, n, height, "height (m)", low, max(high, low + 0.1), SEQUENTIAL)
    entries = [legend_entry(text, colour, 4.0) for text, colour in CELLS.values()]
    way = list(_way(run, found))
    classes = site_panel([*entries, *_passed_over(found), *way], title="what it made of them", heat=kinds)
    seen = site_panel(way, title="what it saw: height above the ground below", heat=heights)
    return Figure(
        "hazard_map", "Map of hazards from hover", [classes, seen], _words(run, found), 2, height=480
    )


def _words(run: Run, found: LandingMap) -> str:
    """A caption that explains the map and the choice."""
    safe = 100.0 * np.mean(found.cell_class == CELL_CLASSES.index("safe"))
    away = float(np.hypot(*(found.spot_m - found.hover_m[:2])))
    reasons = Counter(found.reasons())
    passed = ", ".join(f"{count} for {name}" for name, count in reasons.most_common())
    text = f"Of the map {safe:.0f} % is safe for the whole footprint. "
    if passed:
        text += (
            f"On its way out from the point below, the search passed over unsafe spots: {passed} (the first "
            f"{len(found.rejected_m)} that lie a footprint apart); "
        )
    else:
        text += "The search passed over nothing; "
    if not found.found:
        return text + f"no spot was safe, and it took the least bad one, {away:.1f} m away."
    cell = np.floor((found.spot_m - found.corner_m) / found.cell_m).astype(int)
    clear = float(found.clearance_m[cell[1], cell[0]])
    text += f"the chosen spot lies {away:.1f} m away and {clear:.1f} m from the nearest unsafe one. "
    return text + _nearer(run, found, away, clear)


def _nearer(run: Run, found: LandingMap, away: float, clear: float) -> str:
    """A sentence if another safe spot was nearer (m) but had less clearance (m)."""
    east, north = middles(found)
    distance = np.hypot(north[:, None] - found.hover_m[1], east - found.hover_m[0])
    distance[found.cell_class != CELL_CLASSES.index("safe")] = np.inf
    nearest = np.unravel_index(np.argmin(distance), distance.shape)
    near, its_clear = float(distance[nearest]), float(found.clearance_m[nearest])
    if away - near < 1.0 or clear - its_clear < 0.1:
        return ""
    choice = run.scenario["flight_software"]["hazard"]["choice"]
    return (
        f"The nearest safe one, {near:.1f} m away, is clear of unsafe ones by {its_clear:.1f} m only: each "
        f"metre of that, up to {choice['clearance_m']:g} m, is worth {choice['clearance_worth']:g} m of way."
    )


def _coarse(run: Run, found: LandingMap) -> Figure:
    """The targets that the parts of the landing image offered, and where backshell and lander came down."""
    labels = [f"{100.0 * share:.1f} % obstacles" for share in found.coarse_obstacles]
    offered = Trace(*_xy(found.coarse_m), "parts of the image", "points", GREY, labels=labels, width=4.0)
    chosen = found.coarse_m[int(found.coarse_part)]
    taken = Trace(chosen[:1], chosen[1:], "part taken", "points", VERMILION, symbol="diamond", width=4.0)
    drift = Trace(*_xy(found.drift_m), "backshell, as predicted", colour=PURPLE, dash="dot")
    # all as navigated: off the ground by the error of navigation
    off = run["nav.error_east_m"], run["nav.error_north_m"]
    east, north = (run[f"truth.backshell_{way}_m"] + error for way, error in zip(_WAYS, off, strict=True))
    there = np.isfinite(east)
    shell = Trace(east[there], north[there], "backshell", colour=PURPLE, dash="dash")
    last = run.between("backshell")
    way_e, way_n = (values[last] for values in _navigated(run))
    lander = flown(way_e, way_n, "lander")
    panel = site_panel([offered, taken, drift, shell, lander])
    caption = (
        "From the landing image the part with the fewest obstacles is taken whose middle keeps clear of the "
        "predicted way of backshell and canopy."
    )
    return Figure("coarse_choice", "Choice on the landing image", [panel], caption, height=420)


def _way(run: Run, found: LandingMap) -> Iterator[Trace]:
    """Hover, the path from there to the ground, the footprint around the chosen spot, and the touchdown."""
    radius = float(run.scenario["flight_software"]["hazard"]["footprint_radius_m"])
    last = run.between("spot", "touchdown")
    east, north = _navigated(run)
    yield flown(east[last], north[last], "way, as navigated")
    hover = np.asarray(found.hover_m)
    yield Trace(hover[:1], hover[1:2], "hover", "points", BLACK, symbol="cross", width=3.0)
    ring = circle([float(value) for value in found.spot_m], radius, 73)
    yield Trace(*ring, "chosen footprint", colour=BLACK, width=2.2)
    if "touchdown" in run.when:
        row = [int(np.searchsorted(run.t, run.when["touchdown"]).clip(0, len(run.t) - 1))]
        yield Trace(east[row], north[row], "touchdown", "points", BLUE, symbol="diamond", width=4.0)


def _passed_over(found: LandingMap) -> Iterator[Trace]:
    """The spots that the search rejected."""
    if len(found.rejected_m):
        yield Trace(*_xy(found.rejected_m), "passed over", "points", ORANGE, symbol="x", width=3.0)


def _xy(places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """East and north of places."""
    return places[:, 0], places[:, 1]


def middles(found: LandingMap) -> tuple[np.ndarray, np.ndarray]:
    """East and north (m) of the middles of the columns and rows of the map."""
    step = (np.arange(len(found.cell_class)) + 0.5) * float(found.cell_m)
    return float(found.corner_m[0]) + step, float(found.corner_m[1]) + step


def _navigated(run: Run) -> list[np.ndarray]:
    """East and north (m) of the vehicle by its own navigation."""
    return [run[f"truth.site_{way}_m"] + run[f"nav.error_{way}_m"] for way in _WAYS]
