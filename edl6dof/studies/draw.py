"""Drawings as PNG files, by matplotlib."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from edl6dof.studies.study import Curve, Drawing, Panel


def save_drawing(drawing: Drawing, folder: Path) -> Path:
    """Write ``<folder>/<name>.png`` and return its path.

    Raises:
        ImportError: matplotlib is not installed.
    """
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    columns = len(drawing.panels)
    figure, axes = pyplot.subplots(1, columns, figsize=(6.4 * columns, 4.2), layout="constrained", squeeze=False)
    for panel, place in zip(drawing.panels, axes[0], strict=True):
        _draw_panel(panel, place)
    path = folder / f"{drawing.name}.png"
    figure.savefig(path, dpi=110)
    pyplot.close(figure)
    return path


def _draw_panel(panel: Panel, axes: Any) -> None:
    for curve in panel.curves:
        _draw_curve(curve, axes)
    axes.set(title=panel.title, xlabel=panel.x_label, ylabel=panel.y_label)
    if panel.x_range is not None:
        axes.set_xlim(panel.x_range)
    if panel.y_range is not None:
        axes.set_ylim(panel.y_range)
    axes.grid(alpha=0.3)
    if panel.equal:
        axes.set_aspect("equal", adjustable="datalim")
    if any(curve.label for curve in panel.curves):
        axes.legend()


def _draw_curve(curve: Curve, axes: Any) -> None:
    label = curve.label or None
    if curve.kind == "histogram":
        axes.hist(curve.x, bins="auto", edgecolor="white", label=label)
    elif curve.kind == "dots":
        axes.plot(curve.x, curve.y, "o", markersize=4, markerfacecolor="none", label=label)
    elif curve.kind == "reference":
        axes.plot(curve.x, curve.y, "k--", linewidth=1.0, label=label)
    elif curve.kind == "filled":
        axes.fill_between(curve.x, curve.y, alpha=0.25, label=label)
    else:
        axes.plot(curve.x, curve.y, linewidth=1.6, label=label)
