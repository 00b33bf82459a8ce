"""The trajectory: the whole flight over time, the entry in its corridor, and the deployment box of the
parachute.

The corridor is the drag over speed that lift and the limits of the scenario allow.  Its borders follow from
data of the flight: air density over height, drag and load per dynamic pressure over speed, and the constant
of the heat-flux law.  With these, a limit on dynamic pressure, load or heat flux becomes a drag, or a height
above the areoid, at every speed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import cycle, pairwise
from typing import NamedTuple

import numpy as np

from edl6dof.config.units import G0
from edl6dof.report.catalogue import NEAR_GROUND, OVERVIEW
from edl6dof.report.figure import Axis, Band, Dash, Figure, Panel, Trace, legend_entry
from edl6dof.report.flight.common import EVENTS, figure_of, flown, has_signal, over_flight, placed
from edl6dof.report.palette import GREEN, GREY, ORANGE, PHASES, PURPLE, VERMILION
from edl6dof.runs.run import Run

#: Dynamic pressure (Pa) below which quotients by it are not used.
THIN_AIR = 5.0
#: Time (s) over which lift and drag are averaged for the borders.
CALM_S = 8.0
#: Lift-to-drag ratio below which no equilibrium glide is drawn.
LEAST_LIFT = 0.08


def figures(run: Run) -> Iterator[Figure]:
    """Draw the whole flight and the entry."""
    yield overview(run)
    yield from over_flight(run, [NEAR_GROUND])
    if (entry := entry_state(run)) is not None:
        yield altitude_velocity(run, entry)
        yield drag_velocity(run, entry)
    if "mortar" in run.when:
        yield deployment_box(run)


def overview(run: Run) -> Figure:
    """Draw the main quantities over the whole flight, on the colours of the mission phases."""
    figure = figure_of(run, OVERVIEW)
    phases = [name for name in run.phase_names if f"phase.{name}" in run.when]
    spans = pairwise([*(run.when[f"phase.{name}"] for name in phases), float(run.t[-1])])
    bands = [Band(colour, x=span, opacity=0.75) for colour, span in zip(cycle(PHASES), spans, strict=False)]
    panels = [replace(panel, bands=bands) for panel in figure.panels]
    named = zip(phases, bands, strict=True)
    entries = [legend_entry(name.replace("_", " "), band.colour, border=True) for name, band in named]
    panels[0] = replace(panels[0], traces=[*panels[0].traces, *entries])
    caption = figure.caption + (" The ground colour is the mission phase." if phases else "")
    return replace(figure, panels=panels, caption=caption)


def on_scale(key: str, title: str, panel: Panel, caption: str) -> Figure:
    """Return a figure without the borders that lie outside its scales, which the caption names."""
    (left, right), (low, high) = (sorted(panel.span(axis)) for axis in ("x", "y"))
    kept, beyond = list[Trace](), list[str]()
    for trace in panel.traces:
        inside = (trace.x >= left) & (trace.x <= right) & (trace.y >= low) & (trace.y <= high)
        if not trace.border or inside.any():
            kept.append(trace)
        elif trace.name and np.isfinite(trace.y).any():
            beyond.append(trace.name)
    caption += f" Beyond the scale: {', '.join(beyond)}." if beyond else ""
    title += " in the corridor" if any(one.border and one.kind == "line" for one in kept) else ""
    return Figure(key, title, [replace(panel, traces=kept)], caption, height=380)


def drag_velocity(run: Run, entry: Entry) -> Figure:
    """Draw drag over speed inside its corridor."""
    found = borders(run, entry)
    lowest = min((float(border.y.min()) for border in found), default=1.0)
    top = max(1.3 * float(entry.drag.max()), 1.2 * lowest)
    traces = [*forbidden(entry, found, top), *found, glide(entry)]
    rows = run.between(until="mortar")
    speed, reference = run["truth.airspeed_m_s"][rows] / 1e3, run["guide.reference_drag_m_s2"][rows]
    if np.any(reference > 0.0):
        given = np.where(reference > 0.0, reference, np.nan)
        traces.append(Trace(speed, given, "reference", colour=GREY, width=2.2))
    traces.append(flown(speed, aerodynamic_accelerations(run, rows)[0]))
    caption = "The flight runs from left to right."
    if found:
        caption += " Borders are limits of the scenario, turned into drag by this flight's own aerodynamics."
    x = Axis("speed in the air (km/s)", (float(entry.speed.max()) / 1e3 * 1.03, 0.0))
    panel = Panel(x, Axis("drag acceleration (m/s²)", (0.0, top)), traces)
    return on_scale("drag_velocity", "Drag over speed", panel, caption)


def altitude_velocity(run: Run, entry: Entry) -> Figure:
    """Draw height above the areoid over speed inside its corridor."""
    speed, height = run["truth.airspeed_m_s"] / 1e3, run["truth.height_above_areoid_m"] / 1e3
    rows = run.between(until="mortar")
    found = borders(run, entry)
    traces = []
    for border in (*found, glide(entry)):
        density = 2.0 * border.y / entry.drag_per_pressure / entry.speed**2
        traces.append(replace(border, y=entry.height(density) / 1e3))
    names = {key: EVENTS[key] for key in ("trim_wing", "mortar")}
    events = placed(run, "truth.airspeed_m_s", "truth.height_above_areoid_m", names, (1e-3, 1e-3))
    x = Axis("speed in the air (km/s)", (float(speed[rows].max()) * 1.03, 0.0))
    y = Axis("height above the areoid (km)", (-5.0, float(height[rows].max())))
    above = "; it must stay above the borders of its limits" if found else ""
    caption = f"The flight runs from left to right{above}."
    panel = Panel(x, y, [*traces, flown(speed, height), events])
    return on_scale("altitude_velocity", "Height over speed", panel, caption)


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
    caption = ""
    if has_signal(run, "truth.total_alpha_deg"):
        alpha, allowed = run.at("truth.total_alpha_deg", t0), float(limit["parachute_total_alpha_deg"])
        caption = f"At mortar fire the total angle of attack was {alpha:.2f} deg (allowed {allowed:g} deg)."
    return Figure("deployment_box", "Parachute deployment box", [panel], caption, height=340)


class Entry(NamedTuple):
    """Entry from the first air to the parachute, at rows of falling speed, shape (n,), SI; and the density
    (kg/m3) and height (m above the areoid) of the air that was flown through.
    """

    speed: np.ndarray
    drag: np.ndarray
    lift_to_drag: np.ndarray
    drag_per_pressure: np.ndarray
    load_per_pressure: np.ndarray
    heat_constant: float
    profile_density: np.ndarray
    profile_height: np.ndarray
    radius: float
    gravity: float

    def height(self, density: np.ndarray) -> np.ndarray:
        """Return the height (m above the areoid) at which the flown air has a density; NaN outside it."""
        log = np.log(np.maximum(density, 1e-30))
        return np.interp(log, np.log(self.profile_density), self.profile_height, left=np.nan, right=np.nan)


def entry_state(run: Run) -> Entry | None:
    """Return the state from which the corridor is drawn; ``None`` for a flight without entry."""
    rows = run.between(until="mortar") & (run["truth.height_m"] > 0.0)
    rows &= run["truth.dynamic_pressure_pa"] > THIN_AIR
    if rows.sum() < 50 or not has_signal(run, "truth.heat_flux_w_cm2"):
        return None
    order = np.flatnonzero(rows)
    fastest = np.minimum.accumulate(run["truth.airspeed_m_s"][order])
    order = order[np.append(True, fastest[1:] < fastest[:-1])]
    drag, lift = (_calm(run, values)[order] for values in aerodynamic_accelerations(run))
    pressure, speed = run["truth.dynamic_pressure_pa"][order], run["truth.airspeed_m_s"][order]
    heat = run["truth.heat_flux_w_cm2"][order] / (np.sqrt(run["truth.density_kg_m3"][order]) * speed**3)
    air = run["truth.density_kg_m3"] > 0.0
    rising = np.flatnonzero(air)[np.argsort(run["truth.density_kg_m3"][air], kind="stable")][::10]
    planet = run.scenario["planet"]
    gliding = (run.t[order] < run.when.get("trim_wing", np.inf)) & (drag > 0.0)
    glide = np.divide(lift, drag, out=np.full_like(drag, np.nan), where=gliding)
    radius = float(planet["equatorial_radius_m"])
    return Entry(
        speed, drag, glide, drag / pressure, np.hypot(drag, lift) / pressure, float(np.median(heat)),
        run["truth.density_kg_m3"][rising], run["truth.height_above_areoid_m"][rising], radius,
        float(planet["gravity"]["mu_m3_s2"]) / radius**2,
    )  # fmt: skip


def aerodynamic_accelerations(
    run: Run, rows: np.ndarray | slice = slice(None)
) -> tuple[np.ndarray, np.ndarray]:
    """Return drag and lift acceleration, m/s2, from the aerodynamic force in B and the wind angles."""
    alpha, beta = (np.radians(run[f"truth.{name}_deg"][rows]) for name in ("alpha", "beta"))
    along = (np.cos(alpha) * np.cos(beta), np.sin(beta), np.sin(alpha) * np.cos(beta))
    force = [run[f"truth.aero_force_{axis}_n"][rows] / run["truth.mass_kg"][rows] for axis in "xyz"]
    drag = -sum(f * a for f, a in zip(force, along, strict=True))
    return drag, np.sqrt(np.maximum(sum(f * f for f in force) - drag * drag, 0.0))


def _calm(run: Run, values: np.ndarray) -> np.ndarray:
    """Moving mean of ``values`` over some seconds, which removes the oscillation of the angle of attack."""
    rows = max(int(CALM_S / max(float(np.median(np.diff(run.t))), 1e-6)), 1)
    held = np.pad(values, (rows // 2, rows - 1 - rows // 2), mode="edge")
    return np.convolve(held, np.full(rows, 1.0 / rows), mode="valid")


def _border(entry: Entry, name: str, drag: np.ndarray, colour: str, dash: Dash) -> Trace:
    return Trace(entry.speed / 1e3, drag, name, colour=colour, dash=dash, border=True)


def borders(run: Run, entry: Entry) -> list[Trace]:
    """Return the drag (m/s2) over speed (km/s) of the limits that the scenario sets; heat by convection."""
    limit, found = run.scenario["limits"], list[Trace]()
    if (most := limit.get("entry_heat_flux_w_cm2")) is not None:
        pressure = 0.5 * (most / (entry.heat_constant * entry.speed**3)) ** 2 * entry.speed**2
        drag = pressure * entry.drag_per_pressure
        found.append(_border(entry, f"heat flux {most:g} W/cm²", drag, VERMILION, "dash"))
    if (most := limit.get("entry_dynamic_pressure_pa")) is not None:
        drag = most * entry.drag_per_pressure
        found.append(_border(entry, f"dynamic pressure {most / 1e3:g} kPa", drag, ORANGE, "dashdot"))
    if (most := limit.get("entry_load_g0")) is not None:
        drag = most * G0 * entry.drag_per_pressure / entry.load_per_pressure
        found.append(_border(entry, f"load {most:g} g", drag, PURPLE, "dot"))
    return found


def glide(entry: Entry) -> Trace:
    """Return the drag (m/s2) of the equilibrium glide, in which full lift up keeps the flight-path angle
    constant, with the gravity and radius at the ground; NaN above circular speed and without lift.
    """
    need = entry.gravity - entry.speed**2 / entry.radius
    lifting = (need > 0.0) & (entry.lift_to_drag > LEAST_LIFT)
    drag = np.where(lifting, need / entry.lift_to_drag, np.nan)
    return _border(entry, "equilibrium glide, lift up", drag, GREEN, "dash")


def forbidden(entry: Entry, found: list[Trace], edge: float) -> list[Trace]:
    """Return the drag (m/s2) above the lowest border, up to ``edge``, as one shaded region."""
    if not found:
        return []
    lowest = np.minimum(np.min([border.y for border in found], axis=0), edge)
    rows = np.linspace(0, len(entry.speed) - 1, 200).astype(int)
    x, y = entry.speed[rows] / 1e3, lowest[rows]
    around = np.append(x, x[::-1]), np.append(y, np.full(len(x), edge))
    return [Trace(*around, "beyond a limit", "region", VERMILION, border=True)]
