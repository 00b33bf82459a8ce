"""Figures by matplotlib, for paper: PNG, SVG or a page of a PDF."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from edl6dof.report.figure import Axis, Figure, Heat, Trace, cell_edges, thinned
from edl6dof.report.label_layout import Side, sides, spelt
from edl6dof.report.palette import GREY, INK, RULE

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.container import BarContainer
    from matplotlib.figure import Figure as Canvas
    from matplotlib.figure import SubFigure

    Shown = Artist | BarContainer

#: Width of a figure across the text of an A4 page, in.
WIDTH = 7.0
PIXELS_PER_INCH = 1000.0 / WIDTH
#: Settings of matplotlib; ``Any``, because matplotlib's own type is a literal of all their names.
STYLE: Any = {
    "font.family": "sans-serif", "font.size": 8.0, "axes.titlesize": "medium", "axes.titleweight": "bold",
    "axes.edgecolor": GREY, "axes.linewidth": 0.7, "axes.grid": True, "axes.axisbelow": True,
    "grid.color": RULE, "grid.linewidth": 0.6, "legend.frameon": False, "legend.fontsize": "medium",
    "xtick.color": INK, "ytick.color": INK, "pdf.fonttype": 42, "svg.fonttype": "none", "path.simplify": True,
}  # fmt: skip
#: Letters of all names along an axis beyond which the names are written vertically.
_NAMES_IN_LINE = 60

_DASHES: dict[str, Any] = {
    "solid": "-", "dash": (0, (5, 2)), "dot": (0, (1, 1.6)), "dashdot": (0, (5, 2, 1, 2)),
}  # fmt: skip
_SYMBOLS = {"circle": "o", "square": "s", "diamond": "D", "cross": "P", "x": "X"}


def write_figure(figure: Figure, path: Path) -> None:
    """Write one figure in the format that the suffix of the path names."""
    with own_style():  # some of the settings act only when a figure is saved
        matplotlib_figure(figure).savefig(path, dpi=200)


def own_style() -> AbstractContextManager[None]:
    """Return a context with the settings of this module alone, without a local ``matplotlibrc``."""
    from matplotlib import style

    return style.context(["default", STYLE])


def matplotlib_figure(figure: Figure) -> Canvas:
    """Return the figure, in the style of the report, on a canvas as wide as the text of a page."""
    from matplotlib.figure import Figure as Canvas

    with own_style():
        canvas = Canvas(figsize=(WIDTH, height(figure)), layout="constrained")
        draw(canvas, figure)
    return canvas


def height(figure: Figure, shrink: float = 1.0, letters: int = 110) -> float:
    """Return the height (inch) of a drawing ``letters`` wide, its panels reduced by the factor ``shrink``."""
    weights = sum(panel.weight for panel in figure.panels[:: figure.columns])
    titled = 1 if figure.share_x else figure.rows
    names = figure.entries
    entries = 22.0 * -(-len(names) // _entries_in_line(names, letters)) if names else 0.0
    words = 46.0 * titled + 14.0 * figure.rows + 20.0 + entries
    return shrink * (figure.height * weights + words) / PIXELS_PER_INCH


def _entries_in_line(names: Collection[str], letters: int) -> int:
    return max(min(len(names), letters // (max(map(len, names)) + 9)), 1)


def draw(canvas: Canvas | SubFigure, figure: Figure, letters: int = 110) -> None:
    """Draw a figure on a canvas, or on a part of one, ``letters`` wide."""
    weights = [panel.weight for panel in figure.panels[:: figure.columns]]
    canvas.suptitle(figure.title, x=0.01, ha="left", fontsize="large", fontweight="bold")
    grid = canvas.add_gridspec(figure.rows, figure.columns, height_ratios=weights)
    named: dict[str, Shown] = {}
    for index, panel in enumerate(figure.panels):
        axes = canvas.add_subplot(grid[divmod(index, figure.columns)])
        _panel(axes, figure, index, named)
        if not figure.share_x or index + figure.columns >= len(figure.panels):
            axes.set_xlabel(panel.x.title)
        else:
            axes.tick_params(labelbottom=False)
    if figure.entries:
        shown: Any = named.values()  # may be containers of bars, which matplotlib's types omit
        canvas.legend(shown, named.keys(), loc="outside lower left", ncols=_entries_in_line(named, letters))


def _panel(axes: Axes, figure: Figure, index: int, named: dict[str, Shown]) -> None:
    """Draw a panel; add what the legend names to ``named``."""
    panel, (x, y) = figure.panels[index], figure.spans(index)
    axes.set(title=panel.title, ylabel=panel.y.title)
    if panel.equal and panel.x.range is not None and panel.y.range is not None:
        axes.set(xlim=x, ylim=y, aspect="equal")
    elif panel.equal:
        axes.set_aspect("equal", adjustable="datalim")
        axes.update_datalim(list(zip(x, y, strict=True)))  # room for the words at points
    else:
        _scale(axes, "x", panel.x, x)
        _scale(axes, "y", panel.y, y)
    small: Any = {"fontsize": "small", "textcoords": "offset points", "ha": "right"}
    for band in panel.bands:
        (left, right), (low, high) = (band.bounds("x", x) or x), (band.bounds("y", y) or y)
        order = 2.0 if band.opacity == 1.0 or panel.heat is not None else 0.5
        edge = band.colour if band.outline else "none"
        look: Any = {"facecolor": band.colour, "edgecolor": edge, "alpha": band.opacity, "zorder": order}
        axes.fill_between([left, right], low, high, linewidth=0.8, **look)
        axes.annotate(band.label, (right, high), (-2, -2), va="top", color=GREY, **small)
    for mark in (*spelt(panel.marks, "x", x), *spelt(panel.marks, "y", y)):
        upright, (low, high) = mark.axis == "x", x if mark.axis == "x" else y
        line: Any = {"color": mark.colour, "linestyle": _DASHES[mark.dash], "linewidth": 0.8, "zorder": 1.0}
        (axes.axvline if upright else axes.axhline)(mark.at, **line)
        if low <= mark.at <= high:
            place: Any = (mark.at, 0.98) if upright else (0.995, mark.at)
            frame: Any = ("data", "axes fraction") if upright else ("axes fraction", "data")
            turned: Any = {"rotation": 90, "va": "top"} if upright else {"va": "bottom"}
            axes.annotate(mark.label, place, (0, 0), frame, color=mark.colour, **turned, **small)
    if panel.heat is not None:
        _heat(axes, panel.heat)
    placed = sides(panel, (x, y), *figure.size(index))
    for k, trace in enumerate(panel.coloured()):
        artist = _trace(axes, thinned(trace), placed.get(k, ()))
        if trace.name and trace.legend:
            named.setdefault(trace.name, artist)


def _scale(axes: Axes, which: Literal["x", "y"], axis: Axis, span: tuple[float, float]) -> None:
    if axis.log:
        axes.set(**{f"{which}scale": "log"})
        written = axis.decades(span)
        if written and written[0] >= 1e-3 and written[-1] < 1e5:
            words = [f"{value:,.10g}" for value in written]
            axes.set(**{f"{which}ticks": written, f"{which}ticklabels": words})
    axes.set(**{f"{which}lim": span})
    if axis.names:
        axes.set(**{f"{which}ticks": range(len(axis.names)), f"{which}ticklabels": axis.names})
        axes.grid(False, axis=which)
        if which == "x" and sum(map(len, axis.names)) > _NAMES_IN_LINE:
            axes.tick_params(axis="x", labelrotation=90)


def _trace(axes: Axes, trace: Trace, placed: Sequence[Side]) -> Shown:
    for x, y, words, side in zip(trace.x, trace.y, trace.labels, placed, strict=False):
        style: Any = {"fontsize": "small", "color": trace.colour, "textcoords": "offset points"}
        axes.annotate(words, (x, y), **style, **_offset(side))
    if trace.kind == "bars":
        width = 0.8 * float(np.min(np.diff(trace.x))) if len(trace.x) > 1 else 0.8
        return axes.bar(trace.x, trace.y, width=width, color=trace.colour)
    if trace.kind == "points":
        look: Any = {"s": (2.4 + 1.3 * trace.width) ** 2, "marker": _SYMBOLS[trace.symbol]}
        edge: Any = {"linewidths": 0.3, "edgecolors": "white", "zorder": 3}
        return axes.scatter(trace.x, trace.y, color=trace.colour, **look, **edge)
    if trace.kind == "region":
        return axes.fill(trace.x, trace.y, facecolor=trace.colour, alpha=0.13, linewidth=0.0)[0]
    look = {"linewidth": 0.62 * trace.width, "linestyle": _DASHES[trace.dash]}
    look["drawstyle"] = "steps-post" if trace.kind == "steps" else "default"
    return axes.plot(trace.x, trace.y, color=trace.colour, **look)[0]


def _offset(side: Side) -> dict[str, Any]:
    """Offset (pt) and alignment of a label at its point."""
    up, across = ("above" in side) - ("below" in side), ("right" in side) - ("left" in side)
    level, upright = ("center", "left", "right")[across], ("center", "bottom", "top")[up]
    return {"xytext": ((4 if up else 5) * across, 4 * up), "ha": level, "va": upright}


def _heat(axes: Axes, heat: Heat) -> None:
    from matplotlib.colors import LinearSegmentedColormap

    (low, high), colours = heat.limits, LinearSegmentedColormap.from_list("scale", heat.scale)
    x, y, values = cell_edges(heat.x), cell_edges(heat.y), np.ma.masked_invalid(heat.values)
    cells = axes.pcolormesh(x, y, values, cmap=colours, vmin=low, vmax=high, rasterized=True)
    axes.grid(False)
    if not heat.kinds:
        axes.figure.colorbar(cells, ax=axes, label=heat.title, pad=0.01)
