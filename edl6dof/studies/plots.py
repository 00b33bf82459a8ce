"""Figures of studies, in the style of the reports: panels side by side, and the curves that papers draw."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from edl6dof.report.figure import BLACK, Axis, Figure, Panel, Trace


def figure(name: str, panels: Sequence[Panel]) -> Figure:
    """Panels side by side; the name is that of the file."""
    return Figure(name, "", panels, columns=len(panels), height=380)


def panel(
    title: str,
    x_label: str,
    y_label: str,
    traces: Sequence[Trace],
    *,
    equal: bool = False,
    x_range: tuple[float, float] | None = None,
    y_range: tuple[float, float] | None = None,
) -> Panel:
    """One pair of axes; ``x_range`` and ``y_range`` narrow it to where something is to be seen."""
    return Panel(Axis(x_label, x_range), Axis(y_label, y_range), traces, title=title, equal=equal)


def curve(x: np.ndarray, y: np.ndarray, label: str = "") -> Trace:
    """A line."""
    return Trace(np.asarray(x, float), np.asarray(y, float), label)


def reference(x: np.ndarray, y: np.ndarray, label: str = "") -> Trace:
    """What the curves are to be compared with: thin, black and dashed."""
    return Trace(np.asarray(x, float), np.asarray(y, float), label, colour=BLACK, dash="dash", width=1.2)


def dots(x: np.ndarray, y: np.ndarray, label: str = "") -> Trace:
    """A dot for each run."""
    return Trace(np.asarray(x, float), np.asarray(y, float), label, kind="points")


def histogram(sample: np.ndarray, label: str = "") -> Trace:
    """How often the finite values of a sample fall into bins of one width."""
    counts, edges = np.histogram(sample[np.isfinite(sample)], bins="auto")
    return Trace(0.5 * (edges[1:] + edges[:-1]), counts.astype(float), label, kind="bars")
