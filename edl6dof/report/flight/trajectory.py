"""The way down: overview over time, the entry in its corridor, and the deployment box."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from edl6dof.interface.roles import HOVER_IMAGING, begun
from edl6dof.report.figure import GREEN, GREY, VERMILION, Axis, Band, Figure, Panel, Trace
from edl6dof.report.flight.corridor import (
    Border,
    Entry,
    aerodynamic_accelerations,
    borders,
    entry_state,
    equilibrium_glide,
)
from edl6dof.report.flight.parts import (
    EVENTS,
    figure_of,
    flown,
    has_signal,
    legend_entry,
    phase_bands,
    phase_keys,
    placed,
)
from edl6dof.report.panels import OVERVIEW
from edl6dof.runs.run import Run


def figures(run: Run) -> Iterator[Figure]:
    """Figures of the section."""
    yield overview(run)
    entry = entry_state(run)
    if entry is not None:
        yield altitude_velocity(run, entry)
        yield drag_velocity(run, entry)
    if "mortar" in run.when:
        yield deployment_box(run)


def overview(run: Run) -> Figure:
    """What everyone asks first, over the whole flight."""
    figure, phases = figure_of(run, OVERVIEW), phase_keys(run)
    panels = [replace(panel, bands=phase_bands(run)) for panel in figure.panels]
    entries = [
        legend_entry(key.removeprefix("phase.").replace("_", " "), colour, border=True)
        for key, colour in phases.items()
    ]
    panels[0] = replace(panels[0], traces=[*panels[0].traces, *entries])
    caption = figure.caption + (" The ground colour is the mission phase." if phases else "")
    return replace(figure, panels=panels, caption=caption)


def forbidden(entry: Entry, found: list[Border], edge: float) -> list[Trace]:
    """The drag beyond the lowest border, up to ``edge``, as one shaded region."""
    if not found:
        return []
    lowest = np.minimum(np.min([border.drag for border in found], axis=0), edge)
    rows = np.linspace(0, len(entry.speed) - 1, 200).astype(int)
    x, y = entry.speed[rows] / 1e3, lowest[rows]
    around = np.append(x, x[::-1]), np.append(y, np.full(len(x), edge))
    return [Trace(*around, "beyond a limit", "region", VERMILION, border=True)]


def on_scale(panel: Panel) -> tuple[Panel, str]:
    """The panel without the borders of which nothing lies on its scales, and a sentence that names them."""
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
    """Drag over speed inside its corridor."""
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
    """Height above the areoid over speed inside its corridor."""
    rows = run.between(until="mortar")
    found = borders(run, entry)
    traces = []
    for border in (*found, glide(entry)):
        density = 2.0 * border.drag / entry.drag_per_pressure / entry.speed**2
        traces.append(border.trace(entry.speed, entry.height(density) / 1e3))
    traces.append(flown(run["truth.airspeed_m_s"] / 1e3, run["truth.height_above_areoid_m"] / 1e3))
    names: dict[str, str] = {key: EVENTS[key] for key in ("trim_wing", "mortar") if key in EVENTS}
    traces.append(placed(run, "truth.airspeed_m_s", "truth.height_above_areoid_m", names, (1e-3, 1e-3)))
    widest = float(run["truth.airspeed_m_s"][rows].max()) / 1e3
    top = float(run["truth.height_above_areoid_m"][rows].max()) / 1e3
    panel = Panel(
        Axis("speed in the air (km/s)", (widest * 1.03, 0.0)),
        Axis("height above the areoid (km)", (min(-5.0, 0.0), top)),
        traces,
    )
    panel, beyond = on_scale(panel)
    above = "; it must stay above the borders of its limits" if found else ""
    caption = f"The flight runs from left to right{above}.{beyond}"
    return Figure("altitude_velocity", _titled("Height over speed", panel), [panel], caption, height=380)


def glide(entry: Entry) -> Border:
    """The equilibrium glide."""
    return Border("equilibrium glide, lift up", equilibrium_glide(entry), GREEN, "dash")


def _titled(words: str, panel: Panel) -> str:
    """The title, which speaks of a corridor where a border of one is drawn."""
    return f"{words} in the corridor" if any(t.border and t.kind == "line" for t in panel.traces) else words


def deployment_box(run: Run) -> Figure:
    """Mach number and dynamic pressure around mortar fire, with the box that the parachute allows."""
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


def descent_plane(run: Run) -> Iterator[Figure]:
    """Height over descent speed: the plane in which powered descent is designed."""
    if "ignition" not in run.when:
        return
    rows = run.between("backshell", "touchdown")
    names = {"backshell": "backshell", "ignition": "", begun(HOVER_IMAGING): "hover"}
    curve = flown(run["truth.v_down_m_s"][rows], run["truth.height_m"][rows])
    panel = Panel(
        Axis("descent speed (m/s)"),
        Axis("height above the ground (m)"),
        [curve, placed(run, "truth.v_down_m_s", "truth.height_m", names)],
    )
    yield Figure("descent_plane", "Height above the ground over descent speed", [panel], height=320)
