"""A sweep as maps: success and figures over the grid."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from edl6dof.metrics.figures import FigureOfMerit, figure_of_merit
from edl6dof.report.campaign.results import Results
from edl6dof.report.figure import Axis, Figure, Heat, Panel, Trace
from edl6dof.report.numbers import printed

#: Figures mapped over the grid, besides success.
_FIGURES = (
    *("landing_distance_m", "parachute_mach", "parachute_height_m"),
    *("touchdown_vertical_m_s", "propellant_used_kg", "peak_load_g0"),
)


def figures(results: Results) -> Iterator[Figure]:
    """Maps over the first two axes, the mean over all others and over dispersed flights; curves where there
    is one axis.
    """
    axes = [name for name in _axes(results) if results.has(name)]
    shown = [figure_of_merit(name) for name in _FIGURES if results.has(name)]
    columns = [
        ("success (%)", 100.0 * results.ok),
        *((_label(figure), results[figure.name]) for figure in shown),
    ]
    if len(axes) >= 2:
        yield from _maps(results, axes, columns)
    elif axes:
        yield _curves(results, axes[0], columns)


def _label(figure: FigureOfMerit) -> str:
    return f"{figure.meaning} ({printed(figure.unit.label)})" if figure.unit.label else figure.meaning


def _axes(results: Results) -> list[str]:
    sweep = results.document.get("sweep") or {"axes": []}
    return [("truth." if axis.get("of") == "truth" else "belief.") + axis["path"] for axis in sweep["axes"]]


def _maps(results: Results, axes: list[str], columns: list[tuple[str, np.ndarray]]) -> Iterator[Figure]:
    x, y = (results[name] for name in axes[:2])
    across, up = np.unique(x), np.unique(y)
    panels = []
    for label, values in columns:
        mean = np.array([[_mean(values[(x == a) & (y == b)]) for a in across] for b in up])
        finite = mean[np.isfinite(mean)]
        success = label.startswith("success")
        if not success and (not len(finite) or np.ptp(finite) == 0.0):
            continue  # the same everywhere, which no map need show
        low, high = (0.0, 100.0) if success else (float(finite.min()), float(finite.max()))
        heat = Heat(across, up, mean, label, low, high)
        panels.append(Panel(Axis(_short(axes[0])), Axis(_short(axes[1])), heat=heat))
    yield Figure("sweep", "Sweep", panels, "Mean over the flights at each point.", height=260)


def _curves(results: Results, axis: str, columns: list[tuple[str, np.ndarray]]) -> Figure:
    x = results[axis]
    points = np.unique(x)
    panels = [
        Panel(
            Axis(_short(axis)),
            Axis(label),
            [Trace(points, np.array([_mean(values[x == point]) for point in points]), label, legend=False)],
        )
        for label, values in columns
    ]
    return Figure("sweep", "Sweep", panels, "Mean over the flights at each point.", columns=2, height=260)


def _mean(values: np.ndarray) -> float:
    finite = values[np.isfinite(values)]
    return float(finite.mean()) if len(finite) else float("nan")


def _short(path: str) -> str:
    return path.split(".", 1)[1]
