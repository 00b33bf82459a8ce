"""Disturbance torque and force: what acted, and what the flight software estimated."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from edl6dof.report.figure import BLUE, ORANGE, Figure, Trace
from edl6dof.report.flight.parts import Curve, has_signal, over_time, stacked
from edl6dof.runs.run import Run

#: Share of the values that an axis has room for at least, and how much larger a peak is cut off.
BULK, PEAK = 0.999, 3.0


def figures(run: Run) -> Iterator[Figure]:
    """Figures of the section; the estimates only where the run has them."""
    rows = run.between(until="touchdown")
    if not any(has_signal(run, f"truth.disturbance_{axis}_nm") for axis in "xyz"):
        return
    panels = []
    for axis, name in zip("xyz", ("roll", "pitch", "yaw"), strict=True):
        curves = [
            Curve(f"estimate.torque_{axis}_nm", "estimated", colour=ORANGE),
            Curve(f"truth.disturbance_{axis}_nm", "true", colour=BLUE),
        ]
        panels.append(over_time(run, f"{name} (N m)", curves, rows, _span(run, curves, rows)))
    yield stacked(
        "disturbance_torque",
        "Disturbance torque",
        panels,
        f"Moment of {_all_acting(run)}, in body axes. An axis ends at what {100.0 * BULK:g} % of "
        f"the values stay within where a peak, as of touchdown, is over {PEAK:g} times as large.",
        160,
    )
    if any(has_signal(run, f"estimate.force_{axis}_n") for axis in "xyz"):
        yield force(run, rows)


def _all_acting(run: Run) -> str:
    """What a disturbance is of."""
    return "all but the thrusters" if run.scenario["vehicle"]["rcs"]["thrusters"] else "all that acts"


def _span(run: Run, curves: Sequence[Curve], rows: np.ndarray) -> tuple[float, float] | None:
    """First and last value of an axis that a single peak would leave nothing else on; else ``None``."""
    found = [np.abs(run[curve.channel][rows]) for curve in curves if curve.channel in run]
    bulk = max(float(np.nanquantile(one, BULK)) for one in found)
    if max(float(np.nanmax(one)) for one in found) <= PEAK * bulk:
        return None
    return -1.1 * bulk, 1.1 * bulk


def force(run: Run, rows: np.ndarray) -> Figure:
    """Estimated force beside the aerodynamic force and engine thrust, where no riser pulls in a direction
    that telemetry lacks.
    """
    free = np.where(run["truth.riser_tension_n"][rows] > 0.0, np.nan, 1.0)
    panels = []
    for axis in "xyz":
        panel = over_time(
            run, f"{axis} (N)", [Curve(f"estimate.force_{axis}_n", "estimated", colour=ORANGE)], rows
        )
        acted = run[f"truth.aero_force_{axis}_n"][rows] - (
            run["truth.engine_thrust_n"][rows] if axis == "x" else 0.0
        )
        panels.append(
            replace(panel, traces=[*panel.traces, Trace(run.t[rows], acted * free, "true", colour=BLUE)])
        )
    vehicle = run.scenario["vehicle"]
    engine = " and, along x, the engine" if vehicle["engines"] else ""
    pulled = " True values are left out while the parachute pulls." if vehicle["parachutes"] else ""
    caption = f"Force of {_all_acting(run)}, in body axes: air{engine}.{pulled}"
    return stacked("disturbance_force", "Disturbance force", panels, caption, 160)
