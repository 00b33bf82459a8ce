"""What a panel shows, as plotly.js reads it: lines, points, bars, regions, and fields of cells."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from typing import Any

import numpy as np

from edl6dof.report.beside import Side
from edl6dof.report.figure import PAPER, Heat, Trace

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


def packed(values: Any) -> dict[str, str] | list[Any]:
    """Numbers as plotly's packed array in single precision; a short list as it is."""
    array = np.asarray(values, float)
    if len(array) < 8:
        return [None if not np.isfinite(value) else float(value) for value in array]
    with np.errstate(over="ignore"):  # numbers of a flight that diverged become infinite, and are not drawn
        return {"dtype": "f4", "bdata": base64.b64encode(array.astype("<f4").tobytes()).decode()}


def trace_of(trace: Trace, number: str, shown: bool, beside: Sequence[Side]) -> dict[str, Any]:
    """One trace; ``shown``: in the legend; ``beside``: where each of its labels stands."""
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
        "line": {"color": trace.colour, "width": trace.width, "dash": trace.dash, "simplify": False},
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


def heat_of(heat: Heat, number: str) -> dict[str, Any]:
    """A field of cells in its colours, which the layout tells."""
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
