"""One PNG for each case that has a history."""

from __future__ import annotations

from pathlib import Path

from edl6dof.report.figure import BLACK, Axis, Figure, Panel, Trace
from edl6dof.report.matplotlib_figure import write_figure
from edl6dof.verify.outcome import History


def save_plot(history: History, path: Path) -> None:
    """Draw the curves; what was expected is thin and dashed on top."""
    traces = [
        Trace(history.x, values, name, colour=BLACK, dash="dash", width=1.2)
        if name.endswith("expected")
        else Trace(history.x, values, name, width=3.0)
        for name, values in history.curves.items()
    ]
    panel = Panel(Axis(history.x_label), Axis(history.y_label), traces)
    write_figure(Figure(path.stem, history.title, [panel], height=380), path)
