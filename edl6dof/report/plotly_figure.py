"""A figure as plotly.js reads it: plain dicts, so that nothing of plotly is imported for it."""

from __future__ import annotations

from typing import Any

import numpy as np

from edl6dof.report.beside import sides
from edl6dof.report.figure import AXIS, GREY, INK, PAPER, RULE, Axis, Figure, Heat, thinned
from edl6dof.report.plotly_marks import band_of, mark_of, words_of
from edl6dof.report.plotly_traces import heat_of, trace_of

FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'DejaVu Sans', sans-serif"
#: Pixels around and between panels.
TOP, BOTTOM, GAP_SHARED, GAP, TITLE = 34, 52, 26, 84, 22
#: Share of the width between columns.
COLUMN_GAP = 0.11


def plotly_figure(figure: Figure) -> dict[str, Any]:
    """``{"data": [...], "layout": {...}}`` for ``Plotly.newPlot``."""
    data: list[dict[str, Any]] = []
    named: set[str] = set()
    for index, panel in enumerate(figure.panels):
        number = _number(index)
        if panel.heat is not None:
            data.append(heat_of(panel.heat, number))
        beside = sides(panel, figure.spans(index), *figure.size(index))
        for k, trace in enumerate(panel.coloured()):
            shown = trace.legend and bool(trace.name) and trace.name not in named
            named.add(trace.name)
            data.append(trace_of(thinned(trace), number, shown, beside.get(k, [])))
    return {"data": data, "layout": plotly_layout(figure)}


def plotly_layout(figure: Figure) -> dict[str, Any]:
    """Where everything stands; that of the figure with other ``columns`` fits the same data."""
    layout = _frame(figure)
    for index, panel in enumerate(figure.panels):
        number = _number(index)
        xs, ys = _domains(figure, index)
        spans = dict(zip("xy", figure.spans(index), strict=True))
        last = index + figure.columns >= len(figure.panels)
        layout[f"xaxis{number}"] = _axis(panel.x, spans["x"], xs, f"y{number}", last or not figure.share_x)
        layout[f"yaxis{number}"] = _axis(panel.y, spans["y"], ys, f"x{number}")
        if figure.share_x and index >= figure.columns:
            layout[f"xaxis{number}"]["matches"] = f"x{_number(index % figure.columns)}"
        if panel.equal:
            layout[f"yaxis{number}"].update(scaleanchor=f"x{number}", scaleratio=1)
        layout["shapes"] += [
            band_of(band, number, spans, above=band.opacity == 1.0 or panel.heat is not None)
            for band in panel.bands
        ] + [mark_of(mark, number) for mark in panel.marks]
        layout["annotations"] += words_of(panel, number, spans)
        if panel.heat is not None:
            layout[f"coloraxis{number}"] = _scale(panel.heat, xs, ys)
    if any(panel.title for panel in figure.panels):  # the legend goes above the titles
        layout["margin"]["t"] += TITLE
        layout["height"] += TITLE
        layout["legend"]["y"] = 1.0 + TITLE / (layout["height"] - layout["margin"]["t"] - BOTTOM)
    layout["showlegend"] = bool(figure.entries)
    return layout


def _number(index: int) -> str:
    """What stands behind the names of a panel's axes."""
    return "" if index == 0 else str(index + 1)


def _frame(figure: Figure) -> dict[str, Any]:
    return {
        "height": round(_height(figure)),
        "margin": {"l": 68, "r": 20, "t": TOP, "b": BOTTOM},
        "font": {"family": FONT, "size": 13, "color": INK},
        "paper_bgcolor": PAPER,
        "plot_bgcolor": PAPER,
        "hovermode": "closest",
        "hoverlabel": {"font": {"family": FONT, "size": 12}},
        "legend": {
            "orientation": "h",
            "x": 0,
            "xanchor": "left",
            "y": 1,
            "yanchor": "bottom",
            "bgcolor": "rgba(0,0,0,0)",
            "font": {"size": 12},
        },
        "shapes": [],
        "annotations": [],
        "barmode": "group",
    }


def _gap(figure: Figure) -> int:
    return GAP_SHARED if figure.share_x else GAP


def _height(figure: Figure) -> float:
    weights = sum(panel.weight for panel in figure.panels[:: figure.columns])
    return figure.height * weights + _gap(figure) * (figure.rows - 1) + TOP + BOTTOM


def _domains(figure: Figure, index: int) -> tuple[list[float], list[float]]:
    """Where a panel lies, in shares of the plotting area, y upwards."""
    row, column = divmod(index, figure.columns)
    width = (1.0 - COLUMN_GAP * (figure.columns - 1)) / figure.columns
    left = column * (width + COLUMN_GAP)
    weights = [panel.weight for panel in figure.panels[:: figure.columns]]
    whole = figure.height * sum(weights) + _gap(figure) * (figure.rows - 1)
    top = 1.0 - (figure.height * sum(weights[:row]) + _gap(figure) * row) / whole
    return [left, min(left + width, 1.0)], [max(top - figure.height * weights[row] / whole, 0.0), top]


def _axis(
    axis: Axis, span: tuple[float, float], domain: list[float], anchor: str, show_title: bool = True
) -> dict[str, Any]:
    found: dict[str, Any] = {
        "domain": domain,
        "anchor": anchor,
        "showline": True,
        "linecolor": GREY,
        "mirror": True,
        "ticks": "outside",
        "tickcolor": GREY,
        "gridcolor": RULE,
        "zerolinecolor": AXIS,
        "title": {"text": axis.title.replace("\n", "<br>") if show_title else "", "standoff": 6},
        "automargin": True,
        "exponentformat": "power",
        "minexponent": 6,
    }
    if not show_title:
        found["showticklabels"] = False
    if axis.log:
        found["type"] = "log"
        if written := axis.decades(span):
            found.update(tickmode="array", tickvals=written, ticktext=[_power(value) for value in written])
    found["range"] = [float(np.log10(bound)) if axis.log else float(bound) for bound in span]
    if axis.names:
        found.update(
            tickmode="array",
            tickvals=list(range(len(axis.names))),
            ticktext=[name.replace("\n", "<br>") for name in axis.names],
            zeroline=False,
        )
    return found


def _power(value: float) -> str:
    """A number of a logarithmic axis: as it is, or as a power of ten where it is long."""
    if 1e-3 <= value < 1e5:
        return f"{value:,.10g}"
    exponent = int(np.floor(np.log10(value) + 1e-9))
    step = round(value / 10.0**exponent)
    return f"{step} x 10<sup>{exponent}</sup>" if step > 1 else f"10<sup>{exponent}</sup>"


def _scale(heat: Heat, across: list[float], up: list[float]) -> dict[str, Any]:
    """Colours of a field of cells, and the bar that tells them at the right of its panel."""
    low, high = heat.limits
    return {
        "cmin": low,
        "cmax": high,
        "colorscale": [list(step) for step in heat.scale],
        "showscale": not heat.kinds,
        "colorbar": {
            "title": {"text": heat.title, "side": "right"},
            "thickness": 12,
            "x": across[1] + 0.01,
            "xanchor": "left",
            "y": sum(up) / 2,
            "len": up[1] - up[0],
        },
    }
