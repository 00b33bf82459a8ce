"""The trajectory: overview over time, the entry in its corridor, deployment box, powered descent, and landing
site.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from edl6dof.interface.roles import HOVER_IMAGING, begun
from edl6dof.report.catalogue import OVERVIEW, STACKS
from edl6dof.report.figure import Axis, Band, Figure, Panel, Trace, legend_entry
from edl6dof.report.flight.common import (
    EVENTS,
    circle,
    figure_of,
    flown,
    has_signal,
    over_flight,
    phase_bands,
    phase_keys,
    placed,
    site_panel,
)
from edl6dof.report.flight.corridor import (
    Entry,
    aerodynamic_accelerations,
    borders,
    entry_state,
    forbidden,
    glide,
)
from edl6dof.report.palette import GREEN, GREY, ORANGE, PURPLE, VERMILION
from edl6dof.runs.run import Run
from edl6dof.scenario.terrain_preview import planned_ellipse

#: Parts that are discarded, and their colours.
_PARTS = {"canopy": GREY, "heat_shield": ORANGE, "backshell": PURPLE}
EAST, NORTH = "truth.site_east_m", "truth.site_north_m"


def figures(run: Run) -> Iterator[Figure]:
    """Draw the whole flight and the entry."""
    yield overview(run)
    entry = entry_state(run)
    if entry is not None:
        yield altitude_velocity(run, entry)
        yield drag_velocity(run, entry)
    if "mortar" in run.when:
        yield deployment_box(run)


def overview(run: Run) -> Figure:
    """Draw the main quantities over the whole flight."""
    figure, phases = figure_of(run, OVERVIEW), phase_keys(run)
    panels = [replace(panel, bands=phase_bands(run)) for panel in figure.panels]
    entries = [
        legend_entry(key.removeprefix("phase.").replace("_", " "), colour, border=True)
        for key, colour in phases.items()
    ]
    panels[0] = replace(panels[0], traces=[*panels[0].traces, *entries])
    caption = figure.caption + (" The ground colour is the mission phase." if phases else "")
    return replace(figure, panels=panels, caption=caption)


def on_scale(panel: Panel) -> tuple[Panel, str]:
    """Return the panel without the borders that lie outside its scales, and a sentence that names them."""
    (left, right), (low, high) = (sorted(panel.span(axis)) for axis in ("x", "y"))
    seen = [
        not trace.border
        or bool(np.any((trace.x >= left) & (trace.x <= right) & (trace.y >= low) & (trace.y <= high)))
        for trace in panel.traces
    ]
    beyond = [
        trace.name
        for trace, on in zip(panel.traces, seen, strict=True)
        if not on and trace.name and np.isfinite(trace.y).any()
    ]
    words = f" Beyond the scale: {', '.join(beyond)}." if beyond else ""
    return replace(panel, traces=[trace for trace, on in zip(panel.traces, seen, strict=True) if on]), words


def drag_velocity(run: Run, entry: Entry) -> Figure:
    """Draw drag over speed inside its corridor."""
    found = borders(run, entry)
    lowest = min((float(border.drag.min()) for border in found), default=1.0)
    top = max(1.3 * float(entry.drag.max()), 1.2 * lowest)
    traces = forbidden(entry, found, top)
    traces += [border.trace(entry.speed, border.drag) for border in (*found, glide(entry))]
    rows = run.between(until="mortar")
    speed, reference = run["truth.airspeed_m_s"][rows] / 1e3, run["guide.reference_drag_m_s2"][rows]
    if np.any(reference > 0.0):
        given = np.where(reference > 0.0, reference, np.nan)
        traces.append(Trace(speed, given, "reference", colour=GREY, width=2.2))
    traces.append(flown(speed, aerodynamic_accelerations(run, rows)[0]))
    panel = Panel(
        Axis("speed in the air (km/s)", (float(entry.speed.max()) / 1e3 * 1.03, 0.0)),
        Axis("drag acceleration (m/s²)", (0.0, top)),
        traces,
    )
    panel, beyond = on_scale(panel)
    caption = "The flight runs from left to right."
    if found:
        caption += " Borders are limits of the scenario, turned into drag by this flight's own aerodynamics."
    caption += beyond
    return Figure("drag_velocity", _titled("Drag over speed", panel), [panel], caption, height=380)


def altitude_velocity(run: Run, entry: Entry) -> Figure:
    """Draw height above the areoid over speed inside its corridor."""
    speed, height = run["truth.airspeed_m_s"] / 1e3, run["truth.height_above_areoid_m"] / 1e3
    rows = run.between(until="mortar")
    found = borders(run, entry)
    traces = []
    for border in (*found, glide(entry)):
        density = 2.0 * border.drag / entry.drag_per_pressure / entry.speed**2
        traces.append(border.trace(entry.speed, entry.height(density) / 1e3))
    names = {key: EVENTS[key] for key in ("trim_wing", "mortar")}
    events = placed(run, "truth.airspeed_m_s", "truth.height_above_areoid_m", names, (1e-3, 1e-3))
    panel = Panel(
        Axis("speed in the air (km/s)", (float(speed[rows].max()) * 1.03, 0.0)),
        Axis("height above the areoid (km)", (-5.0, float(height[rows].max()))),
        [*traces, flown(speed, height), events],
    )
    panel, beyond = on_scale(panel)
    above = "; it must stay above the borders of its limits" if found else ""
    caption = f"The flight runs from left to right{above}.{beyond}"
    return Figure("altitude_velocity", _titled("Height over speed", panel), [panel], caption, height=380)


def _titled(words: str, panel: Panel) -> str:
    """The title, with the corridor if a border of it is drawn."""
    return f"{words} in the corridor" if any(t.border and t.kind == "line" for t in panel.traces) else words


def deployment_box(run: Run) -> Figure:
    """Draw Mach number and dynamic pressure around mortar fire, with the box that the parachute allows."""
    limit = run.scenario["limits"]
    most = float(limit["parachute_mach_max"]), float(limit["parachute_dynamic_pressure_pa"])
    t0 = run.when["mortar"]
    rows = (run.t > t0 - 60.0) & (run.t < t0 + 60.0) & (run["truth.mach"] < 1.7 * most[0])
    top = 1.25 * max(most[1], float(run["truth.dynamic_pressure_pa"][rows].max()))
    names = {"mortar": "mortar fire", "line_stretch": "", "trim_wing": "trim wing"}
    traces = [
        flown(run["truth.mach"][rows], run["truth.dynamic_pressure_pa"][rows]),
        placed(run, "truth.mach", "truth.dynamic_pressure_pa", names),
    ]
    words = f"Mach ≤ {most[0]:g}, ≤ {most[1]:g} Pa"
    box = Band(GREEN, (0.0, most[0]), (0.0, most[1]), words, 0.14, outline=True)
    x = Axis("Mach number (1)", (0.0, 1.7 * most[0]))
    panel = Panel(x, Axis("dynamic pressure (Pa)", (0.0, top)), traces, [box])
    alpha = run.at("truth.total_alpha_deg", t0)
    caption = ""
    if has_signal(run, "truth.total_alpha_deg"):
        allowed = float(limit["parachute_total_alpha_deg"])
        caption = f"At mortar fire the total angle of attack was {alpha:.2f} deg (allowed {allowed:g} deg)."
    return Figure("deployment_box", "Parachute deployment box", [panel], caption, height=340)


def powered_descent(run: Run) -> Iterator[Figure]:
    """Draw height over descent speed, in which powered descent is designed; then its plots over time."""
    if "ignition" in run.when:
        rows = run.between("backshell", "touchdown")
        names = {"backshell": "backshell", "ignition": "", begun(HOVER_IMAGING): "hover"}
        curve = flown(run["truth.v_down_m_s"][rows], run["truth.height_m"][rows])
        events = placed(run, "truth.v_down_m_s", "truth.height_m", names)
        panel = Panel(Axis("descent speed (m/s)"), Axis("height above the ground (m)"), [curve, events])
        yield Figure("descent_plane", "Height above the ground over descent speed", [panel], height=320)
    yield from over_flight(run, STACKS["landing"])


def site_figures(run: Run) -> Iterator[Figure]:
    """Draw ground track and landing site."""
    yield ground_track(run)
    if "mortar" in run.when and "backshell" in run.when:
        yield landing_site(run)


def ground_track(run: Run) -> Figure:
    """Draw the whole path east and north of the landing site; the axes have different scales."""
    traces = [_track(run, slice(None), 1e3), _target(run), _events(run, {"mortar": "parachute"}, 1e3)]
    caption = "Axes have different scales."
    if run.summary["figures"].get("bank_reversals"):
        caption += " Bank reversals keep the track inside the corridor of crossrange."
    panel = site_panel(traces, unit="km", equal=False)
    return Figure("ground_track", "Ground track", [panel], caption, height=420)


def landing_site(run: Run) -> Figure:
    """Draw the planned ellipse if there is one, the parachute descent, and the last leg, to scale."""
    last = run.between("backshell")
    target, planned, below = [_target(run)], _planned(run), _track(run, run.between("mortar"), 1e3)
    limit, allowed = run.scenario["limits"]["landing_distance_m"], []
    if limit is not None:
        x, y = circle((0.0, 0.0), float(limit) / 1e3, 181)
        allowed = [Trace(x, y, "allowed distance", colour=GREEN, dash="dash", width=1.2, border=True)]
    panels = []
    if planned:
        panels.append(site_panel([*planned, *allowed, below, *target], unit="km", title="planned ellipse"))
    parts = [_part(run, name, 1e3) for name in _PARTS]
    traces = [
        *([] if planned else allowed),
        *parts,
        below,
        *target,
        _events(run, {"mortar": "parachute"}, 1e3),
    ]
    panels.append(site_panel(traces, unit="km", title="from the parachute on"))
    reach = float(np.hypot(np.ptp(run[EAST][last]), np.ptp(run[NORTH][last])))
    away = float(np.hypot(run[EAST][last], run[NORTH][last]).min())
    near = target if away < 2.0 * reach else []  # else there were nothing else to be seen
    traces = [_part(run, "backshell"), _track(run, last), *near, _events(run, {"touchdown": "touchdown"})]
    panels.append(site_panel(traces, title="powered descent"))
    landed, caption = run.summary["figures"], ""
    if landed.get("landing_distance_m") is not None:
        offset = f"{landed['landing_east_m']:+,.0f} m east, {landed['landing_north_m']:+,.0f} m north"
        caption = f"Landed {landed['landing_distance_m']:,.0f} m from the target: {offset}."
    return Figure("landing_site", "Landing site", panels, caption, columns=len(panels), height=460)


def _track(run: Run, rows: np.ndarray | slice, scale: float = 1.0) -> Trace:
    return flown(run[EAST][rows] / scale, run[NORTH][rows] / scale, "vehicle")


def _target(run: Run) -> Trace:
    """The landing site, called target unless the flight only has to last."""
    name = "landing site" if run.scenario["mission"]["goal"] == "time" else "target"
    return Trace(np.zeros(1), np.zeros(1), name, "points", VERMILION, symbol="cross", width=3.0, border=True)


def _planned(run: Run) -> list[Trace]:
    """The planned landing ellipse (km), if the scenario has one."""
    terrain = run.scenario["terrain"]
    length, width = (float(terrain[f"ellipse_{side}_m"]) / 1e3 for side in ("length", "width"))
    if length <= 0.0:
        return []
    east, north = planned_ellipse(length, width, np.radians(terrain["ellipse_azimuth_deg"]))
    name = f"planned ellipse, {length:g} x {width:g} km"
    return [Trace(east, north, name, colour=GREY, width=1.0, border=True)]


def _part(run: Run, name: str, scale: float = 1.0) -> Trace:
    """The path of a discarded part to the ground."""
    east, north = (run[f"truth.{name}_{way}_m"] / scale for way in ("east", "north"))
    there = np.isfinite(east)
    return Trace(east[there], north[there], name.replace("_", " "), colour=_PARTS[name], dash="dash")


def _events(run: Run, names: dict[str, str], scale: float = 1.0) -> Trace:
    return placed(run, EAST, NORTH, names, (1.0 / scale, 1.0 / scale))
