"""The landing: powered descent and landing site; and the map of hazards from hover with the
chosen and the rejected spots, after the choice on the landing image.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import numpy as np

from edl6dof.interface.roles import HOVER_IMAGING, begun
from edl6dof.report.catalogue import CELLS, STACKS
from edl6dof.report.figure import Axis, Figure, Heat, Panel, Trace, legend_entry, through
from edl6dof.report.flight.common import circle, flown, over_flight, placed, site_panel
from edl6dof.report.palette import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SEQUENTIAL, SKY, VERMILION
from edl6dof.runs.run import Run
from edl6dof.scenario.terrain_preview import planned_ellipse
from edl6dof.telemetry.landing_map import CELL_CLASSES, LandingMap

#: Most cells along a side of a map on a page: more make the page larger and cannot be seen.
MOST_CELLS = 128
#: Parts that are discarded, and their colours.
_PARTS = {"canopy": SKY, "heat_shield": ORANGE, "backshell": PURPLE}
EAST, NORTH = "truth.site_east_m", "truth.site_north_m"
_WAYS = ("east", "north")


def powered_descent(run: Run) -> Iterator[Figure]:
    """Draw height over descent speed, the design plane of powered descent; then its plots over time."""
    if "ignition" in run.when:
        rows = run.between("backshell", "touchdown")
        names = {"backshell": "backshell", "ignition": "", begun(HOVER_IMAGING): "hover"}
        curve = flown(run["truth.v_down_m_s"][rows], run["truth.height_m"][rows])
        events = placed(run, "truth.v_down_m_s", "truth.height_m", names)
        panel = Panel(Axis("descent speed (m/s)"), Axis("height above the ground (m)"), [curve, events])
        yield Figure("descent_plane", "Height above the ground over descent speed", [panel], height=320)
    yield from over_flight(run, STACKS["landing"])


def landing_site(run: Run) -> Iterator[Figure]:
    """Draw the planned ellipse if there is one, the parachute descent, and the last leg, to scale; nothing of
    a flight that did not come down on a parachute and leave it.
    """
    if not {"mortar", "backshell"} <= run.when.keys():
        return
    last = run.between("backshell")
    aim, planned, below = [target(run)], _planned(run), track(run, run.between("mortar"), 1e3)
    limit, allowed = run.scenario["limits"]["landing_distance_m"], []
    if limit is not None:
        ring = circle((0.0, 0.0), float(limit) / 1e3, 181)
        allowed = [Trace(*ring, "allowed distance", colour=GREEN, dash="dash", width=1.2, border=True)]
    panels = []
    if planned:
        panels.append(site_panel([*planned, *allowed, below, *aim], unit="km", title="planned ellipse"))
    parts = [_part(run, name, 1e3) for name in _PARTS]
    mortar = events_on_map(run, {"mortar": "parachute"})
    traces = [*([] if planned else allowed), *parts, below, *aim, mortar]
    panels.append(site_panel(traces, unit="km", title="from the parachute on"))
    reach = float(np.hypot(np.ptp(run[EAST][last]), np.ptp(run[NORTH][last])))
    away = float(np.hypot(run[EAST][last], run[NORTH][last]).min())
    near = aim if away < 2.0 * reach else []  # a farther target would shrink everything else
    ground = events_on_map(run, {"touchdown": "touchdown"}, 1.0)
    traces = [_part(run, "backshell"), track(run, last), *near, ground]
    panels.append(site_panel(traces, title="powered descent"))
    landed, caption = run.summary["figures"], ""
    if landed.get("landing_distance_m") is not None:
        offset = f"{landed['landing_east_m']:+,.0f} m east, {landed['landing_north_m']:+,.0f} m north"
        caption = f"Landed {landed['landing_distance_m']:,.0f} m from the target: {offset}."
    yield Figure("landing_site", "Landing site", panels, caption, columns=len(panels), height=460)


def track(run: Run, rows: np.ndarray | slice, scale: float = 1.0) -> Trace:
    """Return the path from above, in units of ``scale`` (m)."""
    return flown(run[EAST][rows] / scale, run[NORTH][rows] / scale, "vehicle")


def target(run: Run) -> Trace:
    """Return the landing site as a cross, called target unless the goal is a time of flight."""
    name = "landing site" if run.scenario["mission"]["goal"] == "time" else "target"
    return Trace(np.zeros(1), np.zeros(1), name, "points", VERMILION, symbol="cross", width=3.0, border=True)


def _planned(run: Run) -> list[Trace]:
    """The planned landing ellipse (km), if the scenario has one."""
    terrain = run.scenario["terrain"]
    length, width = (float(terrain[f"ellipse_{side}_m"]) / 1e3 for side in ("length", "width"))
    if length <= 0.0:
        return []
    ring = planned_ellipse(length, width, np.radians(terrain["ellipse_azimuth_deg"]))
    return [Trace(*ring, f"planned ellipse, {length:g} x {width:g} km", colour=GREY, width=1.0, border=True)]


def _part(run: Run, name: str, scale: float = 1.0) -> Trace:
    """The path of a discarded part to the ground."""
    east, north = (run[f"truth.{name}_{way}_m"] / scale for way in ("east", "north"))
    there = np.isfinite(east)
    return Trace(east[there], north[there], name.replace("_", " "), colour=_PARTS[name], dash="dash")


def events_on_map(run: Run, names: dict[str, str], scale: float = 1e3) -> Trace:
    """Return events as labelled points of the map, whose unit is ``scale`` (m)."""
    return placed(run, EAST, NORTH, names, (1.0 / scale, 1.0 / scale))


def hazard_maps(run: Run) -> Iterator[Figure]:
    """Draw the choice on the landing image and the map of the scan, of a flight that chose from a scan."""
    if (found := run.landing_map) is None:
        return
    if len(found.coarse_m):
        yield coarse_choice(run, found)
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
    passed = through(found.rejected_m, "passed over", "points", colour=ORANGE, symbol="x", width=3.0)
    traces = [*entries, *[passed] * bool(len(found.rejected_m)), *way]
    classes = site_panel(traces, title="what it made of them", heat=kinds)
    seen = site_panel(way, title="what it saw: height above the ground below", heat=heights)
    panels, caption = [classes, seen], _words(run, found)
    yield Figure("hazard_map", "Map of hazards from hover", panels, caption, columns=2, height=480)


def _words(run: Run, found: LandingMap) -> str:
    """A caption that explains the map and the choice."""
    safe = 100.0 * np.mean(found.cell_class == CELL_CLASSES.index("safe"))
    away = float(np.hypot(*(found.spot_m - found.hover_m[:2])))
    reasons = Counter(found.reasons()).most_common()
    text = f"Of the map {safe:.0f} % is safe for the whole footprint. "
    if passed := ", ".join(f"{count} for {name}" for name, count in reasons):
        text += f"On its way out from the point below, the search passed over unsafe spots: {passed} "
        text += f"(the first {len(found.rejected_m)} that lie a footprint apart); "
    else:
        text += "The search passed over nothing; "
    if not found.found:
        return text + f"no spot was safe, and it took the least bad one, {away:.1f} m away."
    cell = np.floor((found.spot_m - found.corner_m) / found.cell_m).astype(int)
    clear = float(found.clearance_m[cell[1], cell[0]])
    text += f"the chosen spot lies {away:.1f} m away and {clear:.1f} m from the nearest unsafe one. "
    return text + _nearer(run, found, away, clear)


def _nearer(run: Run, found: LandingMap, away: float, clear: float) -> str:
    """Sentence on a safe spot nearer than the chosen one, if any; ``away``, ``clear``: of that one, m."""
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


def coarse_choice(run: Run, found: LandingMap) -> Figure:
    """Draw the targets of the parts of the landing image, and where backshell and lander came down."""
    labels = [f"{100.0 * share:.1f} % obstacles" for share in found.coarse_obstacles]
    offered = through(found.coarse_m, "parts of the image", "points", colour=GREY, labels=labels, width=4.0)
    chosen = found.coarse_m[np.arange(len(found.coarse_m)) == found.coarse_part]
    taken = through(chosen, "part taken", "points", colour=VERMILION, symbol="diamond", width=4.0)
    drift = through(found.drift_m[:, :2], "backshell, as predicted", colour=PURPLE, dash="dot")
    # all in navigated coordinates, which contain the navigation error
    off = run["nav.error_east_m"], run["nav.error_north_m"]
    east, north = (run[f"truth.backshell_{way}_m"] + error for way, error in zip(_WAYS, off, strict=True))
    there = np.isfinite(east)
    shell = Trace(east[there], north[there], "backshell", colour=PURPLE, dash="dash")
    last = run.between("backshell")
    way_e, way_n = (values[last] for values in _navigated(run))
    lander = flown(way_e, way_n, "lander")
    panel = site_panel([offered, taken, drift, shell, lander])
    caption = (
        "Of the parts of the landing image whose target is away from the predicted path of backshell and "
        "canopy, the one with the fewest obstacles is taken. "
    )
    caption += "" if len(chosen) else "None was: the plain divert rule has set the target."
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


def middles(found: LandingMap) -> tuple[np.ndarray, np.ndarray]:
    """Return east and north (m) of the middles of the columns and rows of the map."""
    step = (np.arange(len(found.cell_class)) + 0.5) * float(found.cell_m)
    return float(found.corner_m[0]) + step, float(found.corner_m[1]) + step


def _navigated(run: Run) -> list[np.ndarray]:
    """East and north (m) of the vehicle by its own navigation."""
    return [run[f"truth.site_{way}_m"] + run[f"nav.error_{way}_m"] for way in _WAYS]
