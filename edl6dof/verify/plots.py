"""One PNG for each case that has a history."""

from __future__ import annotations

from pathlib import Path

from edl6dof.verify.outcome import History


def save_plot(history: History, path: Path) -> None:
    """Draw the curves; what was expected is dashed on top."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(8.0, 4.5), layout="constrained")
    for name, values in history.curves.items():
        expected = name.endswith("expected")
        axes.plot(
            history.x, values, "k--" if expected else "-", linewidth=1.0 if expected else 2.0, label=name
        )
    axes.set(title=history.title, xlabel=history.x_label, ylabel=history.y_label)
    axes.grid(alpha=0.3)
    axes.legend()
    figure.savefig(path, dpi=120)
    pyplot.close(figure)
