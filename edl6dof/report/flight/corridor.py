"""The corridor of an entry: the drag over speed that lift and the limits of the scenario allow.

Its borders come from the flight itself: its own air density over height, drag and load per dynamic pressure
over speed and constant of the heat-flux law turn a limit on dynamic pressure, load or heat flux into a drag
or a height above the areoid at every speed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from edl6dof.config.units import G0
from edl6dof.report.figure import Dash, Trace
from edl6dof.report.flight.common import has_signal
from edl6dof.report.palette import GREEN, ORANGE, PURPLE, VERMILION
from edl6dof.runs.run import Run

#: Dynamic pressure (Pa) below which ratios to it say nothing.
THIN_AIR = 5.0
#: Time (s) over which lift and drag are averaged for the borders.
CALM_S = 8.0
#: Lift-to-drag ratio below which there is no gliding.
LEAST_LIFT = 0.08


class Entry(NamedTuple):
    """Entry from the first air to the parachute at falling speeds, shape (n,); and the air flown through."""

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
    """Return drag, lift and the ratios behind the corridor; ``None`` for a flight without entry."""
    rows = (
        run.between(until="mortar")
        & (run["truth.dynamic_pressure_pa"] > THIN_AIR)
        & (run["truth.height_m"] > 0.0)
    )
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
    """Mean over some seconds, without the oscillation of the angle of attack."""
    rows = max(int(CALM_S / max(float(np.median(np.diff(run.t))), 1e-6)), 1)
    held = np.pad(values, (rows // 2, rows - 1 - rows // 2), mode="edge")
    return np.convolve(held, np.full(rows, 1.0 / rows), mode="valid")


class Border(NamedTuple):
    """One border of the corridor: drag (m/s2) over ``Entry.speed``."""

    name: str
    drag: np.ndarray
    colour: str
    dash: Dash

    def trace(self, x: np.ndarray, y: np.ndarray) -> Trace:
        """Return the border in a plane: km/s, and ``y`` over it."""
        return Trace(x / 1e3, y, self.name, colour=self.colour, dash=self.dash, border=True)


def borders(run: Run, entry: Entry) -> list[Border]:
    """Return borders for the limits that the scenario sets."""
    limit = run.scenario["limits"]
    found = []
    if (most := limit.get("entry_heat_flux_w_cm2")) is not None:
        pressure = 0.5 * (most / (entry.heat_constant * entry.speed**3)) ** 2 * entry.speed**2
        drag = pressure * entry.drag_per_pressure
        found.append(Border(f"heat flux {most:g} W/cm²", drag, VERMILION, "dash"))
    if (most := limit.get("entry_dynamic_pressure_pa")) is not None:
        drag = most * entry.drag_per_pressure
        found.append(Border(f"dynamic pressure {most / 1e3:g} kPa", drag, ORANGE, "dashdot"))
    if (most := limit.get("entry_load_g0")) is not None:
        drag = most * G0 * entry.drag_per_pressure / entry.load_per_pressure
        found.append(Border(f"load {most:g} g", drag, PURPLE, "dot"))
    return found


def glide(entry: Entry) -> Border:
    """Return the equilibrium glide, in which full lift up holds the flight-path angle near the ground; NaN
    above circular speed and without lift.
    """
    need = entry.gravity - entry.speed**2 / entry.radius
    lifting = (need > 0.0) & (entry.lift_to_drag > LEAST_LIFT)
    drag = np.where(lifting, need / entry.lift_to_drag, np.nan)
    return Border("equilibrium glide, lift up", drag, GREEN, "dash")


def forbidden(entry: Entry, found: list[Border], edge: float) -> list[Trace]:
    """Return the drag beyond the lowest border, up to ``edge``, as one shaded region."""
    if not found:
        return []
    lowest = np.minimum(np.min([border.drag for border in found], axis=0), edge)
    rows = np.linspace(0, len(entry.speed) - 1, 200).astype(int)
    x, y = entry.speed[rows] / 1e3, lowest[rows]
    around = np.append(x, x[::-1]), np.append(y, np.full(len(x), edge))
    return [Trace(*around, "beyond a limit", "region", VERMILION, border=True)]
