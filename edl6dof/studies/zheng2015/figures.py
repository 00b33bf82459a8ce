"""The paper's figures 3 to 6, redrawn; every panel says of which experiment."""

from __future__ import annotations

import numpy as np
import pyarrow as pa

from edl6dof.report.figure import Figure
from edl6dof.studies import plots
from edl6dof.studies.cases import values
from edl6dof.studies.zheng2015.experiments import AS_PRINTED, FLOWN, INFERRED, Experiment


def drawings(history: dict[str, np.ndarray], tables: dict[str, pa.Table]) -> tuple[Figure, ...]:
    """Figures 3 to 5 of one flight as printed, figure 6 of each experiment that is held against it."""
    h, t, time = history, history["t_s"], "time (s)"
    boundary = np.full_like(t, 0.1)
    drag = plots.curve(t, h["drag"], "flown"), plots.reference(t, h["reference"], "reference")
    bank = plots.curve(t, h["bank_deg"], "commanded"), plots.reference(t, h["planned_deg"], "reference")
    surface = (
        plots.curve(t, h["surface"]),
        plots.reference(t, boundary, "c_s"),
        plots.reference(t, -boundary),
    )
    disturbance = (
        plots.curve(t, h["estimate"], "estimate"),
        plots.reference(t[50:-2], h["disturbance"][50:-2], "true"),
    )
    return (
        plots.figure(
            "fig3_drag_and_bank",
            (
                plots.panel("Drag, as printed", time, "drag (m/s2)", drag),
                plots.panel("Bank angle, as printed", time, "|bank| (deg)", bank),
            ),
        ),
        plots.figure(
            "fig4_error_and_surface",
            (
                plots.panel(
                    "Drag tracking error, as printed",
                    time,
                    "D - D_r (m/s2)",
                    (plots.curve(t, h["drag"] - h["reference"]),),
                ),
                plots.panel("Sliding surface, as printed", time, "s (m/s3)", surface),
            ),
        ),
        plots.figure(
            "fig5_disturbance",
            (
                plots.panel("Lumped disturbance, as printed", time, "d (m/s4)", disturbance),
                plots.panel(
                    "Virtual state, as printed", time, "zeta (m/s3)", (plots.curve(t, h["virtual"]),)
                ),
            ),
        ),
        *(_misses(experiment, tables[experiment.name]) for experiment in (AS_PRINTED, INFERRED, FLOWN)),
    )


def _misses(experiment: Experiment, table: pa.Table) -> Figure:
    """Figure 6 of one experiment."""
    down, cross, altitude = (
        values(table, f"parachute_{name}_m") / 1e3 for name in ("downrange", "crossrange", "altitude")
    )
    angle = np.linspace(0.0, 2.0 * np.pi, 200)
    circles = (plots.reference(r * np.cos(angle), r * np.sin(angle), f"{r:g} km") for r in (3.0, 5.0))
    dots = plots.dots(down, cross, "runs"), *circles
    name = experiment.name
    return plots.figure(
        f"fig6_{name.replace(' ', '_')}",
        (
            plots.panel(f"Miss at 400 m/s, {name}", "downrange (km)", "crossrange (km)", dots, equal=True),
            plots.panel(
                f"Terminal altitude, {name}",
                "altitude above 3394.5 km (km)",
                "runs",
                (plots.histogram(altitude),),
            ),
        ),
    )
