"""A figure as plotly.js reads it: plain dicts, so that nothing of plotly is imported for it."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from typing import Any

import numpy as np

from edl6dof.report.beside import Side, sides, spelt
from edl6dof.report.figure import (
    AXIS,
    GREY,
    INK,
    PAPER,
    RULE,
    Axis,
    Band,
    Figure,
    Heat,
    Mark,
    Panel,
    Trace,
    thinned,
)

FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'DejaVu Sans', sans-serif"
#: Pixels around and between panels.
TOP, BOTTOM, GAP_SHARED, GAP, TITLE = 34, 52, 26, 84, 22
#: Share of the width between columns.
COLUMN_GAP = 0.11
_BESIDE: dict[Side, str] = {
    "above": "top center",
    "below": "bottom center",
    "right": "middle right",
    "left": "middle left",
    "above right": "top right",
    "above left": "top left",
    "below right": "bottom right",
    "below left": "bottom left",
}
_DASHES = {"solid": "solid", "dash": "dash", "dot": "dot", "dashdot": "dashdot"}


def plotly_figure(figure: Figure) -> dict[str, Any]:
    """``{"data": [...], "layout": {...}}`` for ``Plotly.newPlot``."""
    data: list[dict[str, Any]] = []
    named: set[str] = set()
    for index, panel in enumerate(figure.panels):
        number = _number(index)
        if panel.heat is not None:
            data.append(_heat(panel.heat, number))
        beside = sides(panel, figure.spans(index), *figure.size(index))
        for k, trace in enumerate(panel.coloured()):
            shown = trace.legend and bool(trace.name) and trace.name not in named
            named.add(trace.name)
            data.append(_trace(thinned(trace), number, shown, beside.get(k, [])))
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
            _band(band, number, spans, band.opacity == 1.0 or panel.heat is not None) for band in panel.bands
        ] + [_mark(mark, number) for mark in panel.marks]
        layout["annotations"] += _words(panel, number, spans)
        if panel.heat is not None:
            layout[f"coloraxis{number}"] = _scale(panel.heat, xs, ys)
    if any(panel.title for panel in figure.panels):  # the legend goes above the titles
        layout["margin"]["t"] += TITLE
        layout["height"] += TITLE
        layout["legend"]["y"] = 1.0 + TITLE / (layout["height"] - layout["margin"]["t"] - BOTTOM)
    names = {trace.name for panel in figure.panels for trace in panel.traces if trace.legend and trace.name}
    layout["showlegend"] = len(names) > 1
    return layout


def _number(index: int) -> str:
    """What stands behind the names of a panel's axes."""
    return "" if index == 0 else str(index + 1)


def packed(values: Any) -> dict[str, str] | list[Any]:
    """Numbers as plotly's packed array in single precision; a short list as it is."""
    array = np.asarray(values, float)
    if len(array) < 8:
        return [None if not np.isfinite(value) else float(value) for value in array]
    with np.errstate(over="ignore"):  # numbers of a flight that diverged become infinite, and are not drawn
        return {"dtype": "f4", "bdata": base64.b64encode(array.astype("<f4").tobytes()).decode()}


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


def _trace(trace: Trace, number: str, shown: bool, beside: Sequence[Side]) -> dict[str, Any]:
    found: dict[str, Any] = {
        "type": "scatter",
        "mode": "lines",
        "x": packed(trace.x),
        "y": packed(trace.y),
        "xaxis": f"x{number}",
        "yaxis": f"y{number}",
        "name": trace.name,
        "legendgroup": trace.name,
        "showlegend": shown,
        "line": {"color": trace.colour, "width": trace.width, "dash": _DASHES[trace.dash], "simplify": False},
    }
    if trace.kind == "bars":
        del found["mode"], found["line"]
        found.update(type="bar", marker={"color": trace.colour})
    elif trace.kind == "points":
        hollow = {"line": {"color": PAPER, "width": 0.6}}
        found.update(
            mode="markers",
            marker={"color": trace.colour, "size": 4.0 + 2.5 * trace.width, "symbol": trace.symbol, **hollow},
        )
        del found["line"]
    elif trace.kind == "steps":
        found["line"]["shape"] = "hv"
    elif trace.kind == "region":
        found.update(fill="toself", fillcolor=f"{trace.colour}22", hoverinfo="skip")
        found["line"]["width"] = 0
    if trace.labels:
        places = [_BESIDE[side] for side in beside]
        found.update(
            text=list(trace.labels), textposition=places, textfont={"size": 11, "color": trace.colour}
        )
        if "mode" in found:
            found["mode"] += "+text"
    if not trace.name:
        found["hoverinfo"] = "x+y"
    return found


def _heat(heat: Heat, number: str) -> dict[str, Any]:
    values = np.asarray(heat.values, "<f4")
    found: dict[str, Any] = {
        "type": "heatmap",
        "x": packed(heat.x),
        "y": packed(heat.y),
        "z": {
            "dtype": "f4",
            "bdata": base64.b64encode(values.tobytes()).decode(),
            "shape": f"{values.shape[0]}, {values.shape[1]}",
        },
        "xaxis": f"x{number}",
        "yaxis": f"y{number}",
        "coloraxis": f"coloraxis{number}",
        "showlegend": False,
    }
    if heat.labels:
        found |= {"text": [list(row) for row in heat.labels], "hoverinfo": "text", "xgap": 0.5, "ygap": 0.5}
    return found


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


def _place(axis: str, number: str, bounds: tuple[float, float] | None) -> dict[str, Any]:
    """Reference and ends of a shape along one axis; without bounds from edge to edge of the panel."""
    if bounds is None:
        return {f"{axis}ref": f"{axis}{number} domain", f"{axis}0": 0, f"{axis}1": 1}
    return {f"{axis}ref": f"{axis}{number}", f"{axis}0": float(bounds[0]), f"{axis}1": float(bounds[1])}


def _band(band: Band, number: str, spans: dict[str, tuple[float, float]], above: bool) -> dict[str, Any]:
    line = {"width": 1.2, "color": band.colour} if band.outline else {"width": 0}
    shape = {
        "type": "rect",
        "layer": "above" if above else "below",
        "fillcolor": band.colour,
        "opacity": band.opacity,
        "line": line,
    }
    return {
        **shape,
        **_place("x", number, band.bounds("x", spans["x"])),
        **_place("y", number, band.bounds("y", spans["y"])),
    }


def _mark(mark: Mark, number: str) -> dict[str, Any]:
    other = "y" if mark.axis == "x" else "x"
    line = {"color": mark.colour, "width": 1.1, "dash": _DASHES[mark.dash]}
    here, across = _place(mark.axis, number, (mark.at, mark.at)), _place(other, number, None)
    return {"type": "line", "layer": "below", "line": line, **here, **across}


def _words(panel: Panel, number: str, spans: dict[str, tuple[float, float]]) -> list[dict[str, Any]]:
    """Panel title, and the words of marks and bands."""
    plain = {"showarrow": False, "font": {"size": 11, "color": GREY}}
    found = []
    if panel.title:
        place = {
            "xref": f"x{number} domain",
            "yref": f"y{number} domain",
            "x": 0.5,
            "y": 1,
            "xanchor": "center",
            "yanchor": "bottom",
        }
        found.append({"text": f"<b>{panel.title}</b>", "showarrow": False, "font": {"size": 13}, **place})
    spoken = [*spelt(panel.marks, "x", spans["x"]), *spelt(panel.marks, "y", spans["y"])]
    for mark in (mark for mark in spoken if mark.label):
        font = {"size": 11, "color": mark.colour}
        if mark.axis == "x":
            place = {
                "xref": f"x{number}",
                "yref": f"y{number} domain",
                "x": mark.at,
                "y": 0.98,
                "xanchor": "right",
                "yanchor": "top",
            }
            found.append({**plain, **place, "font": font, "text": mark.label, "textangle": -90})
        else:
            place = {
                "xref": f"x{number} domain",
                "yref": f"y{number}",
                "x": 0.995,
                "y": mark.at,
                "xanchor": "right",
                "yanchor": "bottom",
            }
            found.append({**plain, **place, "font": font, "text": mark.label})
    for band in (band for band in panel.bands if band.label):
        x, y = (
            next((bound for bound in reversed(ends) if bound is not None), None) for ends in (band.x, band.y)
        )
        place = {
            "xref": f"x{number}" + (" domain" if x is None else ""),
            "yref": f"y{number}" + (" domain" if y is None else ""),
        }
        found.append(
            {
                **plain,
                **place,
                "x": 1 if x is None else x,
                "y": 1 if y is None else y,
                "xanchor": "right",
                "yanchor": "top",
                "text": band.label,
            }
        )
    return found
