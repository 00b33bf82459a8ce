"""Drawings of studies in the style of the reports: each becomes a figure with its panels side by side, and
that a PNG.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from edl6dof.report.figure import BLACK, Axis, Figure, Panel, Trace
from edl6dof.report.paper import write_figure
from edl6dof.studies import study


def save_drawing(drawing: study.Drawing, folder: Path) -> Path:
    """Write ``<folder>/<name>.png`` and return its path."""
    path = folder / f"{drawing.name}.png"
    write_figure(figure_of(drawing), path)
    return path


def figure_of(drawing: study.Drawing) -> Figure:
    """The drawing as a figure of a report."""
    return Figure(
        drawing.name, "", [_panel(panel) for panel in drawing.panels], columns=len(drawing.panels), height=380
    )


def _panel(panel: study.Panel) -> Panel:
    counted = [curve.x for curve in panel.curves if curve.kind == "histogram"]
    x, y = Axis(panel.x_label, panel.x_range or _bins(counted)), Axis(panel.y_label, panel.y_range)
    return Panel(x, y, [_trace(curve) for curve in panel.curves], title=panel.title, equal=panel.equal)


def _bins(samples: list[np.ndarray]) -> tuple[float, float] | None:
    """Range that shows the outermost bars of histograms whole."""
    edges = [np.histogram_bin_edges(sample[np.isfinite(sample)], bins="auto") for sample in samples]
    return (float(min(e[0] for e in edges)), float(max(e[-1] for e in edges))) if edges else None


def _trace(curve: study.Curve) -> Trace:
    x, y, name = np.asarray(curve.x, float), np.asarray(curve.y, float), curve.label
    if curve.kind == "reference":
        return Trace(x, y, name, colour=BLACK, dash="dash", width=1.2)
    if curve.kind == "dots":
        return Trace(x, y, name, kind="points")
    if curve.kind == "filled":
        return Trace(np.concatenate([x, x[::-1]]), np.concatenate([y, np.zeros_like(y)]), name, kind="region")
    if curve.kind == "histogram":
        counts, edges = np.histogram(x[np.isfinite(x)], bins="auto")
        return Trace(0.5 * (edges[1:] + edges[:-1]), counts.astype(float), name, kind="bars")
    return Trace(x, y, name)
