"""Figures 3 to 6 of the paper, redrawn."""

from __future__ import annotations

import numpy as np
import pyarrow as pa

from edl6dof.report.figure import Figure, Panel
from edl6dof.studies import plots
from edl6dof.studies.cases import values
from edl6dof.studies.wu2013.experiments import KEPT, LAWS, PRINTED
from edl6dof.studies.wu2013.findings import Groups

TIME = "time (s)"


def drawings(
    start: dict[str, np.ndarray], flights: dict[str, dict[str, np.ndarray]], groups: Groups
) -> tuple[Figure, ...]:
    """Of a flight whose observer starts away from the drag, of flights by label, and of all misses."""
    return (
        _estimates(start),
        _tracking(flights),
        _scatter("fig5_fig6_misses", PRINTED.name, groups),
        _scatter("misses_without_update", KEPT.name, groups),
    )


def _estimates(h: dict[str, np.ndarray]) -> Figure:
    t, first = h["t_s"], (0.0, 2.0)
    drag = plots.curve(t, h["drag_estimate"], "estimate"), plots.reference(t, h["drag"], "true")
    rate = plots.curve(t, h["rate_estimate"], "estimate"), plots.reference(t, h["rate"], "true")
    return plots.figure(
        "fig3_estimates",
        (
            plots.panel("Drag", TIME, "drag (m/s2)", drag),
            plots.panel("Drag, 2 s", TIME, "drag (m/s2)", drag, y_range=(4.0, 9.0), x_range=first),
            plots.panel("Drag rate", TIME, "drag rate (m/s3)", rate, y_range=(-4.0, 6.0)),
            plots.panel("Drag rate, 2 s", TIME, "drag rate (m/s3)", rate, y_range=(-1.0, 4.0), x_range=first),
        ),
    )


def _tracking(flights: dict[str, dict[str, np.ndarray]]) -> Figure:
    h = next(iter(flights.values()))
    t = h["t_s"]
    followed = plots.curve(t, h["drag"], "flown"), plots.reference(t, h["reference"], "reference")
    errors = tuple(plots.curve(x["t_s"], x["drag"] - x["reference"], label) for label, x in flights.items())
    return plots.figure(
        "fig4_tracking",
        (
            plots.panel("Drag", TIME, "drag (m/s2)", followed),
            plots.panel("Tracking error", TIME, "D - D_r (m/s2)", errors),
            plots.panel("Bank angle", TIME, "bank (deg)", (plots.curve(t, h["bank_deg"]),)),
        ),
    )


def _scatter(name: str, experiment: str, groups: Groups) -> Figure:
    return plots.figure(
        name, tuple(_misses(groups[experiment, law], f"{label}, {experiment}") for law, label in LAWS.items())
    )


def _misses(table: pa.Table, title: str) -> Panel:
    cross, down = (values(table, f"parachute_{name}_m") / 1e3 for name in ("crossrange", "downrange"))
    return plots.panel(
        title, "across the track (km)", "along the track (km)", (plots.dots(cross, down),), equal=True
    )
